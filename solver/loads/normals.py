"""Normals that particle files give to particles."""

from __future__ import annotations

import numpy as np

from solver.geometry.piece import Array

NO_NORMALS = np.zeros((0, 3))
"""For loads that ask for none."""


class ParticleNormals:
    """The normals (n, 3) of particles with ids (n,), found again by id when particles have been lost."""

    def __init__(self, ids: Array, normals: Array) -> None:
        order = np.argsort(ids)
        self._ids, self._known = ids[order], normals[order]
        self._last_ids, self._last = np.zeros(0, np.int64), NO_NORMALS

    def of(self, ids: Array) -> Array:
        """The normals (n, 3) of the particles with these ids (n,), zero where none is known."""
        if not np.array_equal(ids, self._last_ids):
            place = np.clip(np.searchsorted(self._ids, ids), 0, max(len(self._ids) - 1, 0))
            found = self._ids[place] == ids if len(self._ids) else np.zeros(len(ids), bool)
            normals = np.zeros((len(ids), 3))
            normals[found] = self._known[place[found]]
            self._last_ids, self._last = ids.copy(), normals
        return self._last
