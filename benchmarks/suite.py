"""What is measured: blocks of all sizes, models and interpolators, and the decks of the reference runs."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import NamedTuple

from benchmarks.block import INTERPOLATORS, MODELS, block_deck
from ups.deck import Deck, read_deck

REFERENCE = Path(__file__).resolve().parents[2] / "shared" / "reference"
"""Decks with the runs of Uintah's ``sus`` beside them, where they are at hand."""

LEAST_PARTICLES = 1000
"""Smaller reference decks tell nothing of speed."""


class Case(NamedTuple):
    """Something to measure."""

    name: str
    deck: Callable[[], Deck]
    sus: float | None = None
    """Seconds a step of Uintah's ``sus`` on one core of the machine on which the reference was made."""


def blocks(sizes: tuple[int, ...]) -> Iterator[Case]:
    """Every model with every interpolator, in every size."""
    for particles in sizes:
        for model in MODELS:
            for interpolator in INTERPOLATORS:
                yield block(model, interpolator, particles)


def quick_blocks() -> Iterator[Case]:
    """Two blocks that between them see most of the program, for a look at every change."""
    yield block("comp_neo_hook", "linear", 64_000)
    yield block("elastic_plastic", "gimp", 64_000)


def block(model: str, interpolator: str, particles: int) -> Case:
    """A block of copper; see ``benchmarks.block``."""
    text = block_deck(model, interpolator, particles)
    return Case(f"block {model} {interpolator} {particles}", partial(read_deck, "block.ups", text=text))


def reference_decks() -> Iterator[Case]:
    """The decks of the reference runs that are large enough."""
    for about in sorted(REFERENCE.glob("*/run.json")):
        facts = json.loads(about.read_text())
        deck = about.with_name("deck.ups")
        if _particles(facts["particles"]) > LEAST_PARTICLES:
            yield Case(about.parent.name, partial(read_deck, deck), facts["seconds_per_step"])


def _particles(counts: dict[str, int]) -> int:
    """The particles of all materials at the first stored step, from counts by ``step/material``."""
    first = min(key.split("/")[0] for key in counts)
    return sum(count for key, count in counts.items() if key.split("/")[0] == first)
