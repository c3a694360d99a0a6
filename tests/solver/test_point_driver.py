"""One material point along strain paths, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import logm

pytest.importorskip("numba")

from solver.materials.comp_neo_hook import CompNeoHook, CompNeoHookPlastic
from solver.materials.constitutive import Material
from solver.materials.elastic_plastic import ElasticPlastic
from solver.materials.equation_of_state.default_hypo import DefaultHypo
from solver.materials.flow_stress.isotropic_hardening import IsotropicHardening
from solver.materials.hypo_elastic import HypoElastic
from solver.materials.ideal_gas import IdealGas
from solver.materials.visco_scram import ViscoScram
from solver.materials.yield_condition.von_mises import VonMises
from solver.point_driver import (
    PATHS,
    PointDriverError,
    drive,
    hydrostatic,
    logarithm,
    simple_shear,
    tabulated,
    uniaxial,
)

K, G = 130.0e9, 46.0e9
E = 9 * K * G / (3 * K + G)
MATERIAL = Material(
    density=8900.0,
    specific_heat=400.0,
    specific_heat_constant_pressure=400.0,
    thermal_conductivity=300.0,
    room_temperature=300.0,
    melt_temperature=1400.0,
    thermal_expansion=0.0,
)
HYPO = HypoElastic(G=G, K=K)
NEO_HOOKE = CompNeoHook(bulk_modulus=K, shear_modulus=G)
SCRAM = ViscoScram(
    0.3,
    1e-3,
    10.0,
    300.0,
    5e5,
    0.35,
    3e-5,
    12.0,
    *(944e6, 173.8e6, 521.2e6, 908.5e6, 687.5e6),
    *(0.0, 7.32e3, 7.32e4, 7.32e5, 2.0e6),
    Beta=1.5e-4,
    Gamma=1.0,
    DCp_DTemperature=3.3,
)
YIELD, HARDENING = 200.0e6, 1.0e9
PLASTIC = ElasticPlastic(
    bulk_modulus=K,
    shear_modulus=G,
    flow_model=IsotropicHardening(sigma_Y=YIELD, K=HARDENING),
    yield_condition=VonMises(),
    equation_of_state=DefaultHypo(),
    evolve_porosity=False,
    initial_mean_porosity=0.0,
    initial_std_porosity=0.0,
    taylor_quinney_coeff=0.9,
)


def test_uniaxial_strain_of_a_hypoelastic_material():
    """sigma_xx = (K + 4/3 G) ln F, sigma_yy = (K - 2/3 G) ln F."""
    history = drive(HYPO, MATERIAL, uniaxial(0.1, 10.0, 50, free=False))
    np.testing.assert_allclose(history.stress[:, 0, 0], (K + 4 / 3 * G) * history.strain, rtol=1e-12)
    np.testing.assert_allclose(history.stress[:, 1, 1], (K - 2 / 3 * G) * history.strain, rtol=1e-12)
    assert history.time[-1] == pytest.approx(0.01)
    assert history.temperature == pytest.approx(300.0)
    assert history.plastic_strain is None


@pytest.mark.parametrize("strain", [0.2, -0.2])
def test_uniaxial_stress_of_a_hypoelastic_material(strain):
    """sigma_xx = E ln F, with lateral strains of -nu ln F and no lateral stress."""
    history = drive(HYPO, MATERIAL, uniaxial(strain, 10.0, 20, free=True))
    np.testing.assert_allclose(history.stress[:, 0, 0], E * history.strain, rtol=1e-7)
    nu = (3 * K - 2 * G) / (6 * K + 2 * G)
    lateral = np.log(history.deformation_gradient[:, [1, 2], [1, 2]])
    np.testing.assert_allclose(lateral, -nu * history.strain[:, None] * [1, 1], rtol=1e-7, atol=1e-15)
    assert np.abs(history.stress[:, 1:, 1:]).max() < 1e-7 * np.abs(history.stress).max()


def test_simple_shear_of_a_neo_hookean_material():
    """sigma_xy = G gamma at J = 1, and the normal stress difference G gamma^2."""
    history = drive(NEO_HOOKE, MATERIAL, simple_shear(0.8, 1.0, 16))
    gamma = history.strain
    np.testing.assert_allclose(history.stress[:, 0, 1], G * gamma, rtol=1e-12)
    difference = history.stress[:, 0, 0] - history.stress[:, 1, 1]
    np.testing.assert_allclose(difference, G * gamma**2, rtol=1e-9, atol=1e-3)


def test_hydrostatic_compression_of_a_neo_hookean_material():
    """p = -K/2 (J - 1/J), without shear."""
    history = drive(NEO_HOOKE, MATERIAL, hydrostatic(-0.3, 1.0, 10))
    J = np.exp(history.strain)
    np.testing.assert_allclose(history.pressure, -0.5 * K * (J - 1 / J), rtol=1e-12, atol=1e-3)
    assert history.equivalent_stress.max() < 1e-10 * history.pressure.max()


def test_uniaxial_stress_of_a_neo_hookean_material():
    """The lateral stretch b solves K/2 (J - 1/J) + G/J^(5/3) (b^2 - a^2) / 3 = 0, J = a b^2."""
    from scipy.optimize import brentq

    history = drive(NEO_HOOKE, MATERIAL, uniaxial(0.3, 1.0, 10, free=True))
    a = np.exp(0.3)

    def lateral(b):
        J = a * b * b
        return K / 2 * (J - 1 / J) + G * J ** (-5 / 3) * (b * b - a * a) / 3

    b = brentq(lateral, 0.5, 1.0, xtol=1e-15)
    assert history.deformation_gradient[-1, 1, 1] == pytest.approx(b, rel=1e-7)


def test_hardening_follows_the_yield_surface_and_heats():
    """Uniaxial stress: |sigma| = Y + H ep, and dT = chi times plastic work / (rho c)."""
    history = drive(PLASTIC, MATERIAL, uniaxial(0.2, 100.0, 2000, free=True))
    ep, stress = history.plastic_strain, history.equivalent_stress
    flowing = ep > 1e-3
    np.testing.assert_allclose(stress[flowing], YIELD + HARDENING * ep[flowing], rtol=2e-3)
    assert ep[-1] == pytest.approx(0.2 - stress[-1] / E, rel=1e-2)
    work = YIELD * ep[-1] + 0.5 * HARDENING * ep[-1] ** 2
    J = np.linalg.det(history.deformation_gradient[-1])
    rise = 0.9 * work * J / (MATERIAL.density * MATERIAL.specific_heat)
    assert history.temperature[-1] - 300.0 == pytest.approx(rise, rel=5e-3)


def test_pure_shear_of_j2_plasticity_keeps_to_the_yield_surface():
    """Before plastic flow |sigma_xy| = G gamma, after it sqrt(3) sigma_xy = Y + H ep."""
    history = drive(PLASTIC, MATERIAL, simple_shear(0.02, 10.0, 400))
    shear, ep = history.stress[:, 0, 1], history.plastic_strain
    elastic = np.sqrt(3) * G * history.strain < 0.98 * YIELD
    np.testing.assert_allclose(shear[elastic], G * history.strain[elastic], rtol=1e-3)
    flowing = ep > 1e-3
    np.testing.assert_allclose(np.sqrt(3) * shear[flowing], YIELD + HARDENING * ep[flowing], rtol=5e-3)


def test_isothermal_keeps_the_temperature():
    history = drive(
        PLASTIC, MATERIAL, uniaxial(0.05, 1.0, 100, free=True), temperature=500.0, isothermal=True
    )
    assert (history.temperature == 500.0).all()
    assert history.plastic_strain[-1] > 0.04


def test_neo_hookean_plasticity_with_linear_hardening():
    model = CompNeoHookPlastic(
        bulk_modulus=K, shear_modulus=G, yield_stress=YIELD, hardening_modulus=HARDENING
    )
    history = drive(model, MATERIAL, uniaxial(0.1, 1.0, 400, free=True))
    ep = history.plastic_strain
    J = np.linalg.det(history.deformation_gradient)
    flowing = ep > 1e-3
    np.testing.assert_allclose(
        (J * history.equivalent_stress)[flowing], YIELD + HARDENING * ep[flowing], rtol=1e-6
    )


def test_state_variables_have_uintahs_labels():
    history = drive(PLASTIC, MATERIAL, uniaxial(0.01, 1.0, 10, free=False))
    assert {"p.plasticStrain", "p.plasticStrainRate", "p.energy", "p.rotation"} <= set(history.state)
    assert history.state["p.rotation"].shape == (11, 3, 3)


def test_adiabatic_ideal_gas():
    """Hydrostatic compression of a gas: T J^(gamma - 1) and p J^gamma stay constant, to the step's order."""
    model = IdealGas(gamma=1.4, specific_heat=717.5, Pref=0.0)
    gas = MATERIAL._replace(density=1.2, specific_heat=717.5)
    history = drive(model, gas, hydrostatic(-0.5, 1.0, 2000), temperature=300.0)
    assert history.temperature[-1] == pytest.approx(300.0 * np.exp(0.5 * 0.4), rel=1e-3)


