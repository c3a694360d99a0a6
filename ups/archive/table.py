"""The table of blocks of one rank and level, ``pRRRRR.xml``, and that of a checkpoint's globals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ups.archive import checksums
from ups.archive.layout import IntVector
from ups.archive.markup import HEADER, Node, leaf, quoted, triple


@dataclass(frozen=True)
class Entry:
    """Where the numbers of one variable, material and patch are stored.

    Attributes
    ----------
    name
        Label of the variable.
    type_name
        Uintah's type, such as ``NCVariable<double>``.
    material, patch
        Indices; -1 for values that belong to none.
    start, end
        First byte and first byte beyond, in the data file.
    filename
        Name of the data file, in the directory of the table.
    compression
        ``""`` or ``"gzip"``.
    particles
        Number of particles, or None where the block holds none.
    boundary_layer
        Extra layers that replace the level's own for this variable, or None.
    checksum
        Sum of the stored bytes as `checksums` writes it, or empty where it is not known.
    line
        Line of the table the entry was read from; 0 for a new one.
    """

    name: str
    type_name: str
    material: int
    patch: int
    start: int
    end: int
    filename: str
    compression: str = ""
    particles: int | None = None
    boundary_layer: IntVector | None = None
    checksum: str = ""
    line: int = 0


def table_lines(entries: Sequence[Entry]) -> list[str]:
    """Lines of the table that lists `entries`."""
    lines = [HEADER, "<Uintah_Output>"]
    for entry in entries:
        lines.append(f"  <Variable type={quoted(entry.type_name)}>")
        lines += [
            leaf(2, "variable", entry.name),
            leaf(2, "index", entry.material),
            leaf(2, "patch", entry.patch),
        ]
        if entry.boundary_layer is not None:
            lines.append(leaf(2, "boundaryLayer", triple(entry.boundary_layer)))
        lines.append(leaf(2, "start", entry.start))
        if entry.particles is not None:
            lines.append(leaf(2, "numParticles", entry.particles))
        if entry.compression:
            lines.append(leaf(2, "compression", entry.compression))
        lines += [leaf(2, "end", entry.end), leaf(2, "filename", entry.filename), "  </Variable>"]
    lines.append("</Uintah_Output>")
    return lines


def read_table(path: Path) -> list[Entry]:
    """Read the entries of a table, with their checksums where these lie beside it.

    Raises
    ------
    ArchiveError
        Where the file is missing, damaged, or an entry lacks something or points outside its folder.
    """
    nodes = Node.root(path, "Uintah_Output").children("Variable")
    sums = checksums.of_blocks(path, len(nodes))
    return [replace(_entry(node), checksum=sum_) for node, sum_ in zip(nodes, sums, strict=True)]


def _entry(node: Node) -> Entry:
    particles, compression, layer = (
        node.child(tag) for tag in ("numParticles", "compression", "boundaryLayer")
    )
    entry = Entry(
        name=node.need("variable").text(),
        type_name=node.attribute("type"),
        material=node.need("index").integer(),
        patch=node.need("patch").integer(),
        start=node.need("start").integer(),
        end=node.need("end").integer(),
        filename=node.need("filename").text(),
        compression="" if compression is None or compression.text() == "none" else compression.text(),
        particles=None if particles is None else particles.integer(),
        boundary_layer=None if layer is None else layer.integer_triple(),
        line=node.element.sourceline or 0,
    )
    if entry.compression not in ("", "gzip"):
        raise node.error(
            f"unknown compression {entry.compression!r}", "convert the archive with Uintah first"
        )
    if not 0 <= entry.start <= entry.end or (entry.particles or 0) < 0:
        raise node.error(f"bytes {entry.start} to {entry.end} of {entry.name} are not a block")
    if not entry.name or Path(entry.filename).name != entry.filename:
        raise node.error(f"{entry.filename!r} is not the name of a file beside this one")
    return entry
