"""One material point along a prescribed path: what a constitutive model answers, without a grid.

The point is updated by the same ``stress_update`` that a simulation calls, so what is seen here is what a run
does at one particle: no artificial viscosity, no conduction of heat, no inertia.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.jit import kernel
from solver.materials.constitutive import (
    DELETE,
    Material,
    Point,
    Step,
    initialize,
    state_record,
    stress_update,
    time_step_limit,
)
from solver.particles import Particles, new_arrays, state_variables
from solver.tensor import determinant, put_tensor, tensor_at

Array = NDArray[np.float64]

PROBE = 1.0e-7
"""Logarithmic strain by which a free stretch is probed for the stiffness against it."""
STRESS_TOLERANCE = 1.0e-8
"""Stress that may remain across free directions, as a fraction of the largest stress of the point."""
STRAIN_TOLERANCE = 1.0e-13
"""The same as a strain of the stiffest free direction, for points almost without stress."""
MOST_ITERATIONS = 20
LARGEST_STRAIN_STEP = 0.5
"""Largest change of a free logarithmic strain in one iteration."""
MOST_BISECTIONS = 60


class PointDriverError(ValueError):
    """A path that the material cannot follow; the message names the step."""


@dataclass(frozen=True)
class Path:
    """A deformation to be followed.

    Attributes
    ----------
    time : (n + 1,), s, from 0.
    strain : (n + 1,) the measure that the path prescribes: logarithmic strain along x, engineering shear, or
        logarithmic change of volume.
    deformation_gradient : (n + 1, 3, 3), the identity at the start; where directions are free, without them.
    free_axes : axes whose stretch is found so that the normal stress across them vanishes.
    strain_name : what ``strain`` is, for labels.
    """

    time: Array
    strain: Array
    deformation_gradient: Array
    free_axes: tuple[int, ...] = ()
    strain_name: str = "true strain"


@dataclass(frozen=True)
class PointHistory:
    """What the point went through, at the n + 1 times of its path.

    Attributes
    ----------
    time : s. strain : the path's measure (see ``Path``). temperature : K. All (n + 1,).
    deformation_gradient, stress : (n + 1, 3, 3); Cauchy stress in Pa, positive in tension.
    localized : (n + 1,), 0 where the material is sound.
    state : Uintah's label -> the model's own variable, (n + 1,) or (n + 1, 3, 3), if labelled.
    strain_name : what ``strain`` is.
    """

    time: Array
    strain: Array
    temperature: Array
    deformation_gradient: Array
    stress: Array
    localized: NDArray[np.int64]
    state: dict[str, NDArray[Any]]
    strain_name: str = "true strain"

    @property
    def pressure(self) -> Array:
        """Minus a third of the trace of the stress, (n + 1,), Pa."""
        return -np.trace(self.stress, axis1=1, axis2=2) / 3.0

    @property
    def equivalent_stress(self) -> Array:
        """Von Mises's sqrt(3/2) |dev sigma|, (n + 1,), Pa."""
        deviator = self.stress + self.pressure[:, None, None] * np.eye(3)
        return np.sqrt(1.5 * np.einsum("nij,nij->n", deviator, deviator))

    @property
    def plastic_strain(self) -> Array | None:
        """Equivalent plastic strain (n + 1,), or None where the model has none."""
        return self.state.get("p.plasticStrain")


# ---- paths -------------------------------------------------------------------------------------------------

Strains = float | Sequence[float]
"""The strain at the end, or those at which a path turns, one after the other: (0.2, 0) unloads, (0.01, -0.01, 0) is a
closed cycle."""


def uniaxial(strain: Strains, rate: float, steps: int, *, free: bool) -> Path:
    """Stretch along x by logarithmic strains; y and z keep their length, or are ``free`` of stress."""
    time, strains = _ramp(strain, rate, steps)
    F = np.tile(np.eye(3), (steps + 1, 1, 1))
    F[:, 0, 0] = np.exp(strains)
    return Path(time, strains, F, free_axes=(1, 2) if free else ())


def simple_shear(strain: Strains, rate: float, steps: int) -> Path:
    """Shear of planes normal to y along x: F = I + gamma e_x e_y."""
    time, strains = _ramp(strain, rate, steps)
    F = np.tile(np.eye(3), (steps + 1, 1, 1))
    F[:, 0, 1] = strains
    return Path(time, strains, F, strain_name="engineering shear strain")


def hydrostatic(strain: Strains, rate: float, steps: int) -> Path:
    """Equal stretch in all directions: J = exp(strain)."""
    time, strains = _ramp(strain, rate, steps)
    F = np.exp(strains / 3.0)[:, None, None] * np.eye(3)
    return Path(time, strains, F, strain_name="logarithmic volume strain")


