"""Any model of a family takes the place of any other: the particle moves on, or the deck is told why not."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from test_damage_and_erosion import JC as DAMAGE_JC
from test_damage_and_erosion import STRESS_LIMIT, VARIABLE
from test_flow_stress import (
    COPPER_MTS,
    COPPER_PTW,
    COPPER_SCG,
    COPPER_ZA,
    IRON_ZA,
    ISOTROPIC,
    POLYMER_ZA,
    STEEL_JC,
)
from test_thermal_properties import BPS, HMX, MTS, NP, PTW, SCG, SCG_MELT
from test_yield_condition import GURSON, ROUSSELIER

from solver.declare import FAMILIES
from solver.kernels.stress import STRESS_SUMS, Kinematics, StressLoop, total, update_singly, update_stresses
from solver.materials.comp_neo_hook import CompNeoHook, CompNeoHookPlastic
from solver.materials.constitutive import DELETE, Material, Step, initialize, state_record
from solver.materials.damage import for_constitutive_model, initialize_damage
from solver.materials.damage.brittle import BrittleDamage
from solver.materials.damage.hancock_mackenzie import HancockMacKenzieDamage
from solver.materials.damage.no_damage import NoDamage
from solver.materials.deviatoric_stress.hypo_elastic import HypoElasticDeviator
from solver.materials.deviatoric_stress.hypo_visco_elastic import HypoViscoElasticDeviator
from solver.materials.elastic_plastic import ElasticPlastic
from solver.materials.equation_of_state.default_hyper import DefaultHyper
from solver.materials.equation_of_state.default_hypo import DefaultHypo
from solver.materials.equation_of_state.mie_gruneisen import MieGruneisen
from solver.materials.erosion.zero_stress import ZeroStress
from solver.materials.failure import new_failure
from solver.materials.flow_stress.johnson_cook import JohnsonCook
from solver.materials.hyperelastic_plastic import HyperElasticPlastic
from solver.materials.hypo_elastic import HypoElastic
from solver.materials.melting.constant_melting import ConstantMelting
from solver.materials.melting.linear_melting import LinearMelting
from solver.materials.return_algorithm.radial_return import RadialReturn
from solver.materials.return_algorithm.semi_implicit import SemiImplicit
from solver.materials.shear_modulus.constant_shear import ConstantShear
from solver.materials.specific_heat.constant_specific_heat import ConstantSpecificHeat
from solver.materials.specific_heat.copper_specific_heat import CopperSpecificHeat
from solver.materials.specific_heat.steel_specific_heat import SteelSpecificHeat
from solver.materials.stability.acoustic import Acoustic, Becker
from solver.materials.stability.drucker import Drucker
from solver.materials.stability.drucker_becker import DruckerBecker
from solver.materials.stability.no_check import NoCheck
from solver.materials.yield_condition.von_mises import VonMises
from solver.particles import Particles, new_arrays
from ups.deck import MaterialSection, find_data_file
from ups.diagnostics import Diagnostics
from ups.document import read_document
from ups.reader import Reader

COPPER = Material(8930.0, 414.0, 414.0, 386.0, 294.0, 1356.0, 0.0)
K, G = 129.0e9, 46.0e9
TEMPERATURE = 300.0

MODELS: dict[str, tuple[Any, ...]] = {
    "flow_stress": (ISOTROPIC, STEEL_JC, COPPER_SCG, COPPER_ZA, POLYMER_ZA, COPPER_MTS, COPPER_PTW),
    "equation_of_state": (DefaultHyper(), DefaultHypo(), MieGruneisen(3940.0, 2.02, 1.489)),
    "shear_modulus": (ConstantShear(), MTS, SCG, NP, PTW),
    "melting": (ConstantMelting(), LinearMelting(1356.0, b=2.0e-8), SCG_MELT, BPS),
    "specific_heat": (ConstantSpecificHeat(), CopperSpecificHeat(), SteelSpecificHeat(), HMX),
    "yield_condition": (VonMises(), GURSON, ROUSSELIER),
    "stability": (NoCheck(), Drucker(), Becker(), DruckerBecker(), Acoustic()),
    "damage": (
        NoDamage(),
        DAMAGE_JC,
        HancockMacKenzieDamage(),
        STRESS_LIMIT,
        VARIABLE,
        BrittleDamage(),
    ),
    "return_algorithm": (RadialReturn(), SemiImplicit()),
    "deviatoric_stress": (HypoElasticDeviator(), HypoViscoElasticDeviator((1.0e-3,), (G,))),
}
"""One model, with constants of a metal, for each record class of each family."""
EXCHANGED = tuple(MODELS)[:8]
"""The families of which every three models meet."""


class Choice(NamedTuple):
    """One model of each family."""

    flow_stress: Any
    equation_of_state: Any
    shear_modulus: Any
    melting: Any
    specific_heat: Any
    yield_condition: Any
    stability: Any
    damage: Any
    return_algorithm: Any = SemiImplicit()
    deviatoric_stress: Any = HypoElasticDeviator()

    @property
    def model(self) -> ElasticPlastic:
        return ElasticPlastic(
            K,
            G,
            self.flow_stress,
            self.yield_condition,
            self.equation_of_state,
            self.shear_modulus,
            self.melting,
            self.specific_heat,
            self.deviatoric_stress,
            self.stability,
            plastic_convergence_algo=self.return_algorithm,
            compute_specific_heat=True,
            failure_is_checked=True,
        )

    @property
    def hyperelastic(self) -> HyperElasticPlastic:
        """The same parts in the hyperelastic-plastic material, which has an elastic deviator of its own."""
        fields = self.model._asdict()
        return HyperElasticPlastic(**{name: fields[name] for name in HyperElasticPlastic._fields})

    @property
    def refusals(self) -> list[str]:
        """What the program has against this choice."""
        found = [message for _, message in self.model.faults()]
        try:
            for_constitutive_model(self.damage, self.model)
        except ValueError as problem:
            found.append(str(problem))
        return found


def orthogonal_array(sizes: list[int]) -> list[tuple[int, ...]]:
    """Indices in which every three columns run through all triples of values (R. C. Bose and K. A. Bush 1952).

    The columns are the polynomials a + b x + c x^2 at each x of the integers modulo a prime, and c.
    """
    prime = next(p for p in (5, 7, 11, 13) if p >= max(sizes) and p + 1 >= len(sizes))
    rows = []
    for a, b, c in itertools.product(range(prime), repeat=3):
        values = [*((a + b * x + c * x * x) % prime for x in range(prime)), c]
        rows.append(tuple(value % size for value, size in zip(values, sizes, strict=False)))
    return rows


def choices() -> list[Choice]:
    """Choices in which every three models of different families meet; return and viscosity take turns."""
    rows = orthogonal_array([len(MODELS[family]) for family in EXCHANGED])
    return [
        Choice(
            *(MODELS[family][index] for family, index in zip(EXCHANGED, row, strict=True)),
            MODELS["return_algorithm"][number % 2],
            MODELS["deviatoric_stress"][number % 5 == 0],
        )
        for number, row in enumerate(rows)
    ]


class Specimen:
    """One particle of a choice, with damage and erosion, that the step of a simulation takes along."""

    def __init__(
        self,
        model: Any,
        damage: Any,
        temperature: float = TEMPERATURE,
        *,
        erosion: Any = None,
        material: Material = COPPER,
        viscosity_heating: bool = True,
    ) -> None:
        self.model = model
        self.material = material
        self.viscosity_heating = viscosity_heating
        self.particles: Any = new_arrays(Particles, 1)
        self.particles.volume[:], self.particles.mass[:] = 1.0e-9, material.density * 1.0e-9
        self.particles.temperature[:] = self.particles.previous_temperature[:] = temperature
        self.state: Any = new_arrays(state_record(model), 1)
        patch = np.zeros(1, np.int64)
        if type(model) in initialize.registry:
            initialize(model, self.state, self.particles, material, patch)
        self.failure = new_failure(damage, ZeroStress() if erosion is None else erosion, 1)
        initialize_damage(damage, self.failure.damage_state, self.particles, patch)
        self.time = 0.0

    def advance(self, velocity_gradient: Any, dt: float, compiled: bool = False) -> Any:
        """One step; returns the sums of the stress update."""
        self.particles.velocity_gradient[0] = velocity_gradient
        step = Step(dt, self.time, 1.0e-3, True, 0.2, 2.0, self.viscosity_heating)
        update = update_stresses if compiled else update_singly.py_func
        self.time += dt
        sums = np.empty((1, STRESS_SUMS))
        loop = StressLoop(
            self.model,
            self.state,
            self.failure,
            self.particles,
            self.material,
            step,
            Kinematics(1, False),
            np.zeros(1, np.int64),
            np.ones(1),
        )
        update(loop, 0, 1, sums)
        return total(sums)


DEFORMATION = np.array([[4000.0, 2500.0, 0.0], [-500.0, -3000.0, 800.0], [0.0, 300.0, -800.0]])
"""1/s: mostly shear, with some expansion and spin."""
PATH = [DEFORMATION] * 3 + [-DEFORMATION] * 2
DT = 2.0e-6


def makes_no_sense(choice: Choice) -> bool:
    """The pairs that are known to contradict each other."""
    porous = not isinstance(choice.yield_condition, VonMises)
    viscous = isinstance(choice.deviatoric_stress, HypoViscoElasticDeviator)
    return (
        (porous and isinstance(choice.return_algorithm, RadialReturn))
        or (viscous and not isinstance(choice.shear_modulus, ConstantShear))
        or isinstance(choice.damage, BrittleDamage)
    )


def test_every_model_of_every_family_is_exchanged():
    for family, models in MODELS.items():
        assert {type(model) for model in models} == set(FAMILIES[family].models.values())


def test_every_three_models_meet():
    met = choices()
    for families in itertools.combinations(EXCHANGED, 3):
        wanted = itertools.product(*(map(type, MODELS[family]) for family in families))
        found = {tuple(type(getattr(choice, family)) for family in families) for choice in met}
        assert found == set(wanted)


@pytest.mark.parametrize("flow_model", MODELS["flow_stress"], ids=lambda model: type(model).__name__)
def test_any_choice_runs_or_is_refused(flow_model):
    for choice in choices():
        if choice.flow_stress is not flow_model:
            continue
        assert bool(choice.refusals) == makes_no_sense(choice), choice
        if choice.refusals:
            continue
        specimen = Specimen(choice.model, choice.damage)
        strain = 0.0
        for velocity_gradient in PATH:
            sums = specimen.advance(velocity_gradient, DT)
            assert sums.finite, choice
            particles, state = specimen.particles, specimen.state
            assert 0.0 < particles.temperature[0] < np.inf, choice
            np.testing.assert_allclose(particles.stress[0], particles.stress[0].T, atol=1e-3)
            assert particles.localized[0] in (0, 1)
            assert state.plastic_strain[0] >= strain, choice
            strain = state.plastic_strain[0]
        # a particle that has failed by its stress need not have flowed before
        assert 0.0 < strain < 0.1 or particles.localized[0], choice


@pytest.mark.parametrize("flow_model", MODELS["flow_stress"], ids=lambda model: type(model).__name__)
def test_any_choice_runs_in_the_hyperelastic_material(flow_model):
    for choice in choices():
        model = choice.hyperelastic
        if choice.flow_stress is not flow_model or model.faults():
            continue
        damage = for_constitutive_model(choice.damage, model)
        specimen = Specimen(model, damage)
        for velocity_gradient in PATH:
            assert specimen.advance(velocity_gradient, DT).finite, choice
        assert specimen.particles.temperature[0] > 0.0
        assert specimen.state.plastic_strain[0] > 0.0 or specimen.particles.localized[0], choice


@pytest.mark.parametrize("index", [0, 57, 171, 340])
def test_choices_run_compiled(index):
    possible = [choice for choice in choices() if not choice.refusals]
    choice = possible[index % len(possible)]
    plain, fast = (Specimen(choice.model, choice.damage) for _ in range(2))
    for velocity_gradient in PATH:
        plain.advance(velocity_gradient, DT)
        fast.advance(velocity_gradient, DT, compiled=True)
    for records in zip(
        (plain.particles, plain.state, plain.failure.damage_state),
        (fast.particles, fast.state, fast.failure.damage_state),
        strict=True,
    ):
        for mine, theirs in zip(*records, strict=True):
            np.testing.assert_allclose(theirs, mine, rtol=1e-11, atol=1e-11 * np.abs(mine).max(initial=1.0))


@pytest.mark.parametrize("flow_model", MODELS["flow_stress"], ids=lambda model: type(model).__name__)
@pytest.mark.parametrize("temperature", [77.0, 1340.0, 1360.0])
def test_flow_models_run_cold_and_at_the_melting_point(flow_model, temperature):
    model = ElasticPlastic(K, G, flow_model, VonMises(), MODELS["equation_of_state"][2])
    specimen = Specimen(model, NoDamage(), temperature)
    for velocity_gradient in PATH:
        assert specimen.advance(velocity_gradient, DT).finite
    shear = specimen.particles.stress[0] - np.trace(specimen.particles.stress[0]) / 3 * np.eye(3)
    # above the melting temperature of the material nothing but pressure is left
    assert (np.abs(shear).max() < 1.0) == (temperature > COPPER.melt_temperature)


@pytest.mark.parametrize(
    ("model", "damage", "reason"),
    [
        (CompNeoHook(K, G), DAMAGE_JC, "plastic strain"),
        (CompNeoHookPlastic(K, G, yield_stress=1e8, hardening_modulus=1e9), DAMAGE_JC, "plastic strain"),
        (HypoElastic(G, K), HancockMacKenzieDamage(), "plastic strain"),
        (HypoElastic(G, K), BrittleDamage(), "bulk_modulus"),
        (ElasticPlastic(K, G, STEEL_JC), BrittleDamage(), "every step"),
    ],
)
def test_damage_that_makes_no_sense_says_why(model, damage, reason):
    with pytest.raises(ValueError, match=reason):
        for_constitutive_model(damage, model)


@pytest.mark.parametrize("damage", [NoDamage(), STRESS_LIMIT, VARIABLE, BrittleDamage()])
def test_damage_goes_with_a_hyperelastic_material(damage):
    model = CompNeoHook(K, G)
    specimen = Specimen(model, for_constitutive_model(damage, model))
    for velocity_gradient in PATH:
        assert specimen.advance(velocity_gradient, DT).finite


@pytest.mark.parametrize(
    ("model", "field"),
    [
        (JohnsonCook(9.0e7, 2.92e8, 0.025, 0.31, 1.09, T_r=298.0, T_m=298.0), "T_m"),
        (COPPER_MTS._replace(p_i=0.5, q_i=1.5, edot_0i=1.0e13), "g_0i"),
        (IRON_ZA._replace(k_H=0.0), "c_0"),
        (ElasticPlastic(K, G, STEEL_JC, check_max_stress_failure=True), "critical_stress"),
        (ElasticPlastic(K, G, STEEL_JC, GURSON), "plastic_convergence_algo"),
        (
            ElasticPlastic(
                K,
                G,
                STEEL_JC,
                shear_modulus_model=MTS,
                deviatoric_stress_model=HypoViscoElasticDeviator((1.0e-3,), (G,)),
            ),
            "shear_modulus_model",
        ),
    ],
)
def test_constants_that_contradict_each_other_are_named(model, field):
    assert [name for name, _ in model.faults()] == [field]


MATERIAL = """<material>
  <density>8930</density> <thermal_conductivity>386</thermal_conductivity> <specific_heat>414</specific_heat>
  <constitutive_model type="comp_neo_hook">
    <bulk_modulus>129e9</bulk_modulus> <shear_modulus>46e9</shear_modulus>
  </constitutive_model>
  <damage_model type="hancock_mackenzie"/>
  <erosion algorithm="ZeroStress"/>
