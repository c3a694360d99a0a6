"""Validation: decks at full length against published or exact answers.

Each folder is a case: ``expected.json`` holds the answers with tolerances and sources, ``result.json``
what the last recorded run gave. They run with ``pytest -m slow``; ``UPS_RECORD=1 pytest -m slow`` writes
the results down.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "inputs"))  # the helpers of the shortened forms

from validation_case import Case


@pytest.fixture
def case(request: pytest.FixtureRequest) -> Case:
    """The case in whose folder the test lies."""
    return Case(Path(request.path).parent)
