"""What a picture shows: which variable, where, and with which limits; and the numbers of one time step."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, fields

import numpy as np

from ups.archive import Archive, ArchiveError, GridField, Level, Variable
from ups.archive.layout import FloatVector
from ups.archive.measures import Named, measure_of, measures_of
from ups.archive.units import plain_name, with_unit
from ups.archive.variables import ELEMENTS, NODE
from ups.convert.glyphs import particle_edges, positions_of

_PREFERRED = (
    "p.stress:vonMises",
    "p.velocity:magnitude",
    "p.temperature",
    "p.mass",
    "p.volume",
    "press_CC",
    "temp_CC",
    "g.velocity:magnitude",
)
"""What is shown where nothing is asked for: the first that the archive has."""

_ROUNDING = 1e-9
"""Of a stress, what is no more than noise."""

_SCALAR = {"Vector": "magnitude", "Point": "magnitude", "Matrix3": "norm"}
_SCALAR_OF = {"p.stress": "vonMises", "g.stressFS": "vonMises", "p.deformationMeasure": "equivalentStrain"}
"""The measure that stands for a vector or tensor, by type and, before that, by label."""


@dataclass(frozen=True)
class Slice:
    """A plane across an axis (0, 1, 2 for x, y, z) at a position."""

    axis: int
    position: float

    @classmethod
    def parse(cls, text: str) -> Slice:
        """Read ``z=0.5``.

        Raises
        ------
        ValueError
            For another form.
        """
        axis, equals, position = text.partition("=")
        if not equals or axis.strip() not in ("x", "y", "z"):
            raise ValueError(f"{text!r} is not of the form z=0.5")
        try:
            return cls("xyz".index(axis.strip()), float(position))
        except ValueError:
            raise ValueError(f"{position!r} in {text!r} is not a number") from None


@dataclass(frozen=True)
class View:
    """What a picture or a movie shows.

    Attributes
    ----------
    archive
        Where it is from.
    named
        The variable or measure, a number for each particle or point of the grid.
    materials
        Materials that are shown; of a grid variable only one.
    level
        Index of the level.
    plane
        The slice, or None.
    axes
        Axes that the picture extends along, 1 to 3 of them.
    mirrored
        Axes across whose lower end of the grid particles are shown a second time, as in a mirror.
    """

    archive: Archive
    named: Named
    materials: tuple[int, ...]
    level: int
    plane: Slice | None
    axes: tuple[int, ...]
    mirrored: tuple[int, ...] = ()

    @classmethod
    def choose(
        cls,
        archive: Archive,
        variable: str | None = None,
        *,
        step: int = -1,
        materials: Sequence[int] | None = None,
        level: int = 0,
        plane: Slice | None = None,
        mirrored: Sequence[int] = (),
    ) -> View:
        """Complete what was asked for with what suits the archive.

        Parameters
        ----------
        archive
            The archive.
        variable
            Label, perhaps with a measure; None for what is usually looked at first.
        step
            A time step that has the variable.
        materials
            Materials; None for all, or for a grid variable all together where they are stored so.
        level
            Level of a grid variable.
        plane
            Slice through a body in space, or None.
        mirrored
            Axes across whose lower end of the grid the particles are mirrored.

        Raises
        ------
        ArchiveError
            Where there is no such variable, material or level, the slice misses the grid, or a variable of
            the grid is to be mirrored.
        """
        named = _default(archive, step) if variable is None else _scalar(archive, archive.find(variable))
        label = named.declaration.name
        stored = archive.materials(step, label)
        if not stored:
            raise ArchiveError(
                archive.path,
                f"{label} is not stored at step {archive.timestep(step).step}",
                advice=f"there are: {', '.join(archive.labels(step))}",
            )
        wanted = tuple(stored if materials is None else materials)
        absent = [material for material in wanted if material not in stored]
        if absent:
            advice = f"its materials are: {', '.join(map(str, stored))}"
            raise ArchiveError(archive.path, f"{label} is not stored for material {absent[0]}", advice=advice)
        if named.source.is_grid and materials is None:
            together = named.source.container == NODE and is_with_all(archive, step, stored)
            wanted = (stored[-1] if together else stored[0],)
        levels = archive.grid(step).levels
        if not 0 <= level < len(levels):
            raise ArchiveError(archive.path, f"there is no level {level}, only {len(levels)} levels")
        if mirrored and not named.source.is_particle:
            raise ArchiveError(archive.path, f"{label} is not on particles, and only they can be mirrored")
        axes = _axes(archive, levels[level], plane)
        return cls(archive, named, wanted, level, plane, axes, tuple(dict.fromkeys(mirrored)))

    @property
    def label(self) -> str:
        """What the numbers are, with their unit."""
        return with_unit(plain_name(self.named.declaration.name), self.named.unit)

    def lattice(self, step: int) -> Level:
        """Level at a time step."""
        return self.archive.grid(step).levels[self.level]

    def title(self, step: int) -> str:
        """What the picture shows, in a line."""
        timestep = self.archive.timestep(step)
        name = self.archive.index.title or self.archive.path.resolve().name
        shown = f"{name}, time {timestep.time:.6g} s (step {timestep.step})"
        stored = self.archive.materials(step, self.named.source.name)
        if len(self.materials) < len(stored) and not self._shows_all_together(step, stored):
            shown += f", material {', '.join(map(str, self.materials))}"
        if self.plane is not None:
            shown += f", slice {'xyz'[self.plane.axis]} = {self.plane.position:.6g} m"
        return shown

    def _shows_all_together(self, step: int, stored: Sequence[int]) -> bool:
        together = self.named.source.container == NODE and is_with_all(self.archive, step, stored)
        return together and self.materials == (stored[-1],)


@dataclass(frozen=True)
class ParticleFrame:
    """Particles of one time step.

    Attributes
    ----------
    positions
        Shape (n, 3).
    edges
        Edge vectors of the boxes that they fill, as columns, shape (n, 3, 3).
    values
        Shape (n,).
    materials
        Material of each, shape (n,).
    """

    positions: np.ndarray
    edges: np.ndarray
    values: np.ndarray
    materials: np.ndarray


def particle_frame(view: View, step: int) -> ParticleFrame:
    """Particles that a view shows at a time step: all, or those within half a cell of its slice; and mirrored."""
    level, label = view.lattice(step), view.named.declaration.name
    parts = []
    for material in view.materials:
        positions = positions_of(view.archive, step, material)
        edges = particle_edges(view.archive, step, material, level)
        values = view.archive.particles(step, label, material)
        if view.plane is not None:
            axis = view.plane.axis
            near = np.abs(positions[:, axis] - view.plane.position) <= level.spacing[axis] / 2.0
            positions, edges, values = positions[near], edges[near], values[near]
        parts.append((positions, edges, values, np.full(len(values), material)))
    frame = ParticleFrame(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))
    low, _high = level.bounds(level.interior)
    for axis in view.mirrored:
        frame = _with_mirror_image(view, frame, axis, low[axis])
    return frame


def _with_mirror_image(view: View, frame: ParticleFrame, axis: int, position: float) -> ParticleFrame:
    """Particles with their images in a plane across an axis; components change sign as they do in a mirror."""
    positions, edges = frame.positions.copy(), frame.edges.copy()
    positions[:, axis] = 2.0 * position - positions[:, axis]
    edges[:, axis] *= -1.0
    component = view.named.measure.name if view.named.measure is not None else ""
    is_odd = set(component) <= set("XYZ") and component.count("XYZ"[axis]) % 2 == 1
    image = ParticleFrame(positions, edges, -frame.values if is_odd else frame.values, frame.materials)
    pairs = ((getattr(frame, f.name), getattr(image, f.name)) for f in fields(frame))
    return ParticleFrame(*(np.concatenate(pair) for pair in pairs))


def plane_corners(frame: ParticleFrame, axes: Sequence[int]) -> np.ndarray:
    """Corners of the faces that particles show to who looks at a plane, in order, shape (n, 4, 3)."""
    first, second = (frame.edges[:, :, axis] / 2.0 for axis in axes)
    places = frame.positions
    corners = [places - first - second, places + first - second, places + first + second]
    return np.stack([*corners, places - first + second], axis=1)


def grid_field(view: View, step: int) -> GridField:
    """Grid variable that a view shows at a time step."""
    return view.archive.grid_variable(step, view.named.declaration.name, view.materials[0], view.level)


@dataclass(frozen=True)
class Range:
    """What the colour bar and the axes of a picture cover.

    Attributes
    ----------
    values
        Smallest and largest number.
    low, high
        Corners of the box that is looked at.
    """

    values: tuple[float, float]
    low: FloatVector
    high: FloatVector

    def joined(self, other: Range) -> Range:
        """Return the smallest range that covers both."""
        low, high = (
            tuple(np.array(pick([ours, theirs], axis=0)).tolist())
            for pick, ours, theirs in ((np.min, self.low, other.low), (np.max, self.high, other.high))
        )
        least, most = zip(self.values, other.values, strict=True)
        return Range((min(least), max(most)), low, high)


def range_of(view: View, steps: Sequence[int], limits: tuple[float, float] | None = None) -> Range:
    """Range of a picture, or of all frames of a movie.

    The numbers are the finite ones that are shown, a little more where they hardly differ, so that
    rounding is not drawn as a pattern. The box is that of the particles with a margin, or of the grid.

    Parameters
    ----------
    view
        What is shown.
    steps
        Time steps of the frames.
    limits
        Numbers that the colour bar is to cover instead, or None.
    """
    level = view.lattice(steps[-1])
    grid_low, grid_high = (np.array(corner) for corner in level.bounds(level.interior))
    mirrored = list(view.mirrored)
    grid_low[mirrored] = (2.0 * grid_low - grid_high)[mirrored]
    ends: list[tuple[float, float]] = []
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for step in steps:
        if view.named.source.is_particle:
            frame = particle_frame(view, step)
            values = frame.values
            places = frame.positions[np.isfinite(frame.positions).all(axis=1)]
            low = np.minimum(low, places.min(axis=0, initial=np.inf))
            high = np.maximum(high, places.max(axis=0, initial=-np.inf))
        else:
            found = grid_field(view, step)
            values = found.values[found.interior.within(found.origin)]
        finite = values[np.isfinite(values)]
        if finite.size:
            ends.append((float(finite.min()), float(finite.max())))
    if (high >= low).all():
        margin = max(*level.spacing, 0.03 * (high - low)[list(view.axes)].max())
        low, high = np.maximum(grid_low, low - margin), np.minimum(grid_high, high + margin)
    else:
        low, high = grid_low, grid_high
    corners = (tuple(corner.tolist()) for corner in (low, high))
    return Range(limits or _widened(ends), *corners)


def _widened(ends: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Smallest and largest of all ends, apart by at least a millionth of their size."""
    if not ends:
        return 0.0, 1.0
    low, high = min(end[0] for end in ends), max(end[1] for end in ends)
    size = max(abs(low), abs(high))
    if high - low > 1e-6 * size:
        return (0.0 if abs(low) < 1e-12 * size else low, 0.0 if abs(high) < 1e-12 * size else high)
    return (low - 0.01 * size, high + 0.01 * size) if size else (0.0, 1.0)


