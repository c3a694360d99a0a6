"""Algorithms that bring a trial stress back to the yield surface."""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.declare import family
from solver.dispatch import generic
from solver.materials.plasticity_state import PlasticityState
from solver.tensor import Tensor

RETURN_ALGORITHM = family(
    "return_algorithm",
    tag="plastic_convergence_algo",
    package="solver.materials.return_algorithm",
    key="text",
    meaning="algorithm that brings a trial stress back to the yield surface",
)


class PlasticTrial(NamedTuple):
    """A step that leaves the yield surface; tensors in the frame of the material."""

    leaves: bool
    """Which of eight particles do: what becomes of the others does not matter."""
    old_stress: Tensor
    """Stress at the start of the step."""
    stress_deviator: Tensor
    """Trial deviator: old deviator and the elastic increment of the whole step."""
    rate_deviator: Tensor
    """Deviator of the rate of deformation."""
    old_strain_rate: float
    """Equivalent rate of deformation of the previous step."""
    flow_stress: float
    """At the plastic strain expected at the end of the step."""
    strength: float
    """Equivalent stress of the yield surface at that flow stress."""
    porosity: float
    stiffness: float
    """Half of what a unit of plastic strain takes from the stress: the shear modulus, about."""


class PlasticReturn(NamedTuple):
    """The end of a plastic step."""

    stress_deviator: Tensor
    plastic_strain: float
    plastic_strain_rate: float
    flow_stress: float
    multiplier: float
    """Norm of the plastic part of the strain increment."""
    plastic_increment: Tensor
    """Plastic part of the strain increment."""


@generic
def return_to_yield(
    algorithm: Any, flow_model: Any, state: PlasticityState, trial: PlasticTrial, dt: float
) -> PlasticReturn:
    """Deviatoric stress on the yield surface; ``state`` is that of the start of the step."""
    raise NotImplementedError
