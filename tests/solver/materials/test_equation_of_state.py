from __future__ import annotations

import numpy as np
import pytest
from plasticity import assert_compiled_agrees, difference_quotient, state

from solver.materials.equation_of_state import (
    EQUATION_OF_STATE,
    isentropic_heating,
    mean_stress,
    mean_stress_slope,
)
from solver.materials.equation_of_state.default_hyper import DefaultHyper
from solver.materials.equation_of_state.default_hypo import DefaultHypo
from solver.materials.equation_of_state.mie_gruneisen import MieGruneisen

# copper, Banerjee 2012; tungsten carbide-like higher coefficients exercise S_2 and S_3
COPPER = MieGruneisen(C_0=3940.0, Gamma_0=2.02, S_alpha=1.489)
CURVED = MieGruneisen(C_0=3940.0, Gamma_0=2.02, S_alpha=1.2, S_2=0.4, S_3=-0.3)
MODELS = [DefaultHypo(), DefaultHyper(), COPPER, CURVED]
COMPRESSIONS = np.array([0.6, 0.8, 0.95, 0.999, 1.0, 1.02, 1.3])


def at_volume(J, **changes):
    return state(density=8930.0 / J, **changes)


def test_every_model_is_tested():
    assert {type(m) for m in MODELS} == set(EQUATION_OF_STATE.models.values())
    assert EQUATION_OF_STATE.models["mie_gruneisen_energy"] is EQUATION_OF_STATE.models["mie_gruneisen"]


def test_hypo_adds_the_increment():
    assert mean_stress(DefaultHypo(), state(mean_stress=-3.0e8), 1e-3) == pytest.approx(-3.0e8 + 129.0e6)


@pytest.mark.parametrize("J", COMPRESSIONS)
def test_hyper_is_the_derivative_of_its_energy(J):
    def energy(J):
        return 0.5 * 129.0e9 * (0.5 * (J * J - 1) - np.log(J))

    slope = (energy(J + 1e-6) - energy(J - 1e-6)) / 2e-6
    assert mean_stress(DefaultHyper(), at_volume(J), 0.0) == pytest.approx(slope, rel=1e-6, abs=2e3)


@pytest.mark.parametrize("model", [COPPER, CURVED])
@pytest.mark.parametrize("energy", [-1.0e4, 0.0, 5.0e5])
def test_mie_gruneisen_is_steinbergs_form(model, energy):
    eta = 1 - COMPRESSIONS
    hugoniot = (
        8930.0 * model.C_0**2 * eta / (1 - model.S_alpha * eta - model.S_2 * eta**2 - model.S_3 * eta**3) ** 2
    )
    cold = np.where(eta > 0, hugoniot * (1 - model.Gamma_0 * eta / 2), 8930.0 * model.C_0**2 * eta)
    pressure = cold + 8930.0 * model.Gamma_0 * energy
    computed = [-mean_stress(model, at_volume(J, energy=energy), 0.0) for J in COMPRESSIONS]
    np.testing.assert_allclose(computed, pressure, rtol=1e-12, atol=1.0)


@pytest.mark.parametrize("particle_velocity", [10.0, 300.0, 1500.0, 3000.0])
def test_mie_gruneisen_holds_the_jump_conditions_of_a_shock(particle_velocity):
    # U_s = C_0 + S u: pressure rho_0 U_s u, compression u / U_s, energy u^2 / 2
    shock = 3940.0 + 1.489 * particle_velocity
    behind = at_volume(1 - particle_velocity / shock, energy=0.5 * particle_velocity**2)
    assert -mean_stress(COPPER, behind, 0.0) == pytest.approx(8930.0 * shock * particle_velocity, rel=1e-12)


@pytest.mark.parametrize("model", [DefaultHyper(), COPPER, CURVED])
@pytest.mark.parametrize("J", [0.6, 0.8, 0.95, 1.02, 1.3])
def test_the_slope_is_the_derivative_by_volume(model, J):
    quotient = difference_quotient(lambda m, s: mean_stress(m, s, 0.0), model, at_volume(J), "density", 0.01)
    by_volume = quotient * -(8930.0 / J**2)
    assert mean_stress_slope(model, at_volume(J)) == pytest.approx(by_volume, rel=1e-6)


def test_the_slope_of_the_hypoelastic_rate():
    # J' = J tr(d)
    J, strain = 0.9, 1e-7
    change = mean_stress(DefaultHypo(), at_volume(J), strain) - mean_stress(DefaultHypo(), at_volume(J), 0.0)
    assert mean_stress_slope(DefaultHypo(), at_volume(J)) == pytest.approx(change / (J * strain), rel=1e-6)


def test_compression_heats():
    assert isentropic_heating(COPPER, at_volume(0.9), -1e3) == pytest.approx(400.0 * 2.02 * 0.9 * 1e3)
    assert isentropic_heating(DefaultHyper(), at_volume(0.9), -1e3) == 0.0
    assert isentropic_heating(DefaultHypo(), at_volume(0.9), -1e3) == 0.0


@pytest.mark.parametrize("model", MODELS)
def test_compiled_functions_agree(model):
    for J in (0.9, 1.05):
        assert_compiled_agrees(mean_stress, model, at_volume(J, energy=100.0), 1e-3)
        assert_compiled_agrees(mean_stress_slope, model, at_volume(J))
        assert_compiled_agrees(isentropic_heating, model, at_volume(J), 10.0)