def tabulated(time: Array, deformation_gradient: Array, steps: int) -> Path:
    """Deformation gradients (m, 3, 3) at times (m,), straight between them, in ``steps`` equal steps of time.

    Raises
    ------
    PointDriverError
        where times do not increase, there are less than two, the first gradient is not the identity (to
        1e-9), or a gradient does not have a positive determinant.
    """
    times, gradients = np.asarray(time, float), np.asarray(deformation_gradient, float)
    _positive(steps, "number of steps")
    if len(times) < 2 or np.any(np.diff(times) <= 0.0):
        raise PointDriverError("a table of deformation needs two rows or more, with increasing times")
    if not np.allclose(gradients[0], np.eye(3), atol=1.0e-9):
        raise PointDriverError("the first deformation gradient of a table is the identity")
    if np.any(np.linalg.det(gradients) <= 0.0):
        row = int(np.argmax(np.linalg.det(gradients) <= 0.0)) + 1
        raise PointDriverError(f"row {row} of the table: det F is not positive")
    fine = np.linspace(times[0], times[-1], steps + 1)
    flat = gradients.reshape(-1, 9)
    F = np.stack([np.interp(fine, times, column) for column in flat.T], axis=1).reshape(-1, 3, 3)
    stretch = np.linalg.norm(F[:, :, 0], axis=1)
    return Path(fine - fine[0], np.log(stretch), F, strain_name="true strain along x")


def _ramp(strain: Strains, rate: float, steps: int) -> tuple[Array, Array]:
    """Times and strains of a constant rate from turn to turn, each of which is the end of a step."""
    _positive(steps, "number of steps")
    turns = np.concatenate([[0.0], np.atleast_1d(np.asarray(strain, float))])
    legs = np.abs(np.diff(turns))
    _positive(float(len(legs)), "number of strains")
    for leg in legs:
        _positive(leg, "strain between two turns")
    _positive(abs(rate), "strain rate")
    if steps < len(legs):
        raise PointDriverError(f"{len(legs)} turns of the path need as many steps, not {steps}")
    ends = np.concatenate([[0.0], np.cumsum(legs)])
    at_turn = np.rint(steps * ends / ends[-1])
    for n in range(1, len(at_turn)):
        at_turn[n] = max(at_turn[n], at_turn[n - 1] + 1)
    at_turn[-1] = steps
    for n in range(len(at_turn) - 2, 0, -1):
        at_turn[n] = min(at_turn[n], at_turn[n + 1] - 1)
    path = np.interp(np.arange(steps + 1), at_turn, ends)
    return path / abs(rate), np.interp(path, ends, turns)


def _positive(value: float, name: str) -> None:
    if not (math.isfinite(value) and value > 0.0):
        raise PointDriverError(f"the {name} must be finite and not 0")


PATHS: dict[str, Callable[[Strains, float, int], Path]] = {
    "uniaxial-strain": lambda strain, rate, steps: uniaxial(strain, rate, steps, free=False),
    "uniaxial-stress": lambda strain, rate, steps: uniaxial(strain, rate, steps, free=True),
    "simple-shear": simple_shear,
    "hydrostatic": hydrostatic,
}
"""Paths of constant rate by name: (strain or turns, rate in 1/s, steps) -> path."""


# ---- the point ---------------------------------------------------------------------------------------------


class Trials(NamedTuple):
    """Copies of the point that a step tries side by side; arrays of m copies."""

    stress: Any
    """(m, 3, 3), at the start of the step; overwritten with the stress at its end."""
    old_gradient: Any
    gradient: Any
    velocity_gradient: Any
    """(m, 3, 3) deformation gradients at the start and end of the step, velocity gradient in it."""
    temperature: Any
    """(m, 2), at the start of the step and of the step before."""
    localized: Any
    heating_rate: Any
    """(m,)."""


@kernel
def update_trials(model: Any, state: Any, trials: Trials, material: Material, step: Step) -> None:
    """Stress update of every copy; the state arrays of the model are updated too."""
    for p in range(trials.localized.shape[0]):
        F_old, F = tensor_at(trials.old_gradient, p), tensor_at(trials.gradient, p)
        volume_old, volume = determinant(F_old), determinant(F)
        point = Point(
            tensor_at(trials.stress, p),
            F_old,
            F,
            tensor_at(trials.velocity_gradient, p),
            volume_old,
            volume,
            material.density,
            trials.temperature[p, 0],
            trials.temperature[p, 1],
            trials.localized[p],
        )
        new = stress_update(model, state, p, point, material, step)
        put_tensor(trials.stress, p, new.stress)
        trials.heating_rate[p] = new.heating_rate
        trials.localized[p] = new.localized


