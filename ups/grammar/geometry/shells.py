"""Thin bodies made of shell particles."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section, Vector
from ups.grammar import known


class Shell(Section):
    """What shells share."""

    label: Annotated[str, Parameter("name by which the piece can be used again", attribute=True)] = ""
    thickness: Annotated[float, Parameter("thickness", unit="m", ge=0.0)]


@known("geometry", "sphere_shell", "sphere_membrane")
class SphereShell(Shell):
    """A thin sphere."""

    origin: Annotated[Vector, Parameter("centre", unit="m")]
    radius: Annotated[float, Parameter("radius", unit="m", gt=0.0)]
    num_lat: Annotated[float, Parameter("particles from pole to pole", ge=0.0)]
    num_long: Annotated[float, Parameter("particles along the equator", ge=0.0)]


@known("geometry", "cylinder_shell")
class CylinderShell(Shell):
    """A thin tube."""

    top: Annotated[Vector, Parameter("centre of the upper end", unit="m")]
    bottom: Annotated[Vector, Parameter("centre of the lower end", unit="m")]
    radius: Annotated[float, Parameter("radius", unit="m", gt=0.0)]
    num_axis: Annotated[float, Parameter("particles along the axis", ge=0.0)]
    num_circum: Annotated[float, Parameter("particles around the axis", ge=0.0)]


@known("geometry", "plane_shell")
class PlaneShell(Shell):
    """A thin disk."""

    center: Annotated[Vector, Parameter("centre", unit="m")]
    normal: Annotated[Vector, Parameter("direction across the disk")]
    radius: Annotated[float, Parameter("radius", unit="m", gt=0.0)]
    num_radius: Annotated[float, Parameter("particles along the radius", ge=0.0)]
