"""What an interactive picture shows, and how it changes; the window and the web page put controls to it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ups.archive import Archive, ArchiveError
from ups.archive.index import Timestep
from ups.archive.variables import NODE
from ups.pictures.solid import Frame, Scene
from ups.pictures.view import Range, Slice, View, is_with_all, measure_names, range_of, usual_names

TOGETHER = "all"
"""How the choice of all materials is called."""


class Viewer:
    """A picture of an archive in a plotter, with what can be chosen about it.

    Colours cover what has been shown so far, so that they mean the same from step to step, until ends are
    set. An archive that is still being written is followed: see `refresh`.

    Parameters
    ----------
    archive_path
        The archive.
    plotter
        A pyvista plotter, to draw in.
    variable, step, plane, materials, level, limits, mirrored
        What is shown first, as for `ups.pictures.plot.plot`.
    frame
        Where in the plotter it is drawn.

    Attributes
    ----------
    position
        Index of the time step among `timesteps`.
    trouble
        Why the last choice or drawing failed, or nothing.
    plotter
        What it is drawn in.

    Raises
    ------
    ArchiveError
        Where the archive does not hold what is asked for.
    """

    def __init__(
        self,
        archive_path: str | Path,
        plotter: Any,
        variable: str | None = None,
        *,
        step: int = -1,
        plane: Slice | None = None,
        materials: Sequence[int] | None = None,
        level: int = 0,
        limits: tuple[float, float] | None = None,
        mirrored: Sequence[int] = (),
        frame: Frame | None = None,
    ) -> None:
        archive = Archive(archive_path)
        chosen = archive.timestep(step)
        options: dict[str, Any] = {"materials": materials, "level": level, "plane": plane}
        options["mirrored"] = mirrored
        self.view = View.choose(archive, variable, step=chosen.step, **options)
        self.position = archive.timesteps.index(chosen)
        self.trouble = self._refusal = ""
        self._all = materials is None
        self._limits = limits
        self._seen: Range | None = None
        self.plotter = plotter
        self._scene = Scene(plotter, frame)
        self._written = _stamp(archive)

    @property
    def timesteps(self) -> Sequence[Timestep]:
        """Time steps of the archive."""
        return self.view.archive.timesteps

    @property
    def step(self) -> int:
        """Number of the time step that is shown."""
        return self.timesteps[self.position].step

    @property
    def variable(self) -> str:
        """Name of what is shown."""
        return self.view.named.declaration.name

    @property
    def variables(self) -> list[str]:
        """What is usually looked at, and what is shown."""
        try:
            names = usual_names(self.view.archive, self.step)
        except ArchiveError:  # a damaged step; `draw` says so
            names = []
        return names if self.variable in names else [self.variable, *names]

    @property
    def measures(self) -> list[str]:
        """What else can be shown: measures and components of vectors and tensors."""
        try:
            return measure_names(self.view.archive, self.step)
        except ArchiveError:
            return []

    @property
    def material(self) -> str:
        """The material that is shown: `TOGETHER`, or its index."""
        return TOGETHER if self._all else ", ".join(map(str, self.view.materials))

    @property
    def materials(self) -> list[str]:
        """Materials that can be shown."""
        archive, source = self.view.archive, self.view.named.source
        try:
            stored = archive.materials(self.step, source.name)
            with_all = source.container == NODE and is_with_all(archive, self.step, stored)
        except ArchiveError:
            return [self.material]
        if with_all:
            return [TOGETHER, *map(str, stored[:-1])]
        if source.is_particle and len(stored) > 1:
            return [TOGETHER, *map(str, stored)]
        return list(map(str, stored)) if source.is_grid else [TOGETHER]

    @property
    def limits(self) -> tuple[float, float]:
        """Ends of the colour bar."""
        if self._limits is not None:
            return self._limits
        return self._seen.values if self._seen is not None else (0.0, 1.0)

    @property
    def covered(self) -> tuple[float, float]:
        """Smallest and largest number that has been shown of the variable."""
        return self._seen.values if self._seen is not None else self.limits

    def show_variable(self, name: str) -> None:
        """Show another variable, of all materials where the present one does not have it."""
        if name != self.variable and not self._choose(name, None if self._all else self.view.materials):
            self._choose(name, None)

    def show_material(self, name: str) -> None:
        """Show one material, or `TOGETHER`."""
        if name != self.material:
            self._choose(self.variable, None if name == TOGETHER else [int(name)])

    def show_position(self, position: int) -> None:
        """Show the time step of an index among `timesteps`; beyond the ends is the nearest end."""
        self.position = min(max(position, 0), len(self.timesteps) - 1)

    def show_next(self) -> None:
        """Show the next time step, after the last the first."""
        self.position = (self.position + 1) % len(self.timesteps)

    def reset_camera(self) -> None:
        """Look again from where the picture was first seen."""
        self._scene.reset_camera()

    def set_limits(self, low: float, high: float) -> None:
        """Set the ends of the colour bar.

        Raises
        ------
        ValueError
            Where the low end is not below the high one.
        """
        if not low < high:
            raise ValueError(f"{low:g} is not below {high:g}")
        self._limits = (low, high)

    def fit_step(self) -> None:
        """Let the colours cover the present time step."""
        self._limits = self._seen = None

    def fit_all(self) -> None:
        """Let the colours cover all time steps, each of which is read for it."""
        label = self.view.named.source.name
        try:
            steps = [t.step for t in self.timesteps if label in self.view.archive.labels(t.step)]
            self._limits, self._seen = None, range_of(self.view, steps)
        except ArchiveError as problem:
            self._refusal = str(problem)

    def refresh(self) -> bool:
        """Look for time steps written since; where the last was shown, show the new last. Whether there are."""
        stamp = _stamp(self.view.archive)
        if stamp == self._written:
            return False
        self._written = stamp
        try:
            archive = Archive(self.view.archive.path)
        except ArchiveError:
            return False  # it is being replaced or removed
        if not archive.timesteps:
            return False
        at_end = self.position == len(self.timesteps) - 1
        grown = len(archive.timesteps) != len(self.timesteps)
        self.view = replace(self.view, archive=archive)
        self.show_position(len(archive.timesteps) - 1 if at_end else self.position)
        return grown

    def draw(self) -> None:
        """Draw what is chosen; what cannot be drawn is said in `trouble` and left as it was."""
        self.trouble, self._refusal = self._refusal, ""
        try:
            now = range_of(self.view, [self.step])
            self._seen = now if self._seen is None else self._seen.joined(now)
            self._scene.draw(self.view, self.step, replace(self._seen, values=self.limits))
        except ArchiveError as problem:
            self.trouble = str(problem)

    def _choose(self, variable: str, materials: Sequence[int] | None) -> bool:
        """Show a variable of some materials; whether it can be."""
        view = self.view
        options: dict[str, Any] = {"materials": materials, "level": view.level, "plane": view.plane}
        options["mirrored"] = view.mirrored
        try:
            self.view = View.choose(view.archive, variable, step=self.step, **options)
        except ArchiveError as problem:
            self._refusal = str(problem)
            return False
        self._all, self._refusal = materials is None, ""
        self._limits = self._seen = None
        return True


def _stamp(archive: Archive) -> tuple[int, int]:
    """What changes when an archive's table of contents does."""
    try:
        status = (archive.path / "index.xml").stat()
    except OSError:
        return (0, 0)
    return status.st_mtime_ns, status.st_ino
