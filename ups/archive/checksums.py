"""Checksums beside the files of an archive, by which a changed byte is found.

Uintah's format has none. Beside each XML file ``name.xml`` that this program writes lies ``name.crc32``, which
no tool of Uintah opens: lines of eight hexadecimal digits, the CRC-32 of the XML file and then that of
each block of data that it lists, in its order. The first line may hold a second sum, that of the file
which is about to take the place of the present one. ``histories.crc32`` has, for each history, the sum and the
length of the part that it covers. A file without its sums, such as one that sus wrote, is not checked.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path

from ups.archive.errors import ArchiveError

SUFFIX = ".crc32"
HISTORIES = f"histories{SUFFIX}"

CHANGED = "the file was changed or damaged after it was written"
_ADVICE = "ups check lists what is whole; ups check --repair makes the archive readable up to there"
_SUMS = re.compile(r"[0-9a-f]{8}( [0-9a-f]{8})?(\n[0-9a-f]{8})*\n")
_HISTORY = re.compile(r"([0-9a-f]{8}) (\d{1,18}) ([^/]+)")


def crc32(raw: bytes | memoryview, before: int = 0) -> int:
    """CRC-32 of some bytes, or of these behind others whose sum is `before`."""
    return zlib.crc32(raw, before)


def text(checksum: int) -> str:
    """A sum as it is written."""
    return f"{checksum:08x}"


def save(path: Path, raw: bytes, blocks: Sequence[str] = (), *, present: bytes | None = None) -> None:
    """Write the sums of an XML file and its blocks.

    Parameters
    ----------
    path
        The XML file.
    raw
        What it holds, or is about to.
    blocks
        Sums of the blocks, as text.
    present
        What it holds now, where it is still to be replaced.
    """
    first = text(crc32(raw)) + ("" if present is None else f" {text(crc32(present))}")
    _replace(path.with_suffix(SUFFIX), [first, *blocks])


def check(path: Path, raw: bytes) -> bool:
    """Whether an XML file holds what its sums say; true where it has none.

    Raises
    ------
    ArchiveError
        Where the sums are damaged themselves.
    """
    lines = _lines(path)
    return lines is None or text(crc32(raw)) in lines[0].split()


def of_blocks(path: Path, count: int) -> Sequence[str]:
    """Sums of the blocks that an XML file lists; empty texts where it has none.

    Raises
    ------
    ArchiveError
        Where there are not `count`.
    """
    lines = _lines(path)
    if lines is None:
        return [""] * count
    if len(lines) != 1 + count:
        raise damaged(path.with_suffix(SUFFIX), f"{len(lines) - 1} sums for {count} blocks")
    return lines[1:]


def damaged(path: Path, message: str) -> ArchiveError:
    """Error about a file that is not as it was written."""
    return ArchiveError(path, message, advice=_ADVICE)


def _lines(path: Path) -> list[str] | None:
    beside = path.with_suffix(SUFFIX)
    try:
        content = beside.read_bytes().decode("ascii", "replace")
    except FileNotFoundError:
        return None
    except OSError as error:
        raise ArchiveError.from_os_error(beside, "read the checksums", error) from error
    if not _SUMS.fullmatch(content):
        raise damaged(beside, "these are not checksums")
    return content.splitlines()


def save_histories(folder: Path, sums: Mapping[str, tuple[int, int]]) -> None:
    """Write sum and length of each history by name of its file."""
    _replace(
        folder / HISTORIES, [f"{text(checksum)} {size} {name}" for name, (checksum, size) in sums.items()]
    )


def of_history(path: Path) -> tuple[str, int] | None:
    """Sum and length of the part of a history that is covered; None where it has none.

    Raises
    ------
    ArchiveError
        Where the sums are damaged themselves.
    """
    beside = path.with_name(HISTORIES)
    try:
        content = beside.read_bytes().decode("utf-8", "replace")
    except FileNotFoundError:
        return None
    except OSError as error:
        raise ArchiveError.from_os_error(beside, "read the checksums", error) from error
    found = {}
    for line in content.splitlines():
        match = _HISTORY.fullmatch(line)
        if match is None:
            raise damaged(beside, "these are not checksums")
        found[match[3]] = match[1], int(match[2])
    if path.name not in found or not content.endswith("\n"):
        raise damaged(beside, f"there is no checksum of {path.name}")
    return found[path.name]


def check_history(path: Path, raw: bytes, covered: tuple[str, int] | None) -> None:
    """Raise where a history is not as its sum says; `covered` is what `of_history` gave before it was read."""
    if covered is None:
        return
    checksum, size = covered
    if len(raw) < size:
        raise damaged(path, f"the history ends at byte {len(raw)}, {size} were written")
    if text(crc32(raw[:size])) != checksum:
        raise damaged(path, CHANGED)


def _replace(path: Path, lines: Sequence[str]) -> None:
    partial = path.with_name(f"{path.name}.partial")
    partial.write_bytes(("\n".join(lines) + "\n").encode())
    partial.replace(path)
