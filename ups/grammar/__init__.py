"""What Uintah's language holds beyond what this program runs: declared in the same form, checked, not run.

``EXTENSIONS`` adds tags to records that this program runs; ``known_model`` finds models of Uintah that it
does not. Modules are imported where a deck needs them.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Iterable
from functools import cache
from typing import Annotated, TypeVar

from solver.declare import Parameter

Class = TypeVar("Class", bound=type)

EXTENSIONS: dict[str, str] = {
    "ups.deck:Specification": "ups.grammar.sections:MpmSections",
    "ups.deck:MaterialProperties": "ups.grammar.sections:MaterialPropertiesExtension",
    "ups.deck:MaterialSection": "ups.grammar.mpm_material:MaterialExtension",
    "ups.deck:DataArchiver": "ups.grammar.data_archiver:DataArchiverExtension",
    "ups.deck:BoundaryConditionSection": "ups.grammar.boundary_conditions:BoundaryConditionsExtension",
    "ups.deck:Face": "ups.grammar.boundary_conditions:FaceExtension",
    "ups.deck:BoundaryType": "ups.grammar.boundary_conditions:BoundaryTypeExtension",
    "ups.deck:GridSection": "ups.grammar.sections:GridExtension",
    "ups.deck:Box": "ups.grammar.sections:BoxExtension",
    "ups.deck:PhysicalConstants": "ups.grammar.sections:PhysicalConstantsExtension",
    "solver.creation:GeometryObject": "ups.grammar.geometry_object:GeometryObjectExtension",
}
"""Record, as ``module:Class`` -> the section that holds the tags which this program does not run."""

_PACKAGES = ("constitutive_model", "diffusion", "diffusion_interface", "geometry", "load")
_KNOWN: dict[str, dict[str, type]] = {}


def known(family: str, *names: str) -> Callable[[Class], Class]:
    """Class decorator: a section describes model(s) of a family that this program does not run."""

    def register(cls: Class) -> Class:
        for name in names:
            _KNOWN.setdefault(family, {})[name] = cls
        return cls

    return register


def numbers(table: str) -> Callable[[Class], Class]:
    """Class decorator: add optional numbers to a section; each line is ``NAME NAME ...: meaning``."""

    def add(cls: Class) -> Class:
        for line in table.strip().splitlines():
            names, _, meaning = line.partition(":")
            for name in names.split():
                cls.__annotations__[name] = Annotated[float, Parameter(meaning.strip())]
                setattr(cls, name, 0.0)
        return cls

    return add


@cache
def extension(record: type) -> type | None:
    """The section with the tags that a record may hold besides its own, or None."""
    where = EXTENSIONS.get(f"{record.__module__}:{record.__qualname__}")
    if where is None:
        return None
    module, _, name = where.partition(":")
    found: type = getattr(importlib.import_module(module), name)
    return found


@cache
def _known_of(family: str) -> dict[str, type]:
    """The models of a family that are known and not run."""
    if family in _PACKAGES:
        package = importlib.import_module(f"ups.grammar.{family}")
        for module in pkgutil.iter_modules(package.__path__):
            importlib.import_module(f"{package.__name__}.{module.name}")
    return _KNOWN.get(family, {})


def known_model(family: str, name: str) -> type | None:
    """The section that describes a model which is known and not run, or None."""
    return _known_of(family).get(name)


def known_names(family: str) -> Iterable[str]:
    """The names of the models of a family that are known and not run."""
    return _known_of(family).keys()


def parents_of(tag: str) -> tuple[str, ...]:
    """The sections that may hold a tag, by their tags."""
    from ups.grammar.index import tag_index

    return tag_index().get(tag, ())
