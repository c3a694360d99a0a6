"""Tags of ``<material>`` and its neighbours that belong to parts of Uintah's MPM which are not run."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import Parameter, Section, SubModel
from solver.materials.damage import DAMAGE
from solver.materials.erosion import EROSION

_UNREAD = "no part of Uintah reads it"


class MaterialExtension(Section):
    """What a material may say besides what this program runs."""

    damage_model: Annotated[Any, SubModel(DAMAGE.name)] = None
    erosion: Annotated[Any, SubModel(EROSION.name)] = None
    water_density: Annotated[
        float, Parameter("density of the pore water", unit="kg/m^3", ge=0.0, unsupported="coupled flow")
    ] = 1000.0
    porosity: Annotated[
        float, Parameter("share of the volume that pores take", ge=0.0, le=1.0, unsupported="coupled flow")
    ] = 0.0
    permeability: Annotated[
        float, Parameter("permeability of the skeleton", unit="m/s", ge=0.0, unsupported="coupled flow")
    ] = 0.0
    initial_pore_pressure: Annotated[
        float, Parameter("pore pressure at the start", unit="Pa", unsupported="coupled flow")
    ] = 0.0
    allow_DWIndex_correction: Annotated[
        bool,
        Parameter("renumber materials of a restart", ignored="materials are numbered by the deck's order"),
    ] = False
    applied_contact_model: Annotated[bool, Parameter("a mark of contact", ignored=_UNREAD)] = False
    stress_free: Annotated[bool, Parameter("a mark of a material without stress", ignored=_UNREAD)] = False
    critical_density: Annotated[float, Parameter("a density", unit="kg/m^3", ignored=_UNREAD)] = 0.0
    MatTypeIdx: Annotated[int, Parameter("a type of material", ge=0, ignored=_UNREAD)] = 0
    deactivation_time: Annotated[
        float, Parameter("time from which the material takes no part", unit="s", ignored=_UNREAD)
    ] = 0.0
