"""What is said of an archive, against the numbers put into it and those that Uintah's puda prints."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from other_programs import without_checksums

from cli import main
from ups.archive import ArchiveError
from ups.inspect.info import render, summarize


def of(summary, name, material=0):
    return next(v for v in summary.variables if (v.name, v.material) == (name, material))


def test_ranges_counts_and_steps(make):
    summary = summarize(make())
    assert [t.step for t in summary.timesteps] == [1, 4, 9]
    assert (summary.step, summary.checkpoints, summary.problems) == (9, (4, 9), ())
    velocity = of(summary, "p.velocity")
    assert (velocity.low, velocity.high) == ((3, 36, 0), (3, 36, 0))
    assert velocity.magnitude == pytest.approx((np.hypot(3, 36),) * 2)
    assert (velocity.count, velocity.unit, velocity.not_finite) == (4, "m/s", 0)
    assert of(summary, "p.x", 1).count == 1
    # nodes with their extra layer: x from -0.5 to 2.5, y from -0.5 to 1.5, z from 0 to 0.5
    mass = of(summary, "g.mass")
    assert (mass.count, mass.low[0], mass.high[0]) == (
        7 * 5 * 2,
        1 - 0.5 - 5 + 9000,
        1 + 2.5 + 15 + 50 + 9000,
    )
    assert summary.size == sum(f.stat().st_size for f in Path(summary.path).rglob("*") if f.is_file())


def test_an_earlier_step_and_values_that_are_not_finite(make):
    def spoil(step, fields):
        if step == 4:
            fields[next(v for v in fields if v.name == "p.velocity")][0][2, 1] = np.nan

    velocity = of(summarize(make(change=spoil), 4), "p.velocity")
    assert velocity.not_finite == 1
    assert velocity.high == (3, 16, 0)


def test_text_names_what_there_is(make):
    text = render(summarize(make()))
    assert "a.uda: rod" in text
    assert "by 2 processes" in text
    assert "level 0: 4 x 2 x 1 cells of [0.5, 0.5, 0.5] m, [0, 0, 0] to [2, 1, 0.5] m, 2 patches" in text
    assert "[0.25, 0.25, 0.25] to [1.75, 0.25, 0.25]  m" in text
    assert "KineticEnergy  3 lines  last 4.5    J" in text
    assert text.endswith("nothing is missing or cut off")


def test_a_block_that_was_cut_off_is_named_and_the_step_before_is_shown(make):
    archive = make()
    data = archive / "t00009" / "l0" / "p00001.data"
    data.write_bytes(data.read_bytes()[:-1])
    summary = summarize(archive)
    assert summary.step == 4
    (problem,) = summary.problems
    assert "press_CC of material 0, patch 1" in str(problem)
    assert problem.path == data


def test_the_command_as_json(make):
    done = CliRunner().invoke(main, ["info", str(make()), "--json"])
    assert done.exit_code == 0
    found = json.loads(done.output)
    assert found["timesteps"][1] == {"step": 4, "time": 0.5, "old_delt": 0.125, "href": "t00004/timestep.xml"}
    assert {v["name"] for v in found["variables"]} >= {"p.stress", "g.mass"}


def test_a_range_of_nothing_is_null_in_json(make):
    def empty(_step, fields):
        for variable, by_material in fields.items():
            if variable.is_particle:
                by_material[1] = by_material[1][:0]

    found = summarize(make(change=empty)).as_dict()
    text = json.dumps(found, allow_nan=False)
    lone = next(v for v in json.loads(text)["variables"] if (v["name"], v["material"]) == ("p.velocity", 1))
    assert (lone["count"], lone["low"], lone["magnitude"]) == (0, None, None)


def test_what_is_no_archive_is_said(tmp_path):
    with pytest.raises(ArchiveError, match=r"there is no index\.xml"):
        summarize(tmp_path)
    done = CliRunner().invoke(main, ["info", str(tmp_path / "nothing")])
    assert done.exit_code == 1
    assert "no index.xml" in done.output


def test_the_numbers_that_puda_prints(sus):
    summary = summarize(sus("disks_sulsky"), 1)
    position = of(summary, "p.x")
    assert position.low == (6.3293515079129212e-02, 6.3293515079129212e-02, 1.2500000000000001e-02)
    assert position.high == (9.3670648492087083e-01, 9.3670648492087083e-01, 3.7500000000000006e-02)
    assert of(summary, "p.stress").magnitude == pytest.approx(
        (8.7313052538879922e-17, 1.0270236871084802e-14), rel=1e-14
    )
    mass = of(summary, "g.mass")
    assert (mass.low, mass.high) == ((9.9999999999999998e-201,), (6.2500000000000264e-02,))


def test_a_run_that_was_taken_up_says_from_where(make):
    archive = make()
    index = without_checksums(archive) / "index.xml"
    note = '  <restarts>\n    <restart from="old.uda" timestep="7"/>\n  </restarts>\n</Uintah_DataArchive>'
    index.write_text(index.read_text().replace("</Uintah_DataArchive>", note))
    assert summarize(archive).restarts == (("old.uda", 7),)
    assert "  taken up from old.uda at step 7\n" in render(summarize(archive))
