"""Archives put together byte by byte without the package: every kind of element, place, machine and age."""

import itertools

import foreign
import numpy as np
import pytest

from ups.archive import Archive
from ups.convert import convert

MACHINES = {
    "little 64 plain": {},
    "big 64 plain": {"order": ">"},
    "little 32 gzip": {"bits": 32, "compression": "gzip"},
    "big 32 gzip": {"order": ">", "bits": 32, "compression": "gzip"},
    "big 64 gzip, 2 ranks": {"order": ">", "compression": "gzip", "ranks": 2},
    "little 64 plain, 3 ranks": {"ranks": 3},
}


@pytest.fixture(scope="module", params=MACHINES.values(), ids=MACHINES.keys())
def archive(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("foreign") / "a.uda"
    folder.mkdir()
    return Archive(foreign.Writer(folder, **request.param).write())


def element(values, variable):
    """Components of each element as rows."""
    return values.reshape(-1, variable.element_type.components).tolist()


def test_steps_and_levels(archive):
    assert [(t.step, t.time) for t in archive.timesteps] == [(1, 0.5), (2, 0.75)]
    coarse, fine = archive.grid(1).levels
    assert [patch.id for patch in coarse.patches + fine.patches] == [0, 1, 2]
    assert fine.spacing == (0.5, 0.5, 0.5)
    assert archive.problems(1, values=True) == archive.problems(2, values=True) == []
    for container, extents in foreign.EXTENTS.items():
        assert [coarse.extent(0, container), coarse.extent(1, container), fine.extent(0, container)] == list(
            extents.values()
        )


@pytest.mark.parametrize("step", [1, 2])
def test_particles_of_every_element(archive, step):
    there = [one for patch in (0, 1, 2) for one in foreign.PARTICLES[step][patch]]
    assert archive.particle_count(step, 0) == len(there)
    assert archive.particles(step, "p.x").tolist() == [[x, 0.5, 0.25] for _identity, x in there]
    assert archive.particles(step, "p.particleID").tolist() == [identity for identity, _x in there]
    for name in foreign.CODES:
        label = f"p.{name.replace(' ', '_')}"
        variable = archive.variables[label]
        due = [foreign.element_values(foreign.particle_seed(step, identity), name) for identity, _x in there]
        found = archive.particles(step, label)
        assert found.dtype.isnative
        assert element(found, variable) == due
        parts = list(archive.particle_parts(step, label, 0))
        assert np.array_equal(np.concatenate(parts), found)
        alone = archive.particles(step, label, 0, patch=1)
        assert len(alone) == len(foreign.PARTICLES[step][1])


@pytest.mark.parametrize("container", list(foreign.EXTENTS))
def test_grid_variables_of_every_element(archive, container):
    for name, step, material, level in itertools.product(foreign.CODES, (1, 2), (0, 1), (0, 1)):
        label = f"{container[:4]}.{name.replace(' ', '_')}"
        found = archive.grid_variable(step, label, material, level)
        lows, highs = zip(
            *(foreign.EXTENTS[container][patch] for patch, *_ in foreign.PATCHES[level]), strict=True
        )
        assert found.box == (tuple(np.min(lows, axis=0)), tuple(np.max(highs, axis=0)))
        shape = found.variable.element_type.shape
        for i, j, k in itertools.product(*map(range, *found.box)):
            due = foreign.element_values(foreign.grid_seed(level, step, material, i, j, k), name)
            place = tuple(np.subtract((i, j, k), found.origin))
            assert found.values[place].reshape(-1).tolist() == due
        assert found.values.shape[3:] == shape


def test_values_of_patches(archive):
    assert archive.per_patch(2, "count", 1).tolist() == [3, 13]
    assert archive.per_patch(2, "share", 0, level=1).tolist() == [22.0]


def test_particles_are_followed_by_identity(archive):
    track = archive.follow("p.x", [2, 7, 9, 4])
    assert track.present.tolist() == [[True, True, True, False], [True, True, False, False]]
    assert track.values[0, :3, 0].tolist() == [1.25, 0.25, 2.75]
    assert track.values[1, :2, 0].tolist() == [1.5, 2.25]
    assert np.isnan(track.values[1, 2]).all()


def test_as_a_dataset(archive):
    pytest.importorskip("xarray")
    found = archive.dataset(level=1)
    assert found["time"].values.tolist() == [0.5, 0.75]
    assert found["particle"].values.tolist() == [2, 3, 5, 7, 9, 11]
    assert found["p.x"].sel(particle=7, component="X").values.tolist() == [0.25, 2.25]
    stress = foreign.element_values(foreign.particle_seed(2, 7), "Matrix3")
    assert found["p.Matrix3"].sel(particle=7, row="Y", column="X").values[1] == stress[3]
    assert (
        found["p.Stencil7"].sel(particle=7, stencil7="P").values[1]
        == foreign.element_values(207, "Stencil7")[6]
    )
    assert np.isnan(found["p.double"].sel(particle=9).values[1])  # gone
    cell = found["CCVa.double"].sel(x_cell=1.25, y_cell=0.75, z_cell=0.25)
    due = [foreign.element_values(foreign.grid_seed(1, step, 0, 2, 1, 0), "double")[0] for step in (1, 2)]
    assert cell.values.tolist() == due


def test_converted(archive, tmp_path):
    """What is read is what the formats get, whatever machine wrote it."""
    (file,) = convert(archive.path, tmp_path / "a.npz", variables=["p.Matrix3", "CCVa.Vector"], steps=[2])
    with np.load(file) as found:
        assert np.array_equal(found["t00002/0/p.Matrix3"], archive.particles(2, "p.Matrix3"))
    (file,) = convert(archive.path, tmp_path / "a.vtp", variables=["p.Matrix3", "p.float"], steps=[2])
    pyvista = pytest.importorskip("pyvista")
    data = pyvista.read(file)
    assert data["Matrix3"].tolist() == archive.particles(2, "p.Matrix3").reshape(-1, 9).tolist()
    assert data["float"].dtype == np.float32
