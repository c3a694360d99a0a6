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


@known("constitutive_model", "SVK")
class SaintVenantKirchhoff(Section):
    """Saint Venant and Kirchhoff: the second Piola-Kirchhoff stress is linear in Green's strain."""

    YoungsModulus: Annotated[float, Parameter("Young's modulus", unit="Pa", ge=0.0)]
    PR: Annotated[float, Parameter("Poisson's ratio", ge=0.0, lt=0.5)]


@known("constitutive_model", "VUMAT")
class Vumat(SaintVenantKirchhoff):
    """A model in the form of a user routine of Abaqus."""

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


@known("constitutive_model", "TH_water")
class ThomsenHartkaWater(Section):
    """Water after Thomsen and Hartka."""

    a: Annotated[float, Parameter("first constant of the fit")]
    b: Annotated[float, Parameter("second constant of the fit")]
    co: Annotated[float, Parameter("specific heat", unit="J/(kg K)")]
    ko: Annotated[float, Parameter("compressibility", unit="1/Pa")]
    To: Annotated[float, Parameter("reference temperature", unit="K")]
    L: Annotated[float, Parameter("third constant of the fit")]
    vo: Annotated[float, Parameter("reference specific volume", unit="m^3/kg")]
    Pref: Annotated[float, Parameter("reference pressure", unit="Pa")] = 101325.0


class MaxwellMode(Section):
    """One element of the series."""

    name: Annotated[str, Parameter("a name for the reader", attribute=True)] = ""
    relaxation_time: Annotated[float, Parameter("time of relaxation", unit="s", ge=0.0)]
    partial_shear_modulus: Annotated[float, Parameter("its share of the shear modulus", unit="Pa", ge=0.0)]


class MaxwellSeries(Section):
    """The elements of the series."""

    mode: Annotated[tuple[MaxwellMode, ...], Parameter("an element")] = ()


@known("constitutive_model", "Maxwell_Weichert")
class MaxwellWeichert(Section):
    """Viscoelasticity by a series of Maxwell elements."""

    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    terminal_shear_modulus: Annotated[float, Parameter("shear modulus at rest", unit="Pa", ge=0.0)]
    viscoelastic_series: Annotated[MaxwellSeries, Parameter("the elements")]
