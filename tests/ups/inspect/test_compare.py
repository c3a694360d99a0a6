"""What counts as a difference, and the exit statuses; against Uintah's compare_uda where it is built."""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from other_programs import without_checksums

from cli import main
from ups.archive import ArchiveError, Variable
from ups.inspect.compare import Tolerances, compare_archives, render

COMPARE_UDA = os.environ.get("UINTAH_COMPARE_UDA") or shutil.which("compare_uda")


def changed(label, material, place, function, at=4):
    """Return a change of one number of a variable at one step."""

    def change(step, fields):
        if step == at:
            values = next(by for variable, by in fields.items() if variable.name == label)[material]
            values = values.astype(values.dtype)
            values[place] = function(values[place])
            next(by for variable, by in fields.items() if variable.name == label)[material] = values

    return change


def test_an_archive_equals_itself(make):
    found = compare_archives(make("a"), make("b"), Tolerances(0, 0))
    assert (found.status, found.largest) == (0, (0.0, 0.0))
    # 5 particles of 3 + 3 + 9 + 1, 2 x 5 x 3 x 2 nodes, 4 x 2 cells, at three steps
    assert found.compared == 3 * (5 * 16 + 2 * 5 * 3 * 2 + 8)


def test_patches_ranks_and_compression_do_not_matter(make):
    found = compare_archives(make("a"), make("b", patches=(1, 1, 1), compression="gzip"), Tolerances(0, 0))
    assert found.status == 0


def test_the_worst_is_named(make):
    change = changed("p.stress", 0, (2, 1, 0), lambda value: value * 1.5)
    found = compare_archives(make("a"), make("b", change=change))
    assert found.status == 2
    (worst,) = found.differences
    assert (worst.name, worst.component, worst.step, worst.time) == ("p.stress", "YX", 4, 0.5)
    assert worst.place == "particle 30"  # the third particle of material 0
    assert (worst.first, worst.second) == (84.0, 126.0)
    assert (worst.absolute, worst.failed, worst.compared) == (42.0, 1, 3 * 5 * 9)
    assert worst.relative == 42 / 126


def test_the_worst_variable_comes_first(make):
    def change(step, fields):
        changed("p.velocity", 0, (0, 0), lambda v: v * 1.01)(step, fields)
        changed("g.mass", 1, (3, 2, 1), lambda v: -v)(step, fields)

    found = compare_archives(make("a"), make("b", change=change))
    assert [d.name for d in found.differences] == ["g.mass", "p.velocity"]
    assert found.differences[0].place == "index [2, 1, 1]"


def test_a_rotated_tensor_differs_although_its_norm_does_not(make):
    change = changed("p.stress", 0, 1, lambda tensor: tensor.T)
    assert compare_archives(make("a"), make("b", change=change)).status == 2


@pytest.mark.parametrize(
    ("value", "tolerances", "status"),
    [
        (3.0 * (1 + 5e-7), Tolerances(), 0),
        (3.0 * (1 + 5e-6), Tolerances(), 2),
        (3.0 * (1 + 5e-6), Tolerances(absolute=1e-3), 0),
        (3.0 * (1 + 5e-6), Tolerances(relative=1e-5), 0),
        (np.nan, Tolerances(1e300, 1e300), 2),
        (np.inf, Tolerances(), 2),
    ],
)
def test_both_tolerances_must_be_exceeded(make, value, tolerances, status):
    change = changed("p.velocity", 0, (1, 0), lambda _: value)
    assert compare_archives(make("a"), make("b", change=change), tolerances).status == status


def test_extra_cells_count_only_when_asked_for(make):
    paths = make("a"), make("b", change=changed("press_CC", 0, (0, 0, 0), lambda v: v + 1))
    assert compare_archives(*paths).status == 0
    assert compare_archives(*paths, extra_cells=True).status == 2


def test_variables_can_be_chosen_and_left_out(make):
    paths = make("a"), make("b", change=changed("g.mass", 0, (2, 2, 0), lambda v: v + 1))
    assert compare_archives(*paths, ignore=["g.mass"]).status == 0
    assert compare_archives(*paths, variables=["p.x", "p.stress"]).status == 0
    assert compare_archives(*paths, variables=["g.mass"]).status == 2
    with pytest.raises(ArchiveError, match=r"did you mean g\.mass"):
        compare_archives(*paths, variables=["g.mas"])


def drop(label):
    def change(_step, fields):
        del fields[next(v for v in fields if v.name == label)]

    return change


def retype(_step, fields):
    values = fields.pop(Variable("press_CC", "CCVariable", "double"))
    fields[Variable("press_CC", "CCVariable", "float")] = values


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"steps": (1, 4)}, "3 time steps here, 2 there"),
        ({"steps": (1, 5, 9)}, "step 4: time 0.5 here, 0.625 there"),
        ({"change": drop("press_CC")}, "has press_CC"),
        ({"change": retype}, "press_CC is a CCVariable<double> here, a CCVariable<float> there"),
        ({"change": changed("p.particleID", 0, 0, lambda _: 10)}, "are called 10"),
    ],
)
def test_what_cannot_be_compared_is_said(make, options, message):
    found = compare_archives(make("a"), make("b", **options))
    assert found.status == 5
    assert any(message in obstacle for obstacle in found.obstacles), found.obstacles


