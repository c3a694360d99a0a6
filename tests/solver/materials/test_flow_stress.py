from __future__ import annotations

import numpy as np
import pytest
from plasticity import assert_compiled_agrees, difference_quotient, grid, state
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import erf

from solver.declare import fields
from solver.materials.flow_stress import FLOW_STRESS, flow_stress, hardening_slope, rate_slope
from solver.materials.flow_stress.isotropic_hardening import IsotropicHardening
from solver.materials.flow_stress.johnson_cook import JohnsonCook
from solver.materials.flow_stress.mechanical_threshold_stress import MechanicalThresholdStress
from solver.materials.flow_stress.preston_tonks_wallace import PrestonTonksWallace
from solver.materials.flow_stress.steinberg_cochran_guinan import SteinbergCochranGuinan
from solver.materials.flow_stress.zerilli_armstrong import ZerilliArmstrong
from solver.materials.flow_stress.zerilli_armstrong_polymer import ZerilliArmstrongPolymer

ISOTROPIC = IsotropicHardening(sigma_Y=400.0e6, K=100.0e6)
# 4340 steel, Johnson and Cook 1983, as in Banerjee 2012, section 3.3.3
STEEL_JC = JohnsonCook(A=792.0e6, B=510.0e6, C=0.014, n=0.26, m=1.03, T_r=298.0, T_m=1793.0)
# OFHC copper, Follansbee and Kocks 1988
COPPER_MTS = MechanicalThresholdStress(
    sigma_a=40.0e6,
    mu_0=47.7e9,
    D=3.0e9,
    T_0=180.0,
    koverbcubed=0.823e6,
    g_0i=0.0,
    g_0e=1.6,
    edot_0i=0.0,
    edot_0e=1.0e7,
    p_i=0.0,
    q_i=0.0,
    p_e=0.666667,
    q_e=1.0,
    sigma_i=0.0,
    a_0=2390.0e6,
    a_1=12.0e6,
    a_2=1.696e6,
    a_3=0.0,
    theta_IV=0.0,
    alpha=2.0,
    edot_es0=1.0e7,
    g_0es=0.2625,
    sigma_es0=770.0e6,
)
# HY-100 steel, Goto et al. 2000
STEEL_MTS = COPPER_MTS._replace(
    mu_0=71.46e9,
    koverbcubed=0.905e6,
    g_0i=1.161,
    edot_0i=1.0e13,
    p_i=0.5,
    q_i=1.5,
    sigma_i=1341.0e6,
    a_0=6.0e9,
    a_1=0.0,
    a_2=0.0,
    a_3=2.0758e6,
    alpha=3.0,
    g_0es=0.112,
    sigma_es0=822.0e6,
    theta_IV=200.0e6,
)
# copper, Preston, Tonks and Wallace 2003
COPPER_PTW = PrestonTonksWallace(
    theta=0.025,
    p=2.0,
    s0=0.0085,
    sinf=0.00055,
    kappa=0.11,
    gamma=1.0e-5,
    y0=0.0001,
    yinf=0.0001,
    y1=0.094,
    y2=0.575,
    beta=0.25,
    M=63.54,
)
COPPER_SCG = SteinbergCochranGuinan(
    mu_0=47.7e9,
    A=28.0e-12,
    B=0.38e-3,
    sigma_0=0.12e9,
    beta=36.0,
    n=0.45,
    epsilon_p0=0.0,
    Y_max=0.64e9,
    T_m0=1790.0,
    a=1.5,
    Gamma_0=2.02,
    energy_to_form_kink_pair=0.31,
    Boltzmann_constant=8.617385e-5,
    Peierls_stress=1.0e9,
    C1=0.71e6,
    C2=0.012e6,
)
COPPER_ZA = ZerilliArmstrong(
    B=0.0, beta_0=0.0, beta_1=0.0, B_0=890.0e6, alpha_0=0.0028, alpha_1=0.000115, K=0.0, n=0.0, c_0=65.0e6
)
IRON_ZA = ZerilliArmstrong(
    B=1033.0e6,
    beta_0=0.00698,
    beta_1=0.000415,
    B_0=0.0,
    alpha_0=0.0,
    alpha_1=0.0,
    K=266.0e6,
    n=0.289,
    sigma_g=0.0,
    k_H=22.0e6,
    sqrt_l_inv=2.95,
)
POLYMER_ZA = ZerilliArmstrongPolymer(
    sigma_g=1.0e6,
    B_pa=4.0e7,
    B_pb=3.0e-5,
    B_pn=0.5,
    beta_0=0.02,
    beta_1=1.0e-4,
    T_0=273.0,
    B_0pa=6.0e7,
    B_0pb=3.0e-5,
    B_0pn=0.5,
    omega_a=2.0,
    omega_b=-0.1,
    omega_p=1.0e-5,
    alpha_0=0.01,
    alpha_1=2.0e-4,
)
MODELS = {
    "isotropic_hardening": ISOTROPIC,
    "johnson_cook": STEEL_JC,
    "mts_model": COPPER_MTS,
    "mts_model of steel": STEEL_MTS,
    "preston_tonks_wallace": COPPER_PTW,
    "steinberg_cochran_guinan": COPPER_SCG,
    "zerilli_armstrong": COPPER_ZA,
    "zerilli_armstrong of iron": IRON_ZA,
    "zerilli_armstrong_polymer": POLYMER_ZA,
}
STATES = grid(
    plastic_strain=(1.0e-4, 0.02, 0.3, 1.5),
    strain_rate=(1.0e-3, 0.5, 40.0, 8.0e3),
    temperature=(77.0, 298.0, 700.0, 1300.0),
    mean_stress=(-2.0e9, 0.0, 1.0e9),
)
STATES = [s._replace(plastic_strain_rate=s.strain_rate) for s in STATES]
EDGES = grid(
    plastic_strain=(1.0e-6, 3.0),
    strain_rate=(2.0e-6, 1.0e6, 1.0e10),
    temperature=(4.0, 1356.0),
    mean_stress=(-50.0e9, 5.0e9),
)
"""Nearly no strain or rate, an overdriven shock, the melting temperature, strong compression and tension."""
EDGES = [s._replace(plastic_strain_rate=s.strain_rate) for s in EDGES]


