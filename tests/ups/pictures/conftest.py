"""Small archives along one, two and three axes, with particles, nodes and cells."""

import numpy as np
import pytest

from ups.archive import ArchiveWriter, Box, Grid, Variable

POSITION = Variable("p.x", "ParticleVariable", "Point")
VELOCITY = Variable("p.velocity", "ParticleVariable", "Vector")
DEFORMATION = Variable("p.deformationMeasure", "ParticleVariable", "Matrix3")
VOLUME = Variable("p.volume", "ParticleVariable", "double")
TEMPERATURE = Variable("g.temperature", "NCVariable", "double")
PRESSURE = Variable("press_CC", "CCVariable", "double")
ENERGY = Variable("KineticEnergy", "ReductionVariable", "double")
MOMENTUM = Variable("TotalMomentum", "ReductionVariable", "Vector")


@pytest.fixture
def make(tmp_path):
    """Return a function that writes an archive of two steps; speeds grow with x and with the step."""

    def write(cells, body=None):
        grid = Grid.single_level([Box((0, 0, 0), cells)], spacing=(0.5, 0.5, 0.5))
        level = grid.levels[0]
        counts = [2 * n for n in (body or cells)]
        places = (np.indices(counts).reshape(3, -1).T + 0.5) * 0.25
        nodes, inside = (level.whole(kind).shape for kind in ("NCVariable", "CCVariable"))
        with ArchiveWriter.create(tmp_path / "a.uda", grid, input_xml="<a/>", title="a block") as writer:
            for step in (2, 6):
                writer.append_reductions(step, step / 4, {ENERGY: {-1: step}, MOMENTUM: {-1: [1, step, 0]}})
                stretch = np.tile(np.diag([2.0, 1, 1]), (len(places), 1, 1))
                fields = {
                    POSITION: {0: places},
                    VELOCITY: {0: np.column_stack([step * places[:, 0], *np.zeros((2, len(places)))])},
                    DEFORMATION: {0: stretch},
                    VOLUME: {0: np.full(len(places), 2 * 0.25**3)},
                    TEMPERATURE: {m: np.indices(nodes)[0] * step + 10.0 * m for m in (0, 1)},
                    PRESSURE: {0: np.indices(inside)[0] * 1.0},
                }
                writer.write_timestep(step, step / 4, 0.25, fields)
        return writer.directory

    return write
