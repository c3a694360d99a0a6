"""Rods that fly into a rigid wall: the deck of a shot, its run, and what is measured on the recovered rod."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from string import Template
from typing import NamedTuple

import numpy as np

import ups

HERE = Path(__file__).parent
WIDTH = 3.2
"""Of the grid, in radii of the rod: more than any foot reaches."""
PARTICLES_A_CELL = 2
"""Along each axis."""


class Answer(NamedTuple):
    """A published value and how far from it the run may end, as a fraction of it."""

    value: float
    tolerance: float


@dataclass(frozen=True)
class Shot:
    """A rod and how it is shot; SI units. ``constants`` and ``models`` are include files.

    ``answers`` are published values by the names of ``Rod``'s fields.
    """

    title: str
    length: float
    radius: float
    speed: float
    temperature: float
    duration: float
    viscosity: bool
    """Artificial viscosity."""
    constants: tuple[str, ...]
    models: tuple[str, ...]
    answers: dict[str, Answer]
    source: str


class Rod(NamedTuple):
    """The recovered rod."""

    length: float
    """Over that at the start."""
    foot: float
    """Radius of the foot over that of the rod."""
    temperature: float
    """At the centre of the face that hit the wall, K."""
    plastic_strain: float
    """At the same place."""
    energy: float
    """Kinetic energy that is left, over that at the start."""


def shots() -> dict[str, Shot]:
    """All shots by name."""
    found = {}
    for name, values in json.loads((HERE / "shots.json").read_text()).items():
        answers = {quantity: Answer(**answer) for quantity, answer in values.pop("answers").items()}
        found[name] = Shot(**values, answers=answers)
    return found


def mesh(shot: Shot, cells: int) -> tuple[float, float]:
    """Cell sizes along radius and axis, so that whole cells of nearly equal sides fill the rod."""
    across = shot.radius / cells
    return across, shot.length / round(shot.length / across)


def deck(shot: Shot, cells: int) -> str:
    """The deck of a shot with so many cells on the radius."""
    across, along = mesh(shot, cells)
    cells_across = math.ceil(WIDTH * cells)
    cells_along = round(shot.length / along) + 2
    return Template((HERE / "rod.ups.in").read_text()).substitute(
        name=shot.title,
        duration=shot.duration,
        viscosity=str(shot.viscosity).lower(),
        output_interval=shot.duration / 4.0,
        width=cells_across * across,
        height=cells_along * along,
        thickness=across,
        cells_across=cells_across,
        cells_along=cells_along,
        constants=includes(shot.constants),
        models=includes(shot.models),
        radius=shot.radius,
        length=shot.length,
        speed=shot.speed,
        temperature=shot.temperature,
    )


def includes(files: tuple[str, ...]) -> str:
    """Include tags, one for each file."""
    return "\n".join(f'<include href="{file}"/>' for file in files)


def shoot(shot: Shot, cells: int, folder: Path) -> Rod:
    """Run a shot and measure the rod; particles end half their stretched size beyond their middle."""
    result = ups.read(HERE / "rod.ups", text=deck(shot, cells)).run(output=folder / "taylor.uda")
    position, F = result["p.x"][-1], result["p.deformationMeasure"][-1]
    across, along = (0.5 * size / PARTICLES_A_CELL for size in mesh(shot, cells))
    centre = int(np.argmin(position[:, 0] ** 2 + position[:, 1] ** 2))
    _, energy = result.history("KineticEnergy")
    return Rod(
        length=float((position[:, 1] + along * F[:, 1, 1]).max() / shot.length),
        foot=float((position[:, 0] + across * F[:, 0, 0]).max() / shot.radius),
        temperature=float(result["p.temperature"][-1][centre]),
        plastic_strain=float(result["p.plasticStrain"][-1][centre]),
        energy=float(energy[-1] / energy[0]),
    )
