"""What all tests share: reference material beside the checkout, and settings of the tools.

Compiled kernels are kept where ``solver.jit`` puts them, a folder named after the state of the sources. The
first import settles that folder in the environment, so that all tests and programs that they start share it.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("project", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("project")

SHARED = Path(__file__).resolve().parents[2] / "shared"


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out the slow cases unless they are asked for."""
    if "slow" in config.getoption("markexpr"):
        return
    for item in items:
        if item.get_closest_marker("slow"):
            item.add_marker(pytest.mark.skip(reason="takes minutes; run with -m slow"))


@pytest.fixture(autouse=True, scope="session")
def _types_are_checked() -> None:
    """Kernels that are called without a look at the types are given the same types each time."""
    from solver.jit.calls import Calls

    Calls.checks = True


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of reference runs, decks and archives; a test that asks for it is skipped without it."""
    if not SHARED.is_dir():
        pytest.skip("needs the folder ../shared")
    return SHARED
