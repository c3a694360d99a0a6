"""The one seam between decks and physics: tags become grid, bodies, contact, loads and a simulation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from solver.contact.law import ContactLaw
from solver.creation import Creation, ParticleIds, create_particles
from solver.declare import IntVector, Vector
from solver.domains.communicator import Alone, Communicator, largest_number
from solver.domains.decomposition import Domain, cut, foreseen_work, patch_planes
from solver.domains.exchange import Exchange, ManyRanks, OneRank
from solver.flags import Flags
from solver.grid import Grid, Patch, Window
from solver.interpolation import INTERPOLATOR
from solver.loads.loads import Loads
from solver.materials.constitutive import initialize, state_record
from solver.materials.damage import for_constitutive_model, initialize_damage
from solver.materials.erosion import lets_fail
from solver.materials.failure import Failure, new_failure
from solver.materials.rigid import Rigid
from solver.particles import new_arrays
from ups.deck import Box, Deck, Level, MaterialSection, Specification
from ups.diagnostics import DeckError, Diagnostics, Located
from ups.faces import regions

TOLERANCE = 1.0e-6
"""How far, in cells, a box's edges may lie from the lines of the grid."""


class ProblemError(Exception):
    """A deck whose parts do not fit together; ``at`` is the place to show."""

    def __init__(self, code: str, message: str, at: Any, suggestion: str | None = None) -> None:
        super().__init__(message)
        self.code, self.message, self.at, self.suggestion = code, message, at, suggestion


def build(deck: Deck, communicator: Communicator | None = None, domains: Sequence[Domain] = ()) -> Any:
    """Make the simulation that a deck describes, or the part of it that is one rank's.

    Parameters
    ----------
    deck : as ``read_deck`` returns it.
    communicator : the ranks that run it together, each of which has to call this.
    domains : the cells of each rank; by default they are chosen.

    Returns
    -------
    solver.simulation.Simulation
        with particles in place, loads assigned and nothing moved yet.

    Raises
    ------
    DeckError
        with every diagnostic, where the deck has errors or its parts do not fit together.
    """
    specification = deck.require()
    builder = _Builder(deck, specification, communicator or Alone(), domains)
    try:
        return builder.simulation()
    except ProblemError as problem:
        at: Located | None = problem.at if not isinstance(problem.at, type(None)) else deck.document.root
        deck.diagnostics.error(problem.code, problem.message, at, problem.suggestion)
        raise DeckError(deck.diagnostics, deck.sources) from None


def build_grid(level: Level, place: Callable[[Any], Any]) -> Grid:
    """The grid of a level: boxes of equal cells, each cut into patches.

    Raises
    ------
    ProblemError
        where boxes do not fit on one lattice of cells.
    """
    boxes = level.Box
    anchor = tuple(min(box.lower[a] for box in boxes) for a in range(3))
    for box in boxes:
        for axis, name in enumerate("xyz"):
            if not box.upper[axis] > box.lower[axis]:
                raise ProblemError(
                    "UPS401", f"the upper corner of the box is not above the lower one in {name}", place(box)
                )
    spacing = _spacing(level, place)
    patches: list[Patch] = []
    highest = [0, 0, 0]
    for box in boxes:
        low = _cell_index(box, box.lower, anchor, spacing, place)
        high = _cell_index(box, box.upper, anchor, spacing, place)
        highest = [max(a, b) for a, b in zip(highest, high, strict=True)]
        patches += _split(box, low, high, len(patches), place)
    return Grid(
        anchor=(anchor[0], anchor[1], anchor[2]),
        spacing=spacing,
        cells=(highest[0], highest[1], highest[2]),
        extra_cells=_common(level, "extraCells", place),
        periodic=_common(level, "periodic", place),
        patches=tuple(patches),
    )


