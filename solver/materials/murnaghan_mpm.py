"""Murnaghan's equation of state with a Newtonian viscosity."""

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
from solver.materials.water import barotropic_update
from solver.tensor import determinant


@model("constitutive_model", "murnaghanMPM")
class MurnaghanMPM(NamedTuple):
    """Barotropic material p = K (J^-gamma - 1), sigma = -p I + 2 mu dev d (Murnaghan, PNAS 30, 1944).

    The equations of water, whose particles are never removed; an inverted particle (J <= 0) answers NaN.
    """

    K: Annotated[float, Parameter("bulk modulus at rest over gamma", unit="Pa", gt=0.0)]
    gamma: Annotated[float, Parameter("exponent of density in the pressure", gt=0.0)]
    viscosity: Annotated[float, Parameter("dynamic shear viscosity", unit="Pa s", ge=0.0)]
    pressure: Annotated[
        float,
        Parameter(
            "pressure at the reference density",
            unit="Pa",
            ignored="only the coupled gas-solid method asks the material for its equation of state",
        ),
    ]
    rho0: Annotated[float, Parameter("density of the sound speed at rest", unit="kg/m^3", gt=0.0)]


@initial_sound_speed.register
def _(model: MurnaghanMPM, density: Any, temperature: Any) -> Any:
    return np.sqrt(model.K / density)


@implements(stress_update, MurnaghanMPM)
@lanewise
def murnaghan_stress(
    model: MurnaghanMPM, state: Any, p: int, point: Point, material: Material, step: Step
) -> StressUpdate:
    """The equation above."""
    J = determinant(point.deformation_gradient)
    return barotropic_update(
        model.K, model.viscosity, model.gamma, J, model.rho0 / J, point.localized, point, step
    )
