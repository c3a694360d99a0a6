"""Rules of the time step, each alone and in their order."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.time_control import TimeControl


def control(**given_values):
    return TimeControl(
        **{"maxTime": 10.0, "delt_min": 0.0, "delt_max": 1e9, "timestep_multiplier": 1.0, **given_values}
    )


def limit(rules, stable=1.0, time=1.0, previous=1.0, next_output=math.inf):
    return rules.limit(stable, time, previous, next_output)


def test_the_multiplier_scales_the_stable_step():
    assert limit(control(timestep_multiplier=0.3), stable=2.0) == pytest.approx(0.6)


def test_a_step_grows_by_the_allowed_fraction_of_the_one_before():
    assert limit(control(max_delt_increase=0.1), stable=5.0, previous=2.0) == pytest.approx(2.2)
    assert limit(control(max_delt_increase=0.1), stable=1.0, previous=2.0) == 1.0
    assert limit(control(max_delt_increase=0.1), stable=5.0, previous=0.0) == 5.0


def test_no_growth_given_or_zero_means_no_limit():
    assert limit(control(), stable=5.0, previous=1e-3) == 5.0
    assert limit(control(max_delt_increase=0.0), stable=5.0, previous=1e-3) == 5.0


def test_bounds():
    assert limit(control(delt_min=3.0), stable=2.0) == 3.0
    assert limit(control(delt_max=0.5), stable=2.0) == 0.5


def test_the_smallest_step_comes_after_growth_and_before_the_largest():
    assert limit(control(delt_min=3.0, max_delt_increase=0.1), stable=5.0, previous=1.0) == 3.0
    assert limit(control(delt_min=3.0, delt_max=0.5), stable=2.0) == 0.5


@pytest.mark.parametrize(("time", "expected"), [(0.0, 0.1), (1e-9, 2.0)])
def test_the_initial_step_limits_the_first_step_alone_unless_said(time, expected):
    assert limit(control(delt_init=0.1), stable=2.0, time=time) == expected


@pytest.mark.parametrize(("time", "expected"), [(0.0, 0.1), (0.3, 0.1), (0.5, 0.1), (0.51, 2.0)])
def test_the_initial_step_limits_until_the_end_of_its_range(time, expected):
    assert limit(control(delt_init=0.1, initial_delt_range=0.5), stable=2.0, time=time) == expected


def test_the_initial_step_may_fall_below_the_smallest():
    assert limit(control(delt_init=0.1, delt_min=1.0), stable=2.0, time=0.0) == 0.1


def test_steps_are_cut_at_outputs_only_where_asked():
    assert limit(control(), next_output=1.25) == 1.0
    assert limit(control(clamp_time_to_output=True), next_output=1.25) == 0.25
    assert limit(control(clamp_time_to_output=True), next_output=2.5) == 1.0


def test_an_output_that_is_due_already_does_not_stop_time():
    assert limit(control(clamp_time_to_output=True), next_output=1.0) == 1.0
    assert limit(control(clamp_time_to_output=True), next_output=0.5) == 1.0


def test_the_last_step_ends_at_the_end_only_where_asked():
    assert limit(control(), time=9.7) == 1.0
    assert limit(control(end_at_max_time_exactly=True), time=9.75) == 0.25
    assert limit(control(end_at_max_time_exactly=True), time=5.0) == 1.0


def test_cuts_at_output_and_end_come_after_the_smallest_step():
    rules = control(delt_min=1.0, clamp_time_to_output=True, end_at_max_time_exactly=True)
    assert limit(rules, next_output=1.5) == 0.5
    assert limit(rules, time=9.75, next_output=12.0) == 0.25
    assert limit(rules, time=9.25, next_output=9.5) == 0.25


@given(
    st.floats(1e-3, 10.0),
    st.floats(0.0, 9.9),
    st.floats(0.0, 10.0),
    st.floats(0.1, 2.0),
    st.floats(1e-6, 1.0),
    st.floats(0.0, 1.0),
)
def test_every_bound_holds_together(stable, time, previous, multiplier, delt_max, growth):
    rules = control(
        timestep_multiplier=multiplier,
        delt_max=delt_max,
        max_delt_increase=growth,
        end_at_max_time_exactly=True,
    )
    dt = rules.limit(stable, time, previous, math.inf)
    assert 0.0 < dt <= delt_max
    assert dt <= multiplier * stable
    assert time + dt <= 10.0 * (1.0 + 1e-15)
    if previous > 0.0 and growth > 0.0:
        assert dt <= (1.0 + growth) * previous


@pytest.mark.parametrize(
    ("rules", "time", "step", "wall", "goes_on"),
    [
        (control(), 9.99, 10**9, 1e9, True),
        (control(), 10.0, 0, 0.0, False),
        (control(max_Timesteps=5), 1.0, 4, 0.0, True),
        (control(max_Timesteps=5), 1.0, 5, 0.0, False),
        (control(max_wall_time=60.0), 1.0, 5, 59.0, True),
        (control(max_wall_time=60.0), 1.0, 5, 60.0, False),
    ],
)
def test_when_the_run_ends(rules, time, step, wall, goes_on):
    assert rules.goes_on(time, step, wall) is goes_on


@pytest.mark.parametrize("interval", [0.1, 0.3, 1.0 / 3.0, 7e-5])
def test_steps_between_outputs_cut_at_outputs_are_never_slivers(interval):
    """Rounding in time + dt must not leave a step of one unit in the last place before an output."""
    rules = control(maxTime=100.0, clamp_time_to_output=True)
    time, steps, outputs = 0.0, [], 0
    while outputs < 200:
        due = (outputs + 1) * interval
        dt = rules.limit(0.37 * interval, time, 0.0, due)
        time += dt
        steps.append(dt)
        outputs += time >= due
    assert min(steps) > 1e-6 * interval


def test_foreseen_steps_go_by_the_usual_step_and_the_limits():
    control = TimeControl(
        maxTime=1.0, delt_min=0.0, delt_max=0.25, timestep_multiplier=0.5, delt_init=1.0e-9, max_Timesteps=0
    )
    assert control.foreseen_steps(0.02, 0.0) == 100
    assert control.foreseen_steps(4.0, 0.5) == 2
    assert control.foreseen_steps(0.02, 2.0) == 0
    capped = TimeControl(1.0, 0.0, 0.25, 0.5, max_Timesteps=30)
    assert capped.foreseen_steps(0.02, 0.0, done=10) == 20