def test_a_table_runs_through_its_gradients():
    shear = np.eye(3)
    shear[0, 1] = 0.1
    path = tabulated(np.array([0.0, 1.0, 3.0]), np.array([np.eye(3), shear, np.eye(3)]), 300)
    history = drive(NEO_HOOKE, MATERIAL, path)
    assert history.stress[100, 0, 1] == pytest.approx(0.1 * G, rel=1e-9)
    assert np.abs(history.stress[-1]).max() < 1e-6 * G


def test_the_strain_rate_sets_the_time():
    for name, make in PATHS.items():
        path = make(-0.2, 400.0, 8)
        assert path.time[-1] == pytest.approx(0.2 / 400.0), name
        np.testing.assert_array_equal(path.deformation_gradient[0], np.eye(3))


def test_logarithm_of_increments():
    rng = np.random.default_rng(7)
    increments = np.eye(3) + 0.3 * rng.uniform(-1, 1, (5, 3, 3))
    expected = np.array([logm(a).real for a in increments])
    np.testing.assert_allclose(logarithm(increments), expected, rtol=1e-12, atol=1e-14)
    np.testing.assert_array_equal(logarithm(np.eye(3)[None]), 0.0)


@pytest.mark.parametrize(
    "make",
    [
        lambda: uniaxial(0.1, 0.0, 10, free=False),
        lambda: uniaxial(0.0, 1.0, 10, free=True),
        lambda: simple_shear(np.nan, 1.0, 10),
        lambda: hydrostatic(0.1, 1.0, 0),
        lambda: tabulated(np.array([0.0]), np.eye(3)[None], 10),
        lambda: tabulated(np.array([0.0, 0.0]), np.array([np.eye(3)] * 2), 10),
        lambda: tabulated(np.array([0.0, 1.0]), np.array([2 * np.eye(3)] * 2), 10),
        lambda: tabulated(np.array([0.0, 1.0]), np.array([np.eye(3), -np.eye(3)]), 10),
    ],
)
def test_paths_that_make_no_sense(make):
    with pytest.raises(PointDriverError):
        make()


