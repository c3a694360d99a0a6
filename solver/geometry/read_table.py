"""Reading the tables of numbers that some pieces keep in files."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.geometry.piece import OpenFile


def existing_file(open_file: OpenFile, name: str) -> Path | None:
    """The place of a file, or None if there is none."""
    try:
        path = open_file(name)
    except OSError:
        return None
    return path if path.is_file() else None


class MissingFileError(FileNotFoundError, ValueError):
    """A file that a body is made from is not there: the deck, or the folder that it is run in, is wrong."""


def find_file(open_file: OpenFile, name: str, what: str) -> Path:
    """The place of a file; MissingFileError that says what it is for if there is none."""
    path = existing_file(open_file, name)
    if path is None:
        raise MissingFileError(f"cannot find the file {name!r} with {what}")
    return path


def read_table(path: Path, columns: int, kind: type = float, skip: int = 0) -> NDArray[Any]:
    """The rows of a text file of numbers, (n, columns); ValueError names the line that is wrong.

    ``skip`` is the number of lines at the start that are not read. Blank lines do not count.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that a file is empty is said below
            table: NDArray[Any] = np.loadtxt(path, dtype=kind, ndmin=2, skiprows=skip, comments=None)
    except ValueError as error:
        raise ValueError(_complaint(path, columns, kind, skip)) from error
    if table.size and table.shape[1] == columns:
        return table
    raise ValueError(_complaint(path, columns, kind, skip))


def _complaint(path: Path, columns: int, kind: type, skip: int) -> str:
    """What is wrong with a file that could not be read."""
    kinds = "whole numbers" if kind is int else "numbers"
    try:
        lines = path.read_text().splitlines()
    except (UnicodeDecodeError, OSError):
        return f"{path}: not a text file"
    for number, line in enumerate(lines[skip:], skip + 1):
        words = line.split()
        try:
            good = len([kind(word) for word in words]) in (0, columns)
        except ValueError:
            good = False
        if not good:
            return f"{path}:{number}: expected {columns} {kinds}, found {line.strip()[:60]!r}"
    return f"{path}: no line of {columns} {kinds} in it"
