"""Measures of tensors and vectors, against closed forms and invariants."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from ups.archive.measures import MEASURES, SHORTHANDS, find, measure_of, measures_of
from ups.archive.variables import Variable

STRESS = Variable("p.stress", "ParticleVariable", "Matrix3")
numbers = st.floats(-1e3, 1e3)


def value(name, tensor):
    return MEASURES[name].function(np.asarray(tensor, dtype=float))


def rotation(angle, axis=2):
    c, s = np.cos(angle), np.sin(angle)
    return np.roll(np.roll(np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]), axis + 1, 0), axis + 1, 1)


def test_simple_states_of_stress():
    tension = np.diag([7.0, 0, 0])
    assert value("vonMises", tension) == pytest.approx(7)
    assert value("pressure", tension) == pytest.approx(-7 / 3)
    shear = np.array([[0, 2.0, 0], [2, 0, 0], [0, 0, 0]])
    assert value("vonMises", shear) == pytest.approx(2 * np.sqrt(3))
    assert [value(f"{which}Principal", shear) for which in ("max", "mid", "min")] == pytest.approx([2, 0, -2])
    assert value("triaxiality", tension) == pytest.approx(1 / 3)
    assert value("triaxiality", shear) == pytest.approx(0)
    assert value("maxShear", tension) == pytest.approx(3.5)
    assert value("maxShear", shear) == pytest.approx(2)
    assert value("vonMises", -5 * np.eye(3)) == pytest.approx(0, abs=1e-14)
    assert value("pressure", -5 * np.eye(3)) == pytest.approx(5)


@given(arrays(float, (3, 3), elements=numbers), st.floats(-3, 3), st.integers(0, 2))
def test_invariants_do_not_change_under_rotation(tensor, angle, axis):
    tensor = tensor + tensor.T
    turned = rotation(angle, axis) @ tensor @ rotation(angle, axis).T
    for name in ("vonMises", "pressure", "norm", "maxPrincipal", "minPrincipal", "trace"):
        assert value(name, turned) == pytest.approx(value(name, tensor), abs=1e-9)


def test_strains_of_a_stretched_and_turned_body():
    stretches = np.array([1.5, 0.8, 1.1])
    deformation = rotation(0.7) @ np.diag(stretches)
    assert value("strain", deformation) == pytest.approx(np.diag((stretches**2 - 1) / 2), abs=1e-14)
    logarithmic = np.log(stretches)
    assert value("logStrain", deformation) == pytest.approx(np.diag(logarithmic), abs=1e-14)
    deviator = logarithmic - logarithmic.mean()
    assert value("equivalentStrain", deformation) == pytest.approx(np.sqrt(2 / 3 * (deviator**2).sum()))
    assert value("determinant", deformation) == pytest.approx(stretches.prod())
    assert value("volumetricStrain", deformation) == pytest.approx(stretches.prod() - 1)
    turned = rotation(0.7)
    almansi = turned @ np.diag((1 - stretches**-2) / 2) @ turned.T
    assert value("almansiStrain", deformation) == pytest.approx(almansi, abs=1e-14)


def test_the_rate_of_simple_shear():
    gradient = np.zeros((5, 3, 3))
    gradient[:, 0, 1] = np.arange(5.0)
    assert value("equivalentRate", gradient) == pytest.approx(np.arange(5) / np.sqrt(3))


def test_numbers_that_are_not_finite_stay_so():
    tensors = np.stack([np.eye(3), np.full((3, 3), np.nan)])
    assert np.isnan(value("almansiStrain", np.zeros((3, 3)))).all()
    for name in ("vonMises", "maxPrincipal", "equivalentStrain", "almansiStrain", "maxShear"):
        found = value(name, tensors)
        assert np.isfinite(found[0]).all()
        assert np.isnan(found[1]).all()


def test_temperatures():
    assert value("celsius", [273.15, 300.0]) == pytest.approx([0, 26.85])
    assert value("fahrenheit", [273.15, 373.15]) == pytest.approx([32, 212])


def test_components():
    tensors = np.arange(18.0).reshape(2, 3, 3)
    assert measure_of(STRESS, "YZ").function(tensors).tolist() == [5, 14]
    vector = Variable("p.velocity", "ParticleVariable", "Vector")
    assert measure_of(vector, "Z").function(np.arange(6.0).reshape(2, 3)).tolist() == [2, 5]
    cell = Variable("p.cell", "ParticleVariable", "IntVector")
    assert measure_of(cell, "X").result == "int"
    stencil = Variable("A", "CCVariable", "Stencil7")
    assert measure_of(stencil, "P").function(np.zeros((2, 3, 4, 7))).shape == (2, 3, 4)


def test_names():
    known = {v.name: v for v in (STRESS, Variable("g.stress", "NCVariable", "Matrix3"))}
    assert find("stress", known).source is STRESS
    assert find("g.stress:vonMises", known).declaration == Variable(
        "g.stress:vonMises", "NCVariable", "double"
    )
    assert find("stress:vonMises", known).unit == "Pa"
    assert "vonMises" in measures_of(STRESS)
    with pytest.raises(LookupError, match=r"no variable p\.velocity, of which speed is a measure"):
        find("speed", known)
    with pytest.raises(LookupError, match="has no measure length; there are: norm"):
        find("stress:length", known)


@pytest.mark.parametrize("shorthand", SHORTHANDS)
def test_a_shorthand_gives_way_to_a_variable_of_its_name(shorthand):
    label, _, measure = SHORTHANDS[shorthand].partition(":")
    element = "Vector" if measure == "magnitude" else "Matrix3"
    source = Variable(label, "ParticleVariable", element)
    own = Variable(f"p.{shorthand}", "ParticleVariable", "double")
    assert find(shorthand, {label: source}).declaration.name == f"{label}:{measure}"
    assert find(shorthand, {label: source, own.name: own}).declaration is own
