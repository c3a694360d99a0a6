"""Adding the loads of one curve to the particles that carry it."""

from __future__ import annotations

from typing import Any

from solver.jit import kernel
from solver.loads.action import Action
from solver.loads.direction import Components, force_for_unit_load, turned
from solver.tensor import rotation, tensor_at


@kernel
def add_force(law: Any, action: Action, position: Any, normals: Any, load_curve: Any, force: Any) -> None:
    """Add a load to the forces (n, 3) of the particles at ``position`` (n, 3)."""
    for p in range(load_curve.shape[0]):
        for k in range(3):
            if load_curve[p, k] == action.curve:
                x = Components(position[p, 0], position[p, 1], position[p, 2])
                f = force_for_unit_load(law, p, x, normals)
                force[p, 0] += f.x * action.magnitude
                force[p, 1] += f.y * action.magnitude
                force[p, 2] += f.z * action.magnitude


@kernel
def add_heat(action: Action, load_curve: Any, heat_rate: Any) -> None:
    """Add a rate of heat to those (n,) of the particles."""
    for p in range(load_curve.shape[0]):
        for k in range(3):
            if load_curve[p, k] == action.curve:
                heat_rate[p] += action.magnitude


@kernel
def turn_forces(deformation_gradient: Any, force: Any) -> None:
    """Turn forces (n, 3) by the rotations R of the deformation gradients F = R U, (n, 3, 3)."""
    for p in range(force.shape[0]):
        f = Components(force[p, 0], force[p, 1], force[p, 2])
        if f.x != 0.0 or f.y != 0.0 or f.z != 0.0:
            f = turned(rotation(tensor_at(deformation_gradient, p)), f)
            force[p, 0], force[p, 1], force[p, 2] = f.x, f.y, f.z
