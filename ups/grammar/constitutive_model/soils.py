"""Soils and quasi-brittle materials."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section
from ups.grammar import known


@known("constitutive_model", "HypoplasticB")
class HypoplasticB(Section):
    """Hypoplasticity of sand after von Wolffersdorff and Bauer."""

    ei0_B: Annotated[float, Parameter("greatest void ratio")] = 0.0
    ed0_B: Annotated[float, Parameter("least void ratio")] = 0.0
    ec0_B: Annotated[float, Parameter("critical void ratio")] = 0.0
    phic_B: Annotated[float, Parameter("critical angle of friction", unit="degrees")] = 0.0
    hs_B: Annotated[float, Parameter("hardness of the grains", unit="Pa")] = 0.0
    beta_B: Annotated[float, Parameter("exponent of the stiffness")] = 0.0
    n_B: Annotated[float, Parameter("exponent of the compression")] = 0.0
    alpha_B: Annotated[float, Parameter("exponent of the strength")] = 0.0
    E_B: Annotated[float, Parameter("Young's modulus", unit="Pa")] = 0.0
    v_B: Annotated[float, Parameter("Poisson's ratio")] = 0.0
    epocz_B: Annotated[float, Parameter("void ratio at the start")] = 0.0
    nl_B: Annotated[float, Parameter("weight of the non-local average")] = 0.0
    lchar_B: Annotated[float, Parameter("length of the average", unit="m")] = 0.0
    mean_pressure: Annotated[float, Parameter("pressure at the start", unit="Pa")] = 0.0
    phase: Annotated[float, Parameter("phase at the start")] = 0.0
    phase_change: Annotated[float, Parameter("time of the change of phase", unit="s")] = 0.0
    Volumerate: Annotated[float, Parameter("rate of the volume")] = 0.0


@known("constitutive_model", "QADamage")
class QuasiBrittleDamage(Section):
    """Non-local damage of concrete."""

    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    shear_modulus: Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)]
    useModifiedEOS: Annotated[bool, Parameter("stiffen in compression")] = False
    length_scale: Annotated[float, Parameter("length of the average", unit="m")] = 0.0
    length_mesh: Annotated[float, Parameter("length of a cell", unit="m")] = 0.0
    k_ratio: Annotated[float, Parameter("ratio of strengths in compression and tension")] = 0.0
    tensile_strength: Annotated[float, Parameter("tensile strength", unit="Pa")] = 0.0
    fracture_energy: Annotated[float, Parameter("fracture energy", unit="J/m^2")] = 0.0
    n_nonlocal: Annotated[float, Parameter("weight of the non-local average")] = 0.0
    a: Annotated[float, Parameter("first constant of the rate dependence")] = 0.0
    b: Annotated[float, Parameter("second constant of the rate dependence")] = 0.0
    beta: Annotated[float, Parameter("exponent of the softening")] = 0.0
    ref_eqstrain: Annotated[float, Parameter("reference rate of strain", unit="1/s")] = 0.0
    usePlasticity: Annotated[bool, Parameter("let it yield")] = False
    alpha: Annotated[float, Parameter("plastic strain at the start")] = 0.0
    yield_stress: Annotated[float, Parameter("yield stress", unit="Pa")] = 0.0
    hardening_modulus: Annotated[float, Parameter("hardening modulus", unit="Pa")] = 0.0
    useInitialStress: Annotated[bool, Parameter("start with a pressure")] = False
    initial_pressure: Annotated[float, Parameter("pressure at the start", unit="Pa")] = 0.0


@known("constitutive_model", "ceramic_fiber_damage")
class CeramicFiberDamage(Section):
    """A ceramic matrix with fibres, and cracks in both."""

    E_matrix: Annotated[float, Parameter("Young's modulus of the matrix", unit="Pa")]
    nu_matrix: Annotated[float, Parameter("Poisson's ratio of the matrix")]
    E_fiber_transverse: Annotated[float, Parameter("Young's modulus across the fibres", unit="Pa")]
    E_fiber_longitudinal: Annotated[float, Parameter("Young's modulus along the fibres", unit="Pa")]
    G_fiber_longitudinal: Annotated[float, Parameter("shear modulus along the fibres", unit="Pa")]
    K_fiber: Annotated[float, Parameter("bulk modulus of the fibres", unit="Pa")]
    nu_fiber: Annotated[float, Parameter("Poisson's ratio of the fibres")]
    fiber_volume_fraction: Annotated[float, Parameter("share of fibres", ge=0.0, le=1.0)]
    porosity: Annotated[float, Parameter("share of pores", ge=0.0, le=1.0)]
    pore_aspect_ratio: Annotated[float, Parameter("shape of the pores")] = 1.0
    alpha_matrix: Annotated[float, Parameter("thermal expansion of the matrix", unit="1/K")]
    sigma_o: Annotated[float, Parameter("stress at which cracks begin", unit="Pa")]
    rho_o: Annotated[float, Parameter("density of cracks at the start")]
    rho_c: Annotated[float, Parameter("density of cracks at saturation")]
    rho_n: Annotated[float, Parameter("exponent of their growth")]
    nu_o: Annotated[float, Parameter("opening of cracks at the start")]
    nu_n: Annotated[float, Parameter("exponent of the opening")]
    v_f_eff: Annotated[float, Parameter("share of fibres that carry load")]
    E_fiber_damage: Annotated[float, Parameter("modulus of broken fibres", unit="Pa")]
    E_matrix_damage: Annotated[float, Parameter("modulus of the broken matrix", unit="Pa")]
    residual_stress: Annotated[float, Parameter("stress at the start", unit="Pa")]
    T_reference: Annotated[float, Parameter("temperature free of stress", unit="K")]
    psi_c: Annotated[float, Parameter("constant of the fibres' failure")]
    psi_n: Annotated[float, Parameter("exponent of the fibres' failure")]
    eps_o: Annotated[float, Parameter("strain at which fibres begin to fail")]
    eps_f: Annotated[float, Parameter("strain at which all have failed")]