def _spacing(level: Level, place: Callable[[Any], Any]) -> Vector:
    """Cell size of the level, from its spacing or from the boxes' resolutions, which must agree."""
    found: Vector | None = level.spacing
    for box in level.Box:
        own = box.spacing
        if own is None and box.resolution is not None:
            sizes = [(u - lo) / n for lo, u, n in zip(box.lower, box.upper, box.resolution, strict=True)]
            own = (sizes[0], sizes[1], sizes[2])
        if own is None:
            continue
        if found is not None and any(abs(a - b) > TOLERANCE * b for a, b in zip(own, found, strict=True)):
            raise ProblemError(
                "UPS405", f"the box has cells of {own}, another box or the level of {found}", place(box)
            )
        found = found or own
    if found is None:
        raise ProblemError("UPS101", "the box needs <resolution> or <spacing>", place(level.Box[0]))
    return found


def _cell_index(
    box: Box, corner: Vector, anchor: Any, spacing: Vector, place: Callable[[Any], Any]
) -> list[int]:
    index = []
    for axis in range(3):
        cells = (corner[axis] - anchor[axis]) / spacing[axis]
        nearest = round(cells)
        if abs(cells - nearest) > 1.0e-3:
            raise ProblemError(
                "UPS405",
                f"the box's corner {corner} is not on the lines of the grid: {cells:g} cells from the anchor in "
                f"{'xyz'[axis]}",
                place(box),
            )
        index.append(nearest)
    return index


def _split(
    box: Box, low: list[int], high: list[int], first_id: int, place: Callable[[Any], Any]
) -> list[Patch]:
    """Cut a box into patches a x b x c as Uintah numbers them, z fastest."""
    counts = box.patches
    for axis in range(3):
        if counts[axis] > high[axis] - low[axis]:
            raise ProblemError(
                "UPS405", f"{counts[axis]} patches in {'xyz'[axis]} are more than cells", place(box)
            )
    patches: list[Patch] = []

    def cut(axis: int, i: int) -> int:
        return low[axis] + (high[axis] - low[axis]) * i // counts[axis]

    for i in range(counts[0]):
        for j in range(counts[1]):
            for k in range(counts[2]):
                start = (cut(0, i), cut(1, j), cut(2, k))
                end = (cut(0, i + 1), cut(1, j + 1), cut(2, k + 1))
                patches.append(Patch(first_id + len(patches), start, end))
    return patches


def _common(level: Level, name: str, place: Callable[[Any], Any]) -> IntVector:
    """A value that boxes and level must agree on; zeros where none is given."""
    found: IntVector | None = getattr(level, name)
    for box in level.Box:
        own = getattr(box, name)
        if own is not None and found is not None and own != found:
            raise ProblemError(
                "UPS405", f"<{name}> differs from that of another box or of the level", place(box)
            )
        found = found or own
    return found or (0, 0, 0)


