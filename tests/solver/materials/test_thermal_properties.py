"""Shear modulus, melting temperature and specific heat."""

from __future__ import annotations

import math

import numpy as np
import pytest
from plasticity import assert_compiled_agrees, grid, state

from solver.materials.melting import MELTING, melting_temperature
from solver.materials.melting.burakovsky_preston_silbar import BurakovskyPrestonSilbarMelting
from solver.materials.melting.constant_melting import ConstantMelting
from solver.materials.melting.linear_melting import LinearMelting
from solver.materials.melting.steinberg_cochran_guinan import SteinbergCochranGuinanMelting
from solver.materials.shear_modulus import SHEAR_MODULUS, shear_modulus
from solver.materials.shear_modulus.constant_shear import ConstantShear
from solver.materials.shear_modulus.mechanical_threshold_stress import MechanicalThresholdShear
from solver.materials.shear_modulus.nadal_le_poac import NadalLePoacShear
from solver.materials.shear_modulus.preston_tonks_wallace import PrestonTonksWallaceShear
from solver.materials.shear_modulus.steinberg_cochran_guinan import SteinbergCochranGuinanShear
from solver.materials.specific_heat import SPECIFIC_HEAT, specific_heat
from solver.materials.specific_heat.constant_specific_heat import ConstantSpecificHeat
from solver.materials.specific_heat.copper_specific_heat import CopperSpecificHeat
from solver.materials.specific_heat.cubic_specific_heat import CubicSpecificHeat
from solver.materials.specific_heat.steel_specific_heat import SteelSpecificHeat

STATES = grid(
    temperature=(20.0, 300.0, 900.0, 1355.0),
    mean_stress=(-30.0e9, 0.0, 2.0e9),
    density=(8000.0, 8930.0, 11000.0),
)
MTS = MechanicalThresholdShear(mu_0=28.0e9, D=4.5e9, T_0=294.0)
SCG = SteinbergCochranGuinanShear(mu_0=47.7e9, A=28.0e-12, B=0.38e-3)
NP = NadalLePoacShear(mu_0=50.7e9, zeta=0.04, slope_mu_p_over_mu0=28.0e-12, C=0.057, m=63.55)
PTW = PrestonTonksWallaceShear(mu_0=51.8e9, alpha=0.2, alphap=0.2, slope_mu_p_over_mu0=28.0e-12)
SCG_MELT = SteinbergCochranGuinanMelting(T_m0=1790.0, Gamma_0=2.02, a=1.5)
# copper, Burakovsky, Preston and Silbar 2000
BPS = BurakovskyPrestonSilbarMelting(
    B0=137.0e9,
    dB_dp0=5.48,
    G0=47.7e9,
    dG_dp0=1.4,
    kappa=1.0,
    z=12.0,
    b2rhoTm=0.64,
    alpha=2.9,
    burgers_factor=1.41,
    a=3.6147e-10,
    v_ws_a3_factor=4.0,
    Boltzmann_Constant=1.3806503e-23,
)
HMX = CubicSpecificHeat(c0=5.265e-1, c1=3.073e-4, c2=1.831e-7, c3=4.194e-10, a=0.0, b=0.0, beta=1.3e-4)


def test_every_model_is_tested():
    assert set(SHEAR_MODULUS.models.values()) == {ConstantShear, *map(type, (MTS, SCG, NP, PTW))}
    assert set(MELTING.models.values()) == {ConstantMelting, LinearMelting, type(SCG_MELT), type(BPS)}
    assert set(SPECIFIC_HEAT.models.values()) == {
        ConstantSpecificHeat,
        CopperSpecificHeat,
        SteelSpecificHeat,
        CubicSpecificHeat,
    }


def test_constant_models_keep_the_materials_values():
    at = state(temperature=900.0, density=10000.0)
    assert shear_modulus(ConstantShear(), at) == 46.0e9
    assert melting_temperature(ConstantMelting(), at) == 1356.0
    assert specific_heat(ConstantSpecificHeat(), at) == 414.0


def test_varshnis_shear_modulus():
    for s in STATES:
        expected = 28.0e9 - 4.5e9 / (np.exp(294.0 / s.temperature) - 1)
        assert shear_modulus(MTS, s) == pytest.approx(expected, rel=1e-12)
    assert shear_modulus(MTS, state(temperature=0.0)) == 28.0e9


def test_steinbergs_shear_modulus():
    for s in STATES:
        eta = s.density / 8930.0
        expected = 47.7e9 * (1 - 28e-12 * s.mean_stress / eta ** (1 / 3) - 0.38e-3 * (s.temperature - 300))
        assert shear_modulus(SCG, s) == pytest.approx(expected, rel=1e-12)


def test_nadal_and_le_poacs_shear_modulus():
    for s in STATES:
        t, eta = s.temperature / 1356.0, s.density / 8930.0
        # as Banerjee 2012, Eq. 42, writes the denominator
        J = 1 + np.exp(-(1 + 1 / 0.04) / (1 + 0.04 / (1 - t)))
        cold = 50.7e9 * (1 - 28e-12 * s.mean_stress / eta ** (1 / 3)) * (1 - t)
        thermal = s.density * 1.3806503e-23 * s.temperature / (0.057 * 63.55 * 1.6605402e-27)
        assert shear_modulus(NP, s) == pytest.approx((cold + thermal) / J, rel=1e-10)


def test_the_shear_modulus_vanishes_smoothly_at_melting():
    melting = [shear_modulus(NP, state(temperature=T)) for T in np.linspace(1300.0, 1440.0, 200)]
    assert melting[-1] == 1.0e-8
    assert (np.diff(melting) <= 0.0).all()
    assert np.abs(np.diff(melting)).max() < 0.05 * 50.7e9
    assert shear_modulus(NP, state(temperature=0.0)) == 50.7e9


