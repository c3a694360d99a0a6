"""Measures of stored vectors and tensors: ``p.stress:vonMises``, ``p.velocity:magnitude``.

A measure is asked for behind the label of a stored variable and computed when the variable is read. Any
component is a measure, too: ``p.stress:XY``, ``p.x:Z``. Names follow ParaView where it has one.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ups.archive.units import plain_name, unit_of
from ups.archive.variables import ELEMENTS, Variable

_VECTORS = ("Vector", "Point")
_TENSORS = ("Matrix3",)
_NUMBERS = ("double", "float")


@dataclass(frozen=True)
class Measure:
    """A quantity computed from each element of a variable.

    Attributes
    ----------
    name
        What stands behind the colon.
    elements
        Element types that it is defined for.
    result
        Element type that it gives.
    unit
        Its unit; None for that of the variable.
    meaning
        One phrase.
    function
        From values of shape (n..., element...) to those of the result.
    """

    name: str
    elements: tuple[str, ...]
    result: str
    unit: str | None
    meaning: str
    function: Callable[[np.ndarray], np.ndarray]


MEASURES: dict[str, Measure] = {}
"""Known measures by name, components apart."""


def _measure(
    name: str, elements: tuple[str, ...], result: str = "double", *, unit: str | None = None
) -> Callable[[Callable[[np.ndarray], np.ndarray]], Callable[[np.ndarray], np.ndarray]]:
    """Declare the decorated function as a measure; its docstring is the meaning."""

    def declare(function: Callable[[np.ndarray], np.ndarray]) -> Callable[[np.ndarray], np.ndarray]:
        meaning = (function.__doc__ or "").split("\n")[0].rstrip(".")
        MEASURES[name] = Measure(name, elements, result, unit, meaning, function)
        return function

    return declare


@_measure("magnitude", _VECTORS)
def magnitude(vector: np.ndarray) -> np.ndarray:
    """Length of a vector."""
    return np.sqrt(np.einsum("...i,...i->...", vector, vector))


@_measure("norm", _TENSORS)
def norm(tensor: np.ndarray) -> np.ndarray:
    """Frobenius norm of a tensor."""
    return np.sqrt(np.einsum("...ij,...ij->...", tensor, tensor))


@_measure("trace", _TENSORS)
def trace(tensor: np.ndarray) -> np.ndarray:
    """Trace of a tensor."""
    return np.einsum("...ii->...", tensor)


@_measure("pressure", _TENSORS)
def pressure(stress: np.ndarray) -> np.ndarray:
    """Pressure of a stress, minus a third of its trace: compression is positive."""
    return -trace(stress) / 3.0


@_measure("vonMises", _TENSORS)
def von_mises(stress: np.ndarray) -> np.ndarray:
    """Von Mises stress, the square root of 3/2 s:s with the deviator s."""
    return np.sqrt(1.5) * norm(_deviator(stress))


@_measure("triaxiality", _TENSORS, unit="1")
def triaxiality(stress: np.ndarray) -> np.ndarray:
    """Stress triaxiality, the mean stress over the von Mises stress: 1/3 in uniaxial tension."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return -pressure(stress) / von_mises(stress)


@_measure("maxShear", _TENSORS)
def largest_shear(tensor: np.ndarray) -> np.ndarray:
    """Largest shear (Tresca), half the difference of the extreme principal values."""
    principal = _principal(tensor)
    return (principal[..., 2] - principal[..., 0]) / 2.0


@_measure("maxPrincipal", _TENSORS)
def largest_principal(tensor: np.ndarray) -> np.ndarray:
    """Largest principal value of the symmetric part."""
    return _principal(tensor)[..., 2]


@_measure("midPrincipal", _TENSORS)
def middle_principal(tensor: np.ndarray) -> np.ndarray:
    """Middle principal value of the symmetric part."""
    return _principal(tensor)[..., 1]


@_measure("minPrincipal", _TENSORS)
def smallest_principal(tensor: np.ndarray) -> np.ndarray:
    """Smallest principal value of the symmetric part."""
    return _principal(tensor)[..., 0]


@_measure("determinant", _TENSORS, unit="1")
def determinant(deformation_gradient: np.ndarray) -> np.ndarray:
    """Determinant; of the deformation gradient F the ratio of volumes."""
    return np.linalg.det(deformation_gradient)


@_measure("strain", _TENSORS, "Matrix3", unit="1")
def green_lagrange_strain(deformation_gradient: np.ndarray) -> np.ndarray:
    """Green-Lagrange strain (F^T F - I)/2 of the deformation gradient F."""
    return (_right_cauchy_green(deformation_gradient) - np.eye(3)) / 2.0


@_measure("almansiStrain", _TENSORS, "Matrix3", unit="1")
def almansi_strain(deformation_gradient: np.ndarray) -> np.ndarray:
    """Euler-Almansi strain (I - F^-T F^-1)/2 of the deformation gradient F."""
    sound = np.isfinite(deformation_gradient).all(axis=(-2, -1))
    sound &= determinant(np.where(sound[..., None, None], deformation_gradient, np.eye(3))) != 0.0
    inverse = np.linalg.inv(np.where(sound[..., None, None], deformation_gradient, np.eye(3)))
    strain = (np.eye(3) - np.einsum("...ki,...kj->...ij", inverse, inverse)) / 2.0
    return np.where(sound[..., None, None], strain, np.nan)


@_measure("volumetricStrain", _TENSORS, unit="1")
def volumetric_strain(deformation_gradient: np.ndarray) -> np.ndarray:
    """Change of volume over the volume at the start, det F - 1 of the deformation gradient F."""
    return determinant(deformation_gradient) - 1.0