def usual_names(archive: Archive, step: int) -> list[str]:
    """Names of what a picture can show of a time step; vectors and tensors by the measure that stands for them."""
    found = []
    for variable in _drawable(archive, step):
        with suppress(ArchiveError):  # where only a component is a number
            found.append(_scalar(archive, Named(variable)).declaration.name)
    return found


def measure_names(archive: Archive, step: int) -> list[str]:
    """Names of all other numbers that a picture can show: measures and components of vectors and tensors."""
    usual = usual_names(archive, step)
    names = [
        f"{variable.name}:{measure}"
        for variable in _drawable(archive, step)
        if variable.element_type.shape
        for measure in measures_of(variable)
        if not ELEMENTS[measure_of(variable, measure).result].shape
    ]
    return [name for name in names if name not in usual]


def _drawable(archive: Archive, step: int) -> list[Variable]:
    """Return what has a place, apart from the places and numbers of the particles."""
    skipped = (archive.index.particle_position, "p.particleID")
    stored = [archive.variables[label] for label in archive.labels(step) if label not in skipped]
    return [variable for variable in stored if variable.is_particle or variable.is_grid]


def _default(archive: Archive, step: int) -> Named:
    stored = archive.labels(step)
    for name in _PREFERRED:
        if name.partition(":")[0] in stored:
            return archive.find("p.stress:pressure" if _is_fluid(archive, step, name) else name)
    shown = [v for v in archive.variables.values() if v.name in stored and (v.is_particle or v.is_grid)]
    if not shown:
        raise ArchiveError(archive.path, "there is no particle or grid variable to show")
    return _scalar(archive, Named(shown[0]))


