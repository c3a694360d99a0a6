"""States of elastic-plastic particles for tests of sub-models, and the same call in a kernel."""

from __future__ import annotations

import itertools

import pytest

from solver.materials.plasticity_state import PlasticityState

COPPER = PlasticityState(
    plastic_strain=0.1,
    plastic_strain_rate=4000.0,
    strain_rate=4000.0,
    temperature=400.0,
    mean_stress=0.0,
    density=8930.0,
    initial_density=8930.0,
    energy=0.0,
    bulk_modulus=129.0e9,
    shear_modulus=46.0e9,
    melt_temperature=1356.0,
    specific_heat=414.0,
)


def state(**changes):
    """A particle of copper with some values changed."""
    return COPPER._replace(**changes)


def grid(**values):
    """All states of a grid of values."""
    return [state(**dict(zip(values, point, strict=True))) for point in itertools.product(*values.values())]


def assert_compiled_agrees(function, *arguments):
    """The function gives in a kernel what it gives in Python."""
    from solver.jit import kernel

    def call(*given):
        return function(*given)

    compiled = kernel(call if hasattr(function, "implementations") else function)
    assert compiled(*arguments) == pytest.approx(function(*arguments), rel=1e-13, abs=1e-300)


def difference_quotient(function, model, at, name, step):
    """Central difference of a model's function by one value of the state."""
    value = getattr(at, name)
    up = function(model, at._replace(**{name: value + step}))
    down = function(model, at._replace(**{name: value - step}))
    return (up - down) / (2.0 * step)
