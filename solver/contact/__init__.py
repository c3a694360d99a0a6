"""Contact between materials that share nodes. Each module is one contact law."""

from __future__ import annotations

from solver.declare import family

CONTACT = family(
    "contact",
    tag="contact",
    package="solver.contact",
    key="type",
    meaning="how bodies of different materials interact",
)
