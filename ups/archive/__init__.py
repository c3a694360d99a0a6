"""Uintah archives (UDA): writing and reading them, without any physics."""

from ups.archive.errors import ArchiveError
from ups.archive.index import Timestep
from ups.archive.layout import Box, Grid, Level, Patch
from ups.archive.naming import next_numbered_directory
from ups.archive.ranks import Ranks
from ups.archive.reader import Archive, GridField
from ups.archive.reductions import Reduction, ReductionFormat
from ups.archive.tree import Fields, Positions
from ups.archive.variables import Variable
from ups.archive.writer import ArchiveWriter

__all__ = [
    "Archive",
    "ArchiveError",
    "ArchiveWriter",
    "Box",
    "Fields",
    "Grid",
    "GridField",
    "Level",
    "Patch",
    "Positions",
    "Ranks",
    "Reduction",
    "ReductionFormat",
    "Timestep",
    "Variable",
    "next_numbered_directory",
]
