"""The loops over particles and nodes, compiled by numba and specialised for interpolator and material model.

Each reads like its equation in docs/architecture.md, "The step". Sums over the nodes i of a particle p use the
weights S_ip and gradients G_ip of ``shape_functions``.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from solver.boundary_conditions import GRADIENT, MIRROR, SET, ZERO_NORMAL, Operations
from solver.dispatch import inline
from solver.grid import GridIndex
from solver.interpolation.shape import MOST_NODES, particle_domain, shape_functions
from solver.jit import kernel
from solver.materials.constitutive import DELETE, Material, Point, Step, stress_update
from solver.materials.failure import Failure, restrained, weakened
from solver.nodal import EMPTY_MASS
from solver.particles import Particles
from solver.tensor import (
    Tensor,
    determinant,
    isotropic,
    norm,
    put_tensor,
    tensor_at,
)

CHANNELS = 13
"""Width of the array that particles scatter to, one row a node: mass, momentum (3), internal force (3), heat,
volume, mass times temperature, external force (3). Groups of four that are treated alike lie side by side, so
that one vector instruction serves each."""

EXTERNAL_FORCE = slice(10, 13)
"""The channels of external force."""

GATHERED = 8
"""Width of the array that particles gather from: v* (3), T*, acceleration (3), temperature rate."""


class Transfer(NamedTuple):
    """Options of a material's transfers between particles and grid."""

    axisymmetric: bool
    rigid: bool
    spread_loads: bool
    """Whether external forces go to the nodes with the particle's weights (False: by corners, CBDI)."""
    conductivity: float
    """Thermal conductivity over specific heat; 0 where heat does not flow."""
    specific_heat: float


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
def particles_to_grid(
    interpolator: Any, grid: GridIndex, particles: Particles, transfer: Transfer, sums: Any
) -> None:
    """Scatter mass, momentum, volume, forces and heat of a material's particles to ``sums`` (N, CHANNELS).

    Internal force: f_i = -sum_p V_p G_ip . (sigma_p - q_p I). Heat: sum_p (q_ext S_ip - k V_p G_ip . grad T) / c_v.
    """
    nodes = np.empty(MOST_NODES, np.uint64)
    weights = np.empty(MOST_NODES)
    gradients = np.empty((MOST_NODES, 3))
    sums[:] = 0.0
    for p in range(particles.mass.shape[0]):
        x, y, z = particles.position[p, 0], particles.position[p, 1], particles.position[p, 2]
        F, size = tensor_at(particles.deformation_gradient, p), tensor_at(particles.size, p)
        domain = particle_domain(interpolator, F, size)
        count = shape_functions(interpolator, grid, x, y, z, domain, nodes, weights, gradients)
        mass, volume = particles.mass[p], particles.volume[p]
        mx, my, mz = (
            mass * particles.velocity[p, 0],
            mass * particles.velocity[p, 1],
            mass * particles.velocity[p, 2],
        )
        thermal = mass * particles.temperature[p]
        pull = negative_pull(particles, p, transfer)
        heat = particles.external_heat_rate[p] / transfer.specific_heat
        flow = -transfer.conductivity * volume
        qx, qy, qz = (
            flow * particles.temperature_gradient[p, 0],
            flow * particles.temperature_gradient[p, 1],
            flow * particles.temperature_gradient[p, 2],
        )
        if transfer.axisymmetric:
            qz = 0.0
        bx, by, bz = (
            particles.external_force[p, 0],
            particles.external_force[p, 1],
            particles.external_force[p, 2],
        )
        if not transfer.spread_loads:
            bx = by = bz = 0.0
        for n in range(count):
            row, S = sums[nodes[n]], weights[n]
            gx, gy, gz = gradients[n, 0], gradients[n, 1], gradients[n, 2]
            row[0] += mass * S
            row[1] += mx * S
            row[2] += my * S
            row[3] += mz * S
            row[4] += gx * pull.xx + gy * pull.yx + gz * pull.zx
            row[5] += gx * pull.xy + gy * pull.yy + gz * pull.zy
            row[6] += gx * pull.xz + gy * pull.yz + gz * pull.zz
            row[7] += heat * S + gx * qx + gy * qy + gz * qz
            row[8] += volume * S
            row[9] += thermal * S
            row[10] += bx * S
            row[11] += by * S
            row[12] += bz * S


