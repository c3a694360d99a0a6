"""Diffusion of a concentration through materials; each module here is one law, or close kin.

The concentration c lives on particles. A step projects it to the nodes, weighted by mass, takes the flux of
each particle from its law, and adds the divergence of the fluxes to the nodes:

    c_i = sum m c S / sum m S,   c_i' = -sum m J . G / sum m S,   c_p += dt sum c_i' S,   grad c_p = sum c_i* G,

with J = D grad c (against the flow, as Uintah stores it) and c_i* = c_i + dt c_i', on which the conditions of
faces act. As for heat, a surface without a condition lets nothing through.
"""

from __future__ import annotations

from typing import Any

from solver.declare import family
from solver.dispatch import generic, generic_with_default

DIFFUSION = family(
    "diffusion",
    tag="diffusion_model",
    package="solver.diffusion",
    key="@type",
    meaning="how a concentration spreads in a material",
)


@generic
def diffusivity(model: Any, concentration: float, pressure: float) -> float:
    """D of a particle with a concentration and a pressure (minus a third of the trace of the stress)."""
    raise NotImplementedError


@generic_with_default
def drift(model: Any, concentration: float) -> float:
    """The factor f in J = D (grad c - f grad sigma_m), by which mean stress drives the flux; 0 for most laws."""
    return 0.0


@generic_with_default
def source(model: Any) -> float:
    """Rate of the concentration everywhere in the material; 0 for most laws."""
    return 0.0


def holds_diffusivity(model: Any, time: float) -> bool:
    """Whether particles keep the diffusivity that they have (a law's ``diff_curve`` may say so)."""
    curve = getattr(model, "diff_curve", None)
    return curve is not None and curve.direction(time) == "out"
