"""How a concentration passes from material to material at the nodes that they share."""

from __future__ import annotations

from typing import Any, NamedTuple

from numpy.typing import NDArray

from solver.declare import family

Array = NDArray[Any]

DIFFUSION_INTERFACE = family(
    "diffusion_interface",
    tag="diffusion_interface",
    package="solver.diffusion.interface",
    key="type",
    meaning="how a concentration passes from material to material",
)


class NodalConcentration(NamedTuple):
    """Nodal values of a step, (M, N) each; an interface changes the first two concentrations, then ``rate``."""

    mass: Array
    volume: Array
    concentration: Array
    """At the start of the step, with the conditions on faces."""
    projected: Array
    """The same without them."""
    rate: Array
    star: Array
    """At the end of the step."""
    mean_stress: Array
    external: Array
    """Mass times the rate by fluxes through surfaces."""


class DiffusionInterface:
    """Base of the interfaces: nothing passes."""

    materials: tuple[int, ...]

    def listed(self, count: int) -> list[int]:
        """The materials that the interface is between; all where the deck lists none."""
        return list(self.materials) or list(range(count))

    def share_concentration(self, nodal: NodalConcentration) -> None:
        """Act on the projected concentrations, in place."""

    def share_rate(self, nodal: NodalConcentration, dt: float) -> None:
        """Act on the rates that the fluxes make, in place."""

    def check(self, count: int) -> None:
        """Raise ValueError where a listed material does not exist."""
        wrong = [m for m in self.materials if not 0 <= m < count]
        if wrong:
            raise ValueError(f"<materials> lists {wrong[0]}: there are materials 0 to {count - 1}")
