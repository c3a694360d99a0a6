"""An archive as an `xarray.Dataset`, whose values are read when they are used."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ups.archive.errors import ArchiveError
from ups.archive.layout import Level
from ups.archive.measures import Named
from ups.archive.tracks import IDENTITY
from ups.archive.units import unit_of
from ups.archive.variables import CELL, FACES, NODE, ElementType, Variable

if TYPE_CHECKING:
    from ups.archive.reader import Archive


def dataset(archive: Archive, variables: Sequence[str] | None, material: int, level: int) -> Any:
    """See `Archive.dataset`."""
    try:
        import xarray
    except ImportError:
        message = "a dataset needs xarray, which is not installed"
        raise ArchiveError(archive.path, message, advice="pip install 'ups-mpm[archive]'") from None
    if not archive.timesteps:
        raise ArchiveError(archive.path, "there are no time steps")
    builder = _Builder(archive, material, level)
    if variables is None:
        named = [archive.find(label) for label in archive.variables if builder.has(label)]
    else:
        named = [archive.find(name) for name in variables]
    arrays = {one.declaration.name: builder.array(one) for one in named if builder.can(one)}
    for name in archive.reductions if variables is None else ():
        arrays |= _history(archive, name)
    return xarray.Dataset(arrays, coords=builder.coordinates, attrs={"title": archive.index.title})


class _Builder:
    """Makes the lazy arrays of a dataset and collects their coordinates."""

    def __init__(self, archive: Archive, material: int, level: int) -> None:
        self.archive = archive
        self.material = material
        self.level: int = level
        self.steps = [timestep.step for timestep in archive.timesteps]
        self.coordinates: dict[str, Any] = {
            "time": ("time", [timestep.time for timestep in archive.timesteps], {"units": "s"}),
            "step": ("time", self.steps),
        }
        self.identities = self._identities()

    def _identities(self) -> np.ndarray | None:
        """Identities of the particles of the first time step, ascending; None where they are not stored."""
        first = self.steps[0]
        if IDENTITY not in self.archive.labels(first) or not self.has(IDENTITY):
            return None
        return np.sort(self.archive.particles(first, IDENTITY, self.material))

    def has(self, label: str) -> bool:
        """Whether a variable is stored for the material at every step."""
        return all(self.material in self.archive.materials(step, label) for step in self.steps)

    def can(self, named: Named) -> bool:
        """Whether a variable can be an array: on the grid, or on particles that have identities."""
        return named.source.is_grid or (named.source.is_particle and self.identities is not None)

    def array(self, named: Named) -> Any:
        """Return a lazy `xarray.Variable` of one variable."""
        declared = named.declaration
        element = declared.element_type
        components = self._component_axes(element)
        attributes = {"units": named.unit, "long_name": declared.name}
        read: Callable[[int], np.ndarray]
        dimensions: tuple[str, ...]
        shape: tuple[int, ...]
        if declared.is_particle:
            assert self.identities is not None  # `can` has seen to it
            self.coordinates["particle"] = self.identities
            dimensions, shape = ("particle",), (len(self.identities),)
            read = self._particle_reader(declared)
        else:
            lattice = self.archive.grid(self.steps[0]).levels[self.level]
            dimensions, shape = self._grid_axes(declared, lattice)
            read = self._grid_reader(declared)
        return _lazy(
            ("time", *dimensions, *components),
            (len(self.steps), *shape, *element.shape),
            element.dtype.newbyteorder("="),
            read,
            attributes,
        )

    def _component_axes(self, element: ElementType) -> tuple[str, ...]:
        """Dimensions of an element: (component) of a vector, (row, column) of a matrix, else one of its own."""
        if element.shape == (3, 3):
            axes: tuple[str, ...] = ("row", "column")
        else:
            axes = ("component" if element.shape == (3,) else element.name.lower(),) * len(element.shape)
        for axis, length in zip(axes, element.shape, strict=True):
            names = list("XYZ") if length == 3 else list(element.component_names)
            if names:
                self.coordinates[axis] = (axis, names)
        return axes

    def _grid_axes(self, declared: Variable, lattice: Level) -> tuple[tuple[str, ...], tuple[int, ...]]:
        box = lattice.whole(declared.container)
        names = []
        for axis, places in zip("xyz", lattice.coordinates(declared.container, box), strict=True):
            between = declared.container in FACES and declared.container != FACES["xyz".index(axis)]
            site = (
                "cell"
                if declared.container == CELL or between
                else "face"
                if declared.container != NODE
                else "node"
            )
            names.append(f"{axis}_{site}")
            self.coordinates[names[-1]] = (names[-1], places, {"units": "m"})
        return tuple(names), box.shape

    def _grid_reader(self, declared: Variable) -> Callable[[int], np.ndarray]:
        def read(row: int) -> np.ndarray:
            step = self.steps[row]
            return self.archive.grid_variable(step, declared.name, self.material, self.level).values

        return read

    def _particle_reader(self, declared: Variable) -> Callable[[int], np.ndarray]:
        def read(row: int) -> np.ndarray:
            assert self.identities is not None  # else there would be no such array
            return self.archive.follow(
                declared.name, self.identities, self.material, [self.steps[row]]
            ).values[0]

        return read


def _lazy(
    dimensions: tuple[str, ...],
    shape: tuple[int, ...],
    dtype: np.dtype,
    read: Callable[[int], np.ndarray],
    attributes: dict[str, str],
) -> Any:
    """`xarray.Variable` whose rows along the first dimension are made by `read`."""
    import xarray
    from xarray.backends import BackendArray
    from xarray.core import indexing

    class Rows(BackendArray):
        """Values that are read row by row."""

        def __init__(self) -> None:
            self.shape = shape
            self.dtype = dtype

        def __getitem__(self, key: Any) -> Any:
            basic = indexing.IndexingSupport.BASIC
            return indexing.explicit_indexing_adapter(key, shape, basic, self._take)

        def _take(self, key: tuple[Any, ...]) -> np.ndarray:
            rows, rest = key[0], key[1:]
            if not isinstance(rows, slice):
                return read(int(rows))[rest]
            parts = [read(row)[rest] for row in range(*rows.indices(shape[0]))]
            return np.stack(parts) if parts else np.empty((0, *shape[1:]), dtype)[(slice(None), *rest)]

    return xarray.Variable(dimensions, indexing.LazilyIndexedArray(Rows()), attributes)


def _history(archive: Archive, name: str) -> dict[str, Any]:
    history = archive.reductions[name]
    if not len(history.times) or np.isnan(history.times).any():
        return {}
    dimension = f"time_{name}"
    components = ("component" if history.values.shape[1:] == (3,) else "entry",) * (history.values.ndim - 1)
    return {
        name: ((dimension, *components), history.values, {"units": unit_of(name)}),
        dimension: (dimension, history.times, {"units": "s"}),
    }
