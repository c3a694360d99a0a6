"""Models that take eight particles at once answer as they do for one after the other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from test_flow_stress import COPPER_MTS, COPPER_PTW, STEEL_JC
from test_model_exchange import COPPER, MODELS, Choice, G, K
from test_thermal_properties import MTS, NP, SCG_MELT
from test_yield_condition import GURSON

from solver.dispatch import takes_lanes
from solver.kernels.stress import STRESS_SUMS, Kinematics, StressLoop, total, update_singly, update_stresses
from solver.materials.comp_neo_hook import CompNeoHook, CompNeoHookPlastic
from solver.materials.constitutive import DELETE, Step, initialize, state_record, stress_update
from solver.materials.damage import initialize_damage
from solver.materials.damage.no_damage import NoDamage
from solver.materials.deviatoric_stress.hypo_visco_elastic import HypoViscoElasticDeviator
from solver.materials.elastic_plastic import ElasticPlastic
from solver.materials.equation_of_state.default_hyper import DefaultHyper
from solver.materials.equation_of_state.mie_gruneisen import MieGruneisen
from solver.materials.erosion.no_erosion import NoErosion
from solver.materials.erosion.zero_stress import ZeroStress
from solver.materials.failure import new_failure
from solver.materials.melting.constant_melting import ConstantMelting
from solver.materials.return_algorithm.radial_return import RadialReturn
from solver.materials.shear_modulus.constant_shear import ConstantShear
from solver.materials.specific_heat.constant_specific_heat import ConstantSpecificHeat
from solver.materials.specific_heat.copper_specific_heat import CopperSpecificHeat
from solver.materials.stability.drucker_becker import DruckerBecker
from solver.materials.stability.no_check import NoCheck
from solver.materials.yield_condition.von_mises import VonMises
from solver.particles import Particles, new_arrays

COUNT = 19
"""Twice eight, and three that are left."""
STEPS = 4
DT = 2.0e-6
ROUNDING = 1.0e-11
"""Relative to the largest value of a field: sums of stresses that nearly cancel keep fewer digits."""

SIMPLE = ElasticPlastic(K, G, STEEL_JC, equation_of_state=MieGruneisen(3940.0, 2.02, 1.489))
COPPER_LAWS = Choice(
    COPPER_MTS,
    DefaultHyper(),
    MTS,
    SCG_MELT,
    CopperSpecificHeat(),
    VonMises(),
    DruckerBecker(),
    NoDamage(),
    RadialReturn(),
)
POROUS = Choice(
    COPPER_PTW,
    MieGruneisen(3940.0, 2.02, 1.489),
    NP,
    ConstantMelting(),
    ConstantSpecificHeat(),
    GURSON,
    NoCheck(),
    MODELS["damage"][1],
)
VISCOUS = POROUS._replace(
    shear_modulus=ConstantShear(), deviatoric_stress=HypoViscoElasticDeviator((1.0e-5, 3.0e-5), (G, 0.3 * G))
)
CASES: dict[str, tuple[Any, Any, Any]] = {
    "comp_neo_hook": (CompNeoHook(K, G), None, None),
    "comp_neo_hook, eroding": (CompNeoHook(K, G), MODELS["damage"][3], ZeroStress()),
    "comp_neo_hook_plastic": (
        CompNeoHookPlastic(K, G, yield_stress=2.0e8, hardening_modulus=1.0e9),
        None,
        None,
    ),
    "elastic_plastic": (SIMPLE, None, None),
    "elastic_plastic, laws of copper": (COPPER_LAWS.model, None, ZeroStress()),
    "elastic_plastic, porous and viscous": (VISCOUS.model, VISCOUS.damage, ZeroStress()),
    "hyperelastic_plastic": (POROUS.hyperelastic, None, ZeroStress()),
}


class Specimen:
    """Particles that stretch, flow, melt, fail and turn inside out."""

    def __init__(self, model: Any, damage: Any, erosion: Any) -> None:
        rng = np.random.default_rng(5)
        self.model = model
        self.particles: Any = new_arrays(Particles, COUNT)
        self.particles.volume[:], self.particles.mass[:] = 1.0e-9, COPPER.density * 1.0e-9
        self.particles.temperature[:] = self.particles.previous_temperature[:] = rng.uniform(
            250.0, 500.0, COUNT
        )
        self.particles.position[:] = rng.normal(size=(COUNT, 3))
        self.particles.old_velocity[:] = rng.normal(size=(COUNT, 3))
        self.particles.localized[3] = 1
        self.particles.temperature[6] = 2500.0
        self.state: Any = new_arrays(state_record(model), COUNT)
        patch = np.zeros(COUNT, np.int64)
        if type(model) in initialize.registry:
            initialize(model, self.state, self.particles, COPPER, patch)
        erosion = NoErosion() if erosion is None else erosion
        self.failure = new_failure(damage, erosion, COUNT)
        initialize_damage(self.failure.damage, self.failure.damage_state, self.particles, patch)
        self.rates = rng.normal(size=(COUNT, 3, 3)) * np.geomspace(1.0, 3.0e4, COUNT)[:, None, None]
        if isinstance(model, ElasticPlastic):
            self.particles.deformation_gradient[17] = np.diag([-1.0, 1.0, 1.0])  # inside out

    def advance(self, update: Any, step_number: int, stabilized: bool) -> Any:
        """One step; returns the sums. Without viscosity where pressure is stabilized: J / J_cell is 1 to rounding."""
        self.particles.velocity_gradient[:] = self.rates * (1.0 if step_number < STEPS - 1 else -1.0)
        sums = np.empty((1, STRESS_SUMS))
        loop = StressLoop(
            self.model,
            self.state,
            self.failure,
            self.particles,
            COPPER,
            Step(DT, step_number * DT, 1.0e-3, not stabilized, 0.2, 2.0, True),
            Kinematics(1, stabilized),
            np.arange(COUNT) % 5,
            np.linspace(0.97, 1.03, 5),
        )
        update(loop, 0, 1, sums)
        return total(sums)

    @property
    def arrays(self) -> dict[str, np.ndarray]:
        """All that is known of the particles, by name."""
        records = (self.particles, self.state, self.failure.damage_state, self.failure.erosion_state)
        return {name: array for record in records for name, array in record._asdict().items()}


@pytest.mark.parametrize("case", CASES)
def test_eight_at_once_as_one_after_the_other(case):
    model, damage, erosion = CASES[case]
    assert takes_lanes(stress_update, model)
    eight, single = Specimen(model, damage, erosion), Specimen(model, damage, erosion)
    for step_number in range(STEPS):
        stabilized = case == "comp_neo_hook"
        sums = eight.advance(update_stresses, step_number, stabilized)
        expected = single.advance(update_singly, step_number, stabilized)
        np.testing.assert_allclose(np.hstack(sums), np.hstack(expected), rtol=ROUNDING)
        others = single.arrays
        for name, array in eight.arrays.items():
            scale = np.nanmax(np.abs(others[name]), initial=0.0)
            np.testing.assert_allclose(array, others[name], rtol=0.0, atol=ROUNDING * scale, err_msg=name)


def test_the_specimens_see_every_branch():
    """Elastic and plastic, melted, failed and removed particles; else agreement would say little."""
    model, damage, erosion = CASES["elastic_plastic, laws of copper"]
    specimen = Specimen(model, damage, erosion)
    states = set()
    for step_number in range(STEPS):
        specimen.advance(update_singly, step_number, False)
        states.update(specimen.particles.localized.tolist())
    strain = specimen.state.plastic_strain
    assert 0 < np.count_nonzero(strain) < COUNT - 2
    assert states == {DELETE, 0, 1}
    assert specimen.particles.localized[6] == 1  # it melted
