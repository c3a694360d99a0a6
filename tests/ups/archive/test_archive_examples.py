"""The examples in the docstrings do what they say."""

import doctest

import pytest

import ups.archive.layout
import ups.archive.writer


@pytest.mark.parametrize(
    "module", [ups.archive.layout, ups.archive.writer], ids=lambda module: module.__name__
)
def test_examples(module):
    outcome = doctest.testmod(module)
    assert outcome.attempted > 0
    assert outcome.failed == 0
