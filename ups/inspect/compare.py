"""Comparing two archives number by number, as Uintah's ``compare_uda`` does.

The tolerances, what must agree for a comparison to make sense, and the exit statuses are those of
``compare_uda``: a number fails where both its absolute and its relative difference exceed their
tolerances; integers must be equal; NaN always fails. Differently from there, the components of a tensor
are compared and not only its norm, which a rotated stress would share; the relative difference of a
component is then taken to the largest component of the two tensors, so that rounding in a component that
should be zero does not count. All differences are found, not the first.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from ups.archive import Archive, ArchiveError, Level, Timestep, Variable
from ups.archive.tracks import IDENTITY, identity_label
from ups.archive.variables import PER_PATCH

EQUAL, TOLERANCE_EXCEEDED, NOT_COMPARABLE, UNSUPPORTED = 0, 2, 5, 255
"""Exit statuses of ``compare_uda``."""


@dataclass(frozen=True)
class Tolerances:
    """What counts as equal: a difference of at most `absolute`, or of at most `relative` times the larger.

    Raises
    ------
    ValueError
        For a negative tolerance.
    """

    absolute: float = 1e-9
    relative: float = 1e-6

    def __post_init__(self) -> None:
        if not (self.absolute >= 0.0 and self.relative >= 0.0):
            raise ValueError("a tolerance must not be negative")


@dataclass(frozen=True)
class Difference:
    """The worst difference of one variable.

    Attributes
    ----------
    name, component
        Label, and the component, empty for numbers.
    step, time, level, material
        Where it is.
    place
        The particle or index, in words.
    first, second
        The two numbers.
    absolute, relative
        Their differences.
    failed, compared
        How many numbers of the variable exceed the tolerances, of how many, over all steps.
    """

    name: str
    component: str
    step: int
    time: float
    level: int
    material: int
    place: str
    first: float
    second: float
    absolute: float
    relative: float
    failed: int
    compared: int

    def __str__(self) -> str:
        component = f" {self.component}" if self.component else ""
        return (
            f"{self.name}{component}: {self.failed} of {self.compared} numbers differ; the worst at step "
            f"{self.step} (time {self.time:.9g}), material {self.material}, level {self.level}, {self.place}: "
            f"{self.first:.17g} and {self.second:.17g}, absolute difference {self.absolute:.3g}, "
            f"relative {self.relative:.3g}"
        )


@dataclass
class Comparison:
    """The outcome of a comparison.

    Attributes
    ----------
    differences
        The worst difference of each variable that exceeds the tolerances, the worst variable first.
    obstacles
        Why the archives cannot be compared, in whole or in part.
    unsupported
        Variables of both whose type cannot be read.
    compared
        How many numbers were compared.
    largest
        Largest absolute and relative difference found, within tolerances or not.
    """

    differences: list[Difference] = field(default_factory=list)
    obstacles: list[str] = field(default_factory=list)
    unsupported: list[str] = field(default_factory=list)
    compared: int = 0
    largest: tuple[float, float] = (0.0, 0.0)

    @property
    def status(self) -> int:
        """Exit status: 2 for tolerances exceeded, else 5 for what cannot be compared, 255 read, else 0."""
        if self.differences:
            return TOLERANCE_EXCEEDED
        if self.obstacles:
            return NOT_COMPARABLE
        return UNSUPPORTED if self.unsupported else EQUAL


class _ObstacleError(Exception):
    """Something cannot be compared; the message says what."""


@dataclass(frozen=True)
class _Pair:
    """The same variable and material of both archives, as rows of components in the same order."""

    variable: Variable
    material: int
    level: int
    first: np.ndarray
    second: np.ndarray
    place: Callable[[int], str]


def compare_archives(
    first: str | Path,
    second: str | Path,
    tolerances: Tolerances | None = None,
    *,
    variables: Collection[str] = (),
    ignore: Collection[str] = (),
    levels: tuple[int, int] | None = None,
    extra_cells: bool = False,
    skip_unknown_types: bool = False,
) -> Comparison:
    """Compare two archives.

    Particles are matched by their identity where both archives store ``p.particleID``, so that patches,
    ranks and order may differ; else patch by patch in stored order.

    Parameters
    ----------
    first, second
        The archives.
    tolerances
        What counts as equal.
    variables, ignore
        Labels to compare (all where empty), and labels to leave out.
    levels
        One level of each archive to compare; all with their like where None.
    extra_cells
        Whether extra cells are compared, too.
    skip_unknown_types
        Whether variables of types that cannot be read are passed over.

    Raises
    ------
    ArchiveError
        Where there is no archive or no variable of a given label.
    """
    archives = Archive(first), Archive(second)
    for name in [*variables, *ignore]:
        if not any(name in archive.variables or name in archive.unsupported for archive in archives):
            archives[0].find(name)  # says what there is
    task = _Task(archives, tolerances or Tolerances(), levels, extra_cells)
    task.run(variables, ignore)
    if skip_unknown_types:
        task.outcome.unsupported.clear()
    return task.outcome


class _Task:
    """One comparison, step by step."""

    def __init__(
        self,
        archives: tuple[Archive, Archive],
        tolerances: Tolerances,
        levels: tuple[int, int] | None,
        extra_cells: bool,
    ) -> None:
        self.archives = archives
        self.tolerances = tolerances
        self.levels = levels
        self.extra_cells = extra_cells
        self.outcome = Comparison()
        self._worst: dict[str, Difference] = {}
        self._counts: dict[str, tuple[int, int]] = {}

    def run(self, wanted: Collection[str], ignore: Collection[str]) -> None:
        """Compare all steps that both archives have."""
        named = self._common_variables(wanted, ignore)
        steps = [archive.timesteps for archive in self.archives]
        if len(steps[0]) != len(steps[1]):
            self.outcome.obstacles.append(f"{len(steps[0])} time steps here, {len(steps[1])} there")
        for ours, theirs in zip(*steps, strict=False):
            try:
                self._check_times(ours, theirs)
                for variable in named:
                    self._compare_variable(variable, ours, theirs)
            except _ObstacleError as obstacle:
                self.outcome.obstacles.append(f"step {ours.step}: {obstacle}")
                break
            except ArchiveError as error:
                self.outcome.obstacles.append(str(error))
                break
        self.outcome.differences = sorted(
            (self._finished(name) for name in self._worst), key=lambda found: -found.relative
        )

    def _finished(self, name: str) -> Difference:
        failed, compared = self._counts[name]
        return Difference(**{**self._worst[name].__dict__, "failed": failed, "compared": compared})

    def _common_variables(self, wanted: Collection[str], ignore: Collection[str]) -> list[Variable]:
        """Variables that both archives list; what only one has, or has of another type, is an obstacle."""
        listings = [
            {
                listed.name: listed.type_name
                for listed in archive.index.variables
                if listed.name not in ignore and (not wanted or listed.name in wanted)
            }
            for archive in self.archives
        ]
        for name in sorted(set(listings[0]) ^ set(listings[1])):
            which = self.archives[0 if name in listings[0] else 1].path
            self.outcome.obstacles.append(f"only {which} has {name}")
        common = []
        for name in sorted(set(listings[0]) & set(listings[1])):
            ours, theirs = (listing[name] for listing in listings)
            if ours != theirs:
                self.outcome.obstacles.append(f"{name} is a {ours} here, a {theirs} there")
            elif name in self.archives[0].unsupported:
                self.outcome.unsupported.append(f"{name} is a {ours}, which cannot be read")
            else:
                common.append(self.archives[0].variables[name])
        return common

    def _check_times(self, ours: Timestep, theirs: Timestep) -> None:
        difference = abs(ours.time - theirs.time)
        largest = max(abs(ours.time), abs(theirs.time))
        if difference > self.tolerances.absolute and difference > self.tolerances.relative * largest:
            raise _ObstacleError(f"time {ours.time:.17g} here, {theirs.time:.17g} there")
        if self.levels is None:
            counts = [len(a.grid(t.step).levels) for a, t in zip(self.archives, (ours, theirs), strict=True)]
            if counts[0] != counts[1]:
                raise _ObstacleError(f"{counts[0]} levels here, {counts[1]} there")

    def _compare_variable(self, variable: Variable, ours: Timestep, theirs: Timestep) -> None:
        for pair in self._pairs(variable, ours.step, theirs.step):
            self._compare_numbers(pair, ours)

    def _pairs(self, variable: Variable, ours: int, theirs: int) -> Iterator[_Pair]:
        """Values to hold against each other, material by material."""
        first, second = self.archives
        level_pairs = [self.levels] if self.levels else [(i, i) for i in range(len(first.grid(ours).levels))]
        named = self._identities(variable, ours, theirs)
        for material, identity in named.items():
            yield from self._particles_by_identity(variable, ours, theirs, material, identity)
        for here, there in level_pairs:
            levels = _level(first, ours, here), _level(second, theirs, there)
            for material in self._materials(variable, ours, theirs, here, there):
                if material in named:
                    continue
                if variable.is_particle:
                    yield from self._particles_by_patch(variable, ours, theirs, material, levels)
                elif variable.container == PER_PATCH:
                    yield self._patch_values(variable, ours, theirs, material, levels)
                else:
                    yield self._grid_values(variable, ours, theirs, material, levels)

    def _identities(self, variable: Variable, ours: int, theirs: int) -> dict[int, str]:
        """The materials whose particles can be told apart in both archives, and the label that does so."""
        if not variable.is_particle or self.levels is not None:
            return {}
        found = {}
        for material in self._materials(variable, ours, theirs, None, None):
            labels = {
                identity_label(archive, step, material)
                for archive, step in zip(self.archives, (ours, theirs), strict=True)
            }
            identity = labels.pop()
            if identity is not None and not labels:
                found[material] = identity
        return found

    def _materials(
        self, variable: Variable, ours: int, theirs: int, here: int | None, there: int | None
    ) -> Sequence[int]:
        sets = (
            self.archives[0].materials(ours, variable.name, here),
            self.archives[1].materials(theirs, variable.name, there),
        )
        if sets[0] != sets[1]:
            raise _ObstacleError(
                f"{variable.name} is stored for the materials {sets[0]} here, {sets[1]} there"
            )
        return sets[0]

    def _particles_by_identity(
        self, variable: Variable, ours: int, theirs: int, material: int, identity: str
    ) -> Iterator[_Pair]:
        """Pair particles of the same identity; where some have no partner, the identities are what differs."""
        first_ids, first = self._by_identity(self.archives[0], ours, variable, material, identity)
        second_ids, second = self._by_identity(self.archives[1], theirs, variable, material, identity)
        if len(first_ids) != len(second_ids):
            only = np.setxor1d(first_ids, second_ids)[0]
            raise _ObstacleError(
                f"material {material} has {len(first_ids)} particles here, {len(second_ids)} there; "
                f"only one archive has particle {only}"
            )
        same = np.array_equal(first_ids, second_ids)
        if not same:
            variable, first, second = self.archives[0].variables[identity], first_ids, second_ids
        rows = _rows(first, variable), _rows(second, variable)
        yield _Pair(variable, material, 0, *rows, lambda row: f"particle {first_ids[row]}")
        if not same:
            only = np.setxor1d(first_ids, second_ids)[0]
            raise _ObstacleError(f"only one archive has particle {only} of material {material}")

    def _by_identity(
        self, archive: Archive, step: int, variable: Variable, material: int, identity: str
    ) -> tuple[np.ndarray, np.ndarray]:
        """Identities, ascending, and values in their order."""
        identities = archive.particles(step, identity, material)
        order = np.argsort(identities, kind="stable")
        identities = identities[order]
        twice = identities[1:][identities[1:] == identities[:-1]]
        if len(twice):
            raise _ObstacleError(
                f"two particles of material {material} in {archive.path} are called {twice[0]}"
            )
        return identities, archive.particles(step, variable.name, material)[order]

    def _particles_by_patch(
        self, variable: Variable, ours: int, theirs: int, material: int, levels: tuple[Level, Level]
    ) -> Iterator[_Pair]:
        if [p.interior for p in levels[0].patches] != [p.interior for p in levels[1].patches]:
            raise _ObstacleError(
                f"the patches differ, and {variable.name} can be matched only by {IDENTITY}, which is not stored"
            )
        for mine, other in zip(levels[0].patches, levels[1].patches, strict=True):
            first = self.archives[0].particles(ours, variable.name, material, mine.id)
            second = self.archives[1].particles(theirs, variable.name, material, other.id)
            if len(first) != len(second):
                raise _ObstacleError(
                    f"material {material} has {len(first)} particles on patch {mine.id} here, {len(second)} there"
                )
            yield _Pair(
                variable,
                material,
                levels[0].index,
                _rows(first, variable),
                _rows(second, variable),
                partial(_place_on_patch, mine.id),
            )

    def _patch_values(
        self, variable: Variable, ours: int, theirs: int, material: int, levels: tuple[Level, Level]
    ) -> _Pair:
        first = self.archives[0].per_patch(ours, variable.name, material, levels[0].index)
        second = self.archives[1].per_patch(theirs, variable.name, material, levels[1].index)
        if len(first) != len(second):
            raise _ObstacleError(f"{variable.name} has {len(first)} patches here, {len(second)} there")
        rows = _rows(first, variable), _rows(second, variable)
        return _Pair(
            variable, material, levels[0].index, *rows, lambda row: f"patch {levels[0].patches[row].id}"
        )

    def _grid_values(
        self, variable: Variable, ours: int, theirs: int, material: int, levels: tuple[Level, Level]
    ) -> _Pair:
        fields = (
            self.archives[0].grid_variable(ours, variable.name, material, levels[0].index),
            self.archives[1].grid_variable(theirs, variable.name, material, levels[1].index),
        )
        boxes = [found.box if self.extra_cells else found.interior for found in fields]
        if boxes[0] != boxes[1]:
            raise _ObstacleError(f"{variable.name} covers the indices {boxes[0]} here, {boxes[1]} there")
        rows = [_rows(found.values[boxes[0].within(found.origin)], variable) for found in fields]
        box = boxes[0]

        def place(row: int) -> str:
            index = [int(i) + low for i, low in zip(np.unravel_index(row, box.shape), box.low, strict=True)]
            return f"index {index}"

        return _Pair(variable, material, levels[0].index, rows[0], rows[1], place)

    def _compare_numbers(self, pair: _Pair, timestep: Timestep) -> None:
        if not pair.first.size:
            return
        absolute, relative = _differences(pair)
        exact = pair.first.dtype.kind in "iu"
        with np.errstate(invalid="ignore"):
            limits = self.tolerances
            failed = absolute > 0 if exact else (absolute > limits.absolute) & (relative > limits.relative)
        name = pair.variable.name
        before, total = self._counts.get(name, (0, 0))
        self._counts[name] = before + int(np.count_nonzero(failed)), total + failed.size
        self.outcome.compared += failed.size
        most = float(absolute.max()), float(relative.max())
        self.outcome.largest = max(self.outcome.largest[0], most[0]), max(self.outcome.largest[1], most[1])
        if failed.any():
            self._note(pair, timestep, absolute, np.where(failed, relative, -1.0))

    def _note(self, pair: _Pair, timestep: Timestep, absolute: np.ndarray, relative: np.ndarray) -> None:
        """Keep the worst failure of a variable: the largest relative difference, then the earliest."""
        name = pair.variable.name
        row, column = (int(i) for i in np.unravel_index(int(relative.argmax()), relative.shape))
        if name in self._worst and self._worst[name].relative >= relative[row, column]:
            return
        components = pair.variable.element_type.component_names
        self._worst[name] = Difference(
            name=name,
            component=components[column] if components else "",
            step=timestep.step,
            time=timestep.time,
            level=pair.level,
            material=pair.material,
            place=pair.place(row),
            first=pair.first[row, column].item(),
            second=pair.second[row, column].item(),
            absolute=float(absolute[row, column]),
            relative=float(relative[row, column]),
            failed=0,
            compared=0,
        )


def _place_on_patch(patch: int, row: int) -> str:
    return f"particle {row} of patch {patch}"


def _level(archive: Archive, step: int, index: int) -> Level:
    levels = archive.grid(step).levels
    if not 0 <= index < len(levels):
        raise _ObstacleError(f"{archive.path} has no level {index}, only {len(levels)}")
    return levels[index]


def _rows(values: np.ndarray, variable: Variable) -> np.ndarray:
    return values.reshape(-1, variable.element_type.components)


def _differences(pair: _Pair) -> tuple[np.ndarray, np.ndarray]:
    """Absolute and relative difference of every number; infinite where one is NaN."""
    first, second = pair.first, pair.second
    if first.dtype.kind in "iu":
        unequal = (first != second).astype(float)
        apart = np.abs(first.astype(float) - second.astype(float))
        return np.maximum(apart, unequal), unequal
    first, second = first.astype(float, copy=False), second.astype(float, copy=False)
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        absolute = np.abs(first - second)
        absolute[first == second] = 0.0  # infinities of the same sign
        scale = np.maximum(np.abs(first), np.abs(second))
        if pair.variable.element == "Matrix3":
            scale = np.broadcast_to(scale.max(axis=1, keepdims=True), scale.shape)
        relative = np.where(absolute > 0.0, absolute / scale, 0.0)
    unknown = np.isnan(first) | np.isnan(second)
    absolute[unknown] = relative[unknown] = np.inf
    relative[np.isinf(absolute)] = np.inf
    return absolute, relative


def render(comparison: Comparison) -> str:
    """Return the outcome as text for a terminal."""
    lines = [str(difference) for difference in comparison.differences]
    lines += [f"not comparable: {obstacle}" for obstacle in comparison.obstacles + comparison.unsupported]
    absolute, relative = comparison.largest
    lines.append(
        f"{comparison.compared} numbers compared; largest difference {absolute:.3g} absolute, {relative:.3g} relative"
    )
    verdict = {EQUAL: "equal within the tolerances", TOLERANCE_EXCEEDED: "tolerances exceeded"}
    lines.append(verdict.get(comparison.status, "the archives cannot be compared"))
    return "\n".join(lines)
