"""Viscoelastic solid of many Maxwell elements at finite strain."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.materials.constitutive import (
    Material,
    Point,
    Step,
    StressUpdate,
    artificial_viscosity,
    initial_sound_speed,
    stress_update,
)
from solver.particles import Array, StateVariable
from solver.tensor import determinant, deviator, inverse, isotropic, put_tensor, tensor_at, trace

MOST_MODES = 8
"""Relaxation modes for which particles have room."""


class Mode(NamedTuple):
    """One Maxwell element."""

    relaxation_time: Annotated[float, Parameter("relaxation time", unit="s", gt=0.0)]
    partial_shear_modulus: Annotated[float, Parameter("shear modulus of the element", unit="Pa", gt=0.0)]
    name: Annotated[str, Parameter("a name", attribute=True, ignored="elements are numbered")] = ""


class Series(NamedTuple):
    """The Maxwell elements."""

    mode: Annotated[tuple[Mode, ...], Parameter("one Maxwell element")]


class MaxwellState(NamedTuple):
    """Instantaneous stress and the memory of each element, pulled back to the undeformed body, (n, 3, 3)."""

    instantaneous: Annotated[Array, StateVariable("p.S0", "Matrix3")]
    history_1: Annotated[Array, StateVariable("p.stressDecay_1", "Matrix3")]
    history_2: Annotated[Array, StateVariable("p.stressDecay_2", "Matrix3")]
    history_3: Annotated[Array, StateVariable("p.stressDecay_3", "Matrix3")]
    history_4: Annotated[Array, StateVariable("p.stressDecay_4", "Matrix3")]
    history_5: Annotated[Array, StateVariable("p.stressDecay_5", "Matrix3")]
    history_6: Annotated[Array, StateVariable("p.stressDecay_6", "Matrix3")]
    history_7: Annotated[Array, StateVariable("p.stressDecay_7", "Matrix3")]
    history_8: Annotated[Array, StateVariable("p.stressDecay_8", "Matrix3")]


@model("constitutive_model", "Maxwell_Weichert")
class MaxwellWeichert(NamedTuple):
    """Neo-Hookean solid whose deviator relaxes to the terminal modulus.

    Simo and Hughes, Computational Inelasticity (1998), section 10.3: with f = J^(-1/3) F and the
    instantaneous deviator s = G_0 dev(f f^T), pulled back as S = f^-1 s f^-T, each element obeys
    h' + h / tau = S' and sigma = K/2 (J - 1/J) I + dev(f (S G_inf/G_0 + sum h G_k/G_0) f^T) / J where
    G_0 = G_inf + sum G_k. Energy is not counted. (Uintah leaves out the division by J and keeps the memory in
    the fixed frame, where it does not turn with the body.)
    """

    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    terminal_shear_modulus: Annotated[float, Parameter("shear modulus at rest G_inf", unit="Pa", ge=0.0)]
    viscoelastic_series: Annotated[Series, Parameter("the Maxwell elements")]

    @property
    def State(self) -> type:  # noqa: N802 - a class, like the attribute that other records may have
        """The arrays of a particle set."""
        return MaxwellState

    def faults(self) -> list[tuple[str, str]]:
        """Fields that do not go together, each with what is wrong."""
        count = len(self.viscoelastic_series.mode)
        if 1 <= count <= MOST_MODES:
            return []
        return [("viscoelastic_series", f"1 to {MOST_MODES} <mode> are possible, there are {count}")]


@initial_sound_speed.register
def _(model: MaxwellWeichert, density: Any, temperature: Any) -> Any:
    G = model.terminal_shear_modulus + sum(m.partial_shear_modulus for m in model.viscoelastic_series.mode)
    return np.sqrt((model.bulk_modulus + 4.0 * G / 3.0) / density)


@implements(stress_update, MaxwellWeichert)
@lanewise
def maxwell_weichert_stress(
    model: MaxwellWeichert, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """Advance each element, exactly for a constant rate of the instantaneous stress in the step."""
    histories = (
        state.history_1,
        state.history_2,
        state.history_3,
        state.history_4,
        state.history_5,
        state.history_6,
        state.history_7,
        state.history_8,
    )
    modes = model.viscoelastic_series.mode
    G_0 = model.terminal_shear_modulus
    for k in range(len(modes)):
        G_0 += modes[k].partial_shear_modulus
    K = model.bulk_modulus
    J = determinant(point.deformation_gradient)
    f = point.deformation_gradient * J ** (-1.0 / 3.0)
    back = inverse(f)
    pulled_back = back @ (G_0 * deviator(f @ f.T)) @ back.T
    change = pulled_back - tensor_at(state.instantaneous, p)
    put_tensor(state.instantaneous, p, pulled_back)
    total = pulled_back * (model.terminal_shear_modulus / G_0)
    for k in range(len(modes)):
        ratio = step.dt / modes[k].relaxation_time
        decay = math.exp(-ratio)
        history = tensor_at(histories[k], p) * decay + change * ((1.0 - decay) / ratio)
        put_tensor(histories[k], p, history)
        total = total + history * (modes[k].partial_shear_modulus / G_0)
    density = material.density / J
    return StressUpdate(
        stress=isotropic(0.5 * K * (J - 1.0 / J)) + deviator(f @ total @ f.T) / J,
        sound_speed=math.sqrt((K + 4.0 * G_0 / 3.0) / density),
        strain_energy=0.0,
        heating_rate=0.0,
        artificial_pressure=artificial_viscosity(
            step, trace(point.velocity_gradient), math.sqrt(K / density), density
        ),
        localized=point.localized,
    )
