"""Damage and erosion of a material together: what the stress update does before and after the model's own."""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.dispatch import generic_with_default, inline, lanewise
from solver.lanes import anywhere, where
from solver.materials.constitutive import DELETE, Material, Point, Step
from solver.materials.damage import (
    DamagePoint,
    DamageUpdate,
    counts_strain,
    damage_state,
    damages,
    scalar_damage,
    update_damage,
)
from solver.materials.damage.no_damage import NoDamage
from solver.materials.erosion import ErosionState, erode, lets_fail, restrain
from solver.materials.erosion.no_erosion import NoErosion
from solver.particles import new_arrays
from solver.tensor import Tensor


class Failure(NamedTuple):
    """How the particles of a material are damaged and what becomes of those that failed."""

    damage: Any
    damage_state: Any
    erosion: Any
    erosion_state: ErosionState


def new_failure(damage: Any, erosion: Any, count: int) -> Failure:
    """The failure of a material with ``count`` particles; None stands for no damage, or no erosion."""
    damage = NoDamage() if damage is None else damage
    erosion = NoErosion() if erosion is None else erosion
    return Failure(
        damage,
        new_arrays(damage_state(damage), count),
        erosion,
        new_arrays(ErosionState, count),
    )


@generic_with_default
@lanewise
def plastic_strain_rate(model: Any, state: Any, p: int) -> float:
    """Rate of plastic strain that damages particle ``p`` in the step; 0 for models without plasticity."""
    return 0.0


@generic_with_default
@lanewise
def fractures(model: Any, state: Any, p: int, damage: float) -> bool:
    """Whether particle ``p`` breaks by its porosity together with a scalar damage."""
    return False


def check_flows(damage: str, constitutive_model: Any) -> None:
    """Raise ValueError where a damage model that grows with plastic strain meets a model without any."""
    if type(constitutive_model) not in plastic_strain_rate.implementations:  # type: ignore[attr-defined]  # by generic
        raise ValueError(
            f"damage model {damage} grows with plastic strain, and this material reports none: "
            "use it with elastic_plastic"
        )


@inline
def restrains(failure: Failure) -> bool:
    """Whether particles that failed move otherwise than the others."""
    return lets_fail(failure.erosion)


@inline
def weakens(failure: Failure) -> bool:
    """Whether damage or erosion can change the answer of the constitutive model."""
    return damages(failure.damage) or lets_fail(failure.erosion)


@inline
def restrained(failure: Failure, point: Point) -> Point:
    """The particle with the motion that its erosion algorithm leaves it, where it failed before the step."""
    failed = point.localized != 0
    if not anywhere(failed):
        return point
    motion = restrain(
        failure.erosion,
        point.deformation_gradient_old,
        point.deformation_gradient,
        point.velocity_gradient,
    )
    return Point(
        point.stress,
        point.deformation_gradient_old,
        where(failed, motion.deformation_gradient, point.deformation_gradient),
        where(failed, motion.velocity_gradient, point.velocity_gradient),
        point.volume_old,
        point.volume,
        point.mass,
        point.temperature,
        point.previous_temperature,
        point.localized,
    )


@inline
def weakened(
    failure: Failure,
    model: Any,
    state: Any,
    p: int,
    point: Point,
    stress: Tensor,
    localized: int,
    material: Material,
    step: Step,
) -> DamageUpdate:
    """Stress and failure state, those of the constitutive model, after damage and erosion."""
    damaged = update_damage(
        failure.damage,
        failure.damage_state,
        p,
        DamagePoint(
            stress,
            point.deformation_gradient,
            plastic_strain_rate(model, state, p),
            point.temperature,
            point.volume,
            localized,
        ),
        material,
        step,
    )
    stress, localized = damaged.stress, damaged.localized
    if counts_strain(failure.damage):
        broken = fractures(model, state, p, scalar_damage(failure.damage, failure.damage_state, p))
        localized = where(broken & (localized == 0), 1, localized)
    if lets_fail(failure.erosion):
        stress = eroded(failure, p, stress, localized, point.localized, step.time)
    return DamageUpdate(stress, localized)


@inline
def eroded(
    failure: Failure, p: int, stress: Tensor, localized: int, localized_before: int, time: float
) -> Tensor:
    """Stress of a particle after erosion; the time of its failure is noted."""
    kept = localized != DELETE
    changed = kept & (localized != localized_before)
    failed_at = where(changed, time, failure.erosion_state.failure_time[p])
    if anywhere(changed):
        failure.erosion_state.failure_time[p] = failed_at
    failed = kept & (localized != 0)
    if anywhere(failed):
        stress = where(failed, erode(failure.erosion, stress, time - failed_at), stress)
    return stress
