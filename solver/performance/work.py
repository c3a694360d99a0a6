"""A model of the work of a step: the bytes that each phase has to move, and the operations that it has to make.

Bytes: every array that a phase needs is read, and every array that it changes is written, once a step; rows of nodes
that neighbouring particles share stay in the caches. Arrays that a phase changes without looking at them are not read.

Operations: what the equations ask for, whatever the kernels do besides (lanes that stay empty, weights that two
phases both compute). Those of the stress are counted by running the kernel's Python with numbers that count, on
a sample of the particles in the state in which they are.

Contact, loads and output depend on the deck in too many ways; the model says nothing of them.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.interpolation.shape import MOST_NODES, particle_domain, shape_functions
from solver.interpolation.stencil import direction
from solver.kernels.stress import STRESS_SUMS, Kinematics, StressLoop, update_singly
from solver.kernels.transfer import CHANNELS, GATHERED
from solver.nodal import EMPTY_MASS
from solver.particles import Particles
from solver.performance.memory import bytes_of
from solver.performance.operations import operations_of
from solver.performance.phases import Phase
from solver.tensor import tensor_at

if TYPE_CHECKING:
    from solver.body import Body
    from solver.simulation import Simulation

SAMPLE = 32
"""Particles of a body on which operations are counted."""

DOUBLE = 8


class Access(NamedTuple):
    """The fields of ``Particles`` that a phase needs, and those that it changes."""

    read: frozenset[str]
    written: frozenset[str]


def _access(read: str, written: str = "") -> Access:
    return Access(frozenset(read.split()), frozenset(written.split()))


ACCESS = {
    Phase.TO_GRID: _access(
        read="position mass volume velocity stress temperature artificial_pressure temperature_gradient "
        "external_force external_heat_rate"
    ),
    Phase.TO_PARTICLES: _access(
        read="position velocity displacement mass temperature",
        written="position velocity displacement old_velocity velocity_gradient temperature_gradient "
        "temperature_rate",
    ),
    Phase.STRESS: _access(
        read="position deformation_gradient velocity_gradient stress volume mass temperature "
        "previous_temperature temperature_rate localized old_velocity",
        written="deformation_gradient stress volume temperature previous_temperature heating_rate "
        "artificial_pressure localized",
    ),
    Phase.SETTLE: _access(read="position mass temperature localized"),
}
"""What each phase does with particles; transfers also read what the interpolator's domains need."""

NODE_READ_AND_WRITTEN = 20 + 2 * CHANNELS + 13 + 10 + 6 + 4 + 6 + 3 + 8 + GATHERED
"""Numbers an active node that the grid phase moves: 20 forgotten; the sums read and cleared, 13 nodal values made of
them; 10 read and 6 written by the acceleration; mass and external force read for their totals; 6 read and 3 written
for the rate of change; 8 read and put side by side in a row."""

NODE_HEAT = 12
"""More of them where heat is conducted."""

NODE_OPERATIONS = 5 + 21 + 6 + 4
"""Operations an active node: 5 quotients by mass and the mass's floor, 7 for each component of acceleration and v*,
2 for each of the rate of change, 4 additions to the totals."""

WEIGHT_OPERATIONS_A_NODE = 5
"""Of a product of three weights and its derivatives: four products, and what nodes of a row share."""

WEIGHT_OPERATIONS_A_DIRECTION = 25
"""Of the weights in one direction and their derivatives, about, for the interpolators that have such."""

TO_GRID_OPERATIONS_A_NODE = 2 * (1 + 3 + 1 + 1 + 1) + 3 * 6 + 2 * 3
"""Multiplications and additions: mass, momentum, volume, mass T, heat; V sigma . G; external force."""

TO_PARTICLES_OPERATIONS_A_NODE = 2 * 8 + 3 * 2 * 4
"""Multiplications and additions: v*, a, T* and its rate times S; v* and T* times G."""

CONTENT_OPERATIONS, MOTION_OPERATIONS = 21, 36
"""What a particle carries to the grid; its new position and velocity, and what it adds to momentum and energy."""


class Work(NamedTuple):
    """What a phase moves and computes in a step, all bodies together."""

    bytes: float
    operations: float | None
    """None where they cannot be counted."""


class Weights(NamedTuple):
    """The nodes of a particle, and the operations that make their weights; means of a sample."""

    nodes: float
    operations: float


