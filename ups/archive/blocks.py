"""Blocks of a data file: the numbers of one variable, material and patch."""

from __future__ import annotations

import zlib
from typing import Literal

import numpy as np

from ups.archive.variables import ElementType

ByteOrder = Literal["<", ">"]
"""Little or big endian, in numpy's notation."""

ALIGNMENT = 1024
"""Blocks begin at multiples of this many bytes."""

LARGEST_BLOCK = 2**31 - 1
"""Bytes that Uintah can read or write at once."""

_SIZE = np.dtype("<u8")


def padding(offset: int) -> int:
    """Zero bytes due between `offset` and the start of the next block."""
    return -offset % ALIGNMENT


def particle_bytes(values: np.ndarray) -> memoryview | bytes:
    """Bytes of a particle block: particles of shape (n, ...) in order, each row-major."""
    return _bytes(values)


def grid_bytes(values: np.ndarray) -> memoryview | bytes:
    """Bytes of a grid block: an array indexed [x, y, z, ...], x running fastest."""
    axes = (2, 1, 0, *range(3, values.ndim))
    return _bytes(values.transpose(axes))


def _bytes(values: np.ndarray) -> memoryview | bytes:
    contiguous = np.ascontiguousarray(values)
    return contiguous.data.cast("B") if contiguous.size else b""


def compress(raw: memoryview | bytes) -> bytes:
    """Uintah's "gzip": the plain size as a 64-bit integer, followed by a zlib stream."""
    return np.array(len(raw), dtype=_SIZE).tobytes() + zlib.compress(raw)


def decompress(raw: memoryview | bytes, byte_order: ByteOrder, size_bytes: int, limit: int) -> bytes:
    """Undo `compress`.

    Parameters
    ----------
    raw
        The stored block.
    byte_order
        ``"<"`` or ``">"``, of the archive.
    size_bytes
        Bytes of the leading size, 4 or 8.
    limit
        Bytes expected; nothing beyond them is produced.

    Raises
    ------
    ValueError
        Where the stream is damaged or does not give `limit` bytes.
    """
    if len(raw) < size_bytes:
        raise ValueError(f"{len(raw)} bytes cannot hold a compressed block")
    declared = int(np.frombuffer(raw[:size_bytes], dtype=f"{byte_order}u{size_bytes}")[0])
    if declared != limit:
        raise ValueError(f"the compressed block declares {declared} bytes where {limit} are due")
    stream = zlib.decompressobj()
    try:
        # One byte beyond the limit: the end of the stream is seen, and a limit of 0 would mean none.
        plain = stream.decompress(raw[size_bytes:], limit + 1)
    except zlib.error as error:
        raise ValueError(f"the compressed block is damaged ({error})") from None
    if len(plain) != limit or not stream.eof:
        raise ValueError(f"the compressed block gives {len(plain)} bytes where {limit} are due")
    return plain


def particles_from_bytes(
    raw: memoryview | bytes, element: ElementType, byte_order: ByteOrder, count: int
) -> np.ndarray:
    """Array of shape (count, ...) from the plain bytes of a particle block."""
    return np.frombuffer(raw, element.dtype.newbyteorder(byte_order)).reshape((count, *element.shape))


def grid_from_bytes(
    raw: memoryview | bytes, element: ElementType, byte_order: ByteOrder, shape: tuple[int, int, int]
) -> np.ndarray:
    """Array indexed [x, y, z, ...] from the plain bytes of a grid block."""
    flat = np.frombuffer(raw, element.dtype.newbyteorder(byte_order))
    stored = flat.reshape((shape[2], shape[1], shape[0], *element.shape))
    return stored.transpose((2, 1, 0, *range(3, stored.ndim)))
