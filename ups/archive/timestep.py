"""The description of one stored time step, ``timestep.xml``: its grid, data files and components."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lxml import etree

from ups.archive.blocks import ByteOrder
from ups.archive.errors import ArchiveError
from ups.archive.index import BYTE_ORDERS, ArchiveIndex, Timestep, read_representation
from ups.archive.layout import Box, FloatVector, Grid, Level, Patch
from ups.archive.markup import HEADER, Node, attributes, escape, leaf, number, triple
from ups.archive.variables import CELL, NODE

_BINARY_MARK = 0xDEADBEEF


@dataclass(frozen=True)
class TimestepFile:
    """What ``timestep.xml`` says.

    Attributes
    ----------
    grid
        Levels and patches of the step.
    byte_order
        ``"<"`` or ``">"``, of the data files.
    size_bytes
        Bytes of the size in front of a compressed block, 4 or 8.
    sections
        What the components of the code added, such as ``<MPM>`` and ``<MaterialProperties>``.
    time
        Time at the end of the step, or None where the file does not say.
    """

    grid: Grid
    byte_order: ByteOrder
    size_bytes: int
    sections: tuple[etree._Element, ...]
    time: float | None = None


def timestep_lines(
    timestep: Timestep, grid: Grid, *, has_globals: bool, sections: Sequence[etree._Element]
) -> list[str]:
    """Lines of ``timestep.xml``, in the order and form that Uintah's scanners need."""
    lines = [
        HEADER,
        "<Uintah_timestep>",
        "  <Meta>",
        leaf(2, "endianness", "little_endian"),
        leaf(2, "nBits", 64),
        leaf(2, "numProcs", grid.number_of_processes),
        "  </Meta>",
        "  <Time>",
        leaf(2, "timestepNumber", timestep.step),
        leaf(2, "currentTime", number(timestep.time)),
        leaf(2, "oldDelt", number(timestep.old_delt)),
        "  </Time>",
        "  <Grid>",
        leaf(2, "numLevels", len(grid.levels)),
    ]
    for level in grid.levels:
        lines += _level_lines(level)
    lines += ["  </Grid>", "  <Data>"]
    for level in grid.levels:
        for proc in sorted({patch.proc for patch in level.patches}):
            href = f"l{level.index}/p{proc:05d}.xml"
            lines.append(f"    <Datafile{attributes(href=href, proc=proc)}/>")
    if has_globals:
        lines.append(f"    <Datafile{attributes(href='global.xml')}/>")
    lines.append("  </Data>")
    for section in sections:
        lines += _section_lines(section, 1)
    lines.append("</Uintah_timestep>")
    return lines


def _level_lines(level: Level) -> Iterator[str]:
    yield "    <Level>"
    if any(level.periodic):
        periodic = tuple(map(int, level.periodic))
        yield leaf(3, "periodic", triple((periodic[0], periodic[1], periodic[2])))
    yield leaf(3, "numPatches", len(level.patches))
    yield leaf(3, "totalCells", level.total_cells)
    if any(level.extra_cells):
        yield leaf(3, "extraCells", triple(level.extra_cells))
    yield leaf(3, "anchor", triple(level.anchor))
    yield leaf(3, "id", level.index)
    yield leaf(3, "cellspacing", triple(level.spacing))
    for position in range(len(level.patches)):
        yield from _patch_lines(level, position)
    yield "    </Level>"


def _patch_lines(level: Level, position: int) -> Iterator[str]:
    patch, stored = level.patches[position], level.extent(position, CELL)
    lower, upper = level.bounds(stored)
    yield "      <Patch>"
    yield leaf(4, "id", patch.id)
    yield leaf(4, "proc", patch.proc)
    yield leaf(4, "lowIndex", triple(stored.low))
    yield leaf(4, "highIndex", triple(stored.high))
    if patch.low != stored.low:
        yield leaf(4, "interiorLowIndex", triple(patch.low))
    if patch.high != stored.high:
        yield leaf(4, "interiorHighIndex", triple(patch.high))
    yield leaf(4, "nnodes", level.extent(position, NODE).size)
    yield leaf(4, "lower", triple(lower))
    yield leaf(4, "upper", triple(upper))
    yield leaf(4, "totalCells", stored.size)
    yield "      </Patch>"