@dataclass
class _Answer:
    """The point after a step, as one of the copies that were tried has it."""

    gradient: Array
    stress: Array
    heating_rate: float
    localized: int
    state: list[NDArray[Any]]


class _Driver:
    """A point, and the step that takes it to the next deformation gradient of its path."""

    def __init__(
        self, model: Any, material: Material, temperature: float, free_axes: tuple[int, ...]
    ) -> None:
        self.model, self.material, self.free_axes = model, material, free_axes
        count = 1 + len(free_axes)
        particles: Particles = new_arrays(Particles, count)
        particles.mass[:], particles.volume[:] = material.density, 1.0
        particles.temperature[:] = particles.previous_temperature[:] = temperature
        record: Any = state_record(model)
        self.trial_state = new_arrays(record, count)
        if type(model) in initialize.registry:
            initialize(model, self.trial_state, particles, material, np.zeros(count, np.int64))
        self.labels = {v.label: i for i, v in enumerate(state_variables(record).values()) if v.label}
        self.temperature = self.previous_temperature = temperature
        self.initial_gradient: Array = particles.deformation_gradient[0].copy()
        self.gradient = self.initial_gradient
        self.stress: Array = particles.stress[0].copy()
        self.localized = int(particles.localized[0])
        self.state = [array[0].copy() for array in self.trial_state]
        self.free_strain = np.zeros(len(free_axes))
        self.free_change = np.zeros(len(free_axes))
        self.time = 0.0

    def advance(self, prescribed: Array, dt: float, isothermal: bool) -> None:
        """One step to the prescribed deformation gradient, or PointDriverError where it cannot be made."""
        prescribed = prescribed @ self.initial_gradient
        answer = self._free_of_stress(prescribed, dt) if self.free_axes else self._try([prescribed], dt)[0]
        if answer.localized == DELETE:
            raise PointDriverError("the material gives the point up: failed, or its volume is out of bounds")
        if not np.isfinite(answer.stress).all():
            raise PointDriverError("the stress is not a finite number")
        self.gradient, self.stress, self.state = answer.gradient, answer.stress, answer.state
        self.localized = answer.localized
        self.previous_temperature = self.temperature
        if not isothermal:
            self.temperature += answer.heating_rate * dt
        self.time += dt

    def _free_of_stress(self, prescribed: Array, dt: float) -> _Answer:
        """Newton's iteration for the free stretches, with the stiffness by differences."""
        axes = list(self.free_axes)
        before = self.free_strain
        strain = before + self.free_change
        for _ in range(MOST_ITERATIONS):
            probes = [strain, *(strain + PROBE * unit for unit in np.eye(len(axes)))]
            answers = self._try([self._stretched(prescribed, probe) for probe in probes], dt)
            stresses = np.array([answer.stress[axes, axes] for answer in answers])
            residual, stiffness = stresses[0], (stresses[1:] - stresses[0]).T / PROBE
            if not (np.isfinite(residual).all() and np.isfinite(stiffness).all()):
                break
            allowed = STRESS_TOLERANCE * np.abs(answers[0].stress).max()
            allowed += STRAIN_TOLERANCE * np.abs(stiffness).max()
            if np.abs(residual).max() <= allowed:
                self.free_change, self.free_strain = strain - before, strain
                return answers[0]
            change = np.linalg.lstsq(stiffness, -residual)[0]
            strain = strain + np.clip(change, -LARGEST_STRAIN_STEP, LARGEST_STRAIN_STEP)
        return self._crossing(prescribed, dt)

    def _crossing(self, prescribed: Array, dt: float) -> _Answer:
        """The point where the mean lateral stress changes sign, by bisection of a common free strain.

        The stress of a plastic material is not continuous in the strain: the first plastic step knows of a
        strain rate that the elastic one before it did not, and return algorithms end after a whole number of
        iterations. Then Newton's iteration finds no zero where there is a jump past it; what stress is left
        there is gone in a later step.
        """
        guess = self.free_strain + self.free_change

        def at(shift: float) -> tuple[float, _Answer]:
            answer = self._try([self._stretched(prescribed, guess + shift)], dt)[0]
            return float(np.mean(answer.stress[list(self.free_axes), list(self.free_axes)])), answer

        width = PROBE
        while width < LARGEST_STRAIN_STEP and not at(-width)[0] <= 0.0 <= at(width)[0]:
            width *= 2.0
        low, high = -width, width
        if not at(low)[0] <= 0.0 <= at(high)[0]:
            raise PointDriverError("no lateral stretch was found at which the lateral stress vanishes")
        for _ in range(MOST_BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if at(middle)[0] < 0.0 else (low, middle)
        shift = min(low, high, key=lambda end: abs(at(end)[0]))
        self.free_strain = guess + shift
        return at(shift)[1]

    def _stretched(self, prescribed: Array, strain: Array) -> Array:
        """The prescribed gradient with the free stretches in it."""
        F = prescribed.copy()
        for axis, value in zip(self.free_axes, strain, strict=True):
            F[:, axis] *= math.exp(value)
        return F

    def _try(self, gradients: list[Array], dt: float) -> list[_Answer]:
        """What the material answers to each of these deformation gradients at the end of the step."""
        count = len(gradients)
        new = np.array(gradients)
        increments = new @ np.linalg.inv(self.gradient)
        trials = Trials(
            stress=np.tile(self.stress, (count, 1, 1)),
            old_gradient=np.tile(self.gradient, (count, 1, 1)),
            gradient=new,
            velocity_gradient=logarithm(increments) / dt,
            temperature=np.tile([self.temperature, self.previous_temperature], (count, 1)),
            localized=np.full(count, self.localized, np.int64),
            heating_rate=np.zeros(count),
        )
        for array, committed in zip(self.trial_state, self.state, strict=True):
            array[:] = committed
        step = Step(dt, self.time, 1.0, False, 0.0, 0.0, False)
        update_trials(self.model, self.trial_state, trials, self.material, step)
        return [
            _Answer(
                new[p],
                trials.stress[p],
                float(trials.heating_rate[p]),
                int(trials.localized[p]),
                [array[p].copy() for array in self.trial_state],
            )
            for p in range(count)
        ]

    def record(self, history: PointHistory, row: int) -> None:
        """Write the point as it is now to a row of a history."""
        history.temperature[row] = self.temperature
        history.deformation_gradient[row] = self.gradient
        history.stress[row] = self.stress
        history.localized[row] = self.localized
        for label, index in self.labels.items():
            history.state[label][row] = self.state[index]


def logarithm(increments: Array) -> Array:
    """Matrix logarithms of increments of deformation (m, 3, 3): 2 artanh Y, Y = (A - I) (A + I)^-1.

    The series converges for every increment without a negative eigenvalue, fast for those of a small step.
    """
    identity = np.eye(3)
    Y = (increments - identity) @ np.linalg.inv(increments + identity)
    square, term, total = Y @ Y, Y, Y.copy()
    for order in range(3, 200, 2):
        term = term @ square
        total += term / order
        if np.abs(term).max() < 1.0e-17 * max(np.abs(total).max(), 1.0e-300):
            break
    return 2.0 * total


def drive(
    model: Any, material: Material, path: Path, *, temperature: float | None = None, isothermal: bool = False
) -> PointHistory:
    """Take a point of a material along a path.

    Steps longer than the model allows are cut into parts.

    Parameters
    ----------
    model : record of a constitutive model.
    material : the material's constants.
    temperature : at the start, K; the material's room temperature without.
    isothermal : keep the temperature, whatever heat the material makes. Otherwise all of it stays in the
        point (adiabatic).

    Raises
    ------
    PointDriverError
        naming the step, where the stress is not finite, the material gives the point up, or no free stretch
        can be found.
    """
    start = material.room_temperature if temperature is None else temperature
    _positive(start, "temperature")
    driver = _Driver(model, material, start, path.free_axes)
    steps = len(path.time) - 1
    history = PointHistory(
        time=path.time,
        strain=path.strain,
        temperature=np.empty(steps + 1),
        deformation_gradient=np.empty((steps + 1, 3, 3)),
        stress=np.empty((steps + 1, 3, 3)),
        localized=np.empty(steps + 1, np.int64),
        state={label: np.empty((steps + 1, *driver.state[i].shape)) for label, i in driver.labels.items()},
        strain_name=path.strain_name,
    )
    driver.record(history, 0)
    for n in range(steps):
        dt, F_old, F = path.time[n + 1] - path.time[n], *path.deformation_gradient[n : n + 2]
        parts = math.ceil(dt / time_step_limit(model) - 1.0e-9)  # 0 where the model allows any step
        try:
            for part in range(1, max(parts, 1) + 1):
                share = part / max(parts, 1)
                driver.advance(F_old + share * (F - F_old), dt / max(parts, 1), isothermal)
        except PointDriverError as problem:
            where = f"step {n + 1} of {steps}, {path.strain_name} {path.strain[n + 1]:.6g}"
            raise PointDriverError(f"{where}: {problem}") from None
        driver.record(history, n + 1)
    return history
