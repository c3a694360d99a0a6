"""UPS420."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, register_code
from ups.element import Element
from ups.rules.bodies import bodies
from ups.rules.rule import DeckView, Domain, Rule, periodic_axes

_PARTS = ("side", "circle", "annulus", "ellipse", "rectangle", "rectangulus")
_METHODS = ("mpm", "amrmpm")
_REACH = 0.5
"""How near to a face a body touches it, in cells."""


class UnguardedFace(Rule):
    """A body touches a face of the grid that has no condition, or a face is named and given none.

    **Why.** Through a face without a condition particles leave the grid, and are deleted there, as if nothing
    were. A problem in a plane, one cell thick, needs ``Symmetric`` on both faces of its thickness: without, the
    body is free to swell out of the plane and is in neither plane strain nor plane stress. Of an axisymmetric
    problem z is the angle, and needs nothing.

    **Example.** A grid of 100 x 100 x 1 cells, bodies through all of its thickness, and no ``<Face side="z-">``.

    **Repair.** Give the face a condition, e.g. ``<Face side="z-"> <BCType id="all" label="Symmetric"
    var="symmetry"/> </Face>``, make the grid periodic there, or larger than its bodies. Where particles are
    meant to leave, keep the warning quiet.
    """

    code = register_code("UPS420", "face without a boundary condition")
    title = "face without a boundary condition"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look at faces without conditions, and at the bodies beside those that are not given."""
        faces = list(deck.all("Grid/BoundaryConditions/Face"))
        for face in faces:
            if not face.children:
                yield self.warning("this <Face> has no condition", face, "add a <BCType>, or remove the face")
        domain, level = deck.domain, deck.find("Grid/Level")
        if domain is None or domain.spacing is None or level is None or deck.component not in _METHODS:
            return
        if not deck.deck.document.complete:
            return
        given = {side for face in faces if face.children for side in _sides(face)}
        periodic = periodic_axes(deck)
        for axis in range(2 if deck.switch("MPM/axisymmetric") else 3):
            if not periodic[axis]:
                free = [side for side in ("-", "+") if f"{'xyz'[axis]}{side}" not in given]
                yield from self._check_axis(deck, domain, axis, free)

    def _check_axis(self, deck: DeckView, domain: Domain, axis: int, free: list[str]) -> Iterator[Diagnostic]:
        assert domain.spacing is not None
        cells = (domain.upper[axis] - domain.lower[axis]) / domain.spacing[axis]
        reach = _REACH * domain.spacing[axis]
        touching: dict[str, Element] = {}
        for body in (b for material in deck.particle_materials for b in bodies(deck, material)):
            if body.lower[axis] < domain.lower[axis] + reach and body.upper[axis] > domain.lower[axis]:
                touching.setdefault("-", body.element)
            if body.upper[axis] > domain.upper[axis] - reach and body.lower[axis] < domain.upper[axis]:
                touching.setdefault("+", body.element)
        names = [f"{'xyz'[axis]}{side}" for side in free if side in touching]
        if not names:
            return
        at = deck.find("Grid/BoundaryConditions") or deck.find("Grid")
        assert at is not None
        which = " and ".join(names)
        if cells < 1.5:
            message = f"the grid is one cell thick in {'xyz'[axis]}, without a condition on {which}"
            yield self.warning(message, at, "add Symmetric there for plane strain")
        else:
            found = dict.fromkeys(touching[side].location.line for side in free if side in touching)
            lines = ", ".join(map(str, found))
            message = (
                f"no condition on {which}, which a body touches (line {lines}): particles can leave there"
            )
            yield self.warning(message, at, "add a <Face> with a condition")


def _sides(face: Element) -> Iterator[str]:
    """The faces of the grid that a ``<Face>`` is about, the whole of one or a part."""
    for name in _PARTS:
        attribute = face.attributes.get(name)
        if attribute is not None:
            yield attribute.value.strip()
