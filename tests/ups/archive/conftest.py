"""Small grids, and archives begun on them."""

import pytest

from ups.archive import ArchiveWriter, Box, Grid


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
