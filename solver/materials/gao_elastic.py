"""Hypoelastic material that swells by a diffusing substance."""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.materials.constitutive import (
    Material,
    Point,
    Step,
    StressUpdate,
    initial_sound_speed,
    stress_update,
)
from solver.materials.hypo_elastic import HypoElastic, hypo_elastic_stress
from solver.materials.swelling import ConcentrationRate, Expansion, Swelling, without_swelling


class GaoElasticState(NamedTuple):
    """What a particle remembers."""

    swelling: Swelling
    concentration_rate: ConcentrationRate


@model("constitutive_model", "gao_elastic")
class GaoElastic(NamedTuple):
    """hypo_elastic for the rate of deformation less alpha c' I, with the concentration c.

    Gao and Zhou, J. Appl. Phys. 109 (2011); Uintah once had this model, and no longer does. Like
    hypo_elastic it does not turn the stress with the material: large rotations need another model.
    """

    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    shear_modulus: Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)]
    alpha: Expansion

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return GaoElasticState


@initial_sound_speed.register
def _(model: GaoElastic, density: Any, temperature: Any) -> Any:
    return initial_sound_speed(HypoElastic(model.shear_modulus, model.bulk_modulus), density, temperature)


@implements(stress_update, GaoElastic)
@lanewise
def gao_elastic_stress(
    model: GaoElastic, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The increment of hypo_elastic by what is left of the deformation without the swelling."""
    before = state.swelling[p]
    state.swelling[p] = before + model.alpha * state.concentration_rate[p] * step.dt
    rest = without_swelling(point, before, state.swelling[p], step.dt)
    elastic = HypoElastic(model.shear_modulus, model.bulk_modulus, 0.0, False)
    return hypo_elastic_stress(elastic, state, p, rest, material, step)
