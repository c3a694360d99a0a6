"""A step makes no new arrays as long as the particles or the nodes: those it needs live as long as the simulation."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from mpm_cases import elastic, fill, make_body, make_grid, make_particles, make_simulation, whole_side

from solver.contact import CONTACT
from solver.contact.approach import ApproachContact
from solver.contact.friction_bard import FrictionBard
from solver.contact.friction_lr import FrictionLR
from solver.contact.friction_lr_var import FrictionEntry, FrictionLRVar, VariableFriction
from solver.contact.motion import Profile
from solver.contact.nodal_svf import NodalVolumeFraction
from solver.contact.null import NullContact
from solver.contact.single_velocity import SingleVelocity
from solver.contact.specified import Specified
from solver.contact.specified_friction import SpecifiedFriction
from solver.nodal_stress import FaceTractions, NodalStress
from solver.workspace import Workspace

DT = 1e-3
GRID = make_grid((30, 30, 34))
FACES = [
    whole_side("z-", "Symmetric", "symmetry"),
    whole_side("x+", "Velocity", "Dirichlet", (0.0, 0.0, 0.0)),
]

FORWARD = Profile(np.array([0.0, 1.0]), np.array([[0.01, 0.0, 0.0], [0.02, 0.01, 0.0]]))
BY_COLOR = VariableFriction(entry=(FrictionEntry(0.0, 0.1), FrictionEntry(1.0, 0.3)))
LAWS = {
    "null": NullContact(),
    "single_velocity": SingleVelocity(),
    "friction_bard": FrictionBard(mu=0.3, volume_constraint=0.5),
    "approach": ApproachContact(mu=0.3, volume_constraint=0.5),
    "friction_LR": FrictionLR(mu=0.3),
    "friction_LRVar": FrictionLRVar(variable_friction=BY_COLOR, master_material=0),
    "specified": Specified(materials=(0, 1), profile=FORWARD, volume_constraint=0.1),
    "specified_friction": SpecifiedFriction(materials=(0, 1), mu=0.3, profile=FORWARD, OneOrTwoStep=2),
    "nodal_svf": NodalVolumeFraction(myu=0.1, use_svf=True),
}


def slab(low: int, high: int, index: int):
    """A body of four particles a cell."""
    positions = fill((2, 2, low), (28, 28, high), GRID.spacing, (2, 2, 1))
    particles = make_particles(GRID, positions, (2, 2, 1))
    particles.velocity[:] = 0.01, 0.0, 0.02 * (1 - 2 * index)
    particles.surface[:] = 1.0
    return make_body(particles, index, model=elastic(1.0, 0.0))


def bytes_of_a_step(simulation) -> int:
    """The most that is allocated at a time in one of three steps, after the first few."""
    for _ in range(3):
        simulation.advance(DT)
    tracemalloc.start()
    try:
        most = 0
        for _ in range(3):
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            simulation.advance(DT)
            most = max(most, tracemalloc.get_traced_memory()[1] - before)
    finally:
        tracemalloc.stop()
    return most


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"flags": {"explicit_heat_conduction": True}},
        {"flags": {"XPIC2": True}},
        {"flags": {"restart_on_large_nodal_velocity": True}},
        {"flags": {"pressure_stabilization": True}},
        {"regions": FACES},
        {"contact_laws": [FrictionBard(mu=0.3, materials=(0, 1))], "flags": {"axisymmetric": True}},
        *({"contact_laws": [law]} for law in LAWS.values()),
    ],
    ids=[
        "plain",
        "heat",
        "xpic",
        "too fast",
        "stabilized",
        "conditions",
        "axisymmetric friction_bard",
        *LAWS,
    ],
)
def test_a_step_allocates_nothing_as_long_as_particles_or_nodes(options) -> None:
    """Not one byte for each: what is seen are the small objects of Python that come and go."""
    bodies, least = two_slabs()
    simulation = make_simulation(GRID, bodies, **options)
    assert bytes_of_a_step(simulation) < least


def two_slabs():
    """Two bodies in touch, and the number of their particles, or of the nodes if that is less."""
    bodies = [slab(2, 15, 0), slab(15, 28, 1)]
    least = min(GRID.number_of_nodes, *(len(body.particles) for body in bodies))
    assert least > 35_000
    return bodies, least


def test_every_contact_law_is_counted() -> None:
    assert {type(law) for law in LAWS.values()} == set(CONTACT.models.values())


def test_stress_at_nodes_allocates_nothing() -> None:
    bodies, least = two_slabs()
    simulation = make_simulation(GRID, bodies)
    stress = NodalStress()
    stress.wanted = True
    stress.attach(simulation)
    assert bytes_of_a_step(simulation) < least
    assert np.abs(stress.values).max() > 0.0


def test_tractions_allocate_for_the_nodes_of_faces_only() -> None:
    """Some vectors for each node of the face; the stress at all nodes would be 72 bytes for each."""
    bodies, _ = two_slabs()
    faces = ("xminus",)
    simulation = make_simulation(GRID, bodies, flags={"boundary_traction_faces": faces})
    FaceTractions(faces).attach(simulation)
    assert bytes_of_a_step(simulation) < 5 * 24 * len(simulation.face_nodes["xminus"])


def test_the_count_sees_arrays() -> None:
    """A step that makes one array of a byte a particle is found out."""
    body = slab(2, 28, 0)
    simulation = make_simulation(GRID, [body])
    simulation.after_step.append(lambda simulation, dt: np.ones(len(body.particles), np.bool_).any())
    assert bytes_of_a_step(simulation) >= len(body.particles)


def test_a_workspace_gives_the_same_memory_again() -> None:
    workspace = Workspace()
    first = workspace.rows("a", 5, np.float64, 3)
    assert first.shape == (5, 3)
    assert workspace.rows("a", 4, np.float64, 3).base is first.base
    assert workspace.rows("b", 4, np.float64, 3).base is not first.base
    assert workspace.rows("a", 6, np.float64, 3).shape == (6, 3)
    assert workspace.rows("a", 6, np.float64, 4).shape == (6, 4)
    assert not workspace.zeros("a", 2, np.float64, 4).any()
