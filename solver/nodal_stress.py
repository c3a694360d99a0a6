"""Stress at the nodes and tractions on faces of the domain: recorded for output, never used by the step.

Both belong to the particles as they are before they move, so they hook into
``Simulation.after_boundary_conditions``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from solver.grid import FACES, Grid, GridIndex
from solver.interpolation.shape import MOST_NODES, particle_domain, shape_functions
from solver.jit import kernel
from solver.particles import Particles
from solver.scratch import scratch_numbers, scratch_rows
from solver.tensor import tensor_at
from solver.workspace import Workspace

if TYPE_CHECKING:
    from solver.simulation import Simulation

Array = NDArray[Any]

NO_TRACTION = 1.0e-12
"""Squared normal traction up to which the contact area is not found from force and traction."""


class NodalStress:
    """The stress of each material at the nodes (Uintah's g.stressFS), taken in the steps where it is wanted.

    Attributes
    ----------
    wanted : whether the coming step is to be recorded.
    values : (M, N, 3, 3) as last recorded.
    """

    def __init__(self) -> None:
        self.wanted = False
        self.values: Array = np.zeros((0, 0, 3, 3))
        self._workspace = Workspace()

    def attach(self, simulation: Simulation) -> None:
        """Record from now on."""
        simulation.after_boundary_conditions.append(self._record)

    def _record(self, simulation: Simulation, dt: float) -> None:
        if self.wanted:
            self.values = stress_of_all(simulation, self._workspace)


class FaceTractions:
    """Mean traction and contact area of the faces that ``boundary_traction_faces`` names, in every step.

    The traction of a face is sum_i sigma_i . n A_i / sum_i A_i over its nodes i and all materials, with the
    outward normal n and A_i = 2 V_i / h (half of the volume of a node at the edge is missing). The contact
    area is the normal force over the normal traction, or sum_i A_i where the traction is next to nothing.
    """

    def __init__(self, faces: tuple[str, ...]) -> None:
        self.faces = faces
        self._workspace = Workspace()

    def attach(self, simulation: Simulation) -> None:
        """Record from now on."""
        simulation.after_boundary_conditions.append(self._record)

    def _record(self, simulation: Simulation, dt: float) -> None:
        stresses = stress_of_all(simulation, self._workspace)
        for name in self.faces:
            self._record_face(simulation, name, stresses)

    def _record_face(self, simulation: Simulation, name: str, stresses: Array) -> None:
        face = side_of(name)
        axis, outward = FACES.index(face) // 2, 1.0 if face.endswith("+") else -1.0
        grid, reductions = simulation.grid, simulation.reductions
        nodes = simulation.face_nodes[name]
        traction = np.zeros(3)
        for m, stress in enumerate(stresses):
            node_area = 2.0 * simulation.nodal.volume[m, nodes] / grid.spacing[axis]
            normal_stress = outward * stress[nodes, :, axis]
            traction += (normal_stress * node_area[..., None]).sum(axis=0)
        area = reductions["BndyContactCellArea_" + name, -1]
        force = reductions["BndyForce_" + name, -1]
        communicator = simulation.exchange.communicator
        total = communicator.total(np.array([*traction, area, force[axis]]))
        traction, area, normal_force = total[:3], float(total[3]), float(total[4])
        if area > 0.0:
            traction /= area
        if traction[axis] ** 2 > NO_TRACTION:
            area = normal_force / traction[axis]
        # Reductions are added up over the ranks when the step ends; these are complete already.
        first = communicator.rank == 0
        reductions["BndyTraction_" + name, -1] = traction if first else np.zeros(3)
        reductions["BndyContactArea_" + name, -1] = area if first else 0.0


def stress_of_all(simulation: Simulation, workspace: Workspace) -> Array:
    """(M, N, 3, 3) stress of all materials at the nodes, in arrays of the workspace."""
    materials, nodes = len(simulation.bodies), simulation.grid.number_of_nodes
    stress = workspace.rows("stress", materials, np.float64, nodes, 3, 3)
    for m in range(materials):
        simulation.stress_at_nodes(m, stress[m])
    return stress


def side_of(name: str) -> str:
    """The face that ``boundary_traction_faces`` calls ``xminus``, as grids call it: ``x-``."""
    return name.replace("minus", "-").replace("plus", "+")


def on_face(grid: Grid, face: str) -> Array:
    """(N,) True for the nodes on a face of the bounding box, extra nodes left out."""
    axis = FACES.index(face) // 2
    inside = []
    for a in range(3):
        indices = grid.node_indices(a)
        at = grid.cells[a] if face.endswith("+") else 0
        inside.append(indices == at if a == axis else (indices >= 0) & (indices <= grid.cells[a]))
    x, y, z = inside
    return np.asarray(z[:, None, None] & y[:, None] & x).ravel()


@kernel
def scatter_stress(interpolator: Any, grid: GridIndex, particles: Particles, sums: Any) -> None:
    """Add V_p sigma_p S_ip of each particle to the nodes (N, 9), matrices row by row."""
    nodes = scratch_numbers(MOST_NODES, np.int64)
    weights = scratch_numbers(MOST_NODES, np.float64)
    gradients = scratch_rows(MOST_NODES, 3)
    for p in range(particles.mass.shape[0]):
        x, y, z = particles.position[p, 0], particles.position[p, 1], particles.position[p, 2]
        domain = particle_domain(
            interpolator, tensor_at(particles.deformation_gradient, p), tensor_at(particles.size, p)
        )
        count = shape_functions(interpolator, grid, x, y, z, domain, nodes, weights, gradients)
        for n in range(count):
            share = particles.volume[p] * weights[n]
            for i in range(3):
                for j in range(3):
                    sums[nodes[n], 3 * i + j] += share * particles.stress[p, i, j]
