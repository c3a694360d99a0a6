"""Neo-Hookean models with damage inside, from before damage was a part of the material."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section
from ups.grammar import known


@known("constitutive_model", "cnh_damage")
class NeoHookeanDamage(Section):
    """A neo-Hookean material that fails."""

    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    shear_modulus: Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)]
    useModifiedEOS: Annotated[bool, Parameter("stiffen in compression")] = False
    useInitialStress: Annotated[bool, Parameter("start with a pressure")] = False
    initial_pressure: Annotated[float, Parameter("pressure at the start", unit="Pa")] = 0.0
    failure_criteria: Annotated[str, Parameter("what is compared with the strength")] = ""
    failure_by_stress: Annotated[bool, Parameter("compare stress, not strain")] = True
    failure_mean: Annotated[float, Parameter("mean strength")] = 0.0
    failure_std: Annotated[float, Parameter("standard deviation of the strength")] = 0.0
    failure_distrib: Annotated[
        str, Parameter("distribution of the strength", choices=("constant", "gauss", "weibull", "uniform"))
    ] = "constant"
    failure_seed: Annotated[int, Parameter("seed of the random numbers")] = 0
    exponent: Annotated[float, Parameter("exponent of the effect of size")] = 0.0
    scaling: Annotated[str, Parameter("effect of size", choices=("none", "kayenta"))] = "none"
    reference_volume: Annotated[float, Parameter("volume the strength holds for", ge=0.0)] = 0.0
    char_time: Annotated[float, Parameter("time in which stress decays after failure", unit="s")] = 0.0


@known("constitutive_model", "cnhp_damage")
class NeoHookeanPlasticDamage(NeoHookeanDamage):
    """A neo-Hookean material that yields and fails."""

    yield_stress: Annotated[float, Parameter("yield stress", unit="Pa", ge=0.0)]
    hardening_modulus: Annotated[float, Parameter("hardening modulus", unit="Pa")]
    alpha: Annotated[float, Parameter("plastic strain at the start")] = 0.0
    yield_distrib: Annotated[
        str, Parameter("distribution of the yield stress", choices=("constant", "uniform"))
    ] = "constant"
    yield_range: Annotated[float, Parameter("width of that distribution", unit="Pa")] = 0.0
    yield_seed: Annotated[int, Parameter("seed of the random numbers")] = 0