def johnson_cook(m, s):
    rate = s.strain_rate / m.epdot_0
    by_rate = (1 + rate) ** m.C if rate < 1 else 1 + m.C * np.log(rate)
    T = min((s.temperature - m.T_r) / (m.T_m - m.T_r), 1.0)
    return (m.A + m.B * s.plastic_strain**m.n) * by_rate * (1 - (T if T < 0 else T**m.m))


def zerilli_armstrong(m, s):
    athermal = m.c_0 or m.sigma_g + m.k_H * m.sqrt_l_inv
    alpha = m.alpha_0 - m.alpha_1 * np.log(s.plastic_strain_rate)
    beta = m.beta_0 - m.beta_1 * np.log(s.plastic_strain_rate)
    hardening = m.B_0 * np.sqrt(s.plastic_strain) * np.exp(-alpha * s.temperature)
    return athermal + m.K * s.plastic_strain**m.n + m.B * np.exp(-beta * s.temperature) + hardening


def zerilli_armstrong_polymer(m, s):
    root, rate = np.sqrt(max(-s.mean_stress, 0)), np.log(s.plastic_strain_rate)
    omega = max(m.omega_a + m.omega_b * rate + m.omega_p * root, 0)
    B = (
        m.B_pa
        * (1 + m.B_pb * root) ** m.B_pn
        * np.exp(-(m.beta_0 - m.beta_1 * rate) * (s.temperature - m.T_0))
    )
    B_0 = m.B_0pa * (1 + m.B_0pb * root) ** m.B_0pn
    B_0 *= np.exp(-(m.alpha_0 - m.alpha_1 * rate) * (s.temperature - m.T_0))
    return m.sigma_g + B + B_0 * np.sqrt(omega * s.plastic_strain)


def steinberg_cochran_guinan(m, s):
    def rate(stress):
        barrier = 2 * m.energy_to_form_kink_pair / (m.Boltzmann_constant * s.temperature)
        return 1 / (np.exp(barrier * (1 - stress / m.Peierls_stress) ** 2) / m.C1 + m.C2 / stress)

    thermal = m.Peierls_stress
    if s.plastic_strain_rate < rate(thermal):
        with np.errstate(over="ignore", divide="ignore"):  # no stress gives no rate, whose logarithm is -inf
            thermal = brentq(lambda t: np.log(rate(t) / s.plastic_strain_rate), 1.0e-9, thermal, xtol=1e-6)
    athermal = min(m.sigma_0 * (1 + m.beta * (s.plastic_strain + m.epsilon_p0)) ** m.n, m.Y_max)
    return (athermal + thermal) * s.shear_modulus / m.mu_0


