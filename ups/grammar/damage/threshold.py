"""Failure at a threshold."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section
from ups.grammar import known


class ColourEntry(Section):
    """Strength of the particles of a color."""

    color: Annotated[float, Parameter("the color")]
    mean: Annotated[float, Parameter("mean strength")]
    std: Annotated[float, Parameter("standard deviation of the strength")]


class VariableProperties(Section):
    """Strength against color."""

    entry: Annotated[tuple[ColourEntry, ...], Parameter("strength of a color")] = ()


@known("damage", "Threshold")
class Threshold(Section):
    """A particle fails at a stress or strain that is drawn at random."""

    failure_criteria: Annotated[
        str,
        Parameter("what is compared", choices=("MaximumPrincipalStress", "MaximumPrincipalStrain", "MohrCoulomb")),
    ]
    failure_distrib: Annotated[
        str, Parameter("distribution of the strength", choices=("constant", "gauss", "weibull", "uniform"))
    ]
    failure_mean: Annotated[float, Parameter("mean strength", ge=0.0)]
    failure_std: Annotated[float, Parameter("standard deviation, or Weibull modulus", ge=0.0)]
    failure_seed: Annotated[int, Parameter("seed of the random numbers")] = 0
    exponent: Annotated[float, Parameter("exponent of the effect of size")] = 0.0
    scaling: Annotated[str, Parameter("effect of size", choices=("none", "kayenta"))] = "none"
    reference_volume: Annotated[float, Parameter("volume the strength holds for", ge=0.0)] = 0.0
    friction_angle: Annotated[float, Parameter("angle of internal friction", unit="degrees")] = 0.0
    tensile_cutoff_fraction_of_cohesion: Annotated[
        float, Parameter("tensile strength as a share of the cohesion", ge=0.0)
    ] = 0.0
    LocalizeParticles: Annotated[bool, Parameter("let particles fail")] = True


@known("damage", "ThresholdVar")
class ThresholdVar(Threshold):
    """A particle fails at a stress or strain that depends on its color."""

    failure_mean: Annotated[float, Parameter("mean strength", ge=0.0)] = 0.0
    failure_std: Annotated[float, Parameter("standard deviation", ge=0.0)] = 0.0
    failure_distrib: Annotated[
        str, Parameter("distribution of the strength", choices=("constant", "gauss", "weibull", "uniform"))
    ] = "constant"
    variable_properties: Annotated[VariableProperties | None, Parameter("strength against color")] = None
