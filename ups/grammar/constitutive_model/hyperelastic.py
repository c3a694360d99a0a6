"""Hyperelastic models."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section
from ups.grammar import known


@known("constitutive_model", "three_factor_mooney")
class ThreeFactorMooney(Section):
    """Mooney-Rivlin rubber with three constants."""

    he_constant_1: Annotated[float, Parameter("first constant", unit="Pa", ge=0.0)]
    he_constant_2: Annotated[float, Parameter("second constant", unit="Pa", ge=0.0)]
    he_constant_3: Annotated[float, Parameter("third constant", unit="Pa", ge=0.0)]
    he_PR: Annotated[float, Parameter("Poisson's ratio", ge=0.0, lt=0.5)]


@known("constitutive_model", "VUMAT")
class Vumat(Section):
    """A model in the form of a user routine of Abaqus."""

    YoungsModulus: Annotated[float, Parameter("Young's modulus", unit="Pa", ge=0.0)]
    PR: Annotated[float, Parameter("Poisson's ratio", ge=0.0, lt=0.5)]
    filename: Annotated[str, Parameter("file of the routine's data")]


@known("constitutive_model", "membrane", "shell_CNH")
class Shell(Section):
    """A thin shell or membrane of a compressible neo-Hookean material."""

    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    shear_modulus: Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)]
    includeFlowWork: Annotated[bool, Parameter("count the work of flow")] = False


@known("constitutive_model", "hypo_elastic_fortran")
class HypoElasticFortran(Section):
    """Hypoelasticity, as an example of a Fortran routine."""

    G: Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)]
    K: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]


@known("constitutive_model", "TransIsoHypoFrictional")
class TransIsoHypoFrictional(Section):
    """A hypoelastic yarn: stiff along its fibres, with friction between them."""

    E_t: Annotated[float, Parameter("Young's modulus across the fibres", unit="Pa")]
    Y_t: Annotated[float, Parameter("yield stress across the fibres", unit="Pa")]
    E_a: Annotated[float, Parameter("Young's modulus along the fibres", unit="Pa")]
    nu_at: Annotated[float, Parameter("Poisson's ratio between along and across")]
    nu_t: Annotated[float, Parameter("Poisson's ratio across")]
    G_at: Annotated[float, Parameter("shear modulus along the fibres", unit="Pa")]
    n_fiber: Annotated[tuple[float, float, float], Parameter("direction of the fibres")]
    mu_fiber: Annotated[float, Parameter("friction between fibres")]
    crimp_stretch: Annotated[float, Parameter("stretch at which the fibres are straight")]
    crimp_ratio: Annotated[float, Parameter("stiffness of wavy fibres as a share")]
    phi_0: Annotated[float, Parameter("share of fibres at the start")]
    alpha: Annotated[float, Parameter("exponent of the compaction")]
    bulk: Annotated[float, Parameter("bulk modulus of the fibres", unit="Pa")]
