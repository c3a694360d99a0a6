"""Geomaterials with a cap: the Arenisca family and its kin."""

from typing import Annotated

from solver.declare import Parameter, Section
from ups.grammar import known

_DISTRIBUTION = "distribution of PEAKI1, as weibull, mean, modulus, volume, seed"


class CapModel(Section):
    """What the models of the family share."""

    PEAKI1: Annotated[float, Parameter("tension limit of the first invariant", unit="Pa")]
    FSLOPE: Annotated[float, Parameter("slope of the shear limit at low pressure")]
    CR: Annotated[float, Parameter("shape of the cap", ge=0.0)]
    p0_crush_curve: Annotated[float, Parameter("pressure at which pores begin to close", unit="Pa")]
    p1_crush_curve: Annotated[float, Parameter("rate of the closing", unit="1/Pa")]
    p3_crush_curve: Annotated[float, Parameter("volume strain of all pores")]
    fluid_B0: Annotated[float, Parameter("bulk modulus of the pore fluid", unit="Pa")]
    B0: Annotated[float, Parameter("bulk modulus", unit="Pa")]
    G0: Annotated[float, Parameter("shear modulus", unit="Pa")]
    fluid_pressure_initial: Annotated[
        float, Parameter("pressure of the pore fluid at the start", unit="Pa")
    ] = 0.0
    T1_rate_dependence: Annotated[float, Parameter("first constant of the rate dependence", unit="s")] = 0.0
    T2_rate_dependence: Annotated[float, Parameter("second constant of the rate dependence")] = 0.0
    subcycling_characteristic_number: Annotated[float, Parameter("fineness of sub-steps")] = 256.0
    Use_Disaggregation_Algorithm: Annotated[bool, Parameter("let the rock fall to powder")] = False
    PEAKI1IDIST: Annotated[str, Parameter(_DISTRIBUTION, old_tags=("PeakI1IDist",))] = ""
    hardening_modulus: Annotated[float, Parameter("hardening modulus", unit="Pa")] = 0.0
    evolve_damage: Annotated[bool, Parameter("let damage grow", ignored="it is read no longer")] = False


@known("constitutive_model", "Arenisca")
class Arenisca(CapModel):
    """The second version: a Drucker-Prager limit with a cap."""

    p4_fluid_effect: Annotated[float, Parameter("effect of the pore fluid")]
    FSLOPE_p: Annotated[float, Parameter("slope of the plastic potential")] = 0.0
    kinematic_hardening_constant: Annotated[float, Parameter("kinematic hardening", unit="Pa")] = 0.0
    gruneisen_parameter: Annotated[float, Parameter("Gruneisen coefficient")] = 0.1
    p2_crush_curve: Annotated[float, Parameter("second constant of the closing")] = 0.0
    STREN: Annotated[float, Parameter("shear limit at high pressure", unit="Pa")] = 0.0
    YSLOPE: Annotated[float, Parameter("slope of the shear limit at high pressure")] = 0.0
    BETA_nonassociativity: Annotated[float, Parameter("share of associated flow")] = 1.0
    B01: Annotated[float, Parameter("bulk modulus of another version", unit="Pa")] = 0.0
    B1: Annotated[float, Parameter("bulk modulus at high pressure", unit="Pa")] = 0.0
    B2: Annotated[float, Parameter("pressure of the stiffening", unit="Pa")] = 0.0
    B3: Annotated[float, Parameter("softening by plastic strain", unit="Pa")] = 0.0
    B4: Annotated[float, Parameter("strain of that softening")] = 0.0
    G1: Annotated[float, Parameter("shear modulus at high pressure", unit="Pa")] = 0.0
    G2: Annotated[float, Parameter("pressure of the stiffening", unit="Pa")] = 0.0
    G3: Annotated[float, Parameter("softening by plastic strain", unit="Pa")] = 0.0
    G4: Annotated[float, Parameter("strain of that softening")] = 0.0
