"""Particles followed by identity, and the archive as an xarray dataset."""

import sys

import numpy as np
import pytest

import ups
from ups.archive import Archive, ArchiveError, Variable

X = Variable("p.x", "ParticleVariable", "Point")
IDENTITY = Variable("p.particleID", "ParticleVariable", "long64")
STRESS = Variable("p.stress", "ParticleVariable", "Matrix3")
COLOR = Variable("p.color", "ParticleVariable", "int")
MASS = Variable("g.mass", "NCVariable", "double")
ENERGY = Variable("KineticEnergy", "ReductionVariable", "double")
WHERE = {5: 0.25, 3: 0.75, 9: 1.25, 7: 1.75}


@pytest.fixture
def archive(create, grid):
    """Particles 5, 3, 9, 7, which change patches and order; 9 is gone at the last step."""
    order = {1: [5, 3, 9, 7], 2: [7, 9, 3, 5], 3: [3, 7, 5]}
    with create(grid) as writer:
        for step, identities in order.items():
            places = np.array([[(WHERE[i] + step - 1) % 2, 0.5, 0.25] for i in identities])
            tensors = np.array([np.full((3, 3), i * 10.0 + step) for i in identities])
            shape = grid.levels[0].whole("NCVariable").shape
            writer.append_reductions(step, step / 4, {ENERGY: {-1: step}})
            writer.write_timestep(
                step,
                step / 4,
                0.25,
                {
                    X: {0: places},
                    IDENTITY: {0: np.array(identities)},
                    STRESS: {0: tensors},
                    COLOR: {0: np.array(identities, dtype=np.int32)},
                    MASS: {0: np.full(shape, float(step))},
                },
            )
    return Archive(writer.directory)


def test_follow(archive):
    track = archive.follow("p.stress:XY", [9, 5, 77])
    assert track.steps.tolist() == [1, 2, 3]
    assert track.times.tolist() == [0.25, 0.5, 0.75]
    assert track.present.tolist() == [[True, True, False], [True, True, False], [False, True, False]]
    nan = np.nan
    assert np.array_equal(track.values, [[91, 51, nan], [92, 52, nan], [nan, 53, nan]], equal_nan=True)
    assert archive.follow("p.x", 7, steps=[2]).values[0, 0].tolist() == [0.75, 0.5, 0.25]
    assert archive.follow("p.color", [9, 3]).values.tolist() == [[9, 3], [9, 3], [0, 3]]


def test_names_without_their_prefix(archive):
    assert archive.follow("stress", [9, 5]).values[0, :, 0, 0].tolist() == [91, 51]
    assert archive.follow("stress:XY", [5]).values[:, 0].tolist() == [51, 52, 53]
    assert np.array_equal(archive.particles(1, "stress"), archive.particles(1, "p.stress"))
    assert archive.materials(1, "stress:vonMises") == archive.materials(1, "mass") == [0]
    assert archive.grid_variable(2, "mass", 0).values.max() == 2.0
    with pytest.raises(ArchiveError, match=r"did you mean stress\?"):
        archive.follow("stres", [5])


def test_ups_open_gives_the_archive(archive):
    opened = ups.open(archive.path)
    assert opened.particles(-1, "p.stress:XX").tolist() == archive.particles(3, "p.stress")[:, 0, 0].tolist()


def test_what_cannot_be_followed(archive, create, grid):
    with pytest.raises(ArchiveError, match="not on particles"):
        archive.follow("g.mass", [5])
    with pytest.raises(ArchiveError, match=r"no variable p\.y"):
        archive.follow("p.y", [5])


def test_without_identities(create, grid):
    with create(grid) as writer:
        writer.write_timestep(1, 0.1, 0.1, {X: {0: np.zeros((1, 3))}})
    with pytest.raises(ArchiveError, match=r'add <save label="p\.particleID"/>'):
        Archive(writer.directory).follow("p.x", [1])


def test_dataset(archive):
    pytest.importorskip("xarray")
    found = archive.dataset()
    assert found["g.mass"].dims == ("time", "x_node", "y_node", "z_node")
    assert found["g.mass"].sel(time=0.5).isel(x_node=2, y_node=1, z_node=0).item() == 2
    assert found["x_node"].values[:2].tolist() == [-0.5, 0.0]
    assert found["p.stress"].dims == ("time", "particle", "row", "column")
    assert found["p.stress"].attrs["units"] == "Pa"
    assert found["p.stress"].sel(particle=7).sel(row="X", column="Y").values.tolist() == [
        71,
        72,
        73,
    ]
    assert np.isnan(found["p.stress"].sel(particle=9).isel(time=-1)).all()
    assert found["p.stress"][::-1, 0, 0, 0].values.tolist() == [33, 32, 31]
    assert found["KineticEnergy"].values.tolist() == [1, 2, 3]
    chosen = archive.dataset(["stress:vonMises"])
    assert list(chosen) == ["p.stress:vonMises"]
    assert chosen["p.stress:vonMises"].shape == (3, 4)


def test_a_dataset_reads_only_what_is_used(archive, monkeypatch):
    pytest.importorskip("xarray")
    found = archive.dataset(["g.mass"])
    read = []
    original = Archive.grid_variable
    monkeypatch.setattr(
        Archive, "grid_variable", lambda self, step, *rest: read.append(step) or original(self, step, *rest)
    )
    found["g.mass"].isel(time=1).load()
    assert read == [2]


def test_without_xarray_the_way_to_get_it_is_said(archive, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ArchiveError, match="pip install 'ups-mpm\\[archive\\]'"):
        archive.dataset()