def _section_lines(element: etree._Element, indent: int) -> Iterator[str]:
    """Lines of an element and what it holds, each tag and text on one line, without comments."""
    blank, name = "  " * indent, element.tag
    start = name + attributes(**{str(key): value for key, value in element.attrib.items()})
    text = element.text or ""
    text += "".join(child.tail or "" for child in element if not isinstance(child.tag, str))
    children = [child for child in element if isinstance(child.tag, str)]
    if children:
        yield f"{blank}<{start}>"
        if text.strip():
            yield f"{blank}  {escape(' '.join(text.split()))}"
        for child in children:
            yield from _section_lines(child, indent + 1)
        yield f"{blank}</{name}>"
    elif text.strip():
        yield leaf(indent, name, text).replace(f"<{name}>", f"<{start}>", 1)
    else:
        yield f"{blank}<{start}/>"


def read_timestep(path: Path, index: ArchiveIndex, timestep: Timestep) -> TimestepFile:
    """Read the ``timestep.xml`` at `path`, which `index` lists as `timestep`.

    A ``grid.xml`` beside it, as text or binary, takes the place of its ``<Grid>``.

    Raises
    ------
    ArchiveError
        Where the file is missing or damaged, belongs to another step, or describes no usable grid.
    """
    root = Node.root(path, "Uintah_timestep")
    endianness, bits = index.endianness, index.bits
    if (meta := root.child("Meta")) is not None:
        endianness, bits = read_representation(meta, endianness, bits)
    stamp = root.child("Time")
    stored = None if stamp is None else stamp.child("timestepNumber")
    if stored is not None and stored.integer() != timestep.step:
        raise stored.error(f"this is step {stored.text()}, but index.xml lists it as step {timestep.step}")
    grid_file = path.with_name("grid.xml")
    if not grid_file.exists():
        grid = _read_grid(root.need("Grid"))
    elif _is_binary(grid_file):
        grid = _read_binary_grid(grid_file)
    else:
        grid = _read_grid(Node.root(grid_file, "Grid"))
    known = ("Meta", "Time", "Grid", "Data")
    sections = tuple(child for child in root.element.iterchildren("*") if child.tag not in known)
    time = None if stamp is None else stamp.child("currentTime")
    return TimestepFile(
        grid, BYTE_ORDERS[endianness], bits // 8, sections, None if time is None else time.real()
    )


def contradictions(path: Path, grid: Grid) -> Iterator[ArchiveError]:
    """What the ``timestep.xml`` at `path` says of its patches that does not follow from their cells.

    Sizes, and positions of corners, which no reader needs; but a changed digit of an anchor or a spacing
    is found by them.
    """
    described = Node.root(path, "Uintah_timestep").child("Grid")
    for level, node in zip(
        grid.levels, [] if described is None else described.children("Level"), strict=False
    ):
        counts = {"totalCells": level.total_cells}
        yield from _unequal(node, counts, {}, level)
        for position, patch in enumerate(node.children("Patch")):
            stored = level.extent(position, CELL)
            counts = {"totalCells": stored.size, "nnodes": level.extent(position, NODE).size}
            corners = dict(zip(("lower", "upper"), level.bounds(stored), strict=True))
            yield from _unequal(patch, counts, corners, level)


def _unequal(
    node: Node, counts: Mapping[str, int], corners: Mapping[str, FloatVector], level: Level
) -> Iterator[ArchiveError]:
    """Errors about children that are there and not as they are due."""
    for tag, count in counts.items():
        if (child := node.child(tag)) is not None and child.integer() != count:
            yield child.error(f"<{tag}> is {child.text()} where the cells give {count}")
    for tag, corner in corners.items():
        child = node.child(tag)
        slack = 1e-6 * np.array(level.spacing) + 1e-9 * np.abs(corner)
        if child is not None and (np.abs(np.subtract(child.real_triple(), corner)) > slack).any():
            yield child.error(f"<{tag}> is {child.text()} where the cells give {triple(corner)}")


