from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from solver.contact import CONTACT
from solver.declare import fields

NAMES = {
    "approach",
    "friction_LR",
    "friction_LRVar",
    "friction_bard",
    "nodal_svf",
    "null",
    "rigid",
    "single_velocity",
    "specified",
    "specified_friction",
    "specified_velocity",
}

COMMON_TAGS = {"materials", "vel_fields", "direction", "stop_time", "mu", "OneOrTwoStep", "master_material"}


def test_every_law_is_registered_under_its_names():
    assert set(CONTACT.models) == NAMES
    assert CONTACT.models["rigid"] is CONTACT.models["specified"]
    assert CONTACT.old_names["friction"] == "friction_bard"


@pytest.mark.parametrize("name", sorted(NAMES))
def test_every_law_knows_the_tags_of_contact(name):
    declared = {info.tag for info in fields(CONTACT.models[name])}
    assert declared >= COMMON_TAGS


def test_friction_has_to_be_given():
    for name in ("friction_bard", "approach", "friction_LR", "specified_friction"):
        required = {info.tag for info in fields(CONTACT.models[name]) if info.required}
        assert required == {"mu"}


def test_what_is_read_is_not_declared_as_ignored():
    read = {info.tag for info in fields(CONTACT.models["specified"]) if not info.parameter.ignored}
    assert {"direction", "filename", "include_rotation", "conditionAction", "ExcludeMaterial"} <= read
    ignored = {info.tag for info in fields(CONTACT.models["null"]) if info.parameter.ignored}
    assert {"mu", "direction", "filename"} <= ignored


def test_declarations_do_not_import_numba():
    code = "import sys; from solver.contact import CONTACT; CONTACT.models; sys.exit('numba' in sys.modules)"
    root = Path(__file__).parents[3]
    assert subprocess.run([sys.executable, "-c", code], cwd=root, check=False).returncode == 0
