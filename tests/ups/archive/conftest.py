"""Archives that Uintah wrote, unpacked once, and small grids."""

import tarfile
from pathlib import Path

import pytest

from ups.archive import ArchiveWriter, Box, Grid

SHARED = Path(__file__).parents[3].parent / "shared" / "archives"
SUS_ARCHIVES = ("disks_sulsky", "disks_gzip_2ranks", "mpmice_two_levels")


@pytest.fixture(scope="session")
def sus(tmp_path_factory):
    """Return the path of an archive written by sus, by name."""
    folder = tmp_path_factory.mktemp("sus")

    def unpack(name):
        if not (folder / f"{name}.uda").exists():
            packed = SHARED / f"{name}.uda.tar.gz"
            if not packed.exists():
                pytest.skip("the reference archives are not here")
            with tarfile.open(packed) as tar:
                tar.extractall(folder, filter="data")
        return folder / f"{name}.uda"

    return unpack


@pytest.fixture
def grid():
    """Return 4 x 2 x 1 cells of 0.5 in two patches, with one extra cell in x and y."""
    boxes = Box((0, 0, 0), (4, 2, 1)).split((2, 1, 1))
    return Grid.single_level(boxes, spacing=(0.5, 0.5, 0.5), extra_cells=(1, 1, 0))


@pytest.fixture
def create(tmp_path):
    """Return a function that begins an archive at `tmp_path`/x.uda.000."""

    def make(grid, **options):
        return ArchiveWriter.create(
            tmp_path / "x.uda.000", grid, input_xml="<Uintah_specification/>\n", **options
        )

    return make