class _Builder:
    def __init__(
        self,
        deck: Deck,
        specification: Specification,
        communicator: Communicator,
        domains: Sequence[Domain],
    ) -> None:
        self.communicator = communicator
        self.domains = tuple(domains)
        self.deck = deck
        self.spec = specification
        self.flags: Flags = specification.MPM
        self.place = deck.reader.place
        self.diagnostics: Diagnostics = deck.diagnostics

    def simulation(self) -> Any:
        from solver.boundary_conditions import BoundaryConditions
        from solver.simulation import Simulation

        grid = self._part(self._grid())
        interpolator = self._interpolator(grid)
        contact: tuple[ContactLaw, ...] = self.spec.MaterialProperties.MPM.contact
        materials = self.spec.materials
        for law in contact:
            self._guard("UPS402", law, lambda law=law: law.check(len(materials)))  # type: ignore[misc]
        loads = self._loads(grid)
        creations = self._particles(grid, interpolator, loads, contact)
        bodies = [
            self._body(i, m, c, contact) for i, (m, c) in enumerate(zip(materials, creations, strict=True))
        ]
        exchange = self._exchange(grid, interpolator, bodies, contact)
        grid = getattr(exchange, "grid", grid)
        face_section = self.spec.Grid.BoundaryConditions
        simulation = Simulation(
            grid=grid,
            bodies=bodies,
            interpolator=interpolator,
            flags=self.flags,
            gravity=self._gravity(),
            boundary_conditions=BoundaryConditions(
                regions(face_section, len(bodies), self._problem_at),
                grid,
                len(bodies),
                extra_nodes=self.flags.interpolator != "linear",
            ),
            contact_laws=contact,
            thermal_contact=self.spec.MaterialProperties.MPM.thermal_contact is not None,
            time=self.spec.Time.initTime,
            exchange=exchange,
        )
        self._attach_loads(simulation, loads, creations)
        self._attach_motions(simulation)
        self._attach_cohesive_zones(simulation)
        self._attach_conversion(simulation)
        self._attach_diffusion(simulation, loads, creations)
        return simulation

    # ---- parts ---------------------------------------------------------------------------------------------

    def _problem_at(self, code: str, message: str, record: Any) -> Exception:
        return ProblemError(code, message, self.place(record))

    def _guard(self, code: str, record: Any, action: Callable[[], Any]) -> Any:
        """Run an action; what it raises as ValueError becomes a problem at the record's place."""
        try:
            return action()
        except FileNotFoundError as problem:
            raise ProblemError("UPS408", str(problem), self.place(record)) from None
        except ValueError as problem:
            raise ProblemError(code, str(problem), self.place(record)) from None

    def _together(self, code: str, record: Any, action: Callable[[], Any]) -> Any:
        """As :meth:`_guard` on all ranks: where the action fails on one of them, it fails on all."""
        result: Any = None
        problem: ProblemError | None = None
        try:
            result = self._guard(code, record, action)
        except ProblemError as caught:
            problem = caught
        messages = self.communicator.allgather(None if problem is None else (problem.code, problem.message))
        failed = next((message for message in messages if message is not None), None)
        if failed is not None:
            raise problem or ProblemError(*failed, self.place(record))
        return result

    def _part(self, grid: Grid) -> Grid:
        """The grid with the cells of this rank, where there are several."""
        ranks = self.communicator.size
        if ranks == 1:
            return grid
        if not self.domains:
            along = patch_planes(grid) if len(grid.patches) >= ranks else None
            objects = [o for m in self.spec.materials for o in m.geom_object]
            self.domains = self._guard(
                "UPS405",
                self.spec.Grid.Level[0],
                lambda: cut(grid, ranks, lambda boxes: foreseen_work(grid, objects, boxes), along),
            )
        return replace(grid, window=Window(*self.domains[self.communicator.rank], 0))

    def _exchange(
        self, grid: Grid, interpolator: Any, bodies: list[Any], contact: tuple[ContactLaw, ...]
    ) -> Exchange:
        """What the simulation needs of the other ranks."""
        if self.communicator.size == 1:
            return OneRank(grid)
        from solver.domains.reach import layers_reached

        on_corners = self.flags.use_load_curves and self.flags.use_CBDI_boundary_condition
        own = layers_reached(interpolator, bodies, grid.spacing, on_corners)
        layers = int(largest_number(self.communicator, own))
        sees_neighbours = any(law.needs_surface for law in contact)
        return ManyRanks(self.communicator, grid, self.domains, layers, sees_neighbours=sees_neighbours)

    def _grid(self) -> Grid:
        levels = self.spec.Grid.Level
        if len(levels) > 1:
            raise ProblemError("UPS412", "this program runs on one level", self.place(levels[1]))
        return build_grid(levels[0], self.place)

    def _interpolator(self, grid: Grid) -> Any:
        name = self.flags.interpolator
        chosen = INTERPOLATOR.models[name]
        interpolator = self._guard(
            "UPS405",
            self.flags,
            lambda: chosen.for_deck(self.flags.axisymmetric, self.flags.cpdi_lcrit),  # type: ignore[attr-defined]
        )
        sums = tuple(e + p for e, p in zip(grid.extra_cells, grid.periodic, strict=True))
        level = self.place(self.spec.Grid.Level[0])
        if name == "linear":
            if any(grid.extra_cells):
                raise ProblemError(
                    "UPS409",
                    "the linear interpolator takes extraCells [0,0,0]",
                    level,
                    "set <extraCells> [0,0,0]",
                )
        else:
            allowed = [(1, 1, 1)] + [(1, 1, 0)] * self.flags.axisymmetric
            if sums not in allowed:
                raise ProblemError(
                    "UPS409",
                    f"the {name} interpolator needs extraCells and periodic to add up to [1,1,1], here {list(sums)}",
                    level,
                    f"set <extraCells> {[1 - p for p in grid.periodic]}",
                )
        if self.flags.axisymmetric and grid.cells[2] != 1:
            raise ProblemError("UPS409", "an axisymmetric grid is one cell thick in z", level)
        return interpolator

    def _gravity(self) -> Vector:
        constants = self.spec.PhysicalConstants.gravity
        if constants is not None:
            return constants
        return self.flags.gravity or (0.0, 0.0, 0.0)

    def _loads(self, grid: Grid) -> Loads | None:
        records = self.spec.PhysicalBC.MPM.loads
        if not self.flags.use_load_curves:
            return None
        loads: Loads = self._guard(
            "UPS407",
            self.spec.PhysicalBC.MPM,
            lambda: Loads(
                records,
                grid,
                follow_rotation=self.flags.keep_pressure_normal,
                on_corners=self.flags.use_CBDI_boundary_condition,
                taken_over=self.spec.conversions,
            ),
        )
        return loads

    def _particles(
        self, grid: Grid, interpolator: Any, loads: Loads | None, contact: tuple[ContactLaw, ...]
    ) -> list[Creation]:
        ids = ParticleIds(grid)
        find_surface = loads is not None or any(law.needs_surface for law in contact)
        creations: list[Creation] = []
        counts: list[int] = []
        for section in self.spec.materials:
            creation = self._together(
                "UPS403",
                section,
                lambda section=section: create_particles(  # type: ignore[misc]
                    section.geom_object,
                    grid,
                    section.constants,
                    ids,
                    axisymmetric=self.flags.axisymmetric,
                    tetrahedral=self.flags.interpolator == "cpti",
                    find_surface=find_surface,
                ),
            )
            creations.append(creation)
            counts.append(sum(self.communicator.allgather(len(creation.particles))))
            if not section.waits and counts[-1] == 0:
                self.diagnostics.warning(
                    "UPS411", "no particle lies in the shapes of this material", self.place(section)
                )
        if not any(counts):
            at = self.place(self.spec.MaterialProperties.MPM)
            raise ProblemError(
                "UPS411", "the deck has no particles: no shape covers a lattice point of the grid", at
            )
        return creations

    def _body(
        self, index: int, section: MaterialSection, creation: Creation, contact: tuple[ContactLaw, ...]
    ) -> Any:
        from solver.body import Body

        model = section.constitutive_model
        material = section.constants
        failure = self._failure(section, creation)
        if hasattr(model, "failure_is_checked"):
            model = model._replace(failure_is_checked=lets_fail(failure.erosion))
        state: Any = new_arrays(state_record(model), len(creation.particles))
        self._guard(
            "UPS502", model, lambda: initialize(model, state, creation.particles, material, creation.patch)
        )
        return Body(
            index=index,
            name=section.name or type(model).__name__,
            material=material,
            model=model,
            state=state,
            particles=creation.particles,
            failure=failure,
            rigid=section.is_rigid
            or isinstance(model, Rigid)
            or any(index in law.made_rigid for law in contact),
            transmits_force=section.is_force_transmitting_material,
            activation_time=section.activation_time,
            is_active=section.is_active,
            possible_alpha=section.possible_alpha_material
            and not any(index in law.never_alpha for law in contact),
        )

    def _failure(self, section: MaterialSection, creation: Creation) -> Failure:
        """Damage and erosion of a material."""
        model, damage = section.constitutive_model, section.damage
        if damage is not None:
            damage = self._guard("UPS502", damage, lambda: for_constitutive_model(damage, model))
        failure = new_failure(damage, section.erosion, len(creation.particles))
        self._guard(
            "UPS502",
            section,
            lambda: initialize_damage(
                failure.damage, failure.damage_state, creation.particles, creation.patch
            ),
        )
        return failure

    def _attach_loads(self, simulation: Any, loads: Loads | None, creations: list[Creation]) -> None:
        if loads is None:
            return
        self._guard("UPS403", self.spec.PhysicalBC.MPM, lambda: loads.prepare(creations, self.communicator))
        for notice in loads.notices:
            self.diagnostics.warning("UPS411", notice.message, self.place(notice.load))

        def apply(sim: Any, dt: float) -> None:
            loads.apply(sim.time, [body.particles for body in sim.bodies])

        simulation.loads = loads
        simulation.before_step.append(apply)
        if self.flags.use_CBDI_boundary_condition:
            simulation.spread_corner_loads = lambda body, force: loads.scatter_corner_forces(
                body.index, body.particles, simulation.grid, force
            )

    def _attach_motions(self, simulation: Any) -> None:
        """Prescribed deformation and inserted particles, from the files that the flags name."""
        from solver.insertion import read_insertions
        from solver.prescribed_motion import read_prescribed_deformation

        flags, open_file = self.flags, self.deck.reader.open_file
        if flags.use_prescribed_deformation:
            motion = self._guard(
                "UPS502",
                flags,
                lambda: read_prescribed_deformation(
                    open_file(flags.prescribed_deformation_file), flags.exact_deformation
                ),
            )
            simulation.after_boundary_conditions.append(
                lambda sim, dt: motion.impose(sim.nodal, sim.node_positions, sim.time, dt)
            )
            if flags.exact_deformation:
                simulation.time_step_limits.append(motion.time_step)
        if flags.insert_particles:
            insertions = self._guard(
                "UPS502", flags, lambda: read_insertions(open_file(flags.insert_particles_file))
            )
            simulation.after_step.append(
                lambda sim, dt: insertions.apply([body.particles for body in sim.bodies], sim.time, dt)
            )

    def _attach_cohesive_zones(self, simulation: Any) -> None:
        """The zones of every file, between contact and the accelerations."""
        from solver.cohesive_zones import CohesiveZones, attach, read_zones

        if not self.flags.use_cohesive_zones:
            return
        grid, count, ids = simulation.grid, len(simulation.bodies), ParticleIds(simulation.grid)
        found = []
        for law in self.spec.MaterialProperties.MPM.cohesive_zone:
            file = self._guard("UPS502", law, lambda law=law: self.deck.reader.open_file(law.cz_filename))  # type: ignore[misc]  # bound as mypy cannot see
            zones = self._guard("UPS502", law, lambda file=file: read_zones(file, grid, count, ids))  # type: ignore[misc]  # likewise
            if not sum(self.communicator.allgather(len(zones.area))):
                self.diagnostics.warning("UPS411", f"no zone of {file} lies in the grid", self.place(law))
            found.append(CohesiveZones(law, zones))
        attach(simulation, found)

    def _attach_conversion(self, simulation: Any) -> None:
        """Failed particles go to the materials that take them."""
        from solver.conversion import convert_failed_particles

        targets = self.spec.conversions

        def convert(sim: Any, dt: float) -> None:
            convert_failed_particles(sim.bodies, targets, sim.exchange.communicator)

        if targets:
            simulation.after_step.append(convert)

    def _attach_diffusion(self, simulation: Any, loads: Loads | None, creations: list[Creation]) -> None:
        """Concentrations of all materials, once the particles know their load curves."""
        from solver.diffusion.diffusion import Diffusion, new_solute

        section = self.spec.MaterialProperties.MPM
        if not self.flags.scalar_diffusion:
            return
        materials = self.spec.materials
        for interface in section.diffusion_interface:
            self._guard("UPS402", interface, partial(interface.check, len(materials)))
        for material in materials:
            if material.diffusion_model is None:
                message = "do_scalar_diffusion needs a <diffusion_model> in every material"
                raise ProblemError("UPS101", message, self.place(material), 'add <diffusion_model type="jg">')
        laws = [material.diffusion_model for material in materials]
        for body, creation, law in zip(simulation.bodies, creations, laws, strict=True):
            body.solute = new_solute(creation, law, simulation.grid)
        fluxes = loads.fluxes if loads is not None else []
        counted = [material.do_conc_reduction for material in materials]
        simulation.diffusion = Diffusion(laws, section.diffusion_interface, fluxes, counted)
        simulation.diffusion.attach(simulation)
