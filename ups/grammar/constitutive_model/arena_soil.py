"""Partially saturated soil."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import Parameter, Section, SectionOf
from ups.grammar import known

_HERE = "ups.grammar.constitutive_model.arena_soil"


class ArenaElasticity(Section):
    """Elastic moduli that depend on pressure."""

    type: Annotated[str, Parameter("the model", choices=("arena",), attribute=True)]
    b0: Annotated[float, Parameter("first constant of the bulk modulus")]
    b1: Annotated[float, Parameter("second constant of the bulk modulus")]
    b2: Annotated[float, Parameter("third constant of the bulk modulus")]
    b3: Annotated[float, Parameter("fourth constant of the bulk modulus")]
    b4: Annotated[float, Parameter("fifth constant of the bulk modulus")]
    G0: Annotated[float, Parameter("shear modulus", unit="Pa")]
    nu1: Annotated[float, Parameter("Poisson's ratio at low pressure")]
    nu2: Annotated[float, Parameter("change of Poisson's ratio")]


class ArenaYield(Section):
    """The limit and the cap."""

    type: Annotated[str, Parameter("the model", choices=("arena",), attribute=True)]
    PEAKI1: Annotated[float, Parameter("tension limit of the first invariant", unit="Pa")]
    FSLOPE: Annotated[float, Parameter("slope of the shear limit at low pressure")]
    STREN: Annotated[float, Parameter("shear limit at high pressure", unit="Pa")]
    YSLOPE: Annotated[float, Parameter("slope of the shear limit at high pressure")]
    BETA: Annotated[float, Parameter("share of associated flow")]
    CR: Annotated[float, Parameter("shape of the cap")]
    T1: Annotated[float, Parameter("first constant of the rate dependence", unit="s")]
    T2: Annotated[float, Parameter("second constant of the rate dependence")]
    PEAKI1_failed: Annotated[float, Parameter("PEAKI1 after failure", unit="Pa")] = 0.0
    FSLOPE_failed: Annotated[float, Parameter("FSLOPE after failure")] = 0.0
    STREN_failed: Annotated[float, Parameter("STREN after failure", unit="Pa")] = 0.0
    YSLOPE_failed: Annotated[float, Parameter("YSLOPE after failure")] = 0.0
    weibullDist_PEAKI1: Annotated[str, Parameter("distribution of PEAKI1")] = ""
    weibullDist_FSLOPE: Annotated[str, Parameter("distribution of FSLOPE")] = ""
    weibullDist_STREN: Annotated[str, Parameter("distribution of STREN")] = ""
    weibullDist_YSLOPE: Annotated[str, Parameter("distribution of YSLOPE")] = ""
    weibullDist_BETA: Annotated[str, Parameter("distribution of BETA")] = ""
    weibullDist_CR: Annotated[str, Parameter("distribution of CR")] = ""
    weibullDist_T1: Annotated[str, Parameter("distribution of T1")] = ""
    weibullDist_T2: Annotated[str, Parameter("distribution of T2")] = ""


@known("constitutive_model", "ArenaSoil")
class ArenaSoil(Section):
    """Soil whose pores hold water and air (Banerjee and Brannon)."""

    elastic_moduli_model: Annotated[
        Any, SectionOf(f"{_HERE}:ArenaElasticity"), Parameter("elastic moduli")
    ] = None
    plastic_yield_condition: Annotated[
        Any, SectionOf(f"{_HERE}:ArenaYield"), Parameter("the limit and the cap")
    ]
    initial_porosity: Annotated[float, Parameter("porosity at the start", ge=0.0, le=1.0)]
    initial_saturation: Annotated[float, Parameter("share of the pores with water", ge=0.0, le=1.0)]
    initial_fluid_pressure: Annotated[float, Parameter("pressure of the pore fluid at the start", unit="Pa")]
    reference_porosity: Annotated[float, Parameter("porosity that the constants hold for")] = 0.0
    p0: Annotated[float, Parameter("first constant of the crush curve")]
    p1: Annotated[float, Parameter("second constant of the crush curve")]
    p1_sat: Annotated[float, Parameter("second constant for full pores")]
    p1_density_scale_fac: Annotated[float, Parameter("its change with density")] = 0.0
    p2: Annotated[float, Parameter("third constant of the crush curve")]
    p3: Annotated[float, Parameter("fourth constant of the crush curve")]
    use_disaggregation_algorithm: Annotated[bool, Parameter("let the soil fall to powder")] = False
    do_damage: Annotated[bool, Parameter("let the strength decay")] = False
    fspeed: Annotated[float, Parameter("speed of the decay")] = 1.0e-9
    time_at_failure: Annotated[float, Parameter("time of failure", unit="s")] = 1.0e9
    eq_plastic_strain_at_failure: Annotated[float, Parameter("plastic strain at failure")] = 1.0e9
    yield_surface_radius_scaling_factor: Annotated[float, Parameter("scale of the yield surface")] = 1.0
    consistency_bisection_tolerance: Annotated[float, Parameter("tolerance of the bisection")] = 1.0e-4
    subcycling_characteristic_number: Annotated[float, Parameter("fineness of sub-steps")] = 256.0
    K0_Murnaghan_EOS: Annotated[float, Parameter("bulk modulus of Murnaghan's law", unit="Pa")] = 2.5e8
    n_Murnaghan_EOS: Annotated[float, Parameter("exponent of Murnaghan's law")] = 13.0
