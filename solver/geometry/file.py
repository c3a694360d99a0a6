"""Bodies given particle by particle in a file."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated

import numpy as np

from solver.declare import Parameter, Vector, model
from solver.geometry.piece import Array, BoundingBox, GeometryPiece, OpenFile, as_vector
from solver.geometry.read_table import existing_file, find_file, read_table

COLUMNS = {
    "p.volume": 1,
    "p.temperature": 1,
    "p.color": 1,
    "p.externalforce": 3,
    "p.fiberdir": 3,
    "p.rvec1": 3,
    "p.rvec2": 3,
    "p.rvec3": 3,
    "p.velocity": 3,
    "p.loadCurveID": 3,
    "p.normal": 3,
    "p.concentration": 1,
}
"""Variables that a file can hold after the position, and the number of columns of each."""

FIELDS = {
    "p.temperature": "temperature",
    "p.color": "color",
    "p.externalforce": "external_force",
    "p.velocity": "velocity",
    "p.loadCurveID": "load_curve",
    "p.normal": "normal",
    "p.concentration": "concentration",
}
"""Variables that are handed on as they are, and the names that particles have for them."""

BOX_NUMBERS = 6
"""Numbers of the bounding box with which each file for a patch begins."""


@model("geometry", "file")
@dataclass(frozen=True)
class File(GeometryPiece):
    """Particles listed in a file: a position in each row, then the variables that ``var`` names, in order.

    Without a volume or particle vectors, ``res`` says how large a particle is. A volume alone makes it a
    cube; the vectors p.rvec1, p.rvec2, p.rvec3 alone make its volume.
    """

    name: Annotated[str, Parameter("file of the particles")]
    var: Annotated[
        tuple[str, ...], Parameter("variable that follows the position in each row", choices=tuple(COLUMNS))
    ] = ()
    format: Annotated[
        str,
        Parameter(
            "text, or binary doubles: lsb (least significant byte first), msb, or bin (as on this machine)",
            choices=("text", "lsb", "msb", "bin"),
        ),
    ] = "text"
    per_patch: Annotated[
        bool,
        Parameter(
            "read name.0, name.1, .. for each patch, beginning with the box around all; if there are none, "
            "the file itself is read",
            tag="usePFS",
        ),
    ] = True
    table: Array | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        for variable in self.var:
            if variable not in COLUMNS:
                raise ValueError(f"var is {variable!r}; it must be one of {', '.join(COLUMNS)}")

    @property
    def columns(self) -> int:
        """Numbers in a row of the file."""
        return 3 + sum(COLUMNS[variable] for variable in self.var)

    def load(self, open_file: OpenFile) -> File:
        """The piece with its rows; ValueError if a file is missing or wrong."""
        parts: list[Array] = []
        if self.per_patch:
            while (path := existing_file(open_file, f"{self.name}.{len(parts)}")) is not None:
                parts.append(self._read(path, has_box=True))
        if not parts:
            path = find_file(open_file, self.name, "the particles of the body")
            parts.append(self._read(path, has_box=False))
        return replace(self, table=np.concatenate(parts))

    def _read(self, path: Path, has_box: bool) -> Array:
        """The rows of a file, (n, columns)."""
        if self.format == "text":
            with path.open("rb") as file:
                only_box = has_box and not b"".join([*file][1:]).strip()
            if only_box:
                return np.zeros((0, self.columns))
            return read_table(path, self.columns, skip=1 if has_box else 0)
        order = {"lsb": "<", "msb": ">", "bin": "<" if sys.byteorder == "little" else ">"}[self.format]
        numbers = np.fromfile(path, f"{order}f8").astype(float)[BOX_NUMBERS if has_box else 0 :]
        if len(numbers) % self.columns or path.stat().st_size % 8:
            raise ValueError(f"{path}: not a whole number of rows of {self.columns} doubles")
        return numbers.reshape(-1, self.columns)

    def rows(self) -> Array:
        """The rows of the file (n, columns); ValueError before they are loaded."""
        if self.table is None:
            raise ValueError(f"the particle file {self.name!r} has not been read")
        return self.table

    def inside(self, points: Array) -> Array:
        """Whether points (n, 3) lie in the box around the particles."""
        lower, upper = self.bounding_box()
        return np.all((points >= lower) & (points <= upper), axis=1)

    def bounding_box(self) -> BoundingBox:
        """The box around the particles, of no size where there are none."""
        positions = self.rows()[:, :3]
        if not len(positions):
            return BoundingBox((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        return BoundingBox(as_vector(positions.min(axis=0)), as_vector(positions.max(axis=0)))

    def particles(self, spacing: Vector, tetrahedral: bool) -> dict[str, Array]:
        """The particles in the order of the file."""
        rows = self.rows()
        ends = np.cumsum([3, *(COLUMNS[variable] for variable in self.var)])
        given = {
            variable: rows[:, end - COLUMNS[variable] : end]
            for variable, end in zip(self.var, ends[1:], strict=True)
        }
        made = {"position": rows[:, :3], "surface": np.ones(len(rows))}
        for variable, name in FIELDS.items():
            if variable in given:
                made[name] = given[variable][:, 0] if COLUMNS[variable] == 1 else given[variable]
        return made | _size_and_volume(given, spacing, tetrahedral)


def _size_and_volume(given: dict[str, Array], spacing: Vector, tetrahedral: bool) -> dict[str, Array]:
    """The particle vectors as columns in cell units (n, 3, 3), and the volumes, as far as a file gives them.

    Left-handed vectors are made right-handed by exchanging the second and the third.
    """
    vectors = [given.get(f"p.rvec{k}") for k in (1, 2, 3)]
    count = len(next(iter(given.values()), ()))
    if all(vector is None for vector in vectors):
        if "p.volume" not in given:
            return {}
        volume = given["p.volume"][:, 0]
        size = np.cbrt(volume)[:, None, None] * np.eye(3)
        return {"size": size / np.array(spacing)[:, None], "volume": volume}
    size = np.tile(np.diag(spacing), (count, 1, 1))
    for column, vector in enumerate(vectors):
        if vector is not None:
            size[:, :, column] = vector
    left_handed = np.linalg.det(size) < 0.0
    size[left_handed] = size[left_handed][:, :, [0, 2, 1]]
    volume = np.linalg.det(size) / (6.0 if tetrahedral else 1.0)
    if "p.volume" in given:
        volume = given["p.volume"][:, 0]
    return {"size": size / np.array(spacing)[:, None], "volume": volume}
