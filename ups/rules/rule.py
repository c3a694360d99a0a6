"""The base of rules, and what they see of a deck."""

from __future__ import annotations

import importlib
import math
import pkgutil
from collections.abc import Iterator
from functools import cache, cached_property
from typing import Any, ClassVar

from ups.deck import Deck
from ups.diagnostics import Diagnostic, Fix, Located, Location, Severity
from ups.element import Element
from ups.values import number, numbers


class Domain:
    """The box that the grid covers, and its finest cell."""

    def __init__(self, lower: list[float], upper: list[float], spacing: list[float] | None) -> None:
        self.lower = lower
        self.upper = upper
        self.spacing = spacing


class DeckView:
    """A deck as rules look at it: its tree, and the records that could be read from it.

    Rules work on decks with errors too, so that nothing here may be relied on to be there.
    """

    def __init__(self, deck: Deck, component: str) -> None:
        assert deck.document.root is not None
        self.deck = deck
        self.root: Element = deck.document.root
        self.component = component

    def record(self, element: Element) -> Any | None:
        """The record that was read from an element; None where that failed."""
        return self.deck.reader.record(element)

    def find(self, path: str) -> Element | None:
        """The first element at a path of tags below the root."""
        return self.root.find(path)

    def all(self, path: str) -> Iterator[Element]:
        """Every element at a path of tags below the root."""
        return self.root.find_all(path)

    def text(self, path: str, default: str = "") -> str:
        """The text at a path of tags below the root."""
        element = self.find(path)
        return default if element is None else element.text

    def number(self, path: str) -> float | None:
        """The number at a path of tags below the root; None where there is none."""
        element = self.find(path)
        return None if element is None else number(element.text)

    def number_of(self, element: Element, tag: str) -> float | None:
        """The number that a child gives; None where there is none."""
        child = element.get(tag)
        return None if child is None else number(child.text)

    def switch(self, path: str) -> bool:
        """Whether the text at a path of tags is ``true``."""
        return self.text(path) == "true"

    @cached_property
    def particle_materials(self) -> list[Element]:
        """The materials of the material point method, in the order of their indices."""
        return list(self.all("MaterialProperties/MPM/material"))

    @property
    def particle_material_count(self) -> int:
        """How many materials of particles a run has; copies that take over failed particles count too."""
        return len(self.particle_materials) * (2 if self.switch("MPM/create_new_particles") else 1)

    @property
    def zone_count(self) -> int:
        """How many materials of cohesive zones an archive has; they come after the others."""
        used = self.switch("MPM/use_cohesive_zones")
        return len(list(self.all("MaterialProperties/MPM/cohesive_zone"))) if used else 0

    @cached_property
    def gas_materials(self) -> list[Element]:
        """The materials of gas dynamics, in the order of their indices."""
        return list(self.all("MaterialProperties/ICE/material"))

    @cached_property
    def material_count(self) -> int:
        """How many materials there are of all kinds; those of particles come first."""
        return self.particle_material_count + len(self.gas_materials)

    @cached_property
    def domain(self) -> Domain | None:
        """What the boxes of the first level cover; None where they cannot be read."""
        level = self.find("Grid/Level")
        corners = [
            (_vector(box, "lower"), _vector(box, "upper"), box) for box in (level.all("Box") if level else ())
        ]
        given = [(low, high, box) for low, high, box in corners if low and high]
        if not given or len(given) != len(corners):
            return None
        lower = [min(c[0][a] for c in given) for a in range(3)]
        upper = [max(c[1][a] for c in given) for a in range(3)]
        if any(not high > low or math.isinf(high - low) for low, high in zip(lower, upper, strict=True)):
            return None
        return Domain(lower, upper, _spacing(level, *given[0]))


def _vector(element: Element, tag: str) -> list[float]:
    """The three numbers of a child, or nothing."""
    child = element.get(tag)
    found = numbers(child.text) if child is not None else None
    return found if found is not None and len(found) == 3 else []


def _spacing(
    level: Element | None, lower: list[float], upper: list[float], box: Element
) -> list[float] | None:
    for owner in (box, level):
        found = _vector(owner, "spacing") if owner is not None else []
        if found:
            return found if all(0.0 < cell < math.inf for cell in found) else None
    cells = _vector(box, "resolution")
    if not cells or any(not 1 <= n < math.inf for n in cells):
        return None
    return [(high - low) / n for low, high, n in zip(lower, upper, cells, strict=True)]


def periodic_axes(deck: DeckView) -> list[bool]:
    """Whether the grid repeats in x, y and z."""
    for path in ("Grid/Level/periodic", "Grid/Level/Box/periodic"):
        element = deck.find(path)
        found = numbers(element.text) if element is not None else None
        if found is not None and len(found) == 3:
            return [bool(n) for n in found]
    return [False] * 3


class Rule:
    """One thing that can be wrong with a deck.

    Attributes
    ----------
    code : the code of its findings.
    title : what it finds, in a phrase.
    """

    code: ClassVar[str]
    title: ClassVar[str]

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Yield what is wrong with a deck."""
        raise NotImplementedError

    def error(
        self, message: str, at: Located | Location, suggestion: str | None = None, fix: Fix | None = None
    ) -> Diagnostic:
        """A finding that stops the run."""
        return self._finding(Severity.ERROR, message, at, suggestion, fix)

    def warning(
        self, message: str, at: Located | Location, suggestion: str | None = None, fix: Fix | None = None
    ) -> Diagnostic:
        """A finding that does not."""
        return self._finding(Severity.WARNING, message, at, suggestion, fix)

    def note(
        self, message: str, at: Located | Location, suggestion: str | None = None, fix: Fix | None = None
    ) -> Diagnostic:
        """A finding that only informs."""
        return self._finding(Severity.NOTE, message, at, suggestion, fix)

    def _finding(
        self,
        severity: Severity,
        message: str,
        at: Located | Location,
        suggestion: str | None,
        fix: Fix | None,
    ) -> Diagnostic:
        place = at if isinstance(at, Location) else at.location
        return Diagnostic(self.code, severity, message, place, suggestion, fix)


@cache
def all_rules() -> tuple[Rule, ...]:
    """One of each rule of the package, in the order of their codes."""
    package = importlib.import_module("ups.rules")
    for module in pkgutil.iter_modules(package.__path__):
        importlib.import_module(f"ups.rules.{module.name}")
    return tuple(sorted((rule() for rule in Rule.__subclasses__()), key=lambda rule: rule.code))
