"""VTK XML files: arrays appended as compressed binary, streamed; and the files that name other files.

An array is a header of sizes and blocks compressed by zlib one by one, several at a time on threads. Offsets
and sizes are known only behind the data, so that room is left for them, and filled in at the end.
"""

from __future__ import annotations

import json
import sys
import zlib
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np

from ups.archive.markup import HEADER, attributes, number
from ups.convert.registry import atomically

BLOCK = 1 << 20
"""Bytes that are compressed together."""

ZLIB_LEVEL = 1  # the next levels take twice the time for a few percent of most fields
_OFFSET_WIDTH = 20
_TYPES = {"f8": "Float64", "f4": "Float32", "i8": "Int64", "i4": "Int32", "i2": "Int16", "u1": "UInt8"}

Parts = Iterable[np.ndarray]
"""An array in parts that follow each other along its first axis."""


@dataclass(frozen=True)
class Array:
    """An array of a file, whose values are made when it is written.

    Attributes
    ----------
    name
        Its name.
    dtype
        Type of a number.
    rows, width
        Number of elements, and numbers in each.
    parts
        Makes the values.
    components
        Names of the numbers in an element.
    counted
        Whether the file says how many elements there are, as it must of field data.
    """

    name: str
    dtype: np.dtype
    rows: int
    width: int
    parts: Callable[[], Parts]
    components: Sequence[str] = ()
    counted: bool = False

    @property
    def nbytes(self) -> int:
        """Bytes of the values."""
        return self.rows * self.width * self.dtype.itemsize

    def element(self, offset: int) -> str:
        """Return the XML element that describes the array, of a length that does not depend on the offset."""
        described: dict[str, object] = {
            "type": _TYPES[self.dtype.str[1:]],
            "Name": self.name,
            "NumberOfComponents": self.width,
        }
        described |= {f"ComponentName{i}": component for i, component in enumerate(self.components)}
        if self.counted:
            described["NumberOfTuples"] = self.rows
        described |= {"format": "appended", "offset": offset}
        return f"<DataArray{attributes(**described)}{' ' * (_OFFSET_WIDTH - len(str(offset)))}/>"


def counting(name: str, start: int, stop: int, step: int = 1) -> Array:
    """Array of the whole numbers from `start` to below `stop`."""
    dtype = np.dtype(np.int32 if stop < 2**31 else np.int64)
    stride = BLOCK * step

    def parts() -> Parts:
        for first in range(start, stop, stride):
            yield np.arange(first, min(first + stride, stop), step, dtype=dtype)

    return Array(name, dtype, len(range(start, stop, step)), 1, parts)


Body = Sequence["str | Array"]
"""Lines of a file, with arrays where they are described."""


def save(path: Path, kind: str, body: Body, time: float, threads: int = 1) -> None:
    """Write a file of data.

    Parameters
    ----------
    path
        Where to write.
    kind
        Type of the data set.
    body
        What is inside the element of that name, its tags included.
    time
        Time of the data.
    threads
        Threads that compress.

    Raises
    ------
    OSError
        Where the disk refuses.
    """
    order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    described = {"type": kind, "version": "1.0", "byte_order": order, "header_type": "UInt64"}
    stamp = Array("TimeValue", np.dtype(float), 1, 1, lambda: [np.array([time])], counted=True)
    pieces: list[str | Array] = [
        HEADER,
        f"<VTKFile{attributes(**described, compressor='vtkZLibDataCompressor')}>",
        *body[:1],
        "<FieldData>",
        stamp,
        "</FieldData>",
        *body[1:],
        '<AppendedData encoding="raw">',
    ]
    arrays = [piece for piece in pieces if isinstance(piece, Array)]

    def header(offsets: Sequence[int]) -> bytes:
        offset = iter(offsets)
        lines = [piece if isinstance(piece, str) else piece.element(next(offset)) for piece in pieces]
        return ("\n".join(lines) + "\n_").encode()

    with atomically(path) as partial, partial.open("wb") as file, _compressor(threads) as compress:
        file.write(header([0] * len(arrays)))
        begin, offsets = file.tell(), []
        for array in arrays:
            offsets.append(file.tell() - begin)
            _append(file, array, compress)
        file.write(b"\n</AppendedData>\n</VTKFile>\n")
        file.seek(0)
        file.write(header(offsets))


