"""Fracture by porosity and strain together (TEPLA-F), damage that is held, heat of viscosity, laws at their ends."""

from __future__ import annotations

import numpy as np
import pytest
from test_damage_and_erosion import JC as DAMAGE
from test_elastic_plastic import COPPER_EOS, COPPER_JC, G, K
from test_model_exchange import COPPER, DEFORMATION, DT, MODELS, Specimen

from solver.materials.damage.hancock_mackenzie import HancockMacKenzieDamage
from solver.materials.damage.no_damage import NoDamage
from solver.materials.elastic_plastic import ElasticPlastic, breaks
from solver.materials.equation_of_state.default_hypo import DefaultHypo
from solver.materials.flow_stress.isotropic_hardening import IsotropicHardening
from solver.materials.hyperelastic_plastic import HyperElasticPlastic

METALS = [ElasticPlastic, HyperElasticPlastic]
LAWS = [
    *(("shear_modulus_model", part) for part in MODELS["shear_modulus"]),
    *(("specific_heat_model", part) for part in MODELS["specific_heat"]),
]
CHECKED = {"failure_is_checked": True, "TEPLA_with_damage": True}
SHEAR = np.array([[0.0, 4000.0, 0.0], [4000.0, 0.0, 0.0], [0.0, 0.0, 0.0]])


def metal(record, **changes):
    return record(K, G, COPPER_JC, equation_of_state=COPPER_EOS, **changes)


@pytest.mark.parametrize("porosity", [0.0, 0.02, 0.04, 0.06])
@pytest.mark.parametrize("damage", [0.0, 0.5, 0.9, 1.1])
def test_the_criterion_is_an_ellipse(porosity, damage):
    model = metal(ElasticPlastic, critical_porosity=0.05, **CHECKED)
    assert breaks(model, porosity, 1.0e3, damage) == ((porosity / 0.05) ** 2 + damage**2 > 1.0)
    assert not breaks(model, porosity, 0.0, damage)
    for off in ("failure_is_checked", "TEPLA_with_damage", "check_TEPLA_failure_criterion"):
        assert not breaks(model._replace(**{off: False}), porosity, 1.0e3, damage)


@pytest.mark.parametrize("record", METALS)
def test_a_sheared_particle_breaks_when_its_damage_and_porosity_say_so(record):
    """Of two particles that shear alike one breaks, in the first step whose end lies beyond the ellipse."""
    porosity = {"initial_mean_porosity": 0.03, "initial_std_porosity": 0.0, "critical_porosity": 0.05}
    model = metal(record, evolve_porosity=False, **porosity, **CHECKED)
    half_gone = DAMAGE._replace(initial_mean_scalar_damage=0.78)
    breaking, lasting = (
        Specimen(model, half_gone),
        Specimen(model._replace(TEPLA_with_damage=False), half_gone),
    )
    for _ in range(60):
        for specimen in (breaking, lasting):
            assert specimen.advance(SHEAR, DT).finite
        damage = lasting.failure.damage_state.damage[0]
        beyond = 0.6**2 + damage**2 > 1.0
        assert bool(breaking.particles.localized[0]) == beyond
        assert lasting.particles.localized[0] == 0
        if beyond:
            break
    assert 0.8 < damage < 0.85


@pytest.mark.parametrize("damage", [DAMAGE, HancockMacKenzieDamage()])
def test_damage_grows_unless_the_deck_holds_it(damage):
    start = damage._replace(initial_mean_scalar_damage=0.2)
    grown = []
    for evolves in (True, False):
        specimen = Specimen(metal(ElasticPlastic, evolve_damage=evolves), start)
        for _ in range(3):
            specimen.advance(DEFORMATION, DT)
        assert specimen.state.plastic_strain[0] > 0.0
        grown.append(specimen.failure.damage_state.damage[0] - 0.2)
    assert grown[0] > 1.0e-4
    assert grown[1] == 0.0


@pytest.mark.parametrize("record", METALS)
def test_artificial_viscosity_heats_by_its_work(record):
    """Of two elastic particles that are squeezed alike, one is warmer by q dV / (m c), and has that energy too."""
    model = record(K, G, IsotropicHardening(1.0e12, 0.0), equation_of_state=DefaultHypo())
    hot, cold = Specimen(model, NoDamage()), Specimen(model, NoDamage(), viscosity_heating=False)
    mass, warming, work = hot.particles.mass[0], 0.0, 0.0
    for _ in range(5):
        before = hot.particles.volume[0]
        hot.advance(-2.0e3 * np.eye(3), DT)
        cold.advance(-2.0e3 * np.eye(3), DT)
        q, volume = hot.particles.artificial_pressure[0], hot.particles.volume[0]
        assert q > 0.0
        warming += q * 6.0e3 * DT * volume / (mass * COPPER.specific_heat)
        work += q * (before - volume)
    assert hot.particles.temperature[0] - cold.particles.temperature[0] == pytest.approx(warming, rel=1e-9)
    assert hot.state.energy[0] - cold.state.energy[0] == pytest.approx(work / mass, rel=1e-9)


@pytest.mark.parametrize("record", METALS)
@pytest.mark.parametrize("temperature", [0.0, 1.0, 1355.9, 1356.0, 2.0e4])
@pytest.mark.parametrize(
    ("field", "part"), LAWS, ids=lambda v: "" if isinstance(v, str) else type(v).__name__
)
def test_laws_beyond_their_range_leave_numbers(record, temperature, field, part):
    """From absolute zero to twenty thousand kelvin: the heat has its sign, and waves travel."""
    model = metal(record, compute_specific_heat=True, **{field: part})
    specimen = Specimen(model, NoDamage(), temperature)
    for _ in range(3):
        sums = specimen.advance(np.diag([-3000.0, 1000.0, 0.0]), DT)
        assert sums.finite
        assert 0.0 < max(sums.wave_speed) < 1.0e6
    assert specimen.particles.temperature[0] >= temperature
