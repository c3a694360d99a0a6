"""What materials are made of answers for eight particles at once as in plain Python for one after the other.

And what it answers for one of the eight does not depend on the seven beside it, to the last bit.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest
from test_arruda_boyce import RUBBER as ARRUDA_BOYCE
from test_cam_clay import clay
from test_cnh_mms import MODEL as CNH_MMS
from test_comp_mooney_rivlin import RUBBER as MOONEY_RIVLIN
from test_damage_and_erosion import COULOMB, STRAIN_LIMIT
from test_flow_stress import STEEL_JC
from test_hypo_elastic import MODEL as HYPO_ELASTIC
from test_ideal_gas import AIR, GAS
from test_jwlpp_mpm import HE as BURNING_MATERIAL
from test_jwlpp_mpm import MODEL as BURNING
from test_kelvin_voigt import MODEL as KELVIN_VOIGT
from test_maxwell_weichert import MODEL as MAXWELL_WEICHERT
from test_model_exchange import COPPER, MODELS, TEMPERATURE, G, K
from test_mohr_coulomb import EARTH, SOIL
from test_murnaghan_mpm import MODEL as MURNAGHAN
from test_mw_visco_elastic import MODEL as MW_VISCO_ELASTIC
from test_nonlocal_drucker_prager import rock
from test_p_alpha import MODEL as POROUS
from test_p_alpha import SAND
from test_program_burn import HE as LIT_MATERIAL
from test_program_burn import MODEL as LIT
from test_soil_foam import FOAM
from test_svk import RUBBER as SVK
from test_swelling import PLASTIC, silicon
from test_th_water import MODEL as TH_WATER
from test_th_water import WATER as TH_WATER_MATERIAL
from test_trans_iso_hyper import LIGAMENT
from test_trans_iso_hyper import MATERIAL as TISSUE
from test_trans_iso_hyper import VISCOUS as VISCOUS_LIGAMENT
from test_ucnh_var import MODEL as UCNH_VAR
from test_visco_plastic import ICE
from test_visco_plastic import MODEL as CREEPING
from test_visco_scram import EXPLOSIVE, PBX
from test_water import LIQUID, WATER

from solver.dispatch import inline
from solver.jit import kernel
from solver.lanes import WIDTH, Eight, where
from solver.materials.constitutive import DELETE, Point, Step, initialize, state_record, stress_update
from solver.materials.damage import initialize_damage
from solver.materials.elastic_plastic import ElasticPlastic
from solver.materials.erosion.allow_no_shear import AllowNoShear
from solver.materials.erosion.allow_no_tension import AllowNoTension
from solver.materials.erosion.no_erosion import PreserveStress
from solver.materials.erosion.zero_stress import ZeroStress
from solver.materials.failure import new_failure, restrained, weakened
from solver.materials.flow_stress import in_step, response
from solver.materials.gao_elastic import GaoElastic
from solver.materials.melting import melting_temperature
from solver.materials.melting.linear_melting import LinearMelting
from solver.materials.plasticity_state import PlasticityState
from solver.materials.rigid import Rigid
from solver.materials.shear_modulus import shear_modulus
from solver.materials.specific_heat import specific_heat
from solver.materials.yield_condition import hardening_term, yield_normal, yield_value
from solver.particles import Particles, new_arrays
from solver.tensor import put_tensor, tensor_at, trace

ROUNDING = 2.0e-12
"""Relative to the largest value among the eight."""

BRITTLE = MODELS["damage"][5]._replace(youngs_modulus=1.0e11)


class Parts(NamedTuple):
    """One model of each family."""

    flow_stress: Any
    shear_modulus: Any
    melting: Any
    specific_heat: Any
    yield_condition: Any


@inline
def properties(parts: Any, table: Any, stresses: Any, p: Any, answers: Any) -> None:
    """All that the models say of a state, a row of ``table``."""
    state = PlasticityState(
        table[p, 0],
        table[p, 1],
        table[p, 2],
        table[p, 3],
        table[p, 4],
        table[p, 5],
        table[p, 6],
        table[p, 7],
        table[p, 8],
        table[p, 9],
        table[p, 10],
        table[p, 11],
    )
    at = response(in_step(parts.flow_stress, state), state)
    answers[p, 0] = at.flow_stress
    answers[p, 1] = at.hardening_slope
    answers[p, 2] = at.rate_slope * state.plastic_strain_rate  # what is left of differences, at rest
    answers[p, 3] = shear_modulus(parts.shear_modulus, state)
    answers[p, 4] = melting_temperature(parts.melting, state)
    answers[p, 5] = specific_heat(parts.specific_heat, state)
    stress, porosity = tensor_at(stresses, p), table[p, 12]
    surface = yield_value(parts.yield_condition, 3.0e8, trace(stress), at.flow_stress, porosity)
    normal = yield_normal(parts.yield_condition, stress, at.flow_stress, porosity)
    answers[p, 6] = surface.function
    answers[p, 7] = surface.strength
    answers[p, 8] = normal.xx
    answers[p, 9] = normal.xy
    answers[p, 10] = hardening_term(
        parts.yield_condition, stress, normal, at.flow_stress, at.hardening_slope, porosity, 0.3
    )


@kernel
def properties_of_eight(parts, table, stresses, answers):
    properties(parts, table, stresses, Eight(0), answers)


NAMES = (
    "flow_stress",
    "hardening_slope",
    "rate_slope times rate",
    "shear_modulus",
    "melting_temperature",
    "specific_heat",
    "yield function",
    "strength",
    "normal.xx",
    "normal.xy",
    "hardening_term",
)


def states() -> tuple[Any, Any]:
    """Eight states and stresses: at rest, slow, shocked, cold, hot, molten, without strain, with many voids."""
    rng = np.random.default_rng(7)
    table = np.empty((WIDTH, 13))
    table[:, 0] = 0.0, 1.0e-4, 0.02, 0.1, 0.3, 1.0, 0.5, 0.05
    table[:, 1] = 0.0, 1.0e-3, 0.5, 20.0, 900.0, 4.0e3, 1.0e6, 1.0e9
    table[:, 2] = 0.0, 2.0e-3, 0.7, 30.0, 1.0e3, 5.0e3, 2.0e6, 2.0e9
    table[:, 3] = 294.0, 20.0, 269.0, 270.0, 600.0, 1040.0, 1300.0, 1500.0
    table[:, 4] = rng.uniform(-2.0e9, 1.0e9, WIDTH)
    table[:, 5] = COPPER.density * rng.uniform(0.95, 1.1, WIDTH)
    table[:, 6] = COPPER.density
    table[:, 7] = rng.uniform(0.0, 1.0e5, WIDTH)
    table[:, 8], table[:, 9] = K, G
    table[:, 10], table[:, 11] = COPPER.melt_temperature, COPPER.specific_heat
    table[:, 12] = 0.0, 0.002, 0.01, 0.05, 0.1, 0.2, 0.4, 0.6
    stresses = rng.normal(size=(WIDTH, 3, 3)) * 2.0e8
    return table, stresses + stresses.transpose(0, 2, 1)


LAWS = [
    Parts(
        flow,
        MODELS["shear_modulus"][k % 5],
        (*MODELS["melting"], LinearMelting(1356.0, a=1.5))[k % 5],
        MODELS["specific_heat"][k % 4],
        MODELS["yield_condition"][k % 3],
    )
    for k, flow in enumerate(MODELS["flow_stress"])
]
"""Every flow stress once, and with them every model of the other families."""


@pytest.mark.parametrize("parts", LAWS, ids=lambda parts: type(parts.flow_stress).__name__)
def test_properties_of_eight_particles(parts):
    table, stresses = states()
    answers, expected = np.zeros((2, WIDTH, len(NAMES)))
    properties_of_eight(parts, table, stresses, answers)
    for p in range(WIDTH):
        single = table.tolist()[p]
        properties(parts, {(p, k): value for k, value in enumerate(single)}, stresses, p, expected)
    for k, name in enumerate(NAMES):
        assert np.isfinite(expected[:, k]).all(), name
        scale = np.abs(expected[:, k]).max()
        np.testing.assert_allclose(
            answers[:, k], expected[:, k], rtol=0.0, atol=ROUNDING * scale, err_msg=name
        )


@pytest.mark.parametrize("parts", LAWS, ids=lambda parts: type(parts.flow_stress).__name__)
def test_properties_do_not_depend_on_the_particles_beside(parts):
    table, stresses = states()
    together, among_likes = np.zeros((2, WIDTH, len(NAMES)))
    properties_of_eight(parts, table, stresses, together)
    for p in range(WIDTH):
        likes = np.full(WIDTH, p)
        properties_of_eight(parts, table[likes], stresses[likes], among_likes)
        np.testing.assert_array_equal(among_likes, together[likes])


@inline
def respond(
    model: Any, state: Any, particles: Any, before: Any, material: Any, step: Any, p: Any, answers: Any
) -> None:
    """A stress update; ``before`` holds deformation gradient and volume at its start."""
    point = Point(
        tensor_at(particles.stress, p),
        tensor_at(before.deformation_gradient, p),
        tensor_at(particles.deformation_gradient, p),
        tensor_at(particles.velocity_gradient, p),
        before.volume[p],
        particles.volume[p],
        particles.mass[p],
        particles.temperature[p],
        particles.previous_temperature[p],
        particles.localized[p],
    )
    update = stress_update(model, state, p, point, material, step)
    put_tensor(particles.stress, p, update.stress)
    answers[p, 0] = update.sound_speed
    answers[p, 1] = update.strain_energy
    answers[p, 2] = update.heating_rate
    answers[p, 3] = update.artificial_pressure
    answers[p, 4] = update.localized


@kernel
def respond_all(model, state, particles, before, material, step, answers):
    respond(model, state, particles, before, material, step, Eight(0), answers)


class Before(NamedTuple):
    """What a step starts from."""

    deformation_gradient: Any
    volume: Any


WET_SOIL = SOIL._replace(
    Usetransition=1.0,
    St=2.0,
    A1=3.0e3,
    B1=0.5,
    W=0.4,
    beta_rate=0.1,
    strain_ref=300.0,
    Use_linear=1.0,
    a=2.0e3,
    y_ref=-1.0,
    Usemodul=1.0,
    m_modul=100.0,
    nuy=0.3,
    Use_softening=1.0,
    strain_95=0.2,
    Use_regular=1.0,
    tFE=2.0,
    tShear=1.0,
    UseWaterRetention=1.0,
    WR_Param1=0.5,
    WR_Param2=2.0,
    WR_Param3=1.0e-4,
    PhiB=15.0,
    suction=2.0e4,
    SpecVol=1.8,
)
ROCK = rock(h_local=-2.0e8, h_nonlocal=-1.0e8, minimum_yield_stress=1.0e6)
MATERIALS: dict[str, tuple[Any, ...]] = {
    "arruda_boyce": (ARRUDA_BOYCE, COPPER),
    "cam_clay": (clay(), EARTH, 1.0e-2),
    "cnh_mms": (CNH_MMS, COPPER),
    "comp_mooney_rivlin": (MOONEY_RIVLIN, COPPER),
    "gao_elastic": (GaoElastic(K, G, 0.1), COPPER),
    "hypo_elastic": (HYPO_ELASTIC, COPPER),
    "ideal_gas": (GAS, AIR),
    "jwlpp_mpm": (BURNING._replace(max_burn_timestep_size=1.0e-8), BURNING_MATERIAL),
    "jwlpp_mpm, explicit": (
        BURNING._replace(max_burn_timestep_size=1.0e-8, doFastStressCompute=True),
        BURNING_MATERIAL,
    ),
    "kelvin_voigt": (KELVIN_VOIGT, COPPER),
    "maxwell_weichert": (MAXWELL_WEICHERT, COPPER),
    "mohr_coulomb": (SOIL, EARTH, 1.0e-2),
    "mohr_coulomb, all options": (WET_SOIL, EARTH, 1.0e-2),
    "murnaghan": (MURNAGHAN, COPPER),
    "mw_visco_elastic": (MW_VISCO_ELASTIC, COPPER),
    "nonlocal_drucker_prager": (ROCK, COPPER, 0.1),
    "p_alpha": (POROUS._replace(shear_modulus=1.0e8, yield_stress=1.0e6), SAND),
    "program_burn": (LIT, LIT_MATERIAL, 0.3),
    "rf_elastic_plastic": (silicon(PLASTIC), COPPER),
    "rigid": (Rigid(), COPPER),
    "soil_foam": (FOAM, COPPER),
    "svk": (SVK, COPPER),
    "thermo_water": (TH_WATER, TH_WATER_MATERIAL, 0.02),
    "trans_iso_hyper": (LIGAMENT, TISSUE),
    "trans_iso_hyper, failing": (
        LIGAMENT._replace(failure_option=1.0, max_fiber_strain=1.05, max_matrix_strain=0.06),
        TISSUE,
    ),
    "ucnh_var": (UCNH_VAR._replace(usePlasticity=True), COPPER),
    "visco_plastic": (CREEPING, ICE, 1.0e-2),
    "visco_plastic, failing": (
        CREEPING._replace(check_failure=True, failure_variable_mean=1.0e6, zero_stress_upon_failure=False),
        ICE,
        1.0e-2,
    ),
    "visco_trans_iso_hyper": (VISCOUS_LIGAMENT, TISSUE),
    "visco_scram": (PBX._replace(use_time_temperature_equation=True, useObjectiveRate=True), EXPLOSIVE),
    "water": (LIQUID, WATER),
}
RATES = np.array([0.0, 1.0e1, 1.0e3, 1.0e4, 3.0e4, 1.0e5, 1.5e5, 2.0e5])[:, None, None]


class Octet:
    """Eight particles, from one at rest to one that is crushed and let go, or eight times the same one of these."""

    def __init__(self, model: Any, material: Any, slower: float = 1.0, *, only: int | None = None) -> None:
        rng = np.random.default_rng(11)
        self.model, self.material = model, material
        self.particles: Any = new_arrays(Particles, WIDTH)
        self.particles.volume[:], self.particles.mass[:] = 1.0e-9, material.density * 1.0e-9
        self.particles.temperature[:] = self.particles.previous_temperature[:] = TEMPERATURE
        self.particles.color[:] = rng.uniform(0.0, 2.0, WIDTH)
        self.particles.position[:, 0] = np.linspace(0.0, 0.03, WIDTH)
        self.state: Any = new_arrays(state_record(model), WIDTH)
        if type(model) in initialize.registry:
            initialize(model, self.state, self.particles, material, np.zeros(WIDTH, np.int64))
        self.rates = (rng.normal(size=(WIDTH, 3, 3)) * 0.7 - 0.5 * np.eye(3)) * RATES * slower
        self.warming = np.arange(float(WIDTH))
        self.answers = np.zeros((WIDTH, 5))
        if only is not None:
            for array in (*self.particles, *self.state, self.rates, self.warming):
                array[:] = array[only].copy()

    def advance(self, step: Step, share: float, at_once: bool) -> None:
        """Deform the particles by a share of their rates and ask for their stress."""
        particles = self.particles
        before = Before(particles.deformation_gradient.copy(), particles.volume.copy())
        particles.velocity_gradient[:] = share * self.rates
        increment = np.eye(3) + particles.velocity_gradient * step.dt
        particles.deformation_gradient[:] = increment @ before.deformation_gradient
        particles.volume[:] = before.volume * np.linalg.det(increment)
        given = (self.model, self.state, particles, before, self.material, step)
        if at_once:
            respond_all(*given, self.answers)
        else:
            for p in range(WIDTH):
                respond(*given, p, self.answers)
        particles.previous_temperature[:] = particles.temperature
        particles.temperature[:] += self.warming

    @property
    def arrays(self) -> dict[str, np.ndarray]:
        """All that is known of the particles, by name."""
        return {**self.state._asdict(), "stress": self.particles.stress, "answers": self.answers.T}


SHARES = (1.0, 1.0, -0.6, -0.9, 0.3)
STEPS = [Step(1.0e-6, k * 1.0e-6, 1.0e-3, True, 0.2, 2.0, True) for k in range(len(SHARES))]


@pytest.mark.parametrize("name", MATERIALS)
def test_materials_of_eight_particles(name):
    eight, single = Octet(*MATERIALS[name]), Octet(*MATERIALS[name])
    for step, share in zip(STEPS, SHARES, strict=True):
        eight.advance(step, share, at_once=True)
        single.advance(step, share, at_once=False)
        for field, expected in single.arrays.items():
            assert np.isfinite(expected).all(), field
            axes = tuple(range(1, expected.ndim)) if field == "answers" else None
            scale = np.abs(expected).max(axis=axes, keepdims=True)
            assert (np.abs(eight.arrays[field] - expected) <= ROUNDING * scale).all(), field


@pytest.mark.parametrize("name", MATERIALS)
def test_materials_do_not_depend_on_the_particles_beside(name):
    together = Octet(*MATERIALS[name])
    among_likes = [Octet(*MATERIALS[name], only=p) for p in range(WIDTH)]
    for step, share in zip(STEPS, SHARES, strict=True):
        for octet in (together, *among_likes):
            octet.advance(step, share, at_once=True)
        for p, likes in enumerate(among_likes):
            for field, expected in together.arrays.items():
                found = likes.arrays[field].T if field == "answers" else likes.arrays[field]
                right = expected.T if field == "answers" else expected
                np.testing.assert_array_equal(found, np.broadcast_to(right[p], right.shape), err_msg=field)


@inline
def fail(failure: Any, model: Any, state: Any, particles: Any, step: Any, p: Any, answers: Any) -> None:
    """What damage and erosion make of a motion, a stress and a failure state."""
    F = tensor_at(particles.deformation_gradient, p)
    point = Point(
        tensor_at(particles.stress, p),
        F @ F,
        F,
        tensor_at(particles.velocity_gradient, p),
        particles.volume[p],
        particles.volume[p],
        particles.mass[p],
        particles.temperature[p],
        particles.temperature[p],
        particles.localized[p],
    )
    moved = restrained(failure, point)
    put_tensor(particles.deformation_gradient, p, moved.deformation_gradient)
    put_tensor(particles.velocity_gradient, p, moved.velocity_gradient)
    localized = where(particles.color[p] > 0.5, 1, point.localized)
    localized = where(particles.color[p] > 1.5, DELETE, localized)
    weak = weakened(failure, model, state, p, point, point.stress, localized, COPPER, step)
    put_tensor(particles.stress, p, weak.stress)
    answers[p] = weak.localized


@kernel
def fail_all(failure, model, state, particles, step, answers):
    fail(failure, model, state, particles, step, Eight(0), answers)


FAILURES = {
    "johnson_cook, ZeroStress": (MODELS["damage"][1], ZeroStress(2.0e-5)),
    "hancock_mackenzie, AllowNoTension": (MODELS["damage"][2], AllowNoTension(2.0e-5)),
    "Threshold, AllowNoShear": (MODELS["damage"][3], AllowNoShear()),
    "Threshold of strain, ZeroStress": (STRAIN_LIMIT, ZeroStress(2.0e-5)),
    "Threshold of Coulomb, PreserveStress": (COULOMB, PreserveStress()),
    "ThresholdVar, AllowNoTension": (MODELS["damage"][4], AllowNoTension(2.0e-5)),
    "Brittle, PreserveStress": (BRITTLE, PreserveStress()),
    "Brittle that recovers, AllowNoShear": (
        BRITTLE._replace(brittle_damage_allowRecovery=True, brittle_damage_recoveryCoeff=0.7),
        AllowNoShear(),
    ),
}


BREAKABLE = ElasticPlastic(K, G, STEEL_JC, TEPLA_with_damage=True, failure_is_checked=True)


class Fragments(NamedTuple):
    """Particles, what they were made of and how they fail."""

    particles: Any
    state: Any
    failure: Any

    @property
    def arrays(self) -> dict[str, np.ndarray]:
        """All that is known of the particles, by name."""
        records = (self.particles, self.state, self.failure.damage_state, self.failure.erosion_state)
        return {name: array for record in records for name, array in record._asdict().items()}


def fragments(damage: Any, erosion: Any, only: int | None = None) -> Fragments:
    """Eight particles, or eight times the same one of these, that flow under stresses of all signs.

    One fails and one is removed in the step, two failed before.
    """
    rng = np.random.default_rng(13)
    particles: Any = new_arrays(Particles, WIDTH)
    state: Any = new_arrays(state_record(BREAKABLE), WIDTH)
    failure = new_failure(damage, erosion, WIDTH)
    initialize_damage(damage, failure.damage_state, particles, np.zeros(WIDTH, np.int64))
    particles.deformation_gradient[:] += 0.1 * rng.normal(size=(WIDTH, 3, 3))
    particles.velocity_gradient[:] = rng.normal(size=(WIDTH, 3, 3))
    stress = rng.normal(size=(WIDTH, 3, 3)) + np.linspace(-2.0, 2.0, WIDTH)[:, None, None] * np.eye(3)
    particles.stress[:] = 1.0e8 * (stress + stress.transpose(0, 2, 1))
    particles.stress[5] = 0.0
    particles.volume[:], particles.mass[:] = 1.0e-9, COPPER.density * 1.0e-9
    particles.temperature[:] = 400.0
    particles.localized[2] = particles.localized[7] = 1
    particles.color[4], particles.color[1] = 1.0, 2.0
    state.plastic_strain_rate[:] = 0.0, 1.0e5, 1.0e4, 0.1, 0.0, 3.0e4, 5.0e4, 1.0e5
    state.porosity[:] = np.linspace(0.0, 0.49, WIDTH)
    found = Fragments(particles, state, failure)
    if only is not None:
        for array in found.arrays.values():
            array[:] = array[only].copy()
    return found


def fail_in_steps(some: Fragments, at_once: bool) -> None:
    """Three steps, the stress the same but for damage and erosion."""
    answers = np.zeros(WIDTH)
    for k in range(3):
        step = Step(1.0e-5, k * 1.0e-5, 1.0e-3, True, 0.2, 2.0, True)
        given = (some.failure, BREAKABLE, some.state, some.particles, step)
        if at_once:
            fail_all(*given, answers)
        else:
            for p in range(WIDTH):
                fail(*given, p, answers)
        some.particles.localized[:] = answers


@pytest.mark.parametrize("name", FAILURES)
def test_failure_of_eight_particles(name):
    """Some flow, one fails and one is removed in the step, two failed before; some break by voids and damage."""
    eight, single = fragments(*FAILURES[name]), fragments(*FAILURES[name])
    fail_in_steps(eight, at_once=True)
    fail_in_steps(single, at_once=False)
    assert (single.particles.localized[[2, 7, 4, 1]] == [1, 1, 1, DELETE]).all()
    for field, right in single.arrays.items():
        atol = ROUNDING * np.abs(right).max(initial=0.0)
        np.testing.assert_allclose(eight.arrays[field], right, rtol=0.0, atol=atol, err_msg=field)


@pytest.mark.parametrize("name", FAILURES)
def test_failure_does_not_depend_on_the_particles_beside(name):
    together = fragments(*FAILURES[name])
    fail_in_steps(together, at_once=True)
    for p in range(WIDTH):
        likes = fragments(*FAILURES[name], only=p)
        fail_in_steps(likes, at_once=True)
        for field, right in together.arrays.items():
            expected = np.broadcast_to(right[p], right.shape)
            np.testing.assert_array_equal(likes.arrays[field], expected, err_msg=field)