def threshold(m, s, exact=False):
    r, T = s.strain_rate, s.temperature
    theta_0 = m.a_0 + m.a_1 * np.log(r) + m.a_2 * np.sqrt(r) - m.a_3 * T
    limit = m.sigma_es0 * (r / m.edot_es0) ** (m.koverbcubed * T / (m.g_0es * s.shear_modulus))

    def slope(stress):
        return theta_0 * (1 - np.tanh(m.alpha * stress / limit) / np.tanh(m.alpha))

    if exact:
        path = solve_ivp(lambda _, y: slope(y), (0, s.plastic_strain), [0.0], rtol=1e-9, atol=1.0)
        return path.y[0, -1]
    stress, step = 0.0, s.plastic_strain / 4
    for _ in range(4):
        old = stress
        stress = brentq(lambda t, o=old: t - o - step * slope((t + o) / 2), 0, old + 2 * step * theta_0)
        if stress > limit:
            return limit
    return stress


def mechanical_threshold_stress(m, s, exact=False):
    def scaling(g, p, q, reference):
        delay = max(np.log(reference / s.strain_rate), 0)  # beyond the reference rate heat helps no more
        energy = m.koverbcubed * s.temperature / (g * s.shear_modulus) * delay
        return max(1 - energy ** (1 / q), 0) ** (1 / p)

    intrinsic = m.sigma_i * scaling(m.g_0i, m.p_i, m.q_i, m.edot_0i) if m.p_i > 0 else 0
    evolving = scaling(m.g_0e, m.p_e, m.q_e, m.edot_0e) * threshold(m, s, exact)
    return m.sigma_a + (intrinsic + evolving) * s.shear_modulus / m.mu_0


def preston_tonks_wallace(m, s):
    xi = 0.5 * (4 * np.pi * s.density / (3 * m.M * 1.66043998903379e-27)) ** (1 / 3)
    xi *= np.sqrt(s.shear_modulus / s.density)
    rate, ep = s.plastic_strain_rate, s.plastic_strain
    e = erf(m.kappa * s.temperature / s.melt_temperature * np.log(m.gamma * xi / rate))
    tau_s, tau_y = m.s0 - (m.s0 - m.sinf) * e, m.y0 - (m.y0 - m.yinf) * e
    if rate > 1e3:
        shock = m.s0 * (rate / (m.gamma * xi)) ** m.beta
        tau_s, tau_y = max(tau_s, shock), max(tau_y, min(m.y1 * (rate / (m.gamma * xi)) ** m.y2, shock))
    if tau_s == tau_y:
        return 2 * tau_s * s.shear_modulus
    alpha = (m.s0 - tau_y) / m.p
    beta = (tau_s - tau_y) / alpha
    phi = np.exp(beta) - 1
    hardening = alpha * np.log(1 - phi * np.exp(-beta - m.theta * ep / (alpha * phi)))
    return 2 * (tau_s + hardening) * s.shear_modulus


REFERENCES = {
    "isotropic_hardening": lambda m, s: m.sigma_Y + m.K * s.plastic_strain,
    "johnson_cook": johnson_cook,
    "mts_model": mechanical_threshold_stress,
    "mts_model of steel": mechanical_threshold_stress,
    "preston_tonks_wallace": preston_tonks_wallace,
    "steinberg_cochran_guinan": steinberg_cochran_guinan,
    "zerilli_armstrong": zerilli_armstrong,
    "zerilli_armstrong of iron": zerilli_armstrong,
    "zerilli_armstrong_polymer": zerilli_armstrong_polymer,
}


def test_every_model_is_tested():
    assert {type(m) for m in MODELS.values()} == set(FLOW_STRESS.models.values())


@pytest.mark.parametrize("name", MODELS)
def test_the_flow_stress_is_that_of_the_papers_equation(name):
    # iterations end early: that of Steinberg and Lund's thermal stress at zero where it is nearly nothing
    rtol = {"ste": 1e-4, "mts": 1e-6}.get(name[:3], 1e-11)
    for states in (STATES, EDGES):
        computed = [flow_stress(MODELS[name], s) for s in states]
        np.testing.assert_allclose(computed, [REFERENCES[name](MODELS[name], s) for s in states], rtol=rtol)


