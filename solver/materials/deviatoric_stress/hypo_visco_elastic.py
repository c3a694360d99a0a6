"""Viscoelastic deviatoric stress of Maxwell elements in parallel."""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.lanes import like, where
from solver.materials.deviatoric_stress import relax, stress_increment
from solver.tensor import Tensor, double_dot, isotropic, norm, put_tensor, tensor_at

STEADY = 1.0e-4
"""An element whose stress rate is below this part of the elastic rate counts as saturated."""


@model("deviatoric_stress", "hypoViscoElastic")
class HypoViscoElasticDeviator(NamedTuple):
    """Maxwell elements in parallel: s = sum s_j, s_j' = 2 mu_j dev(d) - s_j / tau_j.

    The stress rate of an element below 1e-4 of its elastic part is dropped, as in Uintah, where saturated
    stress drifted off otherwise. The elements are kept in the frame of the material and turn with it; those
    of Uintah do not, which differs where the material rotates. A step longer than a relaxation time is
    unstable.
    """

    tau: Annotated[tuple[float, ...], Parameter("relaxation times", unit="s", gt=0.0)]
    mu: Annotated[tuple[float, ...], Parameter("shear moduli", unit="Pa", ge=0.0)]

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        if len(self.tau) != len(self.mu):
            return [("mu", f"{len(self.mu)} moduli for {len(self.tau)} relaxation times: give one of each")]
        return [] if self.tau else [("tau", "give at least one relaxation time")]


@implements(stress_increment, HypoViscoElasticDeviator)
@lanewise
def _(
    model: HypoViscoElasticDeviator, elements: Any, p: int, rate: Tensor, shear_modulus: float, dt: float
) -> Tensor:
    stress_rate = isotropic(0.0)
    for j in range(len(model.tau)):
        elastic = 2.0 * model.mu[j] * rate
        relaxing = elastic - tensor_at(elements[j], p) * (1.0 / model.tau[j])
        changes = norm(relaxing) > STEADY * norm(elastic)
        stress_rate = stress_rate + where(changes, relaxing, isotropic(0.0))
    return stress_rate * dt


@implements(relax, HypoViscoElasticDeviator)
@lanewise
def _(
    model: HypoViscoElasticDeviator, elements: Any, p: int, melted: bool, elastic_rate: Tensor, dt: float
) -> float:
    power = like(0.0, elastic_rate.xx)
    for j in range(len(model.tau)):
        old = tensor_at(elements[j], p)
        stress = old + (2.0 * model.mu[j] * elastic_rate - old * (1.0 / model.tau[j])) * dt
        power += double_dot(stress, stress) / (2.0 * model.mu[j] * model.tau[j])
        put_tensor(elements[j], p, where(melted, old, stress))
    return where(melted, 0.0, power)