def _append(
    file: IO[bytes], array: Array, compress: Callable[[Iterable[memoryview]], Iterator[bytes]]
) -> None:
    """Write VTK's compressed form: count and size of blocks, size of a short last one, compressed sizes, blocks."""
    count = -(-array.nbytes // BLOCK)
    sizes = np.array([count, BLOCK, array.nbytes % BLOCK, *[0] * count], dtype=np.uint64)
    begin = file.tell()
    file.write(sizes.tobytes())
    for place, block in enumerate(compress(_blocks(array.parts(), array.dtype)), 3):
        sizes[place] = len(block)
        file.write(block)
    end = file.tell()
    file.seek(begin)
    file.write(sizes.tobytes())
    file.seek(end)


def _blocks(parts: Parts, dtype: np.dtype) -> Iterator[memoryview]:
    """Bytes of the parts in blocks of equal size, the last one shorter; not copied where a block lies in a part."""
    rest = bytearray()
    for part in parts:
        contiguous = np.ascontiguousarray(part, dtype=dtype)
        raw = contiguous.data.cast("B") if contiguous.size else memoryview(b"")
        if rest:
            taken = BLOCK - len(rest)
            rest += raw[:taken]
            raw = raw[taken:]
            if len(rest) < BLOCK:
                continue
            yield memoryview(rest)
            rest = bytearray()
        whole = len(raw) - len(raw) % BLOCK
        for start in range(0, whole, BLOCK):
            yield raw[start : start + BLOCK]
        rest += raw[whole:]
    if rest:
        yield memoryview(rest)


@contextmanager
def _compressor(threads: int) -> Iterator[Callable[[Iterable[memoryview]], Iterator[bytes]]]:
    """Return a function that compresses blocks in order, a few of them ahead on threads."""
    if threads == 1:
        yield lambda blocks: (zlib.compress(block, ZLIB_LEVEL) for block in blocks)
        return
    with ThreadPoolExecutor(threads) as pool:  # zlib runs outside Python's lock

        def compress(blocks: Iterable[memoryview]) -> Iterator[bytes]:
            ahead: deque[Future[bytes]] = deque()
            for block in blocks:
                ahead.append(pool.submit(zlib.compress, block, ZLIB_LEVEL))
                if len(ahead) > 2 * threads:
                    yield ahead.popleft().result()
            for future in ahead:
                yield future.result()

        yield compress


@dataclass(frozen=True)
class Entry:
    """A file of a series: its time, and the part of the whole that it is."""

    time: float
    part: int
    path: Path


def save_series(path: Path, entries: Sequence[Entry]) -> None:
    """Write the .pvd that names files by time and part."""
    lines = [HEADER, '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">', "<Collection>"]
    for entry in entries:
        href = _relative(entry.path, path)
        lines.append(
            f"<DataSet{attributes(timestep=number(entry.time), group='', part=entry.part, file=href)}/>"
        )
    save_lines(path, [*lines, "</Collection>", "</VTKFile>"])


def save_json_series(path: Path, entries: Sequence[Entry]) -> None:
    """Write ParaView's .series, which names files of any kind by time."""
    files = [{"name": _relative(entry.path, path), "time": entry.time} for entry in entries]
    save_lines(path, [json.dumps({"file-series-version": "1.0", "files": files}, indent=1)])


def save_blocks(path: Path, blocks: Sequence[tuple[str, Path]]) -> None:
    """Write the .vtm that names files as blocks of one data set."""
    lines = [
        HEADER,
        '<VTKFile type="vtkMultiBlockDataSet" version="1.0" byte_order="LittleEndian">',
        "<vtkMultiBlockDataSet>",
    ]
    for index, (name, file) in enumerate(blocks):
        lines.append(f"<DataSet{attributes(index=index, name=name, file=_relative(file, path))}/>")
    save_lines(path, [*lines, "</vtkMultiBlockDataSet>", "</VTKFile>"])


def _relative(file: Path, beside: Path) -> str:
    return file.relative_to(beside.parent).as_posix()


def save_lines(path: Path, lines: Sequence[str]) -> None:
    """Write a text file, which has its name only when it is whole."""
    with atomically(path) as partial:
        partial.write_text("\n".join(lines) + "\n", encoding="utf-8")