def work_of_step(simulation: Simulation) -> dict[Phase, Work]:
    """The work of the phases of a step that starts from the state in which the simulation is."""
    bodies = [body for body in simulation.bodies if len(body.particles)]
    weights = [weights_of(simulation, body) for body in bodies]
    domain = domain_fields(simulation.interpolator)
    nodes = active_nodes(simulation)
    rows = DOUBLE * nodes
    heat = simulation.flags.explicit_heat_conduction
    counts = [len(body.particles) for body in bodies]
    to_grid = sum(
        n * (CONTENT_OPERATIONS + w.operations + w.nodes * (TO_GRID_OPERATIONS_A_NODE + 6 * heat))
        for n, w in zip(counts, weights, strict=True)
    )
    to_particles = sum(
        n * (MOTION_OPERATIONS + w.operations + w.nodes * TO_PARTICLES_OPERATIONS_A_NODE)
        for n, w in zip(counts, weights, strict=True)
    )
    return {
        Phase.TO_GRID: Work(_moved(bodies, Phase.TO_GRID, domain) + 2 * CHANNELS * rows, to_grid),
        Phase.GRID: Work(rows * (NODE_READ_AND_WRITTEN + NODE_HEAT * heat), nodes * NODE_OPERATIONS),
        Phase.TO_PARTICLES: Work(_moved(bodies, Phase.TO_PARTICLES, domain) + GATHERED * rows, to_particles),
        Phase.STRESS: Work(
            _moved(bodies, Phase.STRESS) + sum(2 * bytes_of(_state_of(body)) for body in bodies),
            _sum(stress_operations(simulation, body) for body in bodies),
        ),
        Phase.SETTLE: Work(_moved(bodies, Phase.SETTLE) + sum(counts), 6.0 * sum(counts)),
    }


def active_nodes(simulation: Simulation) -> int:
    """The nodes that particles touched in the last step, counted for each body."""
    return int(np.count_nonzero(simulation.nodal.mass > EMPTY_MASS))


def _moved(bodies: Iterable[Body], phase: Phase, domain: frozenset[str] = frozenset()) -> int:
    """Bytes of the particles' arrays that a phase reads and writes."""
    access = ACCESS[phase]
    total = 0
    for body in bodies:
        for fields in (access.read | domain, access.written):
            total += sum(getattr(body.particles, name).nbytes for name in fields)
    return total


def _state_of(body: Body) -> tuple[Any, ...]:
    """The records that the stress update of a body reads and writes beside its particles."""
    return body.state, body.failure.damage_state, body.failure.erosion_state


def _sum(numbers: Iterable[float | None]) -> float | None:
    total = 0.0
    for number in numbers:
        if number is None:
            return None
        total += number
    return total


def domain_fields(interpolator: Any) -> frozenset[str]:
    """The fields of particles that give the domains of an interpolator: initial vectors, and F if it deforms them."""
    one, two = tensor_at(np.eye(3)[None], 0), tensor_at(2.0 * np.eye(3)[None], 0)
    deforms = particle_domain(interpolator, one, one).xx != particle_domain(interpolator, two, one).xx
    return frozenset({"size", "deformation_gradient"} if deforms else {"size"})


def sample(count: int) -> NDArray[np.int64]:
    """Indices of up to :data:`SAMPLE` particles, evenly spread over ``count``."""
    return np.unique(np.linspace(0, count - 1, min(count, SAMPLE)).astype(np.int64))


def weights_of(simulation: Simulation, body: Body) -> Weights:
    """How many nodes a particle of a body touches, and how many operations its weights take."""
    chosen = sample(len(body.particles))
    particles = Particles(*(array[chosen] for array in body.particles))
    interpolator, grid = simulation.interpolator, simulation.grid.index
    nodes, weights, gradients = (
        np.zeros(MOST_NODES, np.int64),
        np.zeros(MOST_NODES),
        np.zeros((MOST_NODES, 3)),
    )
    touched = 0

    def all_weights(particles: Particles, nodes: Any, weights: Any, gradients: Any) -> None:
        nonlocal touched
        for p in range(len(chosen)):
            x, y, z = particles.position[p]
            F, size = tensor_at(particles.deformation_gradient, p), tensor_at(particles.size, p)
            domain = particle_domain(interpolator, F, size)
            touched += shape_functions(interpolator, grid, x, y, z, domain, nodes, weights, gradients)

    operations = operations_of(all_weights, particles, nodes, weights, gradients) / len(chosen)
    touched_each = touched / len(chosen)
    if type(interpolator) in direction.implementations:  # type: ignore[attr-defined]  # set by generic
        # Eight particles at once, which numbers that count do not follow.
        operations = WEIGHT_OPERATIONS_A_NODE * touched_each + 3 * WEIGHT_OPERATIONS_A_DIRECTION
    return Weights(touched_each, operations)


def stress_operations(simulation: Simulation, body: Body) -> float | None:
    """The operations of the stress updates of a body's particles, from a sample of them.

    None where a number of the sample cannot be computed in Python, such as the logarithm of a rate of zero.
    """
    if not len(body.particles):
        return 0.0
    chosen = sample(len(body.particles))

    def of_sample(record: Any) -> Any:
        return type(record)(*(array[chosen] if len(array) else array for array in record))

    state, damage, erosion = (of_sample(record) for record in _state_of(body))
    failure = body.failure._replace(damage_state=damage, erosion_state=erosion)
    try:
        operations = operations_of(
            update_singly.py_func,  # type: ignore[attr-defined]  # numba keeps the function as it was written
            StressLoop(
                body.model,
                state,
                failure,
                of_sample(body.particles),
                body.material,
                simulation.constants_of_step(simulation.initial_limit(body)),
                Kinematics(simulation.flags.minimum_subcycles_for_F, False),
                np.zeros(0, np.int64),
                np.zeros(0),
            ),
            0,
            1,
            np.zeros((1, STRESS_SUMS)),
        )
    except (ArithmeticError, ValueError):
        return None
    return operations / len(chosen) * len(body.particles)