</material>
"""


def test_a_deck_is_told_at_the_line_of_the_damage_model():
    document = read_document("copper", text=MATERIAL, roots=("material",))
    diagnostics = Diagnostics(document.diagnostics)
    reader = Reader(diagnostics, lambda name: find_data_file(name, Path()))
    assert reader.read(MaterialSection, document.root) is None
    (problem,) = list(diagnostics)
    assert "plastic strain" in problem.message
    assert problem.code == "UPS502"
    assert problem.location is not None
    assert problem.location.line == 6


@pytest.mark.parametrize("compiled", [False, True], ids=["plain", "compiled"])
@pytest.mark.parametrize("rate", [1.0e6, -1.0e6])
def test_a_particle_that_blows_up_is_removed_and_holds_nothing_back(rate, compiled):
    # F of a thousand stretches by a hundred: det F is infinite or not a number, and so would the waves be
    model = ElasticPlastic(K, G, STEEL_JC)
    specimen = Specimen(model, NoDamage())
    with np.errstate(all="ignore"):
        sums = specimen.advance(np.diag([rate, rate, abs(rate)]), 1.0, compiled)
    assert specimen.particles.localized[0] == DELETE
    assert sums.finite
    assert max(sums.wave_speed) < 1.0
    np.testing.assert_array_equal(specimen.particles.stress[0], 0.0)
