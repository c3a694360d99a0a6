"""An archive together with those of the runs that its own was taken up from.

Uintah's restart begins a new archive, which notes where it went on from: ``<restart from="bar.uda.000"
timestep="51"/>``. The time steps and histories up to there stay in the earlier archive.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from ups.archive.reader import Archive
from ups.archive.reductions import Reduction


def with_earlier_runs(archive: Archive, seen: frozenset[Path] = frozenset()) -> Archive:
    """See `Archive.with_earlier_runs`."""
    here = archive.path.resolve()
    for restart in reversed(archive.index.restarts):
        for path in (Path(restart.source), here.parent / Path(restart.source).name):
            if (path / "index.xml").is_file() and path.resolve() not in {here, *seen}:
                earlier = with_earlier_runs(Archive(path), seen | {here})
                return _Continued(earlier, archive, restart.step)
    return archive


class _Continued(Archive):
    """An archive with the time steps of an earlier one before its own."""

    def __init__(self, earlier: Archive, later: Archive, step: int) -> None:
        super().__init__(later.path)
        self._histories = _Histories(earlier, later)
        own = {timestep.step for timestep in later.timesteps}
        self.index.timesteps[:0] = [
            replace(timestep, href=str(earlier.path.resolve() / timestep.href))
            for timestep in earlier.timesteps
            if timestep.step <= step and timestep.step not in own
        ]
        known = {listed.name for listed in later.index.variables}
        self.index.variables += [listed for listed in earlier.index.variables if listed.name not in known]

    @property
    def reductions(self) -> Mapping[str, Reduction]:
        """Histories by name, the lines of the earlier archive before those of the later."""
        return self._histories


class _Histories(Mapping[str, Reduction]):
    """Histories of two archives, joined when they are taken."""

    def __init__(self, earlier: Archive, later: Archive) -> None:
        self._earlier = earlier.reductions
        self._later = later.reductions

    def __getitem__(self, key: str) -> Reduction:
        later = self._later[key]
        if key not in self._earlier or not len(later.times):
            return later
        earlier = self._earlier[key]
        before = earlier.times < later.times[0]  # never where a file has no times
        if not before.any():
            return later
        return Reduction(
            later.name,
            later.material,
            np.concatenate([earlier.times[before], later.times]),
            None
            if earlier.steps is None or later.steps is None
            else np.concatenate([earlier.steps[before], later.steps]),
            np.concatenate([earlier.values[before], later.values]),
        )

    def __iter__(self) -> Iterator[str]:
        return iter(self._later)

    def __len__(self) -> int:
        return len(self._later)