def test_particles_of_other_identities_are_a_difference(make):
    found = compare_archives(make("a"), make("b", change=changed("p.particleID", 0, 0, lambda _: 71)))
    assert found.status == 2
    assert [(d.name, d.first, d.second) for d in found.differences] == [("p.particleID", 70, 71)]
    assert "only one archive has particle 70 of material 0" in found.obstacles[0]


def test_without_identities_the_patches_must_agree(make):
    paths = make("a", change=drop("p.particleID")), make("b", change=drop("p.particleID"))
    assert compare_archives(*paths).status == 0
    other = make("c", change=drop("p.particleID"), patches=(1, 1, 1))
    found = compare_archives(paths[0], other)
    assert found.status == 5
    assert "patches differ" in found.obstacles[0]
    moved = changed("p.velocity", 0, (1, 0), lambda v: v + 1)

    def both(step, fields):
        drop("p.particleID")(step, fields)
        moved(step, fields)

    assert compare_archives(paths[0], make("d", change=both)).differences[0].place == "particle 1 of patch 0"


def test_levels(make):
    paths = make("a"), make("b")
    assert compare_archives(*paths, levels=(0, 0)).status == 0
    found = compare_archives(*paths, levels=(0, 1))
    assert (found.status, "has no level 1" in found.obstacles[0]) == (5, True)


def test_damage_cannot_be_compared(make):
    paths = make("a"), make("b")
    (paths[1] / "t00004" / "l0" / "p00000.data").write_bytes(b"")
    found = compare_archives(*paths)
    assert found.status == 5
    assert "p00000.data" in found.obstacles[0]


def test_exit_statuses_of_the_command(make):
    a, b = make("a"), make("b", change=changed("g.mass", 0, (2, 2, 0), lambda v: v * (1 + 1e-8)))

    def status(*arguments):
        return CliRunner().invoke(main, ["compare", *map(str, arguments)]).exit_code

    assert status(a, b) == 0
    assert status(a, b, "--exact") == 2
    assert status(a, b, "--rel-tolerance", "1e-10", "--abs-tolerance", "1e-12") == 2
    assert status(a, make("c", steps=(1,))) == 5
    assert status(a) == 1
    assert status(a, b, "--rel-tolerance", "-1") == 1
    assert status(a, "nowhere") == 1


def test_a_type_that_cannot_be_read_has_a_status_of_its_own(make):
    paths = without_checksums(make("a")), without_checksums(make("b"))
    for path in paths:
        for file in [path / "index.xml", *path.glob("t*/l0/p*.xml")]:
            text = file.read_text().replace("CCVariable&lt;double", "CCVariable&lt;Quaternion")
            file.write_text(text)
    found = compare_archives(*paths)
    assert (found.status, found.compared > 0) == (255, True)
    assert found.unsupported == ["press_CC is a CCVariable<Quaternion>, which cannot be read"]
    assert "not comparable: press_CC" in render(found)
    assert compare_archives(*paths, skip_unknown_types=True).status == 0
    compared = CliRunner().invoke(main, ["compare", *map(str, paths), "--skip-unknown-types"])
    assert compared.exit_code == 0


@pytest.mark.skipif(COMPARE_UDA is None, reason="Uintah's compare_uda is not here")
@pytest.mark.parametrize(
    ("options", "status"),
    [
        ({}, 0),
        ({"change": changed("p.velocity", 0, (1, 0), lambda v: v * 1.1)}, 2),
        ({"change": changed("g.mass", 1, (3, 2, 1), lambda v: v * (1 + 1e-5))}, 2),
        ({"change": changed("g.mass", 1, (3, 2, 1), lambda v: v * (1 + 1e-7))}, 0),
        ({"change": changed("press_CC", 0, (0, 0, 0), lambda v: v + 1)}, 0),
        ({"change": changed("p.particleID", 0, 0, lambda _: 71)}, 2),
        ({"steps": (1, 5, 9)}, 5),
        ({"steps": (1, 4)}, 5),
        ({"change": drop("press_CC")}, 5),
        ({"change": changed("p.velocity", 0, (1, 0), lambda _: np.nan)}, 2),
        ({"patches": (1, 1, 1)}, 0),
    ],
)
def test_as_compare_uda_decides(make, options, status):
    paths: tuple[Path, Path] = make("a"), make("b", **options)
    theirs = subprocess.run([COMPARE_UDA, *map(str, paths)], capture_output=True, check=False)
    assert theirs.returncode == status
    assert compare_archives(*paths).status == status
