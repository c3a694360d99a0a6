"""All the loads of a run: which particles carry them, and what they add in each step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from solver.creation import Creation
from solver.domains.communicator import Alone, Communicator
from solver.geometry.piece import Array
from solver.grid import Grid
from solver.loads.action import Action
from solver.loads.load import Load
from solver.loads.normals import NO_NORMALS, ParticleNormals
from solver.loads.notices import Notice, doubts, no_particle
from solver.particles import Particles

MOST_CURVES = 3
"""How many load curves a particle can carry."""


class _Acting(NamedTuple):
    """A load with its direction law and what it does now."""

    load: Load
    law: Any
    action: Action


class Loads:
    """The loads of a deck, applied at the start of each step.

    A load acts on the particles that hold the id of its load curve in ``load_curve``, whatever the numbers
    are. Uintah finds the load by its place in the list and so needs the ids 1, 2, ... in the order pressure,
    pressure_pts, torque, heat_flux; with other numbers, or with heat flux beside other loads, it applies
    loads to the wrong particles or reads outside its tables.

    Parameters
    ----------
    loads : the load records of the deck, in any order; records that are no :class:`Load` have no effect.
    grid : the grid.
    follow_rotation : turn pressures with the particles (``keepPressBCNormalToSurface``).
    on_corners : apply forces at the corners of the loaded faces (``use_CBDI_boundary_condition``).
    taken_over : index of a material -> index of the one that its particles may go over to, with their curves.

    Attributes
    ----------
    counts : number of particles that share each load, by curve id; 0 until :meth:`prepare` or :meth:`resume`.
    notices : what is doubtful about the loads; :meth:`prepare` adds to it.

    Raises
    ------
    ValueError : two curves have the same id, or ``on_corners`` and a load lacks ``outward_normal``.
    """

    def __init__(
        self,
        loads: Sequence[Any],
        grid: Grid,
        *,
        follow_rotation: bool = False,
        on_corners: bool = False,
        taken_over: Mapping[int, int] | None = None,
    ) -> None:
        self._loads = sorted((load for load in loads if isinstance(load, Load)), key=lambda load: load.rank)
        self._grid = grid
        self._follow_rotation = follow_rotation
        self._on_corners = on_corners
        self._taken_over = taken_over or {}
        self._check()
        self._laws = [load.law(grid) for load in self._loads]
        self._carried: list[set[int]] = []
        self._normals = ParticleNormals(np.zeros(0, np.int64), NO_NORMALS)
        self._time = 0.0
        self.counts = {load.load_curve.id: load.particles_on_surface for load in self._loads}
        self.notices = doubts(self._loads, grid)

    @property
    def fluxes(self) -> list[Any]:
        """The fluxes of a diffusing substance, which :meth:`apply` leaves to ``solver.diffusion``."""
        return [load for load in self._loads if load.soaks]

    def __len__(self) -> int:
        """The number of loads."""
        return len(self._loads)

    def prepare(self, creations: Sequence[Creation], communicator: Communicator | None = None) -> None:
        """Write the ids of the curves that each particle carries into ``load_curve``, and count them.

        Where a particle file lists load curves, those stand. To be called once, for the particles of every
        material as they were created; with a communicator every rank calls it for its own.

        Raises
        ------
        ValueError
            A particle would carry more than three curves, or carries one that acts along a normal that the
            particle file does not give.
        """
        for material, creation in enumerate(creations):
            for load in self._loads:
                if load.load_curve.acts_on(material):
                    _assign(load, creation)
        materials = [creation.particles for creation in creations]
        ranks = communicator or Alone()
        self.learn_normals(creations, ranks)
        counts = [sum(int(np.count_nonzero(p.load_curve == c)) for p in materials) for c in self.counts]
        total = ranks.total(np.array(counts)).tolist()
        self.resume(materials, dict(zip(self.counts, total, strict=True)), ranks)
        self.notices += [
            Notice(load, no_particle(load)) for load in self._loads if not self.counts[load.load_curve.id]
        ]

    def learn_normals(self, creations: Sequence[Creation], communicator: Communicator | None = None) -> None:
        """Remember the normals that particle files gave, by particle id.

        :meth:`prepare` does so; a run that goes on from a checkpoint has to call this itself.

        Raises
        ------
        ValueError : a particle that is loaded along its normal has none.
        """
        along = [load.load_curve.id for load in self._loads if load.along_particle_normals]
        for material, creation in enumerate(creations):
            loaded = np.isin(creation.particles.load_curve, along).any(axis=1)
            if np.any(loaded & ~creation.normal.any(axis=1)):
                raise ValueError(
                    f"particles of material {material} carry a <pressure_pts> load and have no normal: their "
                    "file must give p.normal"
                )
        ids = np.concatenate([creation.particles.id for creation in creations])
        normals = np.concatenate([creation.normal for creation in creations])
        given = normals.any(axis=1)
        # Particles move between ranks, so each knows the normals of all.
        known = (communicator or Alone()).allgather((ids[given], normals[given]))
        ids, normals = (np.concatenate(parts) for parts in zip(*known, strict=True))
        self._normals = ParticleNormals(ids, normals)

    def resume(
        self,
        materials: Sequence[Particles],
        counts: Mapping[int, int],
        communicator: Communicator | None = None,
    ) -> None:
        """Go on with particles that hold their curves already, as from a checkpoint."""
        self.counts.update(counts)
        carried = [set(np.unique(particles.load_curve).tolist()) for particles in materials]
        everywhere = zip(*(communicator or Alone()).allgather(carried), strict=True)
        self._carried = [set().union(*of_material) for of_material in everywhere]
        for source, target in self._taken_over.items():
            self._carried[target] |= self._carried[source]

    def apply(self, time: float, materials: Sequence[Particles]) -> None:
        """Set ``external_force`` and ``external_heat_rate`` of the particles of all materials, for one step.

        Uintah evaluates the curves at the time at which the step starts, for the positions and deformation
        gradients there. What a particle got in the last step is not carried over: it is zero where no curve
        acts. At initialisation Uintah keeps only the last load of a particle with several (an output of the
        initial state shows that); here they add up from the start.

        With loads on corners ``external_force`` holds what each of the four corners gets, as in Uintah, and
        :meth:`scatter_corner_forces` takes the place of its transfer to the grid.
        """
        self._time = time
        for material, particles in enumerate(materials):
            particles.external_force[:] = 0.0
            particles.external_heat_rate[:] = 0.0
            actions = self._actions(material)
            if self._on_corners:
                self._push_corners(actions, particles)
            else:
                self._push(actions, particles)
            self._heat(actions, particles)

    def _push(self, actions: Sequence[_Acting], particles: Particles) -> None:
        """Add the forces on whole particles; only pressures turn with the particle, so they come first."""
        from solver.loads.kernels.apply import add_force, turn_forces

        for turning in (True, False):
            for load, law, action in actions:
                if not load.heats and load.follows_rotation == turning:
                    normals = self._normals_for(load, particles)
                    x, curves, force = particles.position, particles.load_curve, particles.external_force
                    add_force(law, action, x, normals, curves, force)
            if turning and self._follow_rotation:
                turn_forces(particles.deformation_gradient, particles.external_force)

    def _push_corners(self, actions: Sequence[_Acting], particles: Particles) -> None:
        from solver.loads.kernels.corners import add_corner_force

        for load, law, action in actions:
            if not load.heats:
                normals = self._normals_for(load, particles)
                add_corner_force(law, action, particles, normals, self._grid.spacing)

    def _heat(self, actions: Sequence[_Acting], particles: Particles) -> None:
        from solver.loads.kernels.apply import add_heat

        for load, _, action in actions:
            if load.heats:
                add_heat(action, particles.load_curve, particles.external_heat_rate)

    def scatter_corner_forces(
        self, material: int, particles: Particles, grid: Grid, nodal_force: Array
    ) -> None:
        """Add the forces on a material, as of the last :meth:`apply`, to nodal forces (N, 3).

        A particle under several loads gives each from the corners of its own face; Uintah gives all of them
        from those of the last.
        """
        from solver.loads.kernels.corners import scatter_from_corners

        for load, law, action in self._actions(material):
            if not load.heats:
                normals = self._normals_for(load, particles)
                scatter_from_corners(law, action, particles, normals, grid.index, nodal_force)

    def _normals_for(self, load: Load, particles: Particles) -> Array:
        return self._normals.of(particles.id) if load.along_particle_normals else NO_NORMALS

    def _actions(self, material: int) -> list[_Acting]:
        """The loads on a material with what each does at the time of the last :meth:`apply`."""
        return [
            _Acting(load, law, self._action(load))
            for load, law in zip(self._loads, self._laws, strict=True)
            if load.load_curve.id in self._carried[material]
            and self.counts[load.load_curve.id] > 0
            and not load.soaks
        ]

    def _action(self, load: Load) -> Action:
        curve = load.load_curve.id
        return Action(
            curve=curve,
            magnitude=load.magnitude(self._time, self.counts[curve]),
            follow_rotation=self._follow_rotation and load.follows_rotation,
            outward=load.surface_normal_points_outward is not False,
        )

    def _check(self) -> None:
        seen: set[int] = set()
        for load in self._loads:
            curve = load.load_curve.id
            if curve in seen:
                raise ValueError(
                    f"two loads have a load curve with id {curve}: give every load curve its own id"
                )
            seen.add(curve)
            pushes = not load.heats and not load.soaks
            if self._on_corners and pushes and load.surface_normal_points_outward is None:
                raise ValueError(
                    f"<{load.tag}> with load curve {curve} needs <outward_normal>, true or false, because "
                    "use_CBDI_boundary_condition is true"
                )


def _assign(load: Load, creation: Creation) -> None:
    """Add the curve of a load to the particles near its surface."""
    particles = creation.particles
    for number, (hx, hy, hz) in enumerate(creation.spacing.tolist()):
        candidates = np.flatnonzero(creation.loadable & (creation.object == number))
        carriers = candidates[load.near(particles.position[candidates], (hx, hy, hz))]
        place = np.count_nonzero(particles.load_curve[carriers], axis=1)
        if np.any(place >= MOST_CURVES):
            x, y, z = particles.position[carriers[place >= MOST_CURVES][0]]
            raise ValueError(
                f"the particle at [{x:g}, {y:g}, {z:g}] would carry more than {MOST_CURVES} load curves, the "
                f"last with id {load.load_curve.id}: make the loaded surfaces overlap less"
            )
        particles.load_curve[carriers, place] = load.load_curve.id
