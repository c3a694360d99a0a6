"""The particles of one material: arrays for kernels, and how an archive names them."""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple, TypeVar, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


class StateVariable(NamedTuple):
    """How an array of a particle set is called in an archive, and what it starts from.

    Attributes
    ----------
    label : Uintah's name, e.g. ``p.plasticStrain``; empty for what is never saved.
    element : Uintah's element type: double, int, long64, Point, Vector, Matrix3.
    initial : value of every particle at the start (for Matrix3: this times the identity).
    restart : whether a checkpoint needs it.
    """

    label: str
    element: str = "double"
    initial: float = 0.0
    restart: bool = True


SHAPES: dict[str, tuple[int, ...]] = {"Point": (3,), "Vector": (3,), "Matrix3": (3, 3), "IntVector": (3,)}
DTYPES = {"int": np.int32, "long64": np.int64, "IntVector": np.int32}


class Particles(NamedTuple):
    """State of the n particles of a material. Lengths in the deck's units, tensors as (n, 3, 3)."""

    position: Annotated[Array, StateVariable("p.x", "Point")]
    velocity: Annotated[Array, StateVariable("p.velocity", "Vector")]
    displacement: Annotated[Array, StateVariable("p.displacement", "Vector")]
    mass: Annotated[Array, StateVariable("p.mass")]
    volume: Annotated[Array, StateVariable("p.volume")]
    size: Annotated[Array, StateVariable("p.size", "Matrix3")]
    """Initial particle vectors r1, r2, r3 as columns, in cell units."""
    deformation_gradient: Annotated[Array, StateVariable("p.deformationMeasure", "Matrix3", 1.0)]
    velocity_gradient: Annotated[Array, StateVariable("p.velGrad", "Matrix3")]
    stress: Annotated[Array, StateVariable("p.stress", "Matrix3")]
    temperature: Annotated[Array, StateVariable("p.temperature")]
    previous_temperature: Annotated[Array, StateVariable("p.tempPrevious")]
    temperature_gradient: Annotated[Array, StateVariable("p.temperatureGradient", "Vector")]
    temperature_rate: Annotated[Array, StateVariable("", restart=False)]
    """Rate that the particle takes from the grid in this step."""
    heating_rate: Annotated[Array, StateVariable("p.dTdt")]
    """Rate of temperature by the material itself in the last step (plastic work, compression, ...)."""
    external_force: Annotated[Array, StateVariable("p.externalforce", "Vector")]
    external_heat_rate: Annotated[Array, StateVariable("p.externalHeatRate")]
    artificial_pressure: Annotated[Array, StateVariable("p.q")]
    color: Annotated[Array, StateVariable("p.color")]
    localized: Annotated[Array, StateVariable("p.localizedMPM", "int")]
    load_curve: Annotated[Array, StateVariable("p.loadCurveID", "IntVector")]
    """Up to three load-curve ids, 0 where there is none."""
    surface: Annotated[Array, StateVariable("p.surface")]
    """1 on the surface of a body, where load curves or contact ask for it, else 0."""
    id: Annotated[Array, StateVariable("p.particleID", "long64")]
    old_velocity: Annotated[Array, StateVariable("", "Vector", restart=False)]
    """Velocity at the start of the step, for the stable time step."""

    def __len__(self) -> int:
        return int(self.position.shape[0])


Record = TypeVar("Record", bound=tuple[Any, ...])


def state_variables(record: type) -> dict[str, StateVariable]:
    """Field name -> declaration, for a NamedTuple of arrays."""
    hints = get_type_hints(record, include_extras=True)
    fields: tuple[str, ...] = record._fields  # type: ignore[attr-defined]  # record is a NamedTuple class
    return {name: next(m for m in get_args(hints[name]) if isinstance(m, StateVariable)) for name in fields}


def new_arrays(record: type[Record], count: int) -> Record:
    """Arrays of ``count`` particles for a NamedTuple of state variables, at their initial values."""
    arrays = []
    for variable in state_variables(record).values():
        shape = SHAPES.get(variable.element, ())
        array = np.zeros((count, *shape), DTYPES.get(variable.element, np.float64))
        if variable.initial:
            array[...] = np.eye(3) * variable.initial if variable.element == "Matrix3" else variable.initial
        arrays.append(array)
    return record(*arrays)


def keep(record: Record, kept: Array) -> Record:
    """The same record with only the particles that a mask or an index array names."""
    return type(record)(*(np.ascontiguousarray(array[kept]) for array in record))


def append(record: Record, more: Record) -> Record:
    """The particles of two records of one kind, one after the other."""
    return type(record)(*(np.concatenate(pair) for pair in zip(record, more, strict=True)))