def test_a_point_that_is_lost_names_its_step():
    with pytest.raises(PointDriverError, match=r"step \d+ of 4"):
        drive(PLASTIC, MATERIAL, hydrostatic(48.0, 1.0, 4))


def test_a_temperature_below_zero_is_refused():
    with pytest.raises(PointDriverError, match="temperature"):
        drive(HYPO, MATERIAL, hydrostatic(0.1, 1.0, 4), temperature=-1.0)


def test_turns_of_a_path_are_ends_of_steps():
    path = uniaxial([0.02, -0.01, 0.0], 2.0, 11, free=False)
    assert path.time[-1] == pytest.approx(0.06 / 2.0)
    assert {0.02, -0.01, 0.0} <= set(path.strain.tolist())
    assert np.all(np.diff(path.time) > 0.0)
    np.testing.assert_allclose(path.deformation_gradient[:, 0, 0], np.exp(path.strain))


def test_an_elastic_cycle_comes_back():
    history = drive(HYPO, MATERIAL, uniaxial((0.01, -0.005, 0.0), 1.0, 30, free=True))
    np.testing.assert_allclose(history.stress[-1], 0.0, atol=1e-3)
    assert history.stress[:, 0, 0].max() > 0.0 > history.stress[:, 0, 0].min()


def test_steps_that_a_model_does_not_allow_are_cut():
    path = uniaxial(-0.01, 100.0, 4, free=False)  # 25 microseconds a step; visco_scram allows one
    coarse, fine = (drive(SCRAM, MATERIAL, uniaxial(-0.01, 100.0, n, free=False)) for n in (4, 100))
    np.testing.assert_allclose(coarse.time, path.time)
    np.testing.assert_allclose(coarse.stress[-1], fine.stress[-1], rtol=1e-3)
