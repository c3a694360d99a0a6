"""The explicit material point method: bodies on a grid, and the time step.

The order of operations is Uintah's (see docs/architecture.md, "The step"). Reading and writing, progress and
restarts are the caller's: a simulation knows nothing of them.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.body import Body
from solver.boundary_conditions import BoundaryConditions
from solver.cohesive_zones import CohesiveZones
from solver.contact.law import ContactLaw, ContactScene
from solver.domains.communicator import largest_number
from solver.domains.exchange import Exchange, OneRank, Status
from solver.domains.reach import layers_reached
from solver.flags import Flags
from solver.grid import FACES, Grid, NodeBlock
from solver.interpolation.shape import Sums
from solver.jit.ahead import compile_ahead
from solver.jit.calls import Calls
from solver.kernels import nodes, settle, stress, transfer
from solver.kernels.chunks import number_of_chunks
from solver.kernels.transfer import CHANNELS, EXTERNAL_FORCE, GATHERED, MOTION_SUMS, Transfer
from solver.lanes import new_rows
from solver.materials.constitutive import (
    Neighbourhood,
    Step,
    couple_particles,
    initial_sound_speed,
    is_coupled,
    time_step_limit,
)
from solver.nodal import NodalFields, new_nodal_fields
from solver.nodal_stress import on_face, scatter_stress, side_of
from solver.performance.phases import Clock, Phase, no_clock
from solver.sorting import in_order_of_cells, wants_sorting
from solver.team import Team, node_blocks
from solver.workspace import Workspace

Array = NDArray[Any]

NODES_FOR_A_PARTICLE = 4
"""What a loop does for so many nodes takes as long as what one does for a particle."""

STEPS_BETWEEN_CUTS = 20
"""After so many steps the nodes are divided anew among threads."""


class DivergedError(RuntimeError):
    """A value that is not a finite number turned up; the message names the material and the step."""


class NodesTooFastError(RuntimeError):
    """A node would cross more than half a cell; nothing has moved yet, so the step can be repeated with less."""


@dataclass
class Simulation:
    """Bodies, grid and everything that moves them; :meth:`advance` makes one time step.

    Attributes
    ----------
    reductions : (label, material or -1) -> value of the last step, e.g. ("KineticEnergy", -1).
    face_forces : force of the last step on each face of ``boundary_traction_faces``; contact laws go by it, so a
        checkpoint has to keep it.
    before_step : calls made at the start of each step with (simulation, dt), in order: external loads.
    after_contact : calls made once contact has acted on the projected velocities: forces between bodies.
    after_boundary_conditions : calls made once v* and a are known: prescribed motion.
    after_step : calls made before particles are sorted out: inserted particles.
    time_step_limits : functions of the time that bound the step from there.
    diffusion : the diffusion of a substance, which hooks let act; None without.
    exchange : the other ranks; by default there are none.
    spread_corner_loads : adds external forces by particle corners (CBDI), in place of particle weights.
    whole_grid : nodes that no particle touches take part too, for those who look at nodal values afterwards.
    team : the threads that share the loops over particles; the results do not depend on how many they are.
    cohesive_zones : those of each file, in the deck's order; hooks make them act.
    clock : told the phase of the step that begins, for those who want to know where time goes.
    """

    grid: Grid
    bodies: list[Body]
    interpolator: Any
    flags: Flags
    gravity: tuple[float, float, float]
    boundary_conditions: BoundaryConditions
    contact_laws: Sequence[ContactLaw] = ()
    thermal_contact: bool = False
    before_step: list[Callable[[Simulation, float], None]] = field(default_factory=list)
    after_contact: list[Callable[[Simulation, float], None]] = field(default_factory=list)
    after_boundary_conditions: list[Callable[[Simulation, float], None]] = field(default_factory=list)
    after_step: list[Callable[[Simulation, float], None]] = field(default_factory=list)
    time_step_limits: list[Callable[[float], float]] = field(default_factory=list)
    spread_corner_loads: Callable[[Body, Array], None] | None = None
    whole_grid: bool = False
    team: Team = field(default_factory=Team)
    cohesive_zones: list[CohesiveZones] = field(default_factory=list)
    diffusion: Any = None
    clock: Clock = no_clock
    time: float = 0.0
    step_number: int = 0
    reductions: dict[tuple[str, int], Any] = field(default_factory=dict)
    exchange: Exchange = None  # type: ignore[assignment]  # made from the grid where it is not given

    def __post_init__(self) -> None:
        """Make the arrays that live as long as the simulation, so that steps allocate nothing large."""
        if self.exchange is None:
            self.exchange = OneRank(self.grid)
        self.face_forces: dict[str, tuple[float, float, float]] = {}
        self._fault = ""
        self._call = Calls()
        self._calls_of = [Calls() for _ in self.bodies]
        self._agreed_reach: int | None = None
        self._kinematics = stress.Kinematics(
            self.flags.minimum_subcycles_for_F, self.flags.pressure_stabilization
        )
        self._lay_out()

    def _lay_out(self) -> None:
        """Make the arrays of the nodes and cells that this rank holds."""
        count = self.grid.number_of_nodes
        self.nodal: NodalFields = new_nodal_fields(self.grid, len(self.bodies))
        buffers = max(1, min(self.exchange.buffers, len(self.bodies)))
        self._rows = [new_rows(count, CHANNELS) for _ in range(buffers)]
        self._touched = np.zeros((len(self.bodies), -(-count // 8) * 8), dtype=np.uint8)
        self._node_lists = [list(np.zeros((2, count), dtype=np.uintp)) for _ in self.bodies]
        self._active = [listed[:0] for listed, _ in self._node_lists]
        self._fields = [self.nodal.of(m) for m in range(len(self.bodies))]
        self._gathered = new_rows(count, GATHERED)
        self._blocks: dict[int, tuple[int, int, list[NodeBlock]]] = {}
        self._temperature_star = np.zeros((len(self.bodies), count))
        self._projected_temperature = np.zeros((len(self.bodies), count))
        self._inner_nodes = self.grid.inner_nodes()
        self._workspace = Workspace()
        self._owned_nodes = self.grid.owned_nodes()
        owned = self.grid.owned_cells()
        self._space = settle.Space(
            self.grid.index,
            self.grid.cells,
            self.grid.periodic,
            owned,
            bool(owned.all()),
            self.flags.minimum_particle_mass,
        )
        self._uncounted = ~self.exchange.counted
        self.face_nodes = {
            name: np.flatnonzero(on_face(self.grid, side_of(name)) & self.exchange.counted)
            for name in self.flags.boundary_traction_faces
        }
        self.node_positions = self.grid.node_positions()
        self._weight = self.boundary_conditions.node_to_cell_weight()
        low, high = self.grid.own_cells
        self._cell_stretch = np.zeros(math.prod(b - a for a, b in zip(low, high, strict=True)))

    # ---- the time step -------------------------------------------------------------------------------------

    def compile_ahead(self, processes: int) -> None:
        """Have so many processes compile the kernels of the stress update, which the first step needs last."""
        step = self.constants_of_step(0.0)
        loops = [self._stress_loop(body, self._particle_cells(body), step) for body in self.bodies]
        compile_ahead([job for loop in loops for job in stress.kernels_of(loop)], processes)

    def initial_time_step(self) -> float:
        """The stable first step, from the models' initial wave speeds."""
        stable = min((self.initial_limit(body) for body in self.bodies), default=math.inf)
        return self._bounded(-largest_number(self.exchange.communicator, -stable))

    def _bounded(self, stable: float) -> float:
        return min([stable, *(limit(self.time) for limit in self.time_step_limits)])

    def initial_limit(self, body: Body) -> float:
        """The stable first step of a body's particles on this rank."""
        particles = body.particles
        speed = initial_sound_speed(body.model, particles.mass / particles.volume, particles.temperature)
        waves = settle.initial_wave_speed(
            particles.velocity, np.broadcast_to(speed, particles.mass.shape).copy()
        )
        return self._limit(body, waves)

    def _limit(self, body: Body, wave_speed: tuple[float, float, float]) -> float:
        crossing = min(h / w for h, w in zip(self.grid.spacing, wave_speed, strict=True))
        return min(crossing, time_step_limit(body.model))

    def advance(self, dt: float) -> float:
        """Make one time step and return the stable size of the next.

        Raises
        ------
        DivergedError
            when a stress or position is no longer a finite number.
        NodesTooFastError
            when the flags ask for it and a node is too fast for this step; the particles are as they were.
        """
        self.reductions.clear()
        self.clock(Phase.EXCHANGE)
        self.balance()
        self.clock(Phase.SORT)
        self._sort()
        self.clock(Phase.LOADS)
        for action in self.before_step:
            action(self, dt)
        self._project_all()
        scene = self._scene(dt)
        self.clock(Phase.CONTACT)
        for law in self.contact_laws:
            law.apply(1, scene)
        self.clock(Phase.GRID)
        for action in self.after_contact:
            action(self, dt)
        self._record_traction()
        self._symmetric_forces()
        for m, body in enumerate(self.bodies):
            self._accelerate(m, body, dt)
        if self.flags.restart_on_large_nodal_velocity and self.too_fast(dt):
            self.clock(Phase.OUTSIDE)
            raise NodesTooFastError(f"step {self.step_number + 1}: a node would cross half a cell in {dt:g}")
        self.clock(Phase.CONTACT)
        for law in self.contact_laws:
            law.apply(2, scene)
        self.clock(Phase.GRID)
        self._impose_velocities(dt)
        for action in self.after_boundary_conditions:
            action(self, dt)
        if self.flags.explicit_heat_conduction:
            self._conduct_heat(dt)
        self._repeat_images()
        stable = math.inf
        for m, body in enumerate(self.bodies):
            cells = self._particle_cells(body)
            neighbourhood = self._neighbourhood(body, dt)
            self._move(m, body, dt)
            stable = min(stable, self._update_stress(m, body, cells, dt))
            if neighbourhood is not None:
                change = couple_particles(body.model, body.state, body.particles, neighbourhood)
                for material in (body.index, -1):
                    self.reductions["StrainEnergy", material] += change
        for key, value in scene.reductions.items():
            self.reductions[key] = self.reductions.get(key, 0.0) + value
        self.clock(Phase.LOADS)
        for action in self.after_step:
            action(self, dt)
        self.clock(Phase.SETTLE)
        for body in self.bodies:
            self._settle(body)
        self.clock(Phase.EXCHANGE)
        self.exchange.migrate(self.materials)
        stable = self._conclude(stable)
        self.time += dt
        self.step_number += 1
        self.clock(Phase.OUTSIDE)
        return self._bounded(stable)

    @property
    def materials(self) -> Sequence[Body | CohesiveZones]:
        """All that has ``records`` of arrays with a row for each place: the bodies, and after them the zones."""
        return [*self.bodies, *self.cohesive_zones]

    def _reach(self) -> int:
        """Layers of cells around this rank's own that its particles reach."""
        if self.exchange.communicator.size == 1:
            return 0
        on_corners = self.spread_corner_loads is not None
        return layers_reached(self.interpolator, self.bodies, self.grid.spacing, on_corners)

    def _conclude(self, stable: float) -> float:
        """Let all ranks agree on sums and on the stable step, and this one on what it holds from now on."""
        status = self.exchange.conclude(Status(stable, self._reach(), bool(self._fault)), self.reductions)
        for name in self.flags.boundary_traction_faces:
            x, y, z = self.reductions["BndyForce_" + name, -1].tolist()
            self.face_forces[name] = (x, y, z)
        if status.fault:
            faults = self.exchange.communicator.allgather(self._fault)
            raise DivergedError(next(fault for fault in faults if fault))
        self.exchange.deliver(self.materials)
        self._agreed_reach = status.reach
        return status.stable

    def balance(self) -> None:
        """Let the ranks share out the particles evenly, and hold all nodes that these reach.

        Done at the start of steps, so that nodal values of the step before can still be written.
        """
        if self._agreed_reach is None:
            self._agreed_reach = int(largest_number(self.exchange.communicator, self._reach()))
        grid = self.exchange.new_grid(self._agreed_reach, self.materials, self.step_number)
        if grid is not None:
            self.grid = grid
            self.boundary_conditions = self.boundary_conditions.on(grid)
            self._lay_out()

    def _sort(self) -> None:
        """Bring the particles of a body that has mixed into the order of their cells."""
        for body in self.bodies:
            position = body.particles.position
            if wants_sorting(self.grid, position, self.step_number):
                body.keep(in_order_of_cells(self.grid, position))

    # ---- particles to grid ---------------------------------------------------------------------------------

    def _transfer(self, body: Body) -> Transfer:
        conducts = self.flags.explicit_heat_conduction
        return Transfer(
            axisymmetric=self.flags.axisymmetric,
            rigid=body.rigid,
            spread_loads=self.spread_corner_loads is None,
            conductivity=body.material.thermal_conductivity / body.material.specific_heat
            if conducts
            else 0.0,
            specific_heat=body.material.specific_heat,
        )

    def _project_all(self) -> None:
        """Project all bodies; the sums of one are on their way to other ranks while the next is projected."""
        self.clock(Phase.GRID)
        for m, active in enumerate(self._active):
            self._over_nodes(active, nodes.untouch, self._touched[m])
        were_active = list(self._active)
        on_their_way: deque[tuple[int, Callable[[], None]]] = deque()
        for m, body in enumerate(self.bodies):
            if len(on_their_way) == len(self._rows):
                self._arrive(*on_their_way.popleft())
            self._project(m, body)
            sums = self._sums_of(m)
            on_their_way.append((m, self.exchange.add(sums.rows, touched=sums.touched)))
        for arriving in on_their_way:
            self._arrive(*arriving)
        if self.contact_laws and len(self.bodies) > 1:
            for active in were_active:
                self._over_nodes(active, nodes.forget_motion, self._touched, self.nodal)

    def _project(self, m: int, body: Body) -> None:
        """Sums over the particles of a body at the nodes: mass, momentum, forces, volume and heat."""
        rows, touched = self._sums_of(m)
        self.clock(Phase.TO_GRID)
        takes_part = body.takes_part(self.time)
        if self.whole_grid or not takes_part:  # particles that wait feel gravity, at nodes without mass
            touched[:] = 1
        if takes_part:
            self._scatter(m, body)
            if self.flags.gradient_enhanced_projection:
                transfer.add_gradients(self.interpolator, self.grid.index, body.particles, rows)
            if self.spread_corner_loads is not None:
                loads = rows[:, EXTERNAL_FORCE]
                self.spread_corner_loads(body, loads)
                touched[: len(loads)] |= loads.any(axis=1)

    def _arrive(self, m: int, finish: Callable[[], None]) -> None:
        """Velocity, forces and temperature of a body from its sums, with the conditions on symmetry faces."""
        self.clock(Phase.EXCHANGE)
        finish()
        self.clock(Phase.GRID)
        nodal, (rows, touched) = self.nodal, self._sums_of(m)
        self._node_lists[m].reverse()  # the last step's is needed once more
        listed = self._node_lists[m][0]
        count = self._call(nodes.list_touched, touched, touched.view(np.uint64), listed)
        self._over_nodes(self._active[m], nodes.forget, touched, self._fields[m])
        self._active[m] = listed[:count]
        projected = self._projected_temperature[m]
        self._over_nodes(self._active[m], nodes.normalise, rows, self._fields[m], projected)
        self.boundary_conditions.apply_temperature(nodal.temperature[m], m, touched)
        self.boundary_conditions.apply_symmetry(nodal.velocity[m], m, touched)

    def _scatter(self, m: int, body: Body) -> None:
        """Sum what the particles of a body carry at the nodes; each thread fills its own block of nodes."""
        options, index, sums = self._transfer(body), self.grid.index, self._sums_of(m)

        def fill(block: NodeBlock) -> None:
            self._call(
                transfer.particles_to_grid, self.interpolator, index, block, body.particles, options, sums
            )

        self.team.run([partial(fill, block) for block in self._node_blocks(m, body)])

    def _sums_of(self, m: int) -> Sums:
        return Sums(self._rows[m % len(self._rows)], self._touched[m])

    def _node_blocks(self, m: int, body: Body) -> list[NodeBlock]:
        """The blocks of nodes that threads fill, cut anew as particles move."""
        count = len(body.particles)
        made, particles, blocks = self._blocks.get(m, (0, -1, []))
        if particles != count or self.step_number - made >= STEPS_BETWEEN_CUTS:
            blocks = node_blocks(self.grid, body.particles.position, self.team.size_for(count))
            self._blocks[m] = self.step_number, count, blocks
        return blocks

    def _over_nodes(self, active: Array, work: Callable[..., None], *values: Any) -> None:
        """Call ``work(nodes, *values)`` for the listed nodes, a part in each thread."""
        members = self.team.size_for(len(active) // NODES_FOR_A_PARTICLE)
        self.team.share(
            len(active), members, lambda first, last: self._call(work, active[first:last], *values)
        )

    def _in_chunks(self, count: int, work: Callable[[int, int, Array], None]) -> Array:
        """Call ``work(first, last, sums)`` for chunks of particles or nodes; the sums (chunks, ..) that it stores."""
        chunks = number_of_chunks(count)
        sums = self._workspace.rows("sums of chunks", chunks, np.float64, MOTION_SUMS)
        self.team.share(chunks, self.team.size_for(count), lambda first, last: work(first, last, sums))
        return sums

    def complete(self, m: int, sums: Array) -> None:
        """Add to nodal sums (N, components) of a body, in place, what nodes hold that are one and the same."""
        self.exchange.add(sums)()

    def share(self, m: int, field: Array) -> None:
        """Give nodes that are one and the same the value (N,) of the one on which conditions act, in place."""
        self.exchange.repeat(field, self._touched[m])

    def _repeat_images(self) -> None:
        """Periodic directions: image nodes follow their owners, on which contact and conditions acted."""
        nodal = self.nodal
        for m in range(len(self.bodies)):
            vectors = (nodal.velocity[m], nodal.velocity_star[m], nodal.acceleration[m])
            for values in (*vectors, nodal.temperature_rate[m], self._temperature_star[m]):
                self.exchange.repeat(values, self._touched[m])

    def _symmetric_forces(self) -> None:
        for m, body in enumerate(self.bodies):
            if not body.rigid:
                self.boundary_conditions.apply_symmetry(self.nodal.internal_force[m], m, self._touched[m])

    def _scene(self, dt: float) -> ContactScene:
        return ContactScene(
            grid=self.grid,
            nodal=self.nodal,
            particles=[body.particles for body in self.bodies],
            rigid=[body.rigid for body in self.bodies],
            axisymmetric=self.flags.axisymmetric,
            possible_alpha=[body.possible_alpha for body in self.bodies],
            colinear_normals=self.flags.colinear_normals,
            xpic2=self.flags.XPIC2,
            interpolation=self.interpolator,
            node_to_cell_weight=self._weight,
            boundary_conditions=self.boundary_conditions,
            owned_nodes=self._owned_nodes,
            exchange=self.exchange,
            dt=dt,
            time=self.time,
            face_forces=dict(self.face_forces),
            node_positions=self.node_positions,
            workspace=self._workspace,
            call=self._call,
        )

    def stress_at_nodes(self, m: int, stress: Array) -> None:
        """Enter the stress of a body at the nodes, sum_p V_p sigma_p S_ip / V_i, (N, 3, 3); zero for a rigid body.

        To be called before particles move, as ``after_boundary_conditions`` are.
        """
        body = self.bodies[m]
        stress[:] = 0.0
        if body.rigid or not body.takes_part(self.time):
            return
        sums = stress.reshape(-1, 9)
        scatter_stress(self.interpolator, self.grid.index, body.particles, sums)
        self.exchange.add(sums)()
        for component in sums.T:
            component /= self.nodal.volume[m]

    # ---- on the grid ---------------------------------------------------------------------------------------

    def _accelerate(self, m: int, body: Body, dt: float) -> None:
        nodal, active, fields = self.nodal, self._active[m], self._fields[m]
        motion = nodes.Motion(
            self.gravity, self.flags.artificial_damping_coeff, self.flags.minimum_mass_for_acc
        )
        accelerate = partial(self._call, nodes.accelerate, active, fields, motion, dt, self._uncounted)
        mass, *force = self._in_chunks(len(active), accelerate)[:, :4].sum(axis=0)
        if body.transmits_force:
            nodal.acceleration[m] = 0.0
            nodal.velocity_star[m] = nodal.velocity[m]
        self._add("TotalMass", body, mass)
        self._add("SumTransmittedForce", body, np.array(force))

    def too_fast(self, dt: float) -> bool:
        """Whether a node inside the domain would cross half a cell in the last step's dt."""
        half = 0.25 * sum(h * h for h in self.grid.spacing)
        fastest = max(
            nodes.fastest_node(active, v, self._inner_nodes)
            for active, v in zip(self._active, self.nodal.velocity_star, strict=True)
        )
        return largest_number(self.exchange.communicator, fastest) * dt * dt > half

    def _impose_velocities(self, dt: float) -> None:
        """Conditions on v*, from which the acceleration follows anew at every node."""
        nodal = self.nodal
        for m in range(len(self.bodies)):
            self.boundary_conditions.apply_velocity(nodal.velocity_star[m], m, self._touched[m])
            self.boundary_conditions.apply_symmetry(nodal.velocity_star[m], m, self._touched[m])
            vectors = nodal.velocity_star[m], nodal.velocity[m], dt, nodal.acceleration[m]
            self._over_nodes(self._active[m], nodes.rate_of_change, *vectors)

    def _conduct_heat(self, dt: float) -> None:
        """Temperature rates at the nodes: conduction, sources, contact and the conditions on faces."""
        nodal = self.nodal
        if self.thermal_contact:
            nodal.temperature_rate[:] = 0.0
            capacity = np.array([body.material.specific_heat for body in self.bodies])
            nodes.exchange_heat(nodal.mass, nodal.temperature, capacity, dt, nodal.temperature_rate)
        for m, body in enumerate(self.bodies):
            star = self._temperature_star[m]
            if not body.takes_part(self.time):
                star[:] = nodal.temperature_rate[m] = 0.0
                continue
            self._over_nodes(self._active[m], nodes.warm_up, self._fields[m], dt, star)
            self.boundary_conditions.apply_temperature(star, m, self._touched[m])
            numbers = star, self._projected_temperature[m], dt, nodal.temperature_rate[m]
            self._over_nodes(self._active[m], nodes.rate_of_numbers, *numbers)

    # ---- grid to particles ---------------------------------------------------------------------------------

    def _move(self, m: int, body: Body, dt: float) -> None:
        particles = body.particles
        self.clock(Phase.TO_PARTICLES)
        filtered = self._filter(m, body) if self.flags.XPIC2 and not body.rigid else None
        self.clock(Phase.GRID)
        star = self._temperature_star[m]
        self._over_nodes(self._active[m], nodes.interleave, self._fields[m], star, self._gathered)
        options, index = self._transfer(body), self.grid.index

        def move(first: int, last: int, sums: Array) -> None:
            self._call(
                transfer.grid_to_particles,
                self.interpolator,
                index,
                particles,
                options,
                self._gathered,
                filtered is not None,
                particles.velocity if filtered is None else filtered,
                self._sums_of(m).rows,
                dt,
                first,
                last,
                sums,
            )

        self.clock(Phase.TO_PARTICLES)
        motion = transfer.total(self._in_chunks(len(particles), move))
        if filtered is not None:
            nodes.clear(self._active[m], self._sums_of(m).rows)
        self._add("KineticEnergy", body, motion.kinetic_energy)
        self._add("ThermalEnergy", body, motion.thermal_energy)
        self._add("TotalMomentum", body, np.array(motion.momentum))
        self._add("CenterOfMassPosition", body, np.array(motion.mass_position))

    def _filter(self, m: int, body: Body) -> Array:
        """XPIC(2): velocities S v of the particles (n, 3); leaves S+ S v at the nodes in the first of the sums."""
        nodal, filtered = self.nodal, self._workspace.rows("filtered", len(body.particles), np.float64, 3)
        self._gathered[:, :3] = nodal.velocity[m]
        sums = self._sums_of(m)
        transfer.smooth_velocity(
            self.interpolator, self.grid.index, body.particles, self._gathered, filtered, sums
        )
        self.exchange.add(sums.rows)()
        nodes.divide_by_mass(self._active[m], sums.rows, nodal.mass[m])
        return filtered

    def _update_stress(self, m: int, body: Body, cells: Array, dt: float) -> float:
        self.clock(Phase.STRESS)
        step = self.constants_of_step(dt)
        if self.flags.pressure_stabilization:
            self._average_dilatation(body, cells, dt)
        loop = self._stress_loop(body, cells, step)
        update = partial(stress.update_stresses, loop, call=self._calls_of[m])
        stressed = stress.total(self._in_chunks(len(body.particles), update))
        if not stressed.finite and not self._fault:
            self._fault = (
                f"material {body.index} ({body.name}) has a stress or position that is not a finite number "
                f"after step {self.step_number + 1} at time {self.time + dt:g}"
            )
        self._add("StrainEnergy", body, stressed.strain_energy)
        self._add("TotalVolumeDeformed", body, stressed.volume)
        return self._limit(body, stressed.wave_speed)

    def _stress_loop(self, body: Body, cells: Array, step: Step) -> stress.StressLoop:
        return stress.StressLoop(
            body.numeric_model,
            body.state,
            body.failure,
            body.particles,
            body.material,
            step,
            self._kinematics,
            cells,
            self._cell_stretch,
        )

    def _neighbourhood(self, body: Body, dt: float) -> Neighbourhood | None:
        """Where the particles lie at the start of the step, for a model whose particles feel each other."""
        if not is_coupled(body.model):
            return None
        grid = self.grid
        position = self._workspace.rows("position before", len(body.particles), np.float64, 3)
        position[:] = body.particles.position
        repeats = [
            n if p and grid.window is None else 0 for n, p in zip(grid.cells, grid.periodic, strict=True)
        ]
        return Neighbourhood(
            interpolator=self.interpolator,
            grid=grid.index,
            position=position,
            dt=dt,
            repeats=(repeats[0], repeats[1], repeats[2]),
            complete=lambda sums: self.exchange.add(sums)(),
            largest=self.exchange.communicator.largest,
        )

    def constants_of_step(self, dt: float) -> Step:
        """What the stress updates of a step of ``dt`` from now on know of it."""
        flags = self.flags
        heating = flags.artificial_viscosity_heating
        return Step(
            dt=dt,
            time=self.time,
            length=sum(self.grid.spacing) / 3.0,
            artificial_viscosity=flags.artificial_viscosity,
            viscosity_linear=flags.artificial_viscosity_coeff1,
            viscosity_quadratic=flags.artificial_viscosity_coeff2,
            viscosity_heating=flags.artificial_viscosity if heating is None else heating,
        )

    def _particle_cells(self, body: Body) -> Array:
        """Cells of the particles at the start of the step, x fastest in this rank's, where pressure is stabilized."""
        if not self.flags.pressure_stabilization:
            return np.zeros(0, dtype=np.int64)
        cells = self._workspace.rows("cells of particles", len(body.particles), np.int64)
        stress.particle_cells(
            body.particles.position, self.grid.anchor, self.grid.spacing, self.grid.own_cells, cells
        )
        return cells

    def _average_dilatation(self, body: Body, cells: Array, dt: float) -> None:
        """The volume change of each cell as a whole, for pressure stabilization."""
        count = len(self._cell_stretch)
        volume = self._workspace.rows("volume in cells", count, np.float64)
        reference = self._workspace.rows("reference volume in cells", count, np.float64)
        stress.cell_dilatation(body.particles, cells, self._kinematics, dt, volume, reference)
        filled = np.greater(reference, 0.0, out=self._workspace.rows("filled cells", count, np.bool_))
        np.divide(volume, reference, out=self._cell_stretch, where=filled)

    def _settle(self, body: Body) -> None:
        count = len(body.particles)
        kept = self._workspace.rows("kept", count, np.bool_)
        work = partial(self._call, settle.settle, body.particles, self._space, kept)
        if self._in_chunks(count, work)[:, 0].any():
            body.keep(kept)

    # ---- sums ----------------------------------------------------------------------------------------------

    def _add(self, label: str, body: Body, value: Any) -> None:
        """Record a sum of one body, and add it to the sum of all (material -1)."""
        self.reductions[label, body.index] = value
        self.reductions[label, -1] = self.reductions.get((label, -1), 0.0) + value

    def _record_traction(self) -> None:
        """Force, traction and contact area on the faces that the deck names, before symmetry is imposed."""
        for name in self.flags.boundary_traction_faces:
            force, volume = np.zeros(3), 0.0
            chosen = self.face_nodes[name]
            for m, body in enumerate(self.bodies):
                if not body.rigid and body.takes_part(self.time):
                    force -= self.nodal.internal_force[m][chosen].sum(axis=0)
                volume += float(self.nodal.volume[m][chosen].sum())
            self.reductions["BndyForce_" + name, -1] = force
            axis = FACES.index(side_of(name)) // 2
            self.reductions["BndyContactCellArea_" + name, -1] = 2.0 * volume / self.grid.spacing[axis]
