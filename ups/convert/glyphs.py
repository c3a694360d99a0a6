"""Particles as boxes, deformed as their material is."""

from __future__ import annotations

import numpy as np

from ups.archive import Archive, ArchiveError, Level

DEFORMATION, VOLUME = "p.deformationMeasure", "p.volume"

_CORNERS = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=float
)
"""Corners of a unit cube in the order of VTK's hexahedron."""


def particle_edges(archive: Archive, step: int, material: int, level: Level) -> np.ndarray:
    """Edge vectors of the boxes that particles fill, the columns of matrices of shape (n, 3, 3).

    A particle starts as a cube and is deformed by its ``p.deformationMeasure`` F, of a size that gives it
    its ``p.volume``. Without F the box stays a cube; without a volume it is that of a particle of which
    a cell holds eight.
    """
    stored = archive.labels(step)
    count = archive.particle_count(step, material)
    deformation = np.broadcast_to(np.eye(3), (count, 3, 3))
    if DEFORMATION in stored and material in archive.materials(step, DEFORMATION):
        deformation = archive.particles(step, DEFORMATION, material)
    if VOLUME not in stored or material not in archive.materials(step, VOLUME):
        return deformation * (np.array(level.spacing) / 2.0)
    volume = archive.particles(step, VOLUME, material)
    with np.errstate(divide="ignore", invalid="ignore"):
        side = np.cbrt(np.abs(volume / np.linalg.det(deformation)))
    return deformation * np.where(np.isfinite(side), side, 0.0)[:, None, None]


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
