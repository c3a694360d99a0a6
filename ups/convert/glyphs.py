"""Particles as boxes, deformed as their material is."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import repeat

import numpy as np

from ups.archive import Archive, ArchiveError, Level
from ups.archive.markup import parse

DEFORMATION, VOLUME = "p.deformationMeasure", "p.volume"

_CORNERS = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=float
)
"""Corners of a unit cube in the order of VTK's hexahedron."""


def particle_edges(archive: Archive, step: int, material: int, level: Level) -> np.ndarray:
    """Edge vectors of the boxes that particles fill, the columns of matrices of shape (n, 3, 3).

    A particle starts as a box of the shape of a cell and is deformed by its ``p.deformationMeasure`` F, of
    a size that gives it its ``p.volume``; in a grid of one layer of cells with one layer of particles it is
    as thick as the layer, and in a deck of rotational symmetry its volume is that of a radian. Without F
    the box is not deformed; without a volume it is half a cell wide.
    """
    return np.concatenate([np.empty((0, 3, 3)), *edge_parts(archive, step, material, level)])


def edge_parts(archive: Archive, step: int, material: int, level: Level) -> Iterator[np.ndarray]:
    """`particle_edges` in the parts of `Archive.particle_parts`."""
    cell = np.array(level.spacing)
    layered = _layered_axes(archive, step, material, level)
    around_axis = layered[2] and _is_axisymmetric(archive)

    def parts(label: str) -> Iterator[np.ndarray | None]:
        if _is_stored(archive, step, label, material):
            return archive.particle_parts(step, label, material)
        return repeat(None)

    positions = archive.particle_parts(step, archive.index.particle_position, material)
    for places, stored, volume in zip(positions, parts(DEFORMATION), parts(VOLUME), strict=False):
        deformation = np.broadcast_to(np.eye(3), (len(places), 3, 3)) if stored is None else stored
        if volume is None or layered.all():
            yield deformation * np.where(layered, cell, cell / 2.0)
            continue
        with np.errstate(divide="ignore", invalid="ignore"):
            if around_axis:  # the y axis
                area = volume / places[:, 0]
                filled = np.abs(area / np.linalg.det(deformation[:, :2, :2])) / np.prod(cell[:2])
            else:
                filled = np.abs(volume / np.linalg.det(deformation)) / np.prod(cell)
            share = filled ** (1.0 / np.count_nonzero(~layered))
        share = np.where(np.isfinite(share), share, 0.0)
        yield deformation * np.where(layered, cell, share[:, None] * cell)[:, None, :]


def _is_stored(archive: Archive, step: int, label: str, material: int) -> bool:
    return label in archive.labels(step) and material in archive.materials(step, label)


def _is_axisymmetric(archive: Archive) -> bool:
    """Whether the deck that an archive keeps asks for rotational symmetry."""
    path = archive.path / "input.xml"
    if not path.is_file():
        return False
    try:
        deck = parse(path)
    except ArchiveError:
        return False  # a damaged deck says nothing
    return any((tag.text or "").strip().lower() == "true" for tag in deck.iter("axisymmetric"))


def _layered_axes(archive: Archive, step: int, material: int, level: Level) -> np.ndarray:
    """Axes along which the grid has one cell and the material one particle."""
    single = np.array(level.interior.shape) == 1
    position = archive.index.particle_position
    if not single.any() or not _is_stored(archive, step, position, material):
        return np.zeros(3, dtype=bool)
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for places in archive.particle_parts(step, position, material):
        low, high = np.minimum(low, places.min(axis=0)), np.maximum(high, places.max(axis=0))
    return single & (high - low < 1e-6 * np.array(level.spacing))


def box_corners(positions: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Corners of boxes around positions, shape (n, 8, 3), in the order of VTK's hexahedron.

    Parameters
    ----------
    positions
        Centres, shape (n, 3).
    edges
        Edge vectors as columns, shape (n, 3, 3).
    """
    return positions[:, None, :] + np.einsum("nij,cj->nci", edges, _CORNERS - 0.5)


def positions_of(archive: Archive, step: int, material: int) -> np.ndarray:
    """Positions of the particles of a material, shape (n, 3).

    Raises
    ------
    ArchiveError
        Where they are not stored.
    """
    label = archive.index.particle_position
    if label not in archive.labels(step):
        message = f"the positions of the particles, {label}, are not stored"
        raise ArchiveError(archive.path, message, advice=f'add <save label="{label}"/> to the deck')
    return archive.particles(step, label, material)
