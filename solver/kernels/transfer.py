"""The loops over particles that exchange mass, momentum, forces and heat with the nodes."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from solver.dispatch import inline
from solver.grid import GridIndex, NodeBlock
from solver.interpolation.shape import (
    MOST_NODES,
    Content,
    Gathered,
    Sums,
    gather,
    is_near,
    new_room,
    nothing,
    particle_domain,
    prepare,
    scatter,
    shape_functions,
)
from solver.jit import kernel
from solver.kernels.chunks import CHUNK
from solver.lanes import WIDTH, Lanes
from solver.particles import Particles
from solver.scratch import scratch_numbers, scratch_rows
from solver.tensor import Tensor, isotropic, put_tensor, tensor_at

CHANNELS = 16
"""Width of the array that particles scatter to, one row a node: mass, momentum (3), volume, mass times temperature,
external heat, nothing; internal force (3), conducted heat, external force (3), nothing. Rows are two
:class:`solver.lanes.Lanes`: the first takes weights only, the second gradients too."""

EXTERNAL_FORCE = slice(12, 15)
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
def particles_to_grid(
    interpolator: Any,
    grid: GridIndex,
    block: NodeBlock,
    particles: Particles,
    transfer: Transfer,
    sums: Sums,
) -> None:
    """Add mass, momentum, volume, forces and heat of a material's particles to ``sums``, rows of CHANNELS.

    Internal force: f_i = -sum_p V_p G_ip . (sigma_p - q_p I). Heat: sum_p (q_ext S_ip - k V_p G_ip . grad T) / c_v.
    Only nodes in ``block`` are touched, and particles in their order: the sums are the same however the nodes are
    divided into blocks.
    """
    room = new_room()
    for start in range(0, particles.mass.shape[0], WIDTH):
        if not prepare(interpolator, grid, block, particles, start, room):
            continue
        for lane in range(min(WIDTH, particles.mass.shape[0] - start)):
            p = start + lane
            if is_near(interpolator, grid, block, particles, p, lane, room):
                content = carried(particles, p, transfer)
                scatter(interpolator, grid, block, particles, p, lane, content, sums, room)


@inline
def carried(particles: Particles, p: int, transfer: Transfer) -> Content:
    """What a particle brings to its nodes, in the channels of ``sums``."""
    mass, volume, v = particles.mass[p], particles.volume[p], particles.velocity[p]
    s = negative_pull(particles, p, transfer)
    flow = -transfer.conductivity * volume
    grad_T, b = particles.temperature_gradient[p], particles.external_force[p]
    loaded = 1.0 if transfer.spread_loads else 0.0
    around = 0.0 if transfer.axisymmetric else flow * grad_T[2]
    return Content(
        Lanes(
            mass,
            mass * v[0],
            mass * v[1],
            mass * v[2],
            volume,
            mass * particles.temperature[p],
            particles.external_heat_rate[p] / transfer.specific_heat,
            0.0,
        ),
        Lanes(0.0, 0.0, 0.0, 0.0, loaded * b[0], loaded * b[1], loaded * b[2], 0.0),
        Lanes(s.xx, s.xy, s.xz, flow * grad_T[0], 0.0, 0.0, 0.0, 0.0),
        Lanes(s.yx, s.yy, s.yz, flow * grad_T[1], 0.0, 0.0, 0.0, 0.0),
        Lanes(s.zx, s.zy, s.zz, around, 0.0, 0.0, 0.0, 0.0),
    )


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
    nodes = scratch_numbers(MOST_NODES, np.int64)
    weights = scratch_numbers(MOST_NODES, np.float64)
    gradients = scratch_rows(MOST_NODES, 3)
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
            row[5] -= mass * (g[0] * rx + g[1] * ry + g[2] * rz)


@kernel
def smooth_velocity(
    interpolator: Any,
    grid: GridIndex,
    particles: Particles,
    rows: Any,
    filtered: Any,
    smoothed: Sums,
) -> None:
    """XPIC(2), Hammerquist and Nairn (2017): S v at the particles, then their momentum S+ S v back at the nodes.

    ``rows`` (N, GATHERED) begin with the nodal velocity v, ``filtered`` (n, 3) gets sum_i S_ip v_i, ``smoothed``
    sum_p S_ip m_p filtered_p at the beginning of its rows.
    """
    room = new_room()
    everywhere = NodeBlock((0, 0, 0), grid.nodes, True)
    for start in range(0, particles.mass.shape[0], WIDTH):
        prepare(interpolator, grid, everywhere, particles, start, room)
        for lane in range(min(WIDTH, particles.mass.shape[0] - start)):
            p = start + lane
            v = gather(interpolator, grid, particles, p, lane, rows, room).value
            filtered[p, 0], filtered[p, 1], filtered[p, 2] = v[0], v[1], v[2]
            momentum = v * particles.mass[p]
            content = Content(momentum, nothing(), nothing(), nothing(), nothing())
            scatter(interpolator, grid, everywhere, particles, p, lane, content, smoothed, room)


class Motion(NamedTuple):
    """Sums over the particles of a material after they moved."""

    kinetic_energy: float
    thermal_energy: float
    momentum: tuple[float, float, float]
    mass_position: tuple[float, float, float]


MOTION_SUMS = 8
"""Numbers in a :class:`Motion`."""


def total(sums: Any) -> Motion:
    """The sums of all chunks (chunks, MOTION_SUMS) together."""
    kinetic, thermal, px, py, pz, cx, cy, cz = sums.sum(axis=0).tolist()
    return Motion(kinetic, thermal, (px, py, pz), (cx, cy, cz))


@kernel
def grid_to_particles(
    interpolator: Any,
    grid: GridIndex,
    particles: Particles,
    transfer: Transfer,
    nodal: Any,
    xpic: bool,
    filtered: Any,
    smoothed: Any,
    dt: float,
    first: int,
    last: int,
    sums: Any,
) -> None:
    """Move particles and gather the velocity gradient L_p = sum_i v*_i (x) G_ip.

    ``nodal`` holds rows as ``interleave`` makes them. FLIP: x += dt sum S v*, v += dt sum S a. With XPIC(2), where
    ``filtered`` (n, 3) has the velocities S v and ``smoothed`` (N, CHANNELS) S+ S v first in its rows:
    v = 2 S v - S S+ S v + dt a_p, and x moves by the mean of the velocities that this makes.
    Does the chunks ``first`` to ``last`` of particles and stores in ``sums`` (chunks, MOTION_SUMS) each one's
    :class:`Motion`, number by number.
    """
    room = new_room()
    everywhere = NodeBlock((0, 0, 0), grid.nodes, True)
    for chunk in range(first, last):
        kinetic = thermal = 0.0
        px = py = pz = cx = cy = cz = 0.0
        end = min((chunk + 1) * CHUNK, particles.mass.shape[0])
        for start in range(chunk * CHUNK, end, WIDTH):
            prepare(interpolator, grid, everywhere, particles, start, room)
            for lane in range(min(WIDTH, end - start)):
                p = start + lane
                at = gather(interpolator, grid, particles, p, lane, nodal, room)
                put_gradients(particles, p, at, transfer)
                again = nothing()
                if xpic:
                    again = gather(interpolator, grid, particles, p, lane, smoothed, room).value
                move(particles, p, at.value, xpic, filtered, again, dt)
                m, x, u = particles.mass[p], particles.position[p], particles.velocity[p]
                thermal += particles.temperature[p] * m * transfer.specific_heat
                kinetic += 0.5 * m * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2])
                px += m * u[0]
                py += m * u[1]
                pz += m * u[2]
                cx += m * x[0]
                cy += m * x[1]
                cz += m * x[2]
        row = sums[chunk]
        row[0], row[1] = kinetic, thermal
        row[2], row[3], row[4] = px, py, pz
        row[5], row[6], row[7] = cx, cy, cz


@inline
def put_gradients(particles: Particles, p: int, at: Gathered, transfer: Transfer) -> None:
    """Store the gradients of velocity and temperature and the temperature's rate at a particle."""
    dx, dy, dz = at.by_x, at.by_y, at.by_z
    L = Tensor(dx[0], dy[0], dz[0], dx[1], dy[1], dz[1], dx[2], dy[2], dz[2])
    if transfer.axisymmetric:
        L = Tensor(dx[0], dy[0], 0.0, dx[1], dy[1], 0.0, 0.0, 0.0, dz[0])
    put_tensor(particles.velocity_gradient, p, L)
    particles.temperature_gradient[p, 0] = dx[3]
    particles.temperature_gradient[p, 1] = dy[3]
    particles.temperature_gradient[p, 2] = dz[3]
    particles.temperature_rate[p] = at.value[7]


@inline
def move(
    particles: Particles, p: int, nodal: Lanes, xpic: bool, filtered: Any, again: Lanes, dt: float
) -> None:
    """New velocity and position of a particle from the velocity and acceleration of the nodes."""
    move_along(particles, p, 0, nodal[0], nodal[4], xpic, filtered, again[0], dt)
    move_along(particles, p, 1, nodal[1], nodal[5], xpic, filtered, again[1], dt)
    move_along(particles, p, 2, nodal[2], nodal[6], xpic, filtered, again[2], dt)


@inline
def move_along(
    particles: Particles,
    p: int,
    axis: int,
    velocity: float,
    acceleration: float,
    xpic: bool,
    filtered: Any,
    again: float,
    dt: float,
) -> None:
    """:func:`move` in one direction."""
    v, gained, step = particles.velocity[p, axis], acceleration * dt, velocity * dt
    particles.old_velocity[p, axis] = v
    particles.velocity[p, axis] = v + gained
    if xpic:
        twice = 2.0 * filtered[p, axis]
        step -= 0.5 * (gained + (v - twice) + again) * dt
        particles.velocity[p, axis] = twice - again + gained
    particles.position[p, axis] += step
    particles.displacement[p, axis] += step