@_measure("logStrain", _TENSORS, "Matrix3", unit="1")
def logarithmic_strain(deformation_gradient: np.ndarray) -> np.ndarray:
    """Hencky's logarithmic strain ln(F^T F)/2 of the deformation gradient F."""
    finite = np.isfinite(deformation_gradient).all(axis=(-2, -1))
    usable = np.where(finite[..., None, None], deformation_gradient, np.eye(3))
    squares, directions = np.linalg.eigh(_right_cauchy_green(usable))
    with np.errstate(divide="ignore", invalid="ignore"):
        stretches = np.log(squares) / 2.0
    strain = np.einsum("...ia,...a,...ja->...ij", directions, stretches, directions)
    return np.where(finite[..., None, None], strain, np.nan)


@_measure("equivalentStrain", _TENSORS, unit="1")
def equivalent_strain(deformation_gradient: np.ndarray) -> np.ndarray:
    """Equivalent strain, the root of 2/3 e:e with the deviator e of the logarithmic strain of F."""
    return np.sqrt(2.0 / 3.0) * norm(_deviator(logarithmic_strain(deformation_gradient)))


@_measure("equivalentRate", _TENSORS, unit="1/s")
def equivalent_rate(velocity_gradient: np.ndarray) -> np.ndarray:
    """Equivalent strain rate, the root of 2/3 d:d with the deviator d of the velocity gradient's symmetric part."""
    return np.sqrt(2.0 / 3.0) * norm(_deviator(_symmetric(velocity_gradient)))


@_measure("celsius", _NUMBERS, unit="degC")
def celsius(temperature: np.ndarray) -> np.ndarray:
    """A temperature in kelvins, in degrees Celsius."""
    return np.asarray(temperature, dtype=float) - 273.15


@_measure("fahrenheit", _NUMBERS, unit="degF")
def fahrenheit(temperature: np.ndarray) -> np.ndarray:
    """A temperature in kelvins, in degrees Fahrenheit."""
    return celsius(temperature) * 1.8 + 32.0


def _right_cauchy_green(deformation_gradient: np.ndarray) -> np.ndarray:
    return np.einsum("...ki,...kj->...ij", deformation_gradient, deformation_gradient)


def _symmetric(tensor: np.ndarray) -> np.ndarray:
    return (tensor + np.swapaxes(tensor, -1, -2)) / 2.0


def _deviator(tensor: np.ndarray) -> np.ndarray:
    return tensor - trace(tensor)[..., None, None] / 3.0 * np.eye(3)


def _principal(tensor: np.ndarray) -> np.ndarray:
    """Principal values of the symmetric part, ascending; NaN where an element is not finite."""
    finite = np.isfinite(tensor).all(axis=(-2, -1))
    values = np.linalg.eigvalsh(_symmetric(np.where(finite[..., None, None], tensor, 0.0)))
    return np.where(finite[..., None], values, np.nan)


SHORTHANDS = {
    "speed": "p.velocity:magnitude",
    "strain": "p.deformationMeasure:strain",
    "strainRate": "p.velocityGradient:equivalentRate",
}
"""Names that stand for a measure of one variable, where no variable is called so itself."""


@dataclass(frozen=True)
class Named:
    """What a name stands for: a stored variable, or a measure of one.

    Attributes
    ----------
    source
        Declaration of the stored variable.
    measure
        The measure, or None for the variable itself.
    """

    source: Variable
    measure: Measure | None = None

    @property
    def declaration(self) -> Variable:
        """Declaration of the values: the stored variable's, or one called ``label:measure``."""
        if self.measure is None:
            return self.source
        return replace(
            self.source, name=f"{self.source.name}:{self.measure.name}", element=self.measure.result
        )

    @property
    def unit(self) -> str:
        """Unit in a deck of SI units; empty where it is not known."""
        if self.measure is None or self.measure.unit is None:
            return unit_of(self.source.name)
        return self.measure.unit


def find(name: str, known: Mapping[str, Variable]) -> Named:
    """Find what a name stands for: a label, with or without its prefix, and perhaps ``:measure``.

    Where labels on particles and nodes share a plain name, that of the particles is found.

    Raises
    ------
    LookupError
        Where there is no such variable or it has no such measure; the message says what there is.
    """
    label, colon, measure = name.partition(":")
    source = known.get(label) or next((v for key, v in known.items() if plain_name(key) == label), None)
    if source is None and name in SHORTHANDS:
        label, colon, measure = SHORTHANDS[name].partition(":")
        source = known.get(label)
    if source is None:
        reason = f", of which {name} is a measure" if name in SHORTHANDS else ""
        raise LookupError(f"there is no variable {label}{reason}")
    return Named(source, measure_of(source, measure) if colon else None)


def measure_of(source: Variable, name: str) -> Measure:
    """Measure or component of a variable.

    Raises
    ------
    LookupError
        Where its elements have none of this name; the message lists those that they have.
    """
    components = source.element_type.component_names
    if name in components:
        place = components.index(name)
        flat = len(source.element_type.shape)

        def component(values: np.ndarray) -> np.ndarray:
            return values.reshape(*values.shape[: values.ndim - flat], len(components))[..., place]

        element = next(
            e for e in ("double", "int", "short int") if ELEMENTS[e].dtype == source.element_type.dtype
        )
        return Measure(name, (source.element,), element, None, f"component {name}", component)
    found = MEASURES.get(name)
    if found is None or source.element not in found.elements:
        there = ", ".join(measures_of(source)) or "none"
        raise LookupError(f"{source.name} ({source.element}) has no measure {name}; there are: {there}")
    return found


def measures_of(source: Variable) -> Collection[str]:
    """Names of all measures and components that a variable has."""
    fitting = [measure.name for measure in MEASURES.values() if source.element in measure.elements]
    return [*fitting, *source.element_type.component_names]
