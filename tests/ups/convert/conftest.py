"""A small archive of two steps, two materials and every kind of variable."""

import numpy as np
import pytest

from ups.archive import ArchiveWriter, Box, Grid, Variable

STEPS = (3, 8)


def node_values(grid, step):
    """Return x + 10 y + 100 z + 1000 step at every node."""
    level = grid.levels[0]
    x, y, z = np.meshgrid(*level.coordinates("NCVariable", level.whole("NCVariable")), indexing="ij")
    return x + 10 * y + 100 * z + 1000 * step


@pytest.fixture
def grid():
    """Return 4 x 2 x 1 cells in two patches, one extra cell in y, periodic in x."""
    return Grid.single_level(
        Box((0, 0, 0), (4, 2, 1)).split((2, 1, 1)),
        spacing=(0.5, 0.25, 1.0),
        anchor=(1.0, 0.0, 0.0),
        extra_cells=(0, 1, 0),
        periodic=(True, False, False),
    )


@pytest.fixture
def archive(tmp_path, grid):
    """Return the path of the archive; p.damage is stored for material 1 only."""
    level = grid.levels[0]
    x = {0: np.array([[1.25, 0.1, 0.5], [1.75, 0.1, 0.5], [2.75, 0.3, 0.5]]), 1: np.array([[1.5, 0.2, 0.5]])}
    cells = level.whole("CCVariable").shape
    faces = level.whole("SFCYVariable").shape
    with ArchiveWriter.create(tmp_path / "bar.uda", grid, input_xml="<a/>") as writer:
        for step in STEPS:
            fields = {
                Variable("p.x", "ParticleVariable", "Point"): x,
                Variable("p.stress", "ParticleVariable", "Matrix3"): {
                    m: np.arange(9.0 * len(x[m])).reshape(-1, 3, 3) + step for m in x
                },
                Variable("p.particleID", "ParticleVariable", "long64"): {
                    0: np.array([1, 2, 3]),
                    1: np.array([1 << 50]),
                },
                Variable("p.damage", "ParticleVariable", "double"): {1: np.array([0.5])},
                Variable("g.mass", "NCVariable", "double"): {
                    0: node_values(grid, step),
                    1: -node_values(grid, step),
                },
                Variable("g.velocity", "NCVariable", "Vector"): {
                    0: np.arange(3.0 * 4 * 5 * 2).reshape(4, 5, 2, 3)
                },
                Variable("press_CC", "CCVariable", "float"): {
                    0: np.arange(np.prod(cells), dtype="f4").reshape(cells)
                },
                Variable("v_FC", "SFCYVariable", "double"): {
                    0: np.arange(float(np.prod(faces))).reshape(faces)
                },
            }
            writer.append_reductions(
                step, step / 7, {Variable("TotalMomentum", "ReductionVariable", "Vector"): {-1: [1, 2, step]}}
            )
            writer.write_timestep(step, step / 7, 0.1, fields)
    return writer.directory
