"""Uintah's variable types: what one element of a variable is, and where its elements sit."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

PARTICLE = "ParticleVariable"
NODE = "NCVariable"
CELL = "CCVariable"
FACES = ("SFCXVariable", "SFCYVariable", "SFCZVariable")
PER_PATCH = "PerPatch"
REDUCTION = "ReductionVariable"
SOLE = "SoleVariable"

GRID_CONTAINERS = (NODE, CELL, *FACES)
CONTAINERS = (PARTICLE, *GRID_CONTAINERS, PER_PATCH, REDUCTION, SOLE)

GLOBAL_MATERIAL = -1
"""Material index of a value that belongs to no material, such as a total over all of them."""

_AXES = "XYZ"


@dataclass(frozen=True)
class ElementType:
    """One element of a variable.

    Attributes
    ----------
    name
        Uintah's name, as in ``NCVariable<Vector>``.
    dtype
        Little-endian numpy type of one component.
    shape
        Shape of the element: () for a number, (3,) for a vector, (3, 3) for a matrix.
    component_names
        Names of the components in stored order; empty for a number.
    """

    name: str
    dtype: np.dtype[Any]
    shape: tuple[int, ...] = ()
    component_names: tuple[str, ...] = ()

    @property
    def components(self) -> int:
        """Numbers in one element."""
        return int(np.prod(self.shape, dtype=int))

    @property
    def nbytes(self) -> int:
        """Bytes of one element."""
        return self.components * self.dtype.itemsize


def _element(name: str, dtype: str, shape: tuple[int, ...] = (), names: tuple[str, ...] = ()) -> ElementType:
    return ElementType(name, np.dtype(dtype), shape, names)


_MATRIX_NAMES = tuple(a + b for a in _AXES for b in _AXES)

ELEMENTS: dict[str, ElementType] = {
    element.name: element
    for element in (
        _element("double", "<f8"),
        _element("float", "<f4"),
        _element("int", "<i4"),
        _element("short int", "<i2"),
        _element("long64", "<i8"),
        _element("bool", "|u1"),
        _element("unsigned char", "|u1"),
        _element("Point", "<f8", (3,), tuple(_AXES)),
        _element("Vector", "<f8", (3,), tuple(_AXES)),
        _element("IntVector", "<i4", (3,), tuple(_AXES)),
        _element("Matrix3", "<f8", (3, 3), _MATRIX_NAMES),
        _element("Stencil7", "<f8", (7,), tuple("WESNBTP")),
        _element("Stencil4", "<f8", (4,), tuple("WSBP")),
        _element("Short27", "<i2", (27,)),
        _element("Int130", "<i4", (400,)),
    )
}
"""Every element type that a Uintah archive may hold, by name."""

_TYPE = re.compile(r"\s*(\w+)\s*<\s*(.+?)\s*>\s*")


@dataclass(frozen=True)
class Variable:
    """Declaration of a variable of an archive.

    Attributes
    ----------
    name
        Uintah's label, such as ``p.stress`` or ``g.mass``.
    container
        Where its elements sit: one of `CONTAINERS`.
    element
        What an element is: a key of `ELEMENTS`.
    compression
        ``"gzip"``, ``"none"``, or ``""`` where the archive decides.

    Raises
    ------
    ValueError
        For an empty name or an unknown container, element or compression.
    """

    name: str
    container: str
    element: str
    compression: str = ""

    def __post_init__(self) -> None:
        if not self.name:
            raise ValueError("a variable needs a name")
        if self.container not in CONTAINERS:
            raise ValueError(f"{self.name}: unknown container {self.container!r}, not one of {CONTAINERS}")
        if self.element not in ELEMENTS:
            raise ValueError(f"{self.name}: unknown element {self.element!r}, not one of {tuple(ELEMENTS)}")
        if self.compression not in ("", "none", "gzip"):
            raise ValueError(f"{self.name}: unknown compression {self.compression!r}, not 'gzip' or 'none'")

    @classmethod
    def from_type(cls, name: str, type_name: str, compression: str = "") -> Variable:
        """Make the declaration from Uintah's type name, such as ``ParticleVariable<Matrix3>``."""
        match = _TYPE.fullmatch(type_name)
        if match is None:
            raise ValueError(f"{name}: {type_name!r} is not of the form Container<element>")
        return cls(name, match[1], match[2], compression)

    @property
    def type_name(self) -> str:
        """Uintah's name of the type, such as ``ParticleVariable<Matrix3>``."""
        return f"{self.container}<{self.element}>"

    @property
    def element_type(self) -> ElementType:
        """The element's layout."""
        return ELEMENTS[self.element]

    @property
    def is_particle(self) -> bool:
        """Whether the elements sit on particles."""
        return self.container == PARTICLE

    @property
    def is_grid(self) -> bool:
        """Whether the elements sit on nodes, cells or faces of the grid."""
        return self.container in GRID_CONTAINERS

    def shaped(self, values: npt.ArrayLike, outer: tuple[int, ...]) -> np.ndarray:
        """Return `values` as an array of shape ``outer + element shape`` of the stored type.

        A matrix may be given as (..., 3, 3) or (..., 9). No number is copied where the layout fits.

        Raises
        ------
        ValueError
            Where the shape does not fit, or where the values are of a kind that would lose
            information (floats given for integers, integers beyond the range).
        """
        element = self.element_type
        array = np.asarray(values)
        if array.dtype == element.dtype and array.shape == outer + element.shape:
            return array
        flat = (*outer, element.components) if element.shape else outer
        if array.shape not in (outer + element.shape, flat):
            raise ValueError(
                f"{self.name} ({self.type_name}) has shape {array.shape} where {outer + element.shape} is due"
            )
        if not np.can_cast(array.dtype, element.dtype, casting="same_kind"):
            raise ValueError(f"{self.name} ({self.type_name}) cannot hold values of type {array.dtype}")
        stored = array.astype(element.dtype, copy=False)
        if array.dtype.kind in "iu" and element.dtype.kind in "iu" and (stored != array).any():
            lost = array[stored != array].flat[0]
            raise ValueError(f"{self.name} ({self.type_name}) cannot hold the value {lost}")
        return stored.reshape(outer + element.shape)
