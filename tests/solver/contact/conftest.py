from __future__ import annotations

from collections.abc import Callable

import pytest
from contact_scenes import random_scene

from solver.contact.law import ContactScene


@pytest.fixture
def scene() -> Callable[..., ContactScene]:
    """Make a scene of random nodal fields; see ``contact_scenes.random_scene``."""
    return random_scene
