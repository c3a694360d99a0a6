"""Constitutive models: each module one model, with its parameters, its state and its stress update."""

from __future__ import annotations

from solver.declare import family

CONSTITUTIVE_MODEL = family(
    "constitutive_model",
    tag="constitutive_model",
    package="solver.materials",
    key="@type",
    meaning="how a material answers deformation with stress",
)
