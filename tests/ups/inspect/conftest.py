"""A small archive of three steps with histories and checkpoints, in two patches of two ranks."""

import numpy as np
import pytest

from ups.archive import ArchiveWriter, Box, Grid, Variable

STEPS = (1, 4, 9)
POSITION = Variable("p.x", "ParticleVariable", "Point")
VELOCITY = Variable("p.velocity", "ParticleVariable", "Vector")
STRESS = Variable("p.stress", "ParticleVariable", "Matrix3")
IDENTITY = Variable("p.particleID", "ParticleVariable", "long64")
MASS = Variable("g.mass", "NCVariable", "double")
PRESSURE = Variable("press_CC", "CCVariable", "double")
ENERGY = Variable("KineticEnergy", "ReductionVariable", "double")
MOMENTUM = Variable("TotalMomentum", "ReductionVariable", "Vector")


def places():
    """Positions by material: four particles in a row and one above."""
    return {
        0: np.array([[x, 0.25, 0.25] for x in (0.25, 0.75, 1.25, 1.75)]),
        1: np.array([[1.1, 0.75, 0.25]]),
    }


def node_field(level, step):
    """Return 1 + x + 10 y + 100 z + 1000 step, which linear interpolation gives back exactly."""
    x, y, z = np.meshgrid(*level.coordinates("NCVariable", level.whole("NCVariable")), indexing="ij")
    return 1 + x + 10 * y + 100 * z + 1000 * step


def fields_of(grid, step):
    level, x = grid.levels[0], places()
    cells = level.whole("CCVariable").shape
    return {
        POSITION: x,
        VELOCITY: {m: np.full((len(x[m]), 3), [3.0, 4.0 * step, 0.0]) for m in x},
        STRESS: {m: np.arange(9.0 * len(x[m])).reshape(-1, 3, 3) * step for m in x},
        IDENTITY: {0: np.array([70, 10, 30, 20]), 1: np.array([1 << 40])},
        MASS: {m: node_field(level, step) for m in x},
        PRESSURE: {0: np.arange(float(np.prod(cells))).reshape(cells) + step},
    }


@pytest.fixture
def make(tmp_path):
    """Return a function that writes the archive, under a name, with changes to the fields of a step."""

    def write(name="a.uda", patches=(2, 1, 1), compression="", change=None, steps=STEPS):
        grid = Grid.single_level(
            Box((0, 0, 0), (4, 2, 1)).split(patches),
            spacing=(0.5, 0.5, 0.5),
            extra_cells=(1, 1, 0),
            procs=min(2, int(np.prod(patches))),
        )
        with ArchiveWriter.create(
            tmp_path / name, grid, input_xml="<a/>", compression=compression, title="rod"
        ) as writer:
            for step in steps:
                values = {ENERGY: {-1: step / 2}, MOMENTUM: {-1: [1.0, step, 3.0]}}
                writer.append_reductions(step, step / 8, values)
                fields = fields_of(grid, step)
                if change is not None:
                    change(step, fields)
                writer.write_timestep(step, step / 8, 0.125, fields)
                delt = {Variable("delT", "ReductionVariable", "double"): {-1: 0.125}}
                writer.write_checkpoint(step, step / 8, 0.125, fields, global_values=delt, cycle=2)
        return writer.directory

    return write
