"""Loads on the surfaces of bodies, as ``<PhysicalBC><MPM>`` lists them. Each module is one kind of load."""

from __future__ import annotations

from solver.declare import family

LOAD = family(
    "load",
    tag="",
    package="solver.loads",
    key="tag",
    meaning="load on the particles at the surface of a body",
)
