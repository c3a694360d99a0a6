"""The loops over nodes.

Nodal fields are those of one material, (N, ...), unless said.
"""

from __future__ import annotations

from typing import Any

from solver.boundary_conditions import GRADIENT, MIRROR, SET, ZERO_NORMAL, Operations
from solver.jit import kernel
from solver.kernels.transfer import CHANNELS
from solver.nodal import EMPTY_MASS


@kernel
def apply_operations(operations: Operations, field: Any) -> None:
    """Apply boundary operations to nodal values (N, components) in order."""
    for o in range(operations.kind.shape[0]):
        kind, axis = operations.kind[o], operations.axis[o]
        for e in range(operations.start[o], operations.start[o + 1]):
            node, source = operations.node[e], operations.source[e]
            if kind == ZERO_NORMAL:
                field[node, axis] = 0.0
                continue
            for c in range(field.shape[1]):
                if kind == SET:
                    field[node, c] = operations.value[o, c]
                elif kind == MIRROR:
                    field[node, c] = -field[source, c] if c == axis else field[source, c]
                elif kind == GRADIENT:
                    field[node, c] = field[source, c] - operations.value[o, c]


@kernel
def fold_images(sums: Any, owner: Any, image: Any) -> None:
    """Periodic directions: add the sums of image nodes to their owners, then copy the totals back."""
    for e in range(owner.shape[0]):
        for c in range(sums.shape[1]):
            sums[owner[e], c] += sums[image[e], c]
    for e in range(owner.shape[0]):
        for c in range(sums.shape[1]):
            sums[image[e], c] = sums[owner[e], c]


@kernel
def copy_to_images(field: Any, owner: Any, image: Any) -> None:
    """Periodic directions: give image nodes the values (N, components) of their owners."""
    for e in range(owner.shape[0]):
        for c in range(field.shape[1]):
            field[image[e], c] = field[owner[e], c]


@kernel
def normalise(
    sums: Any,
    mass: Any,
    volume: Any,
    velocity: Any,
    internal_force: Any,
    external_force: Any,
    temperature: Any,
    heat: Any,
) -> None:
    """Split the sums into nodal fields, v_i = momentum / mass and T_i = (mass T) / mass, and leave zeros behind."""
    for i in range(mass.shape[0]):
        row = sums[i]
        m = EMPTY_MASS + row[0]
        mass[i] = m
        volume[i] = EMPTY_MASS + row[4]
        for c in range(3):
            velocity[i, c] = row[1 + c] / m
            internal_force[i, c] = row[8 + c]
            external_force[i, c] = row[12 + c]
        temperature[i] = row[5] / m
        heat[i] = row[6] + row[11]
        for c in range(CHANNELS):
            row[c] = 0.0


@kernel
def accelerate(
    mass: Any,
    internal_force: Any,
    external_force: Any,
    velocity: Any,
    acceleration: Any,
    velocity_star: Any,
    gravity: Any,
    damping: float,
    least_mass: float,
    dt: float,
) -> None:
    """a_i = (f_int + f_ext) / m - damping v + g and v* = v + a dt; light nodes feel gravity only."""
    for i in range(mass.shape[0]):
        m = mass[i]
        for c in range(3):
            a = 0.0
            if m > least_mass:
                a = (internal_force[i, c] + external_force[i, c]) / m - damping * velocity[i, c]
            acceleration[i, c] = a + gravity[c]
            velocity_star[i, c] = velocity[i, c] + acceleration[i, c] * dt


@kernel
def rate_of_change(new: Any, old: Any, dt: float, rate: Any) -> None:
    """(new - old) / dt, entry by entry of (N, components) arrays."""
    for i in range(new.shape[0]):
        for c in range(new.shape[1]):
            rate[i, c] = (new[i, c] - old[i, c]) / dt


@kernel
def temperature_rate_of_heat(heat: Any, mass: Any, rate: Any) -> None:
    """Add heat / mass to the nodal temperature rate."""
    for i in range(mass.shape[0]):
        rate[i] += heat[i] / mass[i]


@kernel
def exchange_heat(mass: Any, temperature: Any, specific_heat: Any, dt: float, rate: Any) -> None:
    """Perfect thermal contact: every material moves to the common temperature of the node within the step."""
    for i in range(mass.shape[1]):
        energy, capacity = 0.0, 0.0
        for m in range(mass.shape[0]):
            energy += temperature[m, i] * mass[m, i] * specific_heat[m]
            capacity += mass[m, i] * specific_heat[m]
        for m in range(mass.shape[0]):
            rate[m, i] += (energy / capacity - temperature[m, i]) / dt


@kernel
def fastest_node(velocity: Any, inner: Any) -> float:
    """The largest |v|^2 over the nodes that ``inner`` marks."""
    largest = 0.0
    for i in range(velocity.shape[0]):
        if inner[i]:
            v2 = velocity[i, 0] ** 2 + velocity[i, 1] ** 2 + velocity[i, 2] ** 2
            largest = max(largest, v2)
    return largest


@kernel
def divide_by_mass(vectors: Any, mass: Any) -> None:
    """Divide the vectors that rows (N, ..) of nodes begin with by nodal mass (N,) in place."""
    for i in range(mass.shape[0]):
        for c in range(3):
            vectors[i, c] /= mass[i]


@kernel
def interleave(
    velocity_star: Any, temperature_star: Any, acceleration: Any, temperature_rate: Any, gathered: Any
) -> None:
    """Put what particles gather from a node side by side: rows (N, GATHERED)."""
    for i in range(gathered.shape[0]):
        for c in range(3):
            gathered[i, c] = velocity_star[i, c]
            gathered[i, 4 + c] = acceleration[i, c]
        gathered[i, 3] = temperature_star[i]
        gathered[i, 7] = temperature_rate[i]