@pytest.mark.parametrize("name", [name for name in MODELS if not name.startswith("mts")])
def test_the_hardening_slope_is_the_derivative_by_plastic_strain(name):
    model = MODELS[name]
    for s in (*STATES, *EDGES):
        if name.startswith("preston") and 1e3 < s.plastic_strain_rate < 1e9:
            continue  # its slope looks at both regimes at any rate: the next test
        if name == "steinberg_cochran_guinan" and s.plastic_strain > 0.3:
            continue  # beyond Y_max it is the slope of the law without that limit
        quotient = difference_quotient(flow_stress, model, s, "plastic_strain", 1e-4 * s.plastic_strain)
        floor = 1e-9 * flow_stress(model, s) / s.plastic_strain
        assert hardening_slope(model, s) == pytest.approx(quotient, rel=1e-5, abs=floor)


@pytest.mark.parametrize("model", [COPPER_MTS, STEEL_MTS])
def test_mts_hardening_slope_is_voces_law_at_the_threshold_stress(model):
    for s in STATES:
        stress = threshold(model, s)
        theta_0 = model.a_0 + model.a_1 * np.log(s.strain_rate) + model.a_2 * np.sqrt(s.strain_rate)
        theta_0 -= model.a_3 * s.temperature
        energy = model.koverbcubed * s.temperature / s.shear_modulus
        limit = model.sigma_es0 * (s.strain_rate / model.edot_es0) ** (energy / model.g_0es)
        F = np.tanh(model.alpha * stress / limit) / np.tanh(model.alpha)
        scaling = (1 - energy / model.g_0e * np.log(model.edot_0e / s.strain_rate)) ** (1 / model.p_e)
        slope = scaling * s.shear_modulus / model.mu_0 * (theta_0 * (1 - F) + model.theta_IV * F)
        assert hardening_slope(model, s) == pytest.approx(slope, rel=1e-4, abs=1.0)


@pytest.mark.parametrize("name", ["zerilli_armstrong", "zerilli_armstrong of iron", "preston_tonks_wallace"])
def test_the_rate_slope_is_the_derivative_by_plastic_strain_rate(name):
    model = MODELS[name]
    for s in (*STATES, *EDGES):
        if 1e3 < s.plastic_strain_rate < 1e9:
            continue  # between thermal glide and an overdriven shock
        step = 1e-4 * s.plastic_strain_rate
        quotient = difference_quotient(flow_stress, model, s, "plastic_strain_rate", step)
        floor = 1e-9 * flow_stress(model, s) / s.plastic_strain_rate
        assert rate_slope(model, s) == pytest.approx(quotient, rel=1e-5, abs=floor)


@pytest.mark.parametrize("name", ["johnson_cook"])
def test_the_rate_slope_of_a_model_of_the_whole_rate(name):
    model = MODELS[name]
    for s in (*STATES, *EDGES):
        quotient = difference_quotient(flow_stress, model, s, "strain_rate", 1e-4 * s.strain_rate)
        floor = 1e-9 * flow_stress(model, s) / s.strain_rate
        assert rate_slope(model, s) == pytest.approx(quotient, rel=1e-5, abs=floor)


def test_mts_rate_slope_holds_the_threshold_stress():
    # with a saturated threshold stress that does not depend on the rate, the whole derivative is left
    model = STEEL_MTS._replace(g_0es=1e12, a_3=0.0)
    for s in STATES:
        if s.plastic_strain < 1.0:
            continue
        quotient = difference_quotient(flow_stress, model, s, "strain_rate", 1e-4 * s.strain_rate)
        floor = 1e-7 * flow_stress(model, s) / s.strain_rate
        assert rate_slope(model, s) == pytest.approx(quotient, rel=1e-4, abs=floor)


@pytest.mark.parametrize("name", MODELS)
def test_compiled_functions_agree(name):
    for function in (flow_stress, hardening_slope, rate_slope):
        assert_compiled_agrees(function, MODELS[name], state(temperature=600.0))


@pytest.mark.parametrize("name", MODELS)
def test_zero_strain_and_zero_rate_give_finite_numbers(name):
    zero = state(plastic_strain=0.0, plastic_strain_rate=0.0, strain_rate=0.0)
    assert flow_stress(MODELS[name], zero) > 0.0
    assert np.isfinite([hardening_slope(MODELS[name], zero), rate_slope(MODELS[name], zero)]).all()


def test_johnson_cook_numbers_of_4340_steel():
    at = state(plastic_strain=0.1, strain_rate=1.0, temperature=298.0)
    assert flow_stress(STEEL_JC, at) == pytest.approx(792e6 + 510e6 * 0.1**0.26)
    assert flow_stress(STEEL_JC, at._replace(temperature=1793.0)) == 0.0
    assert flow_stress(STEEL_JC, at._replace(temperature=2500.0)) == 0.0
    assert flow_stress(STEEL_JC, at._replace(strain_rate=np.e)) == pytest.approx(
        1.014 * flow_stress(STEEL_JC, at)
    )


