"""Declarations of records, models and families."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import dataclass, field
from typing import Annotated, Any, NamedTuple

import pytest

import solver.contact
import solver.geometry
import solver.interpolation
import solver.loads
import solver.materials  # noqa: F401 - importing the packages declares their families
from solver.declare import (
    FAMILIES,
    REQUIRED,
    Family,
    Parameter,
    SubModel,
    Vector,
    family,
    fields,
    is_record,
    model,
    without_optional,
)


class Spring(NamedTuple):
    """A record of the kind that models are."""

    stiffness: Annotated[float, Parameter("stiffness", unit="N/m", gt=0.0)]
    rest_length: Annotated[float, Parameter("length without force", unit="m", tag="length")] = 1.0
    counter: int = 0
    note: Annotated[str, "not a parameter"] = ""


@dataclass
class Section:
    """A record of the kind that sections of a deck are."""

    name: Annotated[str, Parameter("name", attribute=True)]
    springs: Annotated[list[Any], SubModel("springs", many=True)] = field(default_factory=list)
    other: Annotated[Any, SubModel("springs"), Parameter("the other one", tag="other_spring")] = None


@pytest.fixture
def springs():
    yield family("springs", tag="spring", package="solver.contact", key="type", meaning="what pulls")
    del FAMILIES["springs"]


def test_fields_are_those_with_a_parameter_in_order():
    stiffness, length = fields(Spring)
    assert (stiffness.name, stiffness.tag, stiffness.required, stiffness.default) == (
        "stiffness",
        "stiffness",
        True,
        REQUIRED,
    )
    assert (length.name, length.tag, length.required, length.default) == ("rest_length", "length", False, 1.0)
    assert stiffness.parameter.gt == 0.0
    assert stiffness.type is float


def test_a_field_with_a_model_takes_tag_and_meaning_from_the_family(springs):
    name, many, other = fields(Section)
    assert name.parameter.attribute
    assert (many.tag, many.parameter.meaning, many.default, many.required) == (
        "spring",
        "what pulls",
        [],
        False,
    )
    assert many.sub_model.many
    assert (other.tag, other.parameter.meaning) == ("other_spring", "the other one")


def test_models_register_under_all_their_names(springs):
    registered = model("springs", "coil", "helix", old_names=("spiral",))(Spring)
    assert registered is Spring
    assert springs.models == {"coil": Spring, "helix": Spring}
    assert springs.old_names == {"spiral": "coil"}


def test_an_unknown_family_is_an_error():
    with pytest.raises(KeyError):
        model("no_such_family", "coil")(Spring)


def test_asking_for_models_loads_every_module_of_the_package():
    fresh = Family("x", "interpolator", "solver.interpolation", "text", "shape functions")
    assert fresh.models == {}  # its models are registered under the family of that name, not under this one
    assert set(FAMILIES["interpolator"].models) >= {
        "linear",
        "gimp",
        "cpdi",
        "fast_cpdi",
        "cpti",
        "3rdorderBS",
    }


@pytest.mark.parametrize(
    ("hint", "inner"),
    [
        (float | None, float),
        (float, float),
        (Vector, Vector),
        (tuple[int, ...], tuple[int, ...]),
        (int | str, int | str),
    ],
)
def test_without_optional(hint, inner):
    assert without_optional(hint) == inner


@pytest.mark.parametrize(
    ("hint", "answer"),
    [(Spring, True), (Section, True), (float, False), (Vector, False), (list[float], False), (Any, False)],
)
def test_is_record(hint, answer):
    assert is_record(hint) is answer


@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_every_declared_parameter_is_consistent(name):
    for record in FAMILIES[name].models.values():
        tags = [info.tag for info in fields(record)]
        assert len(tags) == len(set(tags)), record
        for info in fields(record):
            parameter = info.parameter
            assert parameter.meaning, (record, info.name)
            if isinstance(info.default, float) and not math.isinf(info.default):
                assert parameter.gt is None or info.default > parameter.gt, (record, info.name)
                assert parameter.ge is None or info.default >= parameter.ge, (record, info.name)
                assert parameter.lt is None or info.default < parameter.lt, (record, info.name)
                assert parameter.le is None or info.default <= parameter.le, (record, info.name)
            if parameter.choices and isinstance(info.default, str) and info.default:
                assert info.default in parameter.choices, (record, info.name)


def test_models_are_declared_without_numba():
    packages = "solver.interpolation, solver.materials, solver.contact, solver.geometry, solver.loads"
    load = "[family.models for family in list(solver.declare.FAMILIES.values())]"
    code = f"import sys, solver.declare, {packages}; {load}; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
