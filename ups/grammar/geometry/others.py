"""Corrugated sheets, polyhedra and images."""

from __future__ import annotations

from typing import Annotated

from solver.declare import IntVector, Parameter, Section, Vector
from ups.grammar import known


@known("geometry", "corrugated")
class Corrugated(Section):
    """A sheet with one wavy edge."""

    xymin: Annotated[Vector, Parameter("lower corner", unit="m")]
    xymax: Annotated[Vector, Parameter("upper corner", unit="m")]
    thickness: Annotated[float, Parameter("thickness", unit="m")]
    normal: Annotated[Vector, Parameter("direction across the sheet")]
    corr_edge: Annotated[str, Parameter("edge that is wavy", choices=("x+", "x-", "y+", "y-"))]
    curve: Annotated[str, Parameter("form of the waves", choices=("sin",))]
    wavelength: Annotated[float, Parameter("length of a wave", unit="m")]
    amplitude: Annotated[float, Parameter("height of a wave", unit="m")]


class HalfSpace(Section):
    """All points on one side of a plane."""

    type: Annotated[
        str, Parameter("how the plane is given", choices=("absolute", "relative"), attribute=True)
    ]
    planePoint: Annotated[Vector, Parameter("a point of the plane", unit="m")] = (0.0, 0.0, 0.0)
    normal: Annotated[Vector, Parameter("direction out of the half space")] = (0.0, 0.0, 0.0)
    offset: Annotated[Vector, Parameter("from the centre to the plane", unit="m")] = (0.0, 0.0, 0.0)


class HalfSpaces(Section):
    """The half spaces whose intersection a polyhedron is."""

    half_space: Annotated[tuple[HalfSpace, ...], Parameter("a half space")] = ()


@known("geometry", "polyhedron")
class Polyhedron(Section):
    """A convex body between planes."""

    label: Annotated[str, Parameter("name by which the piece can be used again", attribute=True)] = ""
    center: Annotated[Vector, Parameter("a point inside", unit="m")]
    bounds: Annotated[HalfSpaces, Parameter("the planes")]


@known("geometry", "image")
class Image(Section):
    """A body given by the grey values of an image."""

    name: Annotated[str, Parameter("file of the image")]
    res: Annotated[IntVector | None, Parameter("pixels in each direction")] = None
    threshold: Annotated[tuple[float, ...], Parameter("grey values of the body")] = ()
