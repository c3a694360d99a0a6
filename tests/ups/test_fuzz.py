"""Decks that were broken at random: findings and nothing else, soon, whatever the text.

A few hundred of them run each time; ``pytest -m slow tests/ups/test_fuzz.py`` runs ten thousand.
"""

from __future__ import annotations

import json
import random
import re
import time
from pathlib import Path

import pytest

from ups.diagnostics_format import RENDERERS
from ups.fixes import repaired
from ups.lint import lint_text
from ups.lsp.completion import proposals
from ups.lsp.hover import explanation
from ups.lsp.spot import spot_at

ROOT = Path(__file__).resolve().parents[2]
DECKS = sorted(ROOT.glob("inputs/**/*.ups"))
LIMIT = 2.0
"""Seconds of computing that the check of one deck may take."""

_TAG = re.compile(r"<[^<>]*>")
_VALUE = re.compile(r"(?<=>)[^<>]+(?=<)")
_PIECES = (
    "", "<", ">", "&", "&lt;", "\x00", "nan", "-1", "1e999", "[1,2", "é", "<!--", "-->", "]]>", "</a>", "\ud800",
    "0", "1.0e", "1,0", "true", '"', "'", "\u2028", "𝔘", "<![CDATA[", "<?x", "<include href='.'/>", "9" * 400,
)  # fmt: skip


def mutated(seed: int) -> tuple[Path, str]:
    """A deck that ships with a few things done to it: letters, tags and values lost, doubled, swapped, replaced."""
    chance = random.Random(seed)
    path = chance.choice(DECKS)
    text = path.read_text(encoding="utf-8")
    for _ in range(chance.randint(1, 6)):
        spans = [m.span() for m in chance.choice((_TAG, _VALUE)).finditer(text)]
        if chance.random() < 0.3 or len(spans) < 2:
            start = chance.randrange(len(text) + 1)
            first = second = (start, min(len(text), start + chance.choice((0, 1, 2, 5, 20, 400))))
        else:
            first, second = sorted(chance.sample(spans, 2))
        a, b = text[slice(*first)], text[slice(*second)]
        what = chance.randrange(5)
        if what == 0 and first != second:
            text = text[: first[0]] + b + text[first[1] : second[0]] + a + text[second[1] :]
        elif what == 1:
            text = text[: first[0]] + a + a + text[first[1] :]
        elif what == 2:
            text = text[: first[0]] + text[first[1] :]
        elif what == 3:
            text = text[: first[0]] + a[::-1] + text[first[1] :]
        else:
            text = text[: first[0]] + chance.choice(_PIECES) + text[first[1] :]
    return path, text if chance.random() < 0.95 else text[: chance.randrange(len(text) + 1)]


def check(seed: int) -> None:
    """Check, print, repair and explain one broken deck."""
    path, text = mutated(seed)
    start = time.process_time()
    result = lint_text(text, str(path))
    assert time.process_time() - start < LIMIT, f"seed {seed} took too long"
    for diagnostic in result.diagnostics:
        at = diagnostic.location
        assert diagnostic.message
        assert at is None or (at.line >= 1 and at.column >= 1 and at.length >= 1)
    for form, render in RENDERERS.items():
        printed = render(result.diagnostics, result.sources)
        assert form in ("text", "github") or json.loads(printed)
    texts, _ = repaired(result.diagnostics, {str(path): text}, unsafe=True)
    for changed in texts.values():
        lint_text(changed, str(path))
    offset = random.Random(seed).randrange(len(text) + 1)
    spot = spot_at(text, offset)
    list(proposals(spot, spot.parents, text, "mpm", path))
    explanation(spot, spot.parents, text, "mpm")


@pytest.mark.parametrize("block", range(4))
def test_broken_decks_give_findings_and_nothing_else(block):
    for seed in range(50 * block, 50 * (block + 1)):
        check(seed)


@pytest.mark.slow
def test_ten_thousand_broken_decks():
    for seed in range(1000, 11000):
        check(seed)