@inline
def negative_pull(particles: Particles, p: int, transfer: Transfer) -> Tensor:
    """-V (sigma - q I) of a particle, whose product with G is its internal force on a node.

    In axisymmetry the third component of G is S/r, which meets the hoop stress only.
    """
    if transfer.rigid:
        return isotropic(0.0)
    s = (tensor_at(particles.stress, p) - isotropic(particles.artificial_pressure[p])) * -particles.volume[p]
    if transfer.axisymmetric:
        return Tensor(s.xx, s.xy, 0.0, s.xy, s.yy, 0.0, s.zz, 0.0, 0.0)
    return s


@kernel
def add_gradients(interpolator: Any, grid: GridIndex, particles: Particles, sums: Any) -> None:
    """Gradient-enhanced projection: particles give nodes v_p - L (x_p - x_i) and T_p - grad T . (x_p - x_i).

    Adds to ``sums`` what :func:`particles_to_grid` left out.
    """
    nodes = np.empty(MOST_NODES, np.int64)
    weights = np.empty(MOST_NODES)
    gradients = np.empty((MOST_NODES, 3))
    layer = grid.nodes[0] * grid.nodes[1]
    for p in range(particles.mass.shape[0]):
        x, y, z = particles.position[p, 0], particles.position[p, 1], particles.position[p, 2]
        F, size = tensor_at(particles.deformation_gradient, p), tensor_at(particles.size, p)
        domain = particle_domain(interpolator, F, size)
        count = shape_functions(interpolator, grid, x, y, z, domain, nodes, weights, gradients)
        L, g = tensor_at(particles.velocity_gradient, p), particles.temperature_gradient[p]
        for n in range(count):
            row, mass = sums[nodes[n]], particles.mass[p] * weights[n]
            rx = x - (grid.anchor[0] + (nodes[n] % grid.nodes[0] + grid.first[0]) * grid.spacing[0])
            ry = y - (grid.anchor[1] + (nodes[n] % layer // grid.nodes[0] + grid.first[1]) * grid.spacing[1])
            rz = z - (grid.anchor[2] + (nodes[n] // layer + grid.first[2]) * grid.spacing[2])
            row[1] -= mass * (L.xx * rx + L.xy * ry + L.xz * rz)
            row[2] -= mass * (L.yx * rx + L.yy * ry + L.yz * rz)
            row[3] -= mass * (L.zx * rx + L.zy * ry + L.zz * rz)
            row[9] -= mass * (g[0] * rx + g[1] * ry + g[2] * rz)


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
    """Split the sums into nodal fields: v_i = momentum / mass, T_i = (mass T) / mass."""
    for i in range(mass.shape[0]):
        row = sums[i]
        m = EMPTY_MASS + row[0]
        mass[i] = m
        volume[i] = EMPTY_MASS + row[8]
        for c in range(3):
            velocity[i, c] = row[1 + c] / m
            internal_force[i, c] = row[4 + c]
            external_force[i, c] = row[10 + c]
        temperature[i] = row[9] / m
        heat[i] = row[7]


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
def smooth_velocity(
    interpolator: Any,
    grid: GridIndex,
    particles: Particles,
    velocity: Any,
    filtered: Any,
    smoothed: Any,
) -> None:
    """XPIC(2), Hammerquist and Nairn (2017): S v at the particles, then their momentum S+ S v back at the nodes.

    ``filtered`` (n, 3) gets sum_i S_ip v_i, ``smoothed`` (N, 3) sum_p S_ip m_p filtered_p.
    """
    nodes = np.empty(MOST_NODES, np.uint64)
    weights = np.empty(MOST_NODES)
    gradients = np.empty((MOST_NODES, 3))
    smoothed[:] = 0.0
    for p in range(particles.mass.shape[0]):
        domain = particle_domain(
            interpolator, tensor_at(particles.deformation_gradient, p), tensor_at(particles.size, p)
        )
        x, y, z = particles.position[p, 0], particles.position[p, 1], particles.position[p, 2]
        count = shape_functions(interpolator, grid, x, y, z, domain, nodes, weights, gradients)
        vx = vy = vz = 0.0
        for n in range(count):
            vx += velocity[nodes[n], 0] * weights[n]
            vy += velocity[nodes[n], 1] * weights[n]
            vz += velocity[nodes[n], 2] * weights[n]
        filtered[p, 0], filtered[p, 1], filtered[p, 2] = vx, vy, vz
        for n in range(count):
            mS = particles.mass[p] * weights[n]
            smoothed[nodes[n], 0] += mS * vx
            smoothed[nodes[n], 1] += mS * vy
            smoothed[nodes[n], 2] += mS * vz


@kernel
def divide_by_mass(vectors: Any, mass: Any) -> None:
    """Divide nodal vectors (N, 3) by nodal mass (N,) in place."""
    for i in range(mass.shape[0]):
        for c in range(3):
            vectors[i, c] /= mass[i]


class Motion(NamedTuple):
    """Sums over the particles of a material after they moved."""

    kinetic_energy: float
    thermal_energy: float
    momentum: tuple[float, float, float]
    mass_position: tuple[float, float, float]


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


@kernel
def grid_to_particles(
    interpolator: Any,
    grid: GridIndex,
    particles: Particles,
    transfer: Transfer,
    nodal: Any,
    filtered: Any,
    smoothed: Any,
    dt: float,
) -> Motion:
    """Move particles and gather the velocity gradient L_p = sum_i v*_i (x) G_ip.

    ``nodal`` holds rows as :func:`interleave` makes them. FLIP: x += dt sum S v*, v += dt sum S a. With XPIC(2)
    (``smoothed`` (N, 3) not empty, ``filtered`` (n, 3) the velocities S v): v = 2 S v - S S+ S v + dt a_p, and x
    moves by the mean of the velocities that this makes.
    """
    nodes = np.empty(MOST_NODES, np.uint64)
    weights = np.empty(MOST_NODES)
    gradients = np.empty((MOST_NODES, 3))
    xpic = smoothed.shape[0] > 0
    kinetic = thermal = 0.0
    px = py = pz = cx = cy = cz = 0.0
    for p in range(particles.mass.shape[0]):
        x, y, z = particles.position[p, 0], particles.position[p, 1], particles.position[p, 2]
        domain = particle_domain(
            interpolator, tensor_at(particles.deformation_gradient, p), tensor_at(particles.size, p)
        )
        count = shape_functions(interpolator, grid, x, y, z, domain, nodes, weights, gradients)
        vx = vy = vz = ts = ax = ay = az = rate = 0.0
        xx = yx = zx = tx = xy = yy = zy = ty = xz = yz = zz = tz = 0.0
        for n in range(count):
            row, S = nodal[nodes[n]], weights[n]
            gx, gy, gz = gradients[n, 0], gradients[n, 1], gradients[n, 2]
            ux, uy, uz, T = row[0], row[1], row[2], row[3]
            vx += ux * S
            vy += uy * S
            vz += uz * S
            ts += T * S
            xx += ux * gx
            yx += uy * gx
            zx += uz * gx
            tx += T * gx
            xy += ux * gy
            yy += uy * gy
            zy += uz * gy
            ty += T * gy
            xz += ux * gz
            yz += uy * gz
            zz += uz * gz
            tz += T * gz
            ax += row[4] * S
            ay += row[5] * S
            az += row[6] * S
            rate += row[7] * S
        L = Tensor(xx, xy, xz, yx, yy, yz, zx, zy, zz)
        if transfer.axisymmetric:
            L = Tensor(xx, xy, 0.0, yx, yy, 0.0, 0.0, 0.0, xz)
        put_tensor(particles.velocity_gradient, p, L)
        particles.temperature_gradient[p, 0] = tx
        particles.temperature_gradient[p, 1] = ty
        particles.temperature_gradient[p, 2] = tz
        particles.temperature_rate[p] = rate
        m = particles.mass[p]
        thermal += particles.temperature[p] * m * transfer.specific_heat
        moved, gained = (vx, vy, vz), (ax, ay, az)
        for c in range(3):
            v = particles.velocity[p, c]
            particles.old_velocity[p, c] = v
            step = moved[c] * dt
            particles.velocity[p, c] = v + gained[c] * dt
            if xpic:
                again = 0.0
                for n in range(count):
                    again += smoothed[nodes[n], c] * weights[n]
                twice = 2.0 * filtered[p, c]
                step -= 0.5 * (gained[c] * dt + (v - twice) + again) * dt
                particles.velocity[p, c] = twice - again + gained[c] * dt
            particles.position[p, c] += step
            particles.displacement[p, c] += step
        ux, uy, uz = particles.velocity[p, 0], particles.velocity[p, 1], particles.velocity[p, 2]
        kinetic += 0.5 * m * (ux * ux + uy * uy + uz * uz)
        px += m * ux
        py += m * uy
        pz += m * uz
        cx += m * particles.position[p, 0]
        cy += m * particles.position[p, 1]
        cz += m * particles.position[p, 2]
    return Motion(kinetic, thermal, (px, py, pz), (cx, cy, cz))


class Kinematics(NamedTuple):
    """How deformation gradients follow velocity gradients."""

    subcycles: int
    """n > 0: at least n steps of F <- (I + L dt/n) F; n <= 0: |n| terms of exp(L dt)."""
    stabilize_pressure: bool


@inline
def new_deformation_gradient(F: Tensor, L: Tensor, dt: float, subcycles: int) -> Tensor:
    """F at the end of the step from the velocity gradient L."""
    if subcycles > 0:
        n = min(max(subcycles, 2 * int(norm(L) * dt)), 10000)
        increment = isotropic(1.0) + L * (dt / n)
        for _ in range(n):
            F = increment @ F
        return F
    series = isotropic(1.0)
    term = isotropic(1.0)
    for k in range(1, abs(subcycles) + 1):
        term = (term @ L) * (dt / k)
        series = series + term
    return series @ F


@kernel
def cell_dilatation(
    particles: Particles, cells: Any, kinematics: Kinematics, dt: float, volume: Any, reference_volume: Any
) -> None:
    """Sums of new volume V and of V / det F over the particles of each cell, for pressure stabilization."""
    volume[:] = 0.0
    reference_volume[:] = 0.0
    for p in range(particles.mass.shape[0]):
        F_old = tensor_at(particles.deformation_gradient, p)
        F = new_deformation_gradient(
            F_old, tensor_at(particles.velocity_gradient, p), dt, kinematics.subcycles
        )
        J = determinant(F)
        v = particles.volume[p] * J / determinant(F_old)
        volume[cells[p]] += v
        reference_volume[cells[p]] += v / J


class Stressed(NamedTuple):
    """Sums and extremes over the particles of a material after the stress update."""

    strain_energy: float
    volume: float
    wave_speed: tuple[float, float, float]
    """Per direction the largest of sound speed plus particle speed."""
    finite: bool
    """Whether every stress and position is a finite number."""


@kernel
def update_stresses(
    model: Any,
    state: Any,
    failure: Failure,
    particles: Particles,
    material: Material,
    step: Step,
    kinematics: Kinematics,
    cells: Any,
    cell_stretch: Any,
) -> Stressed:
    """Deformation gradients, volumes, stresses and temperatures at the end of the step.

    ``cell_stretch`` holds det F averaged over each cell, used where pressure is stabilized.
    """
    dt = step.dt
    energy = total_volume = 0.0
    wx = wy = wz = 1.0e-12
    finite = True
    for p in range(particles.mass.shape[0]):
        F_old = tensor_at(particles.deformation_gradient, p)
        L = tensor_at(particles.velocity_gradient, p)
        F = new_deformation_gradient(F_old, L, dt, kinematics.subcycles)
        J, J_old = determinant(F), determinant(F_old)
        volume_old = particles.volume[p]
        volume = volume_old * J / J_old
        if kinematics.stabilize_pressure:
            J_cell = cell_stretch[cells[p]]
            F = F * (J_cell / J) ** (1.0 / 3.0)
            L = L + isotropic(math.log(J_cell / J) / (3.0 * dt))
            put_tensor(particles.velocity_gradient, p, L)
        point = Point(
            tensor_at(particles.stress, p),
            F_old,
            F,
            L,
            volume_old,
            volume,
            particles.mass[p],
            particles.temperature[p],
            particles.previous_temperature[p],
            particles.localized[p],
        )
        point = restrained(failure, point)
        new = stress_update(model, state, p, point, material, step)
        new = weakened(failure, model, state, p, point, new, material, step)
        put_tensor(particles.deformation_gradient, p, point.deformation_gradient)
        put_tensor(particles.stress, p, new.stress)
        particles.volume[p] = volume
        particles.artificial_pressure[p] = new.artificial_pressure
        particles.heating_rate[p] = new.heating_rate
        particles.localized[p] = new.localized
        temperature = particles.temperature[p]
        particles.previous_temperature[p] = temperature
        particles.temperature[p] = temperature + particles.temperature_rate[p] * dt + new.heating_rate * dt
        energy += new.strain_energy
        total_volume += volume
        c = new.sound_speed
        wx = max(wx, c + abs(particles.old_velocity[p, 0]))
        wy = max(wy, c + abs(particles.old_velocity[p, 1]))
        wz = max(wz, c + abs(particles.old_velocity[p, 2]))
        x, y, z = particles.position[p, 0], particles.position[p, 1], particles.position[p, 2]
        if not math.isfinite(norm(new.stress) + c + x + y + z):
            finite = False
    return Stressed(energy, total_volume, (wx, wy, wz), finite)


@kernel
def settle(
    particles: Particles,
    grid: GridIndex,
    cells: tuple[int, int, int],
    periodic: tuple[int, int, int],
    owned: Any,
    least_mass: float,
    kept: Any,
) -> int:
    """Wrap periodic positions and mark in ``kept`` the particles that stay; return how many do not.

    A particle goes when it left every patch (``owned`` marks their cells, x fastest), failed for good, became
    too light or colder than absolute zero.
    """
    lost = 0
    for p in range(particles.mass.shape[0]):
        cell, stride, inside = 0, 1, True
        for c in range(3):
            q = (particles.position[p, c] - grid.anchor[c]) / grid.spacing[c]
            if periodic[c] and (q < 0.0 or q >= cells[c]):
                wraps = math.floor(q / cells[c])
                particles.position[p, c] -= wraps * cells[c] * grid.spacing[c]
                q -= wraps * cells[c]
                if q >= cells[c]:  # a rounding error below the lower face
                    particles.position[p, c] = grid.anchor[c]
                    q = 0.0
            i = math.floor(q)
            if i < 0 or i >= cells[c]:
                inside = False
            cell += i * stride
            stride *= cells[c]
        good = (
            inside
            and owned[cell]
            and particles.localized[p] != DELETE
            and particles.mass[p] > least_mass
            and particles.temperature[p] >= 0.0
        )
        kept[p] = good
        if not good:
            lost += 1
    return lost


@kernel
def initial_wave_speed(velocity: Any, sound_speed: Any) -> tuple[float, float, float]:
    """Per direction the largest of sound speed plus particle speed at the start."""
    wx = wy = wz = 1.0e-12
    for p in range(sound_speed.shape[0]):
        wx = max(wx, sound_speed[p] + abs(velocity[p, 0]))
        wy = max(wy, sound_speed[p] + abs(velocity[p, 1]))
        wz = max(wz, sound_speed[p] + abs(velocity[p, 2]))
    return wx, wy, wz