def _read_grid(node: Node) -> Grid:
    levels = [_read_level(position, child) for position, child in enumerate(node.children("Level"))]
    if (count := node.child("numLevels")) is not None and count.integer() != len(levels):
        raise count.error(f"{count.text()} levels are announced, {len(levels)} described")
    try:
        return Grid(tuple(levels))
    except ValueError as error:
        raise node.error(str(error)) from None


def _read_level(index: int, node: Node) -> Level:
    extra, periodic = node.child("extraCells"), node.child("periodic")
    wraps = (0, 0, 0) if periodic is None else periodic.integer_triple()
    patches = tuple(_read_patch(child) for child in node.children("Patch"))
    if (count := node.child("numPatches")) is not None and count.integer() != len(patches):
        raise count.error(f"{count.text()} patches are announced, {len(patches)} described")
    try:
        return Level(
            index,
            node.need("anchor").real_triple(),
            node.need("cellspacing").real_triple(),
            (0, 0, 0) if extra is None else extra.integer_triple(),
            (wraps[0] != 0, wraps[1] != 0, wraps[2] != 0),
            patches,
        )
    except ValueError as error:
        raise node.error(str(error)) from None


def _read_patch(node: Node) -> Patch:
    low = node.child("interiorLowIndex") or node.need("lowIndex")
    high = node.child("interiorHighIndex") or node.need("highIndex")
    box = Box(low.integer_triple(), high.integer_triple())
    return Patch(node.need("id").integer(), node.need("proc").integer(), *box)


def _is_binary(path: Path) -> bool:
    with path.open("rb") as file:
        mark = file.read(4)
    return mark in (struct.pack("<I", _BINARY_MARK), struct.pack(">I", _BINARY_MARK))


class _Packed:
    """Numbers packed one after the other in a file."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.raw = path.read_bytes()
        self.sign = "<" if self.raw[:4] == struct.pack("<I", _BINARY_MARK) else ">"
        self.offset = 0

    def take(self, form: str) -> tuple:
        """Take the numbers that `form`, in the notation of `struct`, describes."""
        try:
            values = struct.unpack_from(self.sign + form, self.raw, self.offset)
        except struct.error:
            raise self.error("the file ends too early") from None
        self.offset += struct.calcsize(self.sign + form)
        return values

    def error(self, message: str) -> ArchiveError:
        """Error at the present place of the file."""
        advice = "the archive is damaged or was cut off while it was written"
        return ArchiveError(self.path, message, offset=self.offset, advice=advice)


def _read_binary_grid(path: Path) -> Grid:
    """Read Uintah's packed form of ``<Grid>``: see the order of the fields below."""
    packed = _Packed(path)
    _mark, count = packed.take("Ii")
    levels = []
    for index in range(count):
        patch_count, _cells = packed.take("iq")
        extra = packed.take("3i")
        anchor, periodic, _level_id, spacing = (
            packed.take("3d"),
            packed.take("3i"),
            packed.take("i"),
            packed.take("3d"),
        )
        patches = []
        for _ in range(patch_count):
            number_, proc, *_box = packed.take("ii6i")
            interior = packed.take("6i")
            _nodes, *_bounds, _total = packed.take("i6di")
            patches.append(Patch(number_, proc, interior[:3], interior[3:]))
        wraps = (periodic[0] != 0, periodic[1] != 0, periodic[2] != 0)
        try:
            levels.append(Level(index, anchor, spacing, extra, wraps, tuple(patches)))
        except ValueError as error:
            raise packed.error(str(error)) from None
    if packed.take("I") != (_BINARY_MARK,):
        raise packed.error("the closing mark is missing")
    try:
        return Grid(tuple(levels))
    except ValueError as error:
        raise packed.error(str(error)) from None
