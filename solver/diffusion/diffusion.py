"""The diffusion of a run: one call a step, before the particles move."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from solver.creation import Creation
from solver.diffusion import holds_diffusivity, source
from solver.diffusion.interface import DiffusionInterface, NodalConcentration
from solver.diffusion.solute import Solute
from solver.domains.communicator import largest_number
from solver.grid import Grid
from solver.loads.scalar_flux import ScalarFlux
from solver.particles import new_arrays

if TYPE_CHECKING:
    from solver.body import Body
    from solver.simulation import Simulation

Array = NDArray[Any]


def new_solute(creation: Creation, law: Any, grid: Grid) -> Solute:
    """The solute of particles that were just created, whose load curves are assigned.

    A particle that carries a load curve has the areas of its sides across x, y and z.
    """
    solute: Solute = new_arrays(Solute, len(creation.particles))
    solute.concentration[:] = creation.concentration
    solute.previous[:] = solute.concentration
    solute.diffusivity[:] = law.diffusivity
    loaded = creation.particles.load_curve.any(axis=1)
    sides = np.einsum("nii->ni", creation.particles.size) * np.array(grid.spacing)
    solute.area[loaded] = (sides.prod(axis=1)[:, None] / sides)[loaded]
    return solute


class Diffusion:
    """The laws of all materials, what passes between them, and the flux through their surfaces.

    Hooks into a simulation by :meth:`attach`. Where a constitutive model swells (its state has
    ``concentration_rate``), it is told the rate of the step before, as Uintah does.

    Attributes
    ----------
    nodal : the nodal fields of the last step; None before the first.
    """

    def __init__(
        self,
        laws: Sequence[Any],
        interfaces: Sequence[DiffusionInterface] = (),
        fluxes: Sequence[ScalarFlux] = (),
        counted: Sequence[bool] = (),
    ) -> None:
        """``counted`` : whether the concentration of each material counts in the sum TotalConc."""
        self.laws = laws
        self.counted = counted or [False] * len(laws)
        self.interfaces = interfaces
        self.fluxes = fluxes
        self.nodal: NodalConcentration | None = None
        self._largest = max((law.diffusivity for law in laws), default=0.0)
        self._least_spacing = 0.0

    def attach(self, simulation: Simulation) -> None:
        """Let the concentration spread from now on, within the step that its stability allows."""
        self._least_spacing = min(simulation.grid.spacing)
        simulation.after_boundary_conditions.append(self.advance)
        simulation.time_step_limits.append(self.limit)

    def limit(self, time: float) -> float:
        """The longest stable step, h^2 / (2 D), with the largest D of the last step."""
        return self._least_spacing**2 / (2.0 * self._largest) if self._largest > 0.0 else math.inf

    def advance(self, simulation: Simulation, dt: float) -> None:
        """Spread the concentrations for a step; particles and nodal masses are those of its start."""
        shape = simulation.nodal.mass.shape
        nodal = NodalConcentration(
            simulation.nodal.mass, simulation.nodal.volume, *(np.zeros(shape) for _ in range(6))
        )
        for m, body in enumerate(simulation.bodies):
            self._soak(body, simulation.time)
            self._project(simulation, m, body, nodal)
        for interface in self.interfaces:
            interface.share_concentration(nodal)
        self._largest = 0.0
        for m, body in enumerate(simulation.bodies):
            nodal.rate[m] = self._rate_of_fluxes(simulation, m, body, nodal.mean_stress[m])
        for interface in self.interfaces:
            interface.share_rate(nodal, dt)
        for m, body in enumerate(simulation.bodies):
            nodal.star[m] = nodal.concentration[m] + dt * nodal.rate[m]
            simulation.boundary_conditions.apply_concentration(nodal.star[m], m)
            nodal.rate[m] = (nodal.star[m] - nodal.projected[m]) / dt + nodal.external[m] / nodal.mass[m]
            self._to_particles(simulation, m, body, nodal, dt)
        self._largest = largest_number(simulation.exchange.communicator, self._largest)
        self.nodal = nodal
        counted = (b.solute.previous.sum() for b, c in zip(simulation.bodies, self.counted, strict=True) if c)
        simulation.reductions["TotalConc", -1] = float(sum(counted))

    def _project(self, simulation: Simulation, m: int, body: Body, nodal: NodalConcentration) -> None:
        """Concentration, mean stress and external flux of a body at the nodes."""
        from solver.diffusion.kernels.transfer import SUMS, concentration_to_grid

        sums = np.zeros((simulation.grid.number_of_nodes, SUMS))
        if body.takes_part(simulation.time):
            concentration_to_grid(
                simulation.interpolator,
                simulation.grid.index,
                body.particles,
                body.solute,
                simulation.flags.gradient_enhanced_projection,
                sums,
            )
        simulation.complete(m, sums)
        nodal.projected[m] = nodal.concentration[m] = sums[:, 0] / nodal.mass[m]
        nodal.mean_stress[m] = sums[:, 1] / nodal.mass[m]
        nodal.external[m] = sums[:, 2]
        simulation.boundary_conditions.apply_concentration(nodal.concentration[m], m)

    def _rate_of_fluxes(self, simulation: Simulation, m: int, body: Body, mean_stress: Array) -> Array:
        """-sum m J . G / sum m S of a body at the nodes, (N,), and its source."""
        from solver.diffusion.kernels.transfer import fluxes_to_grid

        law = self.laws[m]
        sums = np.zeros((simulation.grid.number_of_nodes, 1))
        if not body.takes_part(simulation.time):
            return sums[:, 0]
        largest = fluxes_to_grid(
            compiled_form(law),
            holds_diffusivity(law, simulation.time),
            simulation.flags.axisymmetric,
            simulation.interpolator,
            simulation.grid.index,
            body.particles,
            body.solute,
            mean_stress,
            sums,
        )
        self._largest = max(self._largest, largest)
        simulation.complete(m, sums)
        return np.asarray(sums[:, 0] / simulation.nodal.mass[m] + source(law))

    def _to_particles(
        self, simulation: Simulation, m: int, body: Body, nodal: NodalConcentration, dt: float
    ) -> None:
        """Grow the concentrations of a body, and tell a model that swells the growth of the step before."""
        from solver.diffusion.kernels.transfer import concentration_to_particles

        simulation.share(m, nodal.rate[m])
        simulation.share(m, nodal.star[m])
        law, solute = self.laws[m], body.solute
        if hasattr(body.state, "concentration_rate"):
            body.state.concentration_rate[:] = (solute.concentration - solute.previous) / dt
        if not body.takes_part(simulation.time):
            return
        concentration_to_particles(
            simulation.interpolator,
            simulation.grid.index,
            body.particles,
            solute,
            simulation.flags.axisymmetric,
            nodal.rate[m],
            nodal.star[m],
            (law.min_concentration + law.tolerance, law.max_concentration - law.tolerance),
            dt,
        )

    def _soak(self, body: Body, time: float) -> None:
        """The rate of the particles by fluxes through the surface: sum q A / V."""
        particles, solute = body.particles, body.solute
        solute.external_rate[:] = 0.0
        for load in self.fluxes:
            carried = np.flatnonzero((particles.load_curve == load.load_curve.id).any(axis=1))
            if len(carried):
                facing = load.normals(particles.position[carried]) * solute.area[carried]
                area = np.sqrt((facing**2).sum(axis=1))
                solute.external_rate[carried] += load.magnitude(time, 1) * area / particles.volume[carried]


def compiled_form(law: Any) -> Any:
    """The numbers of a law, without what is not for kernels."""
    others = {"diff_curve": None, "conductivity_equation": None}
    return law._replace(**{name: none for name, none in others.items() if name in law._fields})
