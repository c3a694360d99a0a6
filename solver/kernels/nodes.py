"""The loops over nodes.

``active`` lists the nodes that particles of a material touch in this step, ``fields`` holds the nodal fields of that
material alone, (N, ...). All other nodes keep the values of empty ones.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from solver.boundary_conditions import GRADIENT, MIRROR, SET, ZERO_NORMAL, Operations
from solver.dispatch import inline
from solver.jit import kernel
from solver.kernels.chunks import CHUNK
from solver.kernels.transfer import CHANNELS
from solver.nodal import EMPTY_MASS, NodalFields


@kernel
def apply_operations(operations: Operations, touched: Any, field: Any) -> None:
    """Apply boundary operations to nodal values (N, components) in order; at touched nodes, or with no mask at all."""
    everywhere = touched.shape[0] == 0
    for o in range(operations.kind.shape[0]):
        kind, axis, value = operations.kind[o], operations.axis[o], operations.value[o]
        for e in range(operations.start[o], operations.start[o + 1]):
            node, source = operations.node[e], operations.source[e]
            if everywhere or touched[node]:
                apply_operation(kind, axis, value, field[node], field[source])


@inline
def apply_operation(kind: int, axis: int, value: Any, at: Any, there: Any) -> None:
    """Apply an operation to the values of a node, given those of its source."""
    if kind == ZERO_NORMAL:
        at[axis] = 0.0
    elif kind == SET:
        for c in range(at.shape[0]):
            at[c] = value[c]
    elif kind == MIRROR:
        for c in range(at.shape[0]):
            at[c] = -there[c] if c == axis else there[c]
    elif kind == GRADIENT:
        for c in range(at.shape[0]):
            at[c] = there[c] - value[c]


@kernel
def fold_images(rows: Any, touched: Any, owner: Any, image: Any) -> None:
    """Periodic directions: add the rows of image nodes to their owners, then copy the totals back."""
    for e in range(owner.shape[0]):
        if touched[image[e]]:
            touched[owner[e]] = 1
            for c in range(rows.shape[1]):
                rows[owner[e], c] += rows[image[e], c]
    for e in range(owner.shape[0]):
        if touched[owner[e]]:
            touched[image[e]] = 1
            for c in range(rows.shape[1]):
                rows[image[e], c] = rows[owner[e], c]


@kernel
def copy_to_images(field: Any, touched: Any, owner: Any, image: Any) -> None:
    """Periodic directions: give image nodes the values (N, components) of their owners."""
    for e in range(owner.shape[0]):
        if touched[image[e]]:
            for c in range(field.shape[1]):
                field[image[e], c] = field[owner[e], c]


@kernel
def list_touched(touched: Any, words: Any, active: Any) -> int:
    """Write the nodes that are touched to ``active`` (N,), in order, and return how many there are.

    ``words`` is ``touched`` seen as numbers of eight bytes, most of which are 0.
    """
    count = 0
    for w in range(words.shape[0]):
        if words[w] != 0:
            for i in range(8 * w, min(8 * w + 8, active.shape[0])):
                if touched[i]:
                    active[count] = i
                    count += 1
    return count


@kernel
def untouch(active: Any, touched: Any) -> None:
    """Count nodes that were active as not touched."""
    for n in range(active.shape[0]):
        touched[active[n]] = 0


@kernel
def forget(active: Any, touched: Any, fields: NodalFields) -> None:
    """Give nodes that were active and are no longer touched the values of empty ones."""
    for n in range(active.shape[0]):
        i = active[n]
        if touched[i]:
            continue
        fields.mass[i] = fields.volume[i] = EMPTY_MASS
        fields.temperature[i] = fields.temperature_rate[i] = fields.heat[i] = 0.0
        for c in range(3):
            fields.velocity[i, c] = fields.velocity_star[i, c] = fields.acceleration[i, c] = 0.0
            fields.internal_force[i, c] = fields.external_force[i, c] = 0.0


@kernel
def forget_motion(active: Any, touched: Any, nodal: NodalFields) -> None:
    """Stop materials at nodes that were active for one and that they do not touch: contact moves them there too."""
    for m in range(nodal.mass.shape[0]):
        for n in range(active.shape[0]):
            i = active[n]
            if not touched[m, i]:
                for c in range(3):
                    nodal.velocity[m, i, c] = nodal.velocity_star[m, i, c] = nodal.acceleration[m, i, c] = 0.0


@kernel
def normalise(active: Any, rows: Any, fields: NodalFields, projected_temperature: Any) -> None:
    """Split sums into nodal fields, v_i = momentum / mass and T_i = (mass T) / mass, and leave zeros behind.

    ``projected_temperature`` (N,) keeps T_i from before conditions act on it.
    """
    for n in range(active.shape[0]):
        i = active[n]
        row = rows[i]
        m = EMPTY_MASS + row[0]
        fields.mass[i] = m
        fields.volume[i] = EMPTY_MASS + row[4]
        for c in range(3):
            fields.velocity[i, c] = row[1 + c] / m
            fields.internal_force[i, c] = row[8 + c]
            fields.external_force[i, c] = row[12 + c]
        fields.temperature[i] = projected_temperature[i] = row[5] / m
        fields.temperature_rate[i] = 0.0
        fields.heat[i] = row[6] + row[11]
        for c in range(CHANNELS):
            row[c] = 0.0


class Motion(NamedTuple):
    """What acts on nodes apart from the forces of particles."""

    gravity: tuple[float, float, float]
    damping: float
    least_mass: float
    """Nodes no heavier than that feel gravity only."""


@kernel
def accelerate(
    active: Any,
    fields: NodalFields,
    motion: Motion,
    dt: float,
    is_image: Any,
    first: int,
    last: int,
    sums: Any,
) -> None:
    """a_i = (f_int + f_ext) / m - damping v + g and v* = v + a dt.

    Does the chunks ``first`` to ``last`` of active nodes and stores in the rows of ``sums`` each one's sums of mass
    and of the three components of external force over nodes that are no periodic images.
    """
    for chunk in range(first, last):
        mass = x = y = z = 0.0
        for n in range(chunk * CHUNK, min((chunk + 1) * CHUNK, active.shape[0])):
            i = active[n]
            m = fields.mass[i]
            for c in range(3):
                a, v = 0.0, fields.velocity[i, c]
                if m > motion.least_mass:
                    force = fields.internal_force[i, c] + fields.external_force[i, c]
                    a = force / m - motion.damping * v
                fields.acceleration[i, c] = a + motion.gravity[c]
                fields.velocity_star[i, c] = v + fields.acceleration[i, c] * dt
            if not is_image[i]:
                mass += m
                x += fields.external_force[i, 0]
                y += fields.external_force[i, 1]
                z += fields.external_force[i, 2]
        row = sums[chunk]
        row[0], row[1], row[2], row[3] = mass, x, y, z


@kernel
def rate_of_change(active: Any, new: Any, old: Any, dt: float, rate: Any) -> None:
    """(new - old) / dt of values (N, components) of the active nodes."""
    for n in range(active.shape[0]):
        i = active[n]
        for c in range(new.shape[1]):
            rate[i, c] = (new[i, c] - old[i, c]) / dt


@kernel
def rate_of_numbers(active: Any, new: Any, old: Any, dt: float, rate: Any) -> None:
    """(new - old) / dt of values (N,) of the active nodes."""
    for n in range(active.shape[0]):
        i = active[n]
        rate[i] = (new[i] - old[i]) / dt


@kernel
def warm_up(active: Any, fields: NodalFields, dt: float, star: Any) -> None:
    """Add heat / mass to the rate of temperature and take it for a step: T* = T + rate dt."""
    for n in range(active.shape[0]):
        i = active[n]
        fields.temperature_rate[i] += fields.heat[i] / fields.mass[i]
        star[i] = fields.temperature[i] + fields.temperature_rate[i] * dt


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
def fastest_node(active: Any, velocity: Any, inner: Any) -> float:
    """The largest |v|^2 over the active nodes that ``inner`` marks."""
    largest = 0.0
    for n in range(active.shape[0]):
        i = active[n]
        if inner[i]:
            v2 = velocity[i, 0] ** 2 + velocity[i, 1] ** 2 + velocity[i, 2] ** 2
            largest = max(largest, v2)
    return largest


@kernel
def divide_by_mass(active: Any, rows: Any, mass: Any) -> None:
    """Divide the vectors that the rows (N, ..) of active nodes begin with by nodal mass (N,) in place."""
    for n in range(active.shape[0]):
        i = active[n]
        for c in range(3):
            rows[i, c] /= mass[i]


@kernel
def clear(active: Any, rows: Any) -> None:
    """Make the rows (N, ..) of active nodes zero."""
    for n in range(active.shape[0]):
        for c in range(rows.shape[1]):
            rows[active[n], c] = 0.0


@kernel
def interleave(active: Any, fields: NodalFields, temperature_star: Any, gathered: Any) -> None:
    """Put what particles gather from a node side by side: rows (N, GATHERED)."""
    for n in range(active.shape[0]):
        i = active[n]
        for c in range(3):
            gathered[i, c] = fields.velocity_star[i, c]
            gathered[i, 4 + c] = fields.acceleration[i, c]
        gathered[i, 3] = temperature_star[i]
        gathered[i, 7] = fields.temperature_rate[i]