def test_the_threshold_stress_approaches_the_exact_integral_of_voces_law():
    for s in grid(plastic_strain=(0.01, 0.1, 0.5, 1.0), strain_rate=(1.0, 4.0e3), temperature=(300.0, 700.0)):
        exact = mechanical_threshold_stress(COPPER_MTS, s, exact=True)
        assert flow_stress(COPPER_MTS, s) == pytest.approx(exact, rel=0.02)


def test_constants_of_the_high_temperature_phase_of_steel():
    model = STEEL_MTS._replace(T_c=1040.0)
    hot = state(temperature=1100.0)
    austenite = model._replace(
        g_0i=0.57582, sigma_i=896.14e6, g_0es=0.294, sigma_es0=478.36e6, a_0=7.5159e9, a_3=3.7796e6
    )
    assert flow_stress(model, hot) == pytest.approx(mechanical_threshold_stress(austenite, hot), rel=1e-7)


@pytest.mark.parametrize("strain", [0.0, 0.3])
def test_where_heat_leaves_no_saturation_stress_the_athermal_stress_is_left(strain):
    melting = state(strain_rate=1.0e-6, temperature=1300.0, shear_modulus=1.0e6, plastic_strain=strain)
    assert flow_stress(COPPER_MTS, melting) == COPPER_MTS.sigma_a
    assert hardening_slope(COPPER_MTS, melting) == 0.0
    assert_compiled_agrees(flow_stress, COPPER_MTS, melting)


def test_thermal_stress_of_dislocation_constants():
    constants = {
        "dislocation_density": 1.0e12,
        "length_of_dislocation_segment": 1.0e-7,
        "distance_between_Peierls_valleys": 2.5e-10,
        "length_of_Burger_vector": 2.55e-10,
        "Debye_frequency": 7.0e12,
        "width_of_kink_loop": 4.0e-9,
        "drag_coefficient": 1.0e-5,
    }
    density, length, valley, burgers, debye, width, drag = constants.values()
    C1 = density * length * valley * burgers**2 * debye / (2 * width**2)
    C2 = drag / (density * burgers**2)
    by_constants = COPPER_SCG._replace(C1=0.0, C2=0.0, **constants)
    direct = COPPER_SCG._replace(C1=C1, C2=C2)
    assert not by_constants.faults()
    at = state(plastic_strain_rate=1.0e-3 * C1)
    assert flow_stress(by_constants, at) == pytest.approx(flow_stress(direct, at), rel=1e-12)
    assert flow_stress(direct, at) > flow_stress(direct, at._replace(plastic_strain_rate=0.0))


def test_without_thermal_activation_the_flow_stress_does_not_depend_on_rate():
    athermal = COPPER_SCG._replace(C1=0.0, C2=0.0, energy_to_form_kink_pair=0.0, Peierls_stress=0.0)
    assert not athermal.faults()
    expected = 0.12e9 * (1 + 36.0 * 0.1) ** 0.45 * 46.0 / 47.7
    for rate in (0.0, 1.0, 1.0e6):
        assert flow_stress(athermal, state(plastic_strain_rate=rate)) == pytest.approx(expected)


def test_missing_constants_are_faults():
    assert COPPER_SCG._replace(Peierls_stress=0.0).faults()
    assert len(COPPER_SCG._replace(C1=0.0, dislocation_density=1.0e12).faults()) == 6
    assert ZerilliArmstrong(*[0.0] * 8).faults()
    assert not COPPER_ZA.faults() + IRON_ZA.faults()


def test_overdriven_shock_follows_the_power_law():
    at = state(plastic_strain_rate=1.0e11, plastic_strain=0.1)
    faster = at._replace(plastic_strain_rate=2.0e11)
    assert flow_stress(COPPER_PTW, faster) / flow_stress(COPPER_PTW, at) == pytest.approx(2.0**0.25)
    assert rate_slope(COPPER_PTW, at) == pytest.approx(0.25 * flow_stress(COPPER_PTW, at) / 1.0e11)
    assert hardening_slope(COPPER_PTW, at) == 0.0


def test_all_parameters_explain_themselves():
    for record in FLOW_STRESS.models.values():
        assert record.__doc__
        assert all(item.parameter.meaning for item in fields(record))
