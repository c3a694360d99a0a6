"""What the particles of a material carry of a diffusing substance."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from solver.particles import Array, StateVariable


class Solute(NamedTuple):
    """Arrays of n particles."""

    concentration: Annotated[Array, StateVariable("p.concentration")]
    previous: Annotated[Array, StateVariable("p.concPrevious")]
    """One step earlier."""
    gradient: Annotated[Array, StateVariable("p.concentrationGradient", "Vector")]
    flux: Annotated[Array, StateVariable("p.flux", "Vector")]
    """D grad c, against the flow."""
    diffusivity: Annotated[Array, StateVariable("p.diffusivity")]
    area: Annotated[Array, StateVariable("p.area", "Vector")]
    """Areas of the sides across x, y and z of particles that carry a flux; zero for the others."""
    external_rate: Annotated[Array, StateVariable("p.externalScalarFlux")]
    """Rate of the concentration by fluxes through the surface."""


class NoSolute(NamedTuple):
    """Nothing diffuses."""
