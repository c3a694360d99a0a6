"""Fick's law."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import model
from solver.diffusion import diffusivity
from solver.diffusion import parameters as of_law
from solver.dispatch import implements


@model("diffusion", "jg", "rf1")
class Fick(NamedTuple):
    """Fick (1855): J = D grad c with a constant D."""

    diffusivity: of_law.Diffusivity
    max_concentration: of_law.MaxConcentration
    min_concentration: of_law.MinConcentration = 0.0
    tolerance: of_law.Tolerance = 1.0e-100
    initial_concentration: of_law.InitialConcentration = 0.0
    conductivity_equation: of_law.Conductivity = None


@implements(diffusivity, Fick)
def _(model: Fick, concentration: float, pressure: float) -> float:
    return model.diffusivity