def test_prestons_shear_modulus():
    for s in STATES:
        eta = s.density / 8930.0
        expected = 51.8e9 * (1 - 28e-12 * s.mean_stress / eta ** (1 / 3)) * (1 - 0.2 * s.temperature / 1356.0)
        assert shear_modulus(PTW, s) == pytest.approx(expected, rel=1e-12)


def test_steinbergs_melting_temperature():
    for s in STATES:
        eta = s.density / 8930.0
        expected = 1790.0 * np.exp(3.0 * (1 - 1 / eta)) * eta ** (2 * (2.02 - 1.5 - 1 / 3))
        assert melting_temperature(SCG_MELT, s) == pytest.approx(expected, rel=1e-12)


def test_melting_temperature_of_copper_by_dislocations():
    # 1.41 = b^3 / v_WS and 0.64 = b^2 rho_c are those of face-centred lattices; the experiment is 1356 K
    v_ws = 3.6147e-10**3 / 4
    at_zero = 1.41 * v_ws * 47.7e9 * np.log(2.9**2 / (4 * 0.64)) / (8 * np.pi * np.log(11) * 1.3806503e-23)
    assert melting_temperature(BPS, state()) == pytest.approx(at_zero, rel=1e-12)
    assert at_zero == pytest.approx(1356.0, rel=0.2)
    p = 50.0e9
    eta = (1 + 5.48 / 137.0e9 * p) ** (1 / 5.48)
    expected = at_zero * (1 / eta + 1.4 / 47.7e9 * p / eta ** (4 / 3))
    assert melting_temperature(BPS, state(mean_stress=-p)) == pytest.approx(expected, rel=1e-12)


def test_linear_melting_laws():
    squeezed = state(mean_stress=-10.0e9, density=8930.0 / 0.9)
    assert melting_temperature(LinearMelting(1000.0, b=2e-8), squeezed) == pytest.approx(1200.0)
    assert melting_temperature(LinearMelting(1000.0, a=2.0, K_T=1e11), squeezed) == pytest.approx(1200.0)
    assert melting_temperature(LinearMelting(1000.0, a=2.0), squeezed) == pytest.approx(1200.0)
    assert melting_temperature(LinearMelting(1000.0, Gamma_0=4.0 / 3.0), squeezed) == pytest.approx(1200.0)
    for law in (LinearMelting(1000.0, b=2e-8), LinearMelting(1000.0, a=2.0)):
        assert melting_temperature(law, state()) == pytest.approx(1000.0)


def test_a_linear_melting_law_needs_a_coefficient():
    assert LinearMelting(1000.0).faults()
    assert not LinearMelting(1000.0, b=2e-8).faults()


def test_specific_heat_of_copper():
    # the handbook value at room temperature is 385 J/(kg K)
    assert specific_heat(CopperSpecificHeat(), state(temperature=298.0)) == pytest.approx(385.0, rel=0.01)
    below = 4.16e-5 * 200**3 - 0.027 * 200**2 + 6.21 * 200 - 142.6
    assert specific_heat(CopperSpecificHeat(), state(temperature=200.0)) == pytest.approx(below)
    halves = [specific_heat(CopperSpecificHeat(), state(temperature=T)) for T in (269.999, 270.0)]
    assert halves[0] == pytest.approx(halves[1], rel=0.02)


def test_specific_heat_of_steel():
    def expected(T):
        t = T / 1040.0 - 1
        if t < 0:
            return 190.14 + 273.75 * t + 418.30 * abs(t) ** -0.2
        return 465.21 + 267.52 * t + 58.16 * t**-0.35

    for T in (300.0, 1000.0, 1100.0, 1700.0):
        assert specific_heat(SteelSpecificHeat(), state(temperature=T)) == pytest.approx(expected(T))
    assert specific_heat(SteelSpecificHeat(), state(temperature=1040.0)) == pytest.approx(expected(1039.0))
    # about 450 to 475 J/(kg K) in handbooks
    assert specific_heat(SteelSpecificHeat(), state(temperature=298.0)) == pytest.approx(460.0, rel=0.05)


def test_specific_heat_of_hmx():
    t = 300.0
    cubic = t**3 / (5.265e-1 + 3.073e-4 * t + 1.831e-7 * t**2 + 4.194e-10 * t**3)
    expansion = 1.3e-4**2 * t * 129.0e9 / 8930.0
    assert specific_heat(HMX, state(temperature=t)) == pytest.approx(cubic + expansion)
    dense = HMX._replace(a=1.1, b=-0.2, beta=0.0)
    debye = 1.2**1.1 * math.exp(-0.2 * 0.2)
    at = specific_heat(dense, state(temperature=t * debye, density=1.2 * 8930.0))
    assert at == pytest.approx(cubic)


@pytest.mark.parametrize("model", [ConstantShear(), MTS, SCG, NP, PTW])
def test_compiled_shear_modulus_agrees(model):
    assert_compiled_agrees(shear_modulus, model, state(mean_stress=-1.0e9))


@pytest.mark.parametrize("model", [ConstantMelting(), LinearMelting(1000.0, a=1.0), SCG_MELT, BPS])
def test_compiled_melting_temperature_agrees(model):
    assert_compiled_agrees(melting_temperature, model, state(mean_stress=-1.0e9, density=9000.0))


@pytest.mark.parametrize("model", [ConstantSpecificHeat(), CopperSpecificHeat(), SteelSpecificHeat(), HMX])
def test_compiled_specific_heat_agrees(model):
    assert_compiled_agrees(specific_heat, model, state(density=9000.0))