def _is_fluid(archive: Archive, step: int, name: str) -> bool:
    """Whether a von Mises stress is only the rounding of stresses that are pressures."""
    if name != "p.stress:vonMises":
        return False
    shear, whole = (archive.particles(step, f"p.stress:{measure}") for measure in ("vonMises", "norm"))
    return bool(np.nanmax(shear, initial=0.0) < _ROUNDING * np.nanmax(whole, initial=0.0))


def _scalar(archive: Archive, named: Named) -> Named:
    """Return the name of a number: a vector's or tensor's own is given the measure that stands for it."""
    declared: Variable = named.declaration
    if not (declared.is_particle or declared.is_grid):
        raise ArchiveError(archive.path, f"{declared.name} is a {declared.type_name}, which has no place")
    if not declared.element_type.shape:
        return named
    measure = _SCALAR_OF.get(declared.name) or _SCALAR.get(declared.element)
    if named.measure is not None or measure is None:
        raise ArchiveError(
            archive.path,
            f"{declared.name} is not a number but a {declared.element}",
            advice=f"choose a component: {declared.name}:{declared.element_type.component_names[:1]}"
            if named.measure is None
            else "choose a measure that gives a number",
        )
    return archive.find(f"{declared.name}:{measure}")


def is_with_all(archive: Archive, step: int, stored: Sequence[int]) -> bool:
    """Whether the last material of a nodal variable stands for all together, one more than have particles."""
    position = archive.index.particle_position
    own = archive.materials(step, position) if position in archive.labels(step) else []
    return bool(own) and stored[-1] == own[-1] + 1


def _axes(archive: Archive, level: Level, plane: Slice | None) -> tuple[int, ...]:
    """Axes along which there is more than one cell, the one across the slice left out; at least one."""
    low, high = level.bounds(level.interior)
    if plane is not None and not low[plane.axis] <= plane.position <= high[plane.axis]:
        name = "xyz"[plane.axis]
        raise ArchiveError(
            archive.path,
            f"the slice {name}={plane.position:g} misses the grid",
            advice=f"{name} reaches from {low[plane.axis]:g} to {high[plane.axis]:g}",
        )
    cut = () if plane is None else (plane.axis,)
    axes = tuple(axis for axis in range(3) if level.interior.shape[axis] > 1 and axis not in cut)
    return axes or tuple(axis for axis in range(3) if axis not in cut)[:1]
