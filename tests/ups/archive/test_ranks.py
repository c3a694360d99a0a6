"""Several ranks that write one archive leave what a single process leaves, and fail together."""

import threading

import numpy as np
import pytest

from ups.archive import Archive, ArchiveError, ArchiveWriter, Box, Grid, Level, Patch, Variable

X = Variable("p.x", "ParticleVariable", "Point")
MASS = Variable("p.mass", "ParticleVariable", "double")
NODES = Variable("g.mass", "NCVariable", "double")
FACES = Variable("v_FC", "SFCYVariable", "Vector")
BURNS = Variable("burns", "PerPatch", "int")
ENERGY = Variable("KineticEnergy", "ReductionVariable", "double")
DELT = Variable("delT", "ReductionVariable", "double")


class Threads:
    """Ranks that are threads of one process."""

    def __init__(self, size):
        self.size = size
        self._barrier = threading.Barrier(size, timeout=20)
        self._sent = [None] * size

    def of(self, number):
        shared = self

        class Rank:
            rank, size = number, shared.size

            def allgather(self, sendobj):
                shared._sent[number] = sendobj
                shared._barrier.wait()
                everything = list(shared._sent)
                shared._barrier.wait()
                return everything

        return Rank()

    def run(self, work):
        """Do `work(rank)` on every rank; return what each returned or raised."""
        outcome = [None] * self.size

        def body(number):
            try:
                outcome[number] = work(self.of(number))
            except BaseException as error:
                outcome[number] = error

        threads = [threading.Thread(target=body, args=(number,)) for number in range(self.size)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        return outcome


@pytest.fixture
def levels():
    """Six coarse patches on the ranks 0 0 1 1 2 2, two fine ones on the ranks 0 and 2."""
    boxes = Box((0, 0, 0), (6, 4, 1)).split((3, 2, 1))
    coarse = [Patch(number, number // 2, *box) for number, box in enumerate(boxes)]
    fine = [Patch(6, 0, (2, 2, 0), (6, 6, 2)), Patch(7, 2, (6, 2, 0), (8, 6, 2))]
    return Grid(
        (
            Level(0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (1, 0, 0), (False, True, False), tuple(coarse)),
            Level(1, (0.0, 0.0, 0.0), (0.5, 0.5, 0.5), (1, 1, 0), (False,) * 3, tuple(fine)),
        )
    )


def fields_of(level, rank=None):
    """Values as functions of place, of the whole level or of what a rank has of it."""
    random = np.random.default_rng(level.index)
    low, high = level.bounds(level.interior)
    points = random.uniform(low, high, (500, 3))
    points = points[level.patch_of_position(points) >= 0]
    owners = np.array([level.patches[position].proc for position in level.patch_of_position(points)])
    mine = points if rank is None else points[owners == rank]
    if not level.positions_of(rank):
        return {variable: {} for variable in (X, MASS, NODES, FACES, BURNS)}

    def on(container):
        x, y, z = np.meshgrid(*level.coordinates(container, level.whole(container, rank=rank)), indexing="ij")
        return x + 10 * y + 100 * z

    return {
        X: {0: mine, 2: mine[:0]},
        MASS: {0: mine[:, 0] * 7, 2: mine[:0, 0]},
        NODES: {0: on("NCVariable"), 1: -on("NCVariable")},
        FACES: {1: np.stack([on("SFCYVariable")] * 3, axis=-1)},
        BURNS: {0: np.array([level.patches[position].id for position in level.positions_of(rank)])},
    }


def write(path, grid, share, **ranks):
    with ArchiveWriter.create(path, grid, input_xml="<a/>", compression="gzip", **ranks) as writer:
        for step in (1, 2, 3):
            fields = [fields_of(level, share) for level in grid.levels]
            writer.append_reductions(step, step / 10, {ENERGY: {-1: 5.0 * step}})
            writer.write_timestep(step, step / 10, 0.1, fields)
            writer.write_checkpoint(
                step,
                step / 10,
                0.1,
                fields,
                global_values={DELT: {-1: 0.1}},
                state={"mine": [-1 if share is None else share]},
                cycle=2,
            )
    return writer.directory


def files(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_ranks_leave_the_files_of_a_single_process(levels, tmp_path, monkeypatch):
    monkeypatch.setattr("time.asctime", lambda: "today")
    alone = files(write(tmp_path / "alone", levels, None))
    outcome = Threads(3).run(lambda rank: write(tmp_path / "many", levels, rank.rank, ranks=rank))
    assert outcome == [tmp_path / "many"] * 3
    many = files(tmp_path / "many")
    states = {name for name in many if name.endswith(".npz")}
    assert states == {
        f"checkpoints/t0000{step}/restart{rank}.npz" for step in (2, 3) for rank in ("", ".00001", ".00002")
    }
    assert set(many) - states == {name for name in alone if not name.endswith(".npz")}
    assert "t00001/l1/p00002.data" in many
    assert "t00001/l1/p00001.data" not in many
    assert all(many[name] == alone[name] for name in set(many) - states)
    found = Archive(tmp_path / "many").checkpoints
    assert [found.state(3, rank)["mine"].tolist() for rank in range(3)] == [[0], [1], [2]]


def test_an_archive_is_gone_on_with_by_all(levels, tmp_path):
    path = write(tmp_path / "a", levels, None)

    def go_on(rank):
        with ArchiveWriter.open_existing(
            path, levels, step=1, time=0.1, compression="gzip", ranks=rank
        ) as writer:
            writer.append_reductions(5, 0.5, {ENERGY: {-1: 1.0}})
            writer.write_timestep(5, 0.5, 0.1, [fields_of(level, rank.rank) for level in levels.levels])

    assert Threads(3).run(go_on) == [None] * 3
    archive = Archive(path)
    assert [timestep.step for timestep in archive.timesteps] == [1, 5]
    assert archive.reductions["KineticEnergy"].values.tolist() == [5.0, 1.0]
    assert archive.index.restarts == [type(archive.index.restarts[0])("a", 1)]
    assert archive.problems(5, values=True) == []
    assert archive.particles(5, "p.mass").tolist() == archive.particles(1, "p.mass").tolist()


def test_what_one_rank_cannot_write_no_rank_writes(levels, tmp_path):
    def fill(rank):
        writer = ArchiveWriter.create(tmp_path / "a", levels, input_xml="<a/>", ranks=rank)
        fields = [fields_of(level, rank.rank) for level in levels.levels]
        writer.write_timestep(1, 0.1, 0.1, fields)
        told = None
        try:
            bad = [dict(fields[0]), fields[1]]
            if rank.rank == 1:
                bad[0][MASS] = {0: np.zeros(3), 2: np.zeros(0)}
            writer.write_timestep(2, 0.2, 0.1, bad)
        except (ArchiveError, ValueError) as error:
            told = f"{type(error).__name__}: {error}"
        writer.write_timestep(3, 0.3, 0.1, fields)
        return told

    first, second, third = Threads(3).run(fill)
    assert second.startswith("ValueError: p.mass has 3 values for ")
    assert first == third
    assert first.endswith(f"t00002: rank 1 could not write: {second.removeprefix('ValueError: ')}")
    assert sorted(p.name for p in (tmp_path / "a").glob("t*")) == ["t00001", "t00003"]
    assert [timestep.step for timestep in Archive(tmp_path / "a").timesteps] == [1, 3]


def test_a_particle_in_a_patch_of_another_rank_is_refused(levels, tmp_path):
    def fill(rank):
        writer = ArchiveWriter.create(tmp_path / "a", levels, input_xml="<a/>", ranks=rank)
        writer.write_timestep(1, 0.1, 0.1, [{X: {0: [[0.5, 0.5, 0.5]]}}, {}])

    outcome = Threads(3).run(fill)
    assert [type(error) for error in outcome] == [ArchiveError, ValueError, ValueError]
    message = "1 particles of material 0 are not in the patches of rank 1, the first in patch 0 of rank 0"
    assert str(outcome[1]) == message
    assert list((tmp_path / "a").glob("t*")) == []


def test_patches_of_no_rank_are_refused(levels, tmp_path):
    outcome = Threads(2).run(
        lambda rank: ArchiveWriter.create(tmp_path / "a", levels, input_xml="", ranks=rank)
    )
    assert [str(error) for error in outcome] == ["2 ranks write patches of 3"] * 2
    assert not (tmp_path / "a").exists()
