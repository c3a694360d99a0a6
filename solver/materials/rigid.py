"""Rigid material: moves as contact laws prescribe and never bears stress."""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from solver.declare import Parameter, model
from solver.dispatch import implements, lanewise
from solver.materials.constitutive import (
    Material,
    Point,
    Step,
    StressUpdate,
    initial_sound_speed,
    stress_update,
)
from solver.tensor import isotropic

NO_WAVES = -1.0e300
"""A sound speed so negative that neither waves nor the particle's own speed limit the time step."""

_UNUSED = "a rigid body has no stress; only the coupled gas-solid method asks for its compressibility"


@model("constitutive_model", "rigid")
class Rigid(NamedTuple):
    """A body whose particles keep zero stress and do not limit the time step below one unit of time."""

    shear_modulus: Annotated[float, Parameter("shear modulus", unit="Pa", gt=0.0, ignored=_UNUSED)] = 1.0e200
    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0, ignored=_UNUSED)] = 1.0e200

    coeff_thermal_expansion: Annotated[
        float, Parameter("coefficient of linear thermal expansion", unit="1/K", ignored=_UNUSED)
    ] = 0.0
    G: Annotated[float, Parameter("shear modulus", unit="Pa", ignored=_UNUSED)] = 0.0
    K: Annotated[float, Parameter("bulk modulus", unit="Pa", ignored=_UNUSED)] = 0.0
    alpha: Annotated[float, Parameter("thermal expansion", unit="1/K", ignored=_UNUSED)] = 0.0

    @property
    def largest_time_step(self) -> float:
        """The longest step that Uintah allows where a rigid body is all there is."""
        return 1.0


@initial_sound_speed.register
def _(model: Rigid, density: Any, temperature: Any) -> Any:
    return np.full(np.shape(density), NO_WAVES)


@implements(stress_update, Rigid)
@lanewise
def rigid_stress(
    model: Rigid, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """No stress, no energy, no heat."""
    return StressUpdate(
        stress=isotropic(0.0),
        sound_speed=NO_WAVES,
        strain_energy=0.0,
        heating_rate=0.0,
        artificial_pressure=0.0,
        localized=point.localized,
    )
