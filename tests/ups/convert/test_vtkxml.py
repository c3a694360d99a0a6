"""The files of VTK XML: streamed arrays, byte by byte."""

import re
import zlib
from itertools import pairwise

import numpy as np
import pytest

from ups.convert import vtkxml
from ups.convert.vtkxml import Array, counting, save


def arrays_of(path):
    """Arrays of a file by name, found by their offsets and decompressed block by block."""
    raw = path.read_bytes()
    start = raw.index(b"_", raw.index(b"<AppendedData")) + 1
    found = {}
    for element in re.findall(rb"<DataArray[^>]*>", raw[:start]):
        said = {key.decode(): value.decode() for key, value in re.findall(rb'(\w+)="([^"]*)"', element)}
        begin = start + int(said["offset"])
        blocks, size, last = np.frombuffer(raw[begin : begin + 24], np.uint64).astype(int).tolist()
        sizes = np.frombuffer(raw[begin + 24 : begin + 24 + 8 * blocks], np.uint64).astype(int).tolist()
        begin += 24 + 8 * blocks
        plain = []
        for place, length in enumerate(sizes):
            plain.append(zlib.decompress(raw[begin : begin + length]))
            assert len(plain[-1]) == (last if last and place == blocks - 1 else size)
            begin += length
        dtype = {"Float64": "f8", "Int32": "i4", "Int64": "i8", "UInt8": "u1"}[said["type"]]
        found[said["Name"]] = np.frombuffer(b"".join(plain), dtype)
    return found


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("lengths", [[], [0], [5], [7, 0, 300, 1], [128], [64, 64, 64], [1, 127, 129]])
def test_parts_become_blocks(tmp_path, monkeypatch, threads, lengths):
    monkeypatch.setattr(vtkxml, "BLOCK", 1024)
    rows = np.random.default_rng(1).uniform(size=(sum(lengths), 3))
    ends = np.cumsum([0, *lengths])

    def parts():
        return (rows[a:b] for a, b in pairwise(ends))

    body = ["<X>", Array("a", np.dtype(float), len(rows), 3, parts), counting("n", 3, 1003, 2), "</X>"]
    save(tmp_path / "x", "X", body, 0.25, threads)
    found = arrays_of(tmp_path / "x")
    assert found["a"].tolist() == rows.reshape(-1).tolist()
    assert found["n"].tolist() == list(range(3, 1003, 2))
    assert found["TimeValue"].tolist() == [0.25]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["x"]


def test_a_part_is_made_when_it_is_written(tmp_path):
    made = []

    def parts():
        for number in range(4):
            made.append(number)
            yield np.full(vtkxml.BLOCK // 8, float(number))
            assert made[-1] == number  # the next is not made before this one is taken

    save(tmp_path / "x", "X", [Array("a", np.dtype(float), vtkxml.BLOCK // 2, 1, parts)], 0.0)
    assert made == [0, 1, 2, 3]
    assert arrays_of(tmp_path / "x")["a"][:: vtkxml.BLOCK // 8].tolist() == [0, 1, 2, 3]


def test_what_fails_leaves_no_file_of_the_name(tmp_path):
    def parts():
        yield np.zeros(3)
        raise ValueError("no more")

    with pytest.raises(ValueError, match="no more"):
        save(tmp_path / "x", "X", [Array("a", np.dtype(float), 6, 1, parts)], 0.0)
    assert list(tmp_path.iterdir()) == []


def test_numbers_beyond_32_bits_are_wide():
    assert counting("n", 0, 2**31 - 1).dtype == np.int32
    assert counting("n", 0, 2**31).dtype == np.int64
