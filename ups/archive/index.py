"""The table of contents of an archive, ``index.xml``."""

from __future__ import annotations

import getpass
import time
from dataclasses import dataclass, field
from pathlib import Path

from ups.archive.blocks import ByteOrder
from ups.archive.markup import HEADER, Node, attributes, leaf, number

BYTE_ORDERS: dict[str, ByteOrder] = {"little_endian": "<", "big_endian": ">"}
"""numpy's sign for Uintah's name of a byte order."""


_LONGEST_TITLE = 1000  # Uintah's scanners read lines of up to 4094 characters, references included


@dataclass(frozen=True)
class Timestep:
    """One stored time step.

    Attributes
    ----------
    step
        Number of the step.
    time
        Simulation time at the end of the step.
    old_delt
        Size of the step.
    href
        Its ``timestep.xml``, relative to the archive.
    """

    step: int
    time: float
    old_delt: float
    href: str


@dataclass(frozen=True)
class Listed:
    """A variable as the table of contents lists it: name, type, file of a reduction, materials."""

    name: str
    type_name: str
    materials: int = -1
    href: str = ""


@dataclass(frozen=True)
class Restart:
    """A note that the run went on from another archive at a step."""

    source: str
    step: int


@dataclass
class ArchiveIndex:
    """What ``index.xml`` says.

    Attributes
    ----------
    processes
        Ranks that wrote the archive.
    particle_position
        Label of the particles' positions.
    title
        Title of the run; only this program writes one.
    username, date
        Who wrote it and when.
    endianness
        ``little_endian`` or ``big_endian``; a time step may say otherwise.
    bits
        Bits of an address, 32 or 64; the width of the size before a compressed block.
    globals_, variables
        Variables with one value a step, and all others.
    timesteps
        Stored steps in the order of the file.
    restarts
        Where the run was taken up again.
    """

    processes: int = 1
    particle_position: str = "p.x"
    title: str = ""
    username: str = ""
    date: str = ""
    endianness: str = "little_endian"
    bits: int = 64
    globals_: list[Listed] = field(default_factory=list)
    variables: list[Listed] = field(default_factory=list)
    timesteps: list[Timestep] = field(default_factory=list)
    restarts: list[Restart] = field(default_factory=list)

    @classmethod
    def new(cls, processes: int, title: str = "") -> ArchiveIndex:
        """Contents of an archive that holds nothing yet, by the present user, now."""
        short = " ".join(title.split())[:_LONGEST_TITLE]
        return cls(processes=processes, title=short, username=_user(), date=time.asctime())

    def lines(self) -> list[str]:
        """Lines of ``index.xml``, in the order and form that Uintah's scanners need."""
        lines = [
            HEADER,
            "<Uintah_DataArchive>",
            leaf(1, "numberOfProcessors", self.processes),
            leaf(1, "ParticlePosition", self.particle_position),
            leaf(1, "outputFormat", "UDA"),
            "  <Meta>",
            leaf(2, "username", self.username.strip() or "unknown"),
            leaf(2, "date", self.date.strip() or "unknown"),
            leaf(2, "endianness", self.endianness),
            leaf(2, "nBits", self.bits),
            *([leaf(2, "title", self.title)] if self.title else []),
            "  </Meta>",
        ]
        if self.globals_:
            lines += ["  <globals>", *map(_listed_line, self.globals_), "  </globals>"]
        lines += ["  <variables>", *map(_listed_line, self.variables), "  </variables>"]
        lines += ["  <timesteps>", *map(_timestep_line, self.timesteps), "  </timesteps>"]
        if self.restarts:
            lines += ["  <restarts>", *map(_restart_line, self.restarts), "  </restarts>"]
        lines.append("</Uintah_DataArchive>")
        return lines


def read_index(path: Path) -> ArchiveIndex:
    """Read ``index.xml``; what archives of other ages lack gets its default.

    Raises
    ------
    ArchiveError
        Where the file is missing, damaged, or lists a step without number, time or file.
    """
    root = Node.root(path, "Uintah_DataArchive")
    index = ArchiveIndex()
    if (node := root.child("numberOfProcessors")) is not None:
        index.processes = node.integer()
    if (node := root.child("ParticlePosition")) is not None:
        index.particle_position = node.text()
    if (node := root.child("outputFormat")) is not None and node.text().upper() == "PIDX":
        raise node.error("the archive is in the PIDX format", "convert it to UDA with Uintah first")
    if (node := root.child("Meta")) is not None:
        for tag in ("title", "username", "date"):
            if (item := node.child(tag)) is not None:
                setattr(index, tag, item.text())
        index.endianness, index.bits = read_representation(node, index.endianness, index.bits)
    index.globals_ = _listing(root.child("globals"))
    index.variables = _listing(root.child("variables"))
    if (node := root.child("timesteps")) is not None:
        index.timesteps = [_timestep(child) for child in node.children("timestep")]
    if (node := root.child("restarts")) is not None:
        index.restarts = [_restart(child) for child in node.children("restart")]
    return index


def read_representation(meta: Node, endianness: str, bits: int) -> tuple[str, int]:
    """Byte order and address width of a ``<Meta>`` block, the given ones where it is silent."""
    if (node := meta.child("endianness")) is not None:
        endianness = node.text()
        if endianness not in BYTE_ORDERS:
            raise node.error(f"unknown byte order {endianness!r}")
    if (node := meta.child("nBits")) is not None:
        bits = node.integer()
        if bits not in (32, 64):
            raise node.error(f"unknown address width {bits}")
    return endianness, bits


def _user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError, ImportError):  # no such user, as in some containers
        return "unknown"


def _listed_line(listed: Listed) -> str:
    href = attributes(href=listed.href) if listed.href else ""  # first, where Uintah's tests look for it
    count = attributes(numMaterials=listed.materials) if listed.materials >= 0 else ""
    return f"    <variable{href}{attributes(type=listed.type_name, name=listed.name)}{count}/>"


def _timestep_line(timestep: Timestep) -> str:
    values = attributes(href=timestep.href, time=number(timestep.time), oldDelt=number(timestep.old_delt))
    return f"    <timestep{values}>{timestep.step}</timestep>"


def _restart_line(restart: Restart) -> str:
    return f"    <restart{attributes(**{'from': restart.source, 'timestep': restart.step})}/>"


def _listing(block: Node | None) -> list[Listed]:
    if block is None:
        return []
    return [
        Listed(
            node.attribute("name"),
            node.attribute("type"),
            int(node.real("numMaterials")) if node.element.get("numMaterials") else -1,
            node.element.get("href", ""),
        )
        for node in block.children("variable")
    ]


def _timestep(node: Node) -> Timestep:
    old_delt = node.real("oldDelt") if node.element.get("oldDelt") else 0.0
    return Timestep(node.integer(), node.real("time"), old_delt, node.attribute("href"))


def _restart(node: Node) -> Restart:
    return Restart(node.attribute("from"), int(node.real("timestep")))
