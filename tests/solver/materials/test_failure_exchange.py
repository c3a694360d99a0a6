"""Any damage, with any criterion and distribution, and any erosion meet any constitutive model, or say why not."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from test_damage_and_erosion import JC, VARIABLE
from test_energy_balance import CASES, STRETCHING
from test_model_exchange import MODELS, Specimen

from solver.declare import FAMILIES
from solver.materials.damage import for_constitutive_model
from solver.materials.damage.brittle import BrittleDamage
from solver.materials.damage.hancock_mackenzie import HancockMacKenzieDamage
from solver.materials.damage.no_damage import NoDamage
from solver.materials.damage.threshold import Threshold, ThresholdVar
from solver.materials.distribution.constant import Constant
from solver.materials.distribution.gauss import Gauss
from solver.materials.erosion import lets_fail
from solver.materials.erosion.allow_no_shear import AllowNoShear
from solver.materials.erosion.allow_no_tension import AllowNoTension
from solver.materials.erosion.no_erosion import NoErosion, PreserveStress
from solver.materials.erosion.zero_stress import ZeroStress
from solver.materials.failure_criterion.mohr_coulomb import MohrCoulombFailure
from solver.materials.failure_criterion.principal_strain import MaximumPrincipalStrain
from solver.materials.failure_criterion.principal_stress import MaximumPrincipalStress

EROSIONS = (NoErosion(), PreserveStress(), ZeroStress(), AllowNoTension(), AllowNoShear())
CRITERIA = (MaximumPrincipalStress(), MaximumPrincipalStrain(), MohrCoulombFailure())
FAILING = [
    JC._replace(initial_scalar_damage_distrib=Gauss(), initial_std_scalar_damage=0.01),
    HancockMacKenzieDamage(),
    BrittleDamage(),
    *(Threshold(c, 1.0e-3 if isinstance(c, MaximumPrincipalStrain) else 1.0e8) for c in CRITERIA),
    *(VARIABLE._replace(failure_criteria=c) for c in CRITERIA),
]
"""Every damage model, with every criterion and distribution that it takes."""


def test_every_erosion_criterion_and_distribution_is_exchanged():
    for family, models in {"erosion": EROSIONS, "failure_criterion": CRITERIA}.items():
        assert {type(model) for model in models} == set(FAMILIES[family].models.values())
    assert set(FAMILIES["distribution"].models.values()) == {Constant, Gauss}
    assert {type(damage) for damage in FAILING} | {NoDamage} == set(FAMILIES["damage"].models.values())


def test_no_family_of_parts_is_left_out():
    """The families that a material of particles is put together from; ice has a flow model of its own."""
    parts = {part.name for part in FAMILIES.values() if part.package.startswith("solver.materials.")}
    assert parts == {*MODELS, "erosion", "failure_criterion", "distribution", "viscoplastic_flow"}


def fitted(damage, model):
    """The damage model as the material takes it, or why it takes it not."""
    try:
        return for_constitutive_model(damage, model), ""
    except ValueError as refusal:
        return None, str(refusal)


def taken_along(case, damage, erosion):
    """A particle of the case after four steps that may have made it fail."""
    model = case.model
    if hasattr(model, "failure_is_checked"):
        model = model._replace(failure_is_checked=lets_fail(erosion))
    specimen = Specimen(model, damage, case.temperature, erosion=erosion, material=case.material)
    dt = case.duration / 4.0
    for part in (0.05, 0.05, 0.05, -0.03):
        strain = part * case.scale * (STRETCHING - 0.3 * case.squeeze * np.eye(3))
        assert specimen.advance(strain / dt, dt).finite, (damage, erosion)
    return specimen.particles


@pytest.mark.parametrize("name", CASES)
def test_any_constitutive_model_meets_any_damage_and_erosion(name):
    """Each pair runs to a stress that is a number, or is refused with a reason; where it failed, erosion acts."""
    failed = set()
    for damage, erosion in itertools.product([NoDamage(), *FAILING], EROSIONS):
        fitting, refusal = fitted(damage, CASES[name].model)
        if refusal:
            assert type(damage).__name__[:5].lower() in refusal.lower().replace("_", "")
            assert not isinstance(damage, Threshold | ThresholdVar | NoDamage)
            continue
        particles = taken_along(CASES[name], fitting, erosion)
        stress = particles.stress[0]
        np.testing.assert_allclose(stress, stress.T, atol=1e-6 * np.abs(stress).max())
        if particles.localized[0] > 0:
            failed.add(type(erosion))
            shear = np.abs(stress - np.trace(stress) / 3.0 * np.eye(3)).max()
            assert isinstance(erosion, NoErosion | PreserveStress) or shear <= 1e-9 * np.abs(stress).max()
            assert not isinstance(erosion, ZeroStress) or not stress.any()
            assert not isinstance(erosion, AllowNoTension) or np.trace(stress) <= 0.0
    if name.startswith(("elastic_plastic", "comp_neo_hook", "hypo_elastic", "visco_scram")):
        assert failed >= {ZeroStress, AllowNoTension, AllowNoShear, PreserveStress}


@pytest.mark.parametrize("equation_of_state", MODELS["equation_of_state"], ids=lambda m: type(m).__name__)
def test_ice_takes_any_equation_of_state(equation_of_state):
    case = CASES["visco_plastic"]
    model = case.model._replace(equation_of_state=equation_of_state)
    particles = taken_along(case._replace(model=model), NoDamage(), NoErosion())
    assert np.isfinite(particles.stress).all()
    assert np.abs(particles.stress).max() > 0.0
