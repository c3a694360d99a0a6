"""How a model or a section of a deck declares its parameters, once.

A *record* is a ``NamedTuple`` or dataclass whose fields carry a :class:`Parameter` in their annotation::

    @model("flow_stress", "johnson_cook")
    class JohnsonCook(NamedTuple):
        '''Johnson and Cook (1983): sigma = (A + B ep^n) (1 + C ln rate) (1 - T*^m).'''

        A: Annotated[float, Parameter("yield stress", unit="Pa", ge=0.0)]
        T_m: Annotated[float, Parameter("melting temperature", unit="K", gt=0.0)] = 1793.0

The reader of decks, ``ups lint``, ``ups explain`` and the documentation are derived from these declarations.
Field names are the tags of the deck unless ``Parameter.tag`` says otherwise. A field without a default is required.
"""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import pkgutil
import re
import typing
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args, get_origin, get_type_hints

Vector = tuple[float, float, float]
"""Three numbers, written ``[a, b, c]`` in a deck."""

IntVector = tuple[int, int, int]
"""Three integers, written ``[a, b, c]`` in a deck."""

REQUIRED: Any = dataclasses.MISSING

Class = TypeVar("Class", bound=type)


@dataclass(frozen=True)
class Parameter:
    """What one tag (or attribute) of a deck means and which values it may take.

    Attributes
    ----------
    meaning : what the value stands for, in a phrase.
    unit : unit in SI, e.g. ``"Pa"``; any consistent system may be used.
    gt, ge, lt, le : bounds of a number (of every component of a vector).
    choices : the legal words of a string.
    tag : name in the deck where it differs from the field's name.
    old_tags : names that earlier versions of Uintah used.
    attribute : True for an XML attribute, False for a child element.
    source : where the value or its equation comes from.
    ignored : why the value is read and has no effect, if so.
    unsupported : what this program would need to run a deck that gives the value, if it does not run it.
    not_run : those of the choices that are known, and not run.
    repeated : True for a tag that may be given several times, each with one value of the tuple.
    tag_attributes : attributes that the tag may carry besides its value.
    """

    meaning: str
    unit: str = ""
    gt: float | None = None
    ge: float | None = None
    lt: float | None = None
    le: float | None = None
    choices: tuple[str, ...] = ()
    tag: str = ""
    old_tags: tuple[str, ...] = ()
    attribute: bool = False
    source: str = ""
    ignored: str = ""
    unsupported: str = ""
    not_run: tuple[str, ...] = ()
    repeated: bool = False
    tag_attributes: tuple[str, ...] = ()


class Section:
    """Base of records that are declared by plain annotations: sections and models that are known, but not run.

    A subclass needs no decorator and costs nothing until a deck names it; the tags read are its attributes.
    """

    def __init__(self, **values: Any) -> None:
        self.__dict__.update(values)


@dataclass(frozen=True)
class TagGroup:
    """Tags (or attributes) of a record of which a deck gives exactly one, or at most one if none is needed."""

    names: tuple[str, ...]
    needed: bool


def one_of(*names: str, needed: bool = True) -> Callable[[Class], Class]:
    """Class decorator: of these tags or attributes a deck gives exactly one (at most one if not ``needed``)."""
    group = TagGroup(names, needed)

    def add(cls: Class) -> Class:
        _GROUPS[cls] = (group, *_GROUPS.get(cls, ()))
        return cls

    return add


_GROUPS: dict[type, tuple[TagGroup, ...]] = {}


def groups(record: type) -> tuple[TagGroup, ...]:
    """The groups of tags of a record, its bases' included."""
    return tuple(group for cls in record.__mro__ for group in _GROUPS.get(cls, ()))


@dataclass(frozen=True)
class SubModel:
    """Marks a field that holds a model of a family, e.g. ``Annotated[Any, SubModel("flow_stress")]``."""

    family: str
    many: bool = False


@dataclass(frozen=True)
class SectionOf:
    """Marks a field that holds a section declared elsewhere, ``"module:Class"``, loaded where a deck gives it."""

    where: str
    many: bool = False

    @property
    def record(self) -> type:
        """The record class."""
        module, _, name = self.where.partition(":")
        record: type = getattr(importlib.import_module(module), name)
        return record


@dataclass
class Family:
    """A set of interchangeable models that one tag of a deck chooses from.

    Attributes
    ----------
    name : the family's name in this program, e.g. ``"flow_stress"``.
    tag : the tag in the deck, e.g. ``"flow_model"``.
    package : the package whose modules each hold one model (or a close kin of models), or the one module that
        holds them all.
    key : ``"@type"`` when an attribute names the model, ``"type"`` when a child tag does, ``"tag"`` when the
        tag itself is the model's name (geometry pieces).
    meaning : what the family is, in a phrase.
    old_tags : tags that earlier versions of Uintah used.
    """

    name: str
    tag: str
    package: str
    key: str
    meaning: str
    old_tags: tuple[str, ...] = ()
    _models: dict[str, type] = field(default_factory=dict, repr=False)
    _old_names: dict[str, str] = field(default_factory=dict, repr=False)
    _loaded: bool = field(default=False, repr=False)

    def _load(self) -> None:
        if self._loaded:
            return
        self._loaded = True
        for module in self._modules():
            if not module.ispkg:
                importlib.import_module(f"{self.package}.{module.name}")

    def _modules(self) -> Iterator[pkgutil.ModuleInfo]:
        """The modules of the package; none where a single module declares the whole family."""
        yield from pkgutil.iter_modules(getattr(importlib.import_module(self.package), "__path__", ()))

    @cached_property
    def _homes(self) -> dict[str, str]:
        """Name of a model -> the module that declares it, found in the texts of the modules without loading them."""
        declaration = re.compile(rf'^@model\(\s*"{self.name}",([^)]*)', re.MULTILINE)
        homes: dict[str, str] = {}
        for module in self._modules():
            spec = module.module_finder.find_spec(module.name, None)
            origin = spec.origin if spec is not None else None
            if origin is None or not origin.endswith(".py"):
                continue
            for names in declaration.findall(Path(origin).read_text(encoding="utf-8")):
                homes.update(
                    (name, f"{self.package}.{module.name}") for name in re.findall(r'"([^"]+)"', names)
                )
        return homes

    def find(self, name: str) -> type | None:
        """The record class of a model by its name, old or new; only the module that declares it is loaded."""
        if not self._loaded and name not in self._models:
            plain = name.replace("_", "").lower()
            for module in self._modules():
                if not module.ispkg and module.name.replace("_", "") == plain:
                    importlib.import_module(f"{self.package}.{module.name}")
        if not self._loaded and name not in self._models and name not in self._old_names:
            home = self._homes.get(name)
            if home is None and self._homes:
                return None
            importlib.import_module(home or self.package)
        if name in self._models:
            return self._models[name]
        today = self._old_names.get(name)
        if today is None:
            return self.models.get(name) if not self._homes else None
        return self._models.get(today)

    def today(self, name: str) -> str:
        """The name of today of a model that was found."""
        return self._old_names.get(name, name)

    @property
    def models(self) -> dict[str, type]:
        """The record class of every model, by the name a deck uses today."""
        self._load()
        return self._models

    @property
    def old_names(self) -> dict[str, str]:
        """Names of earlier versions of Uintah -> the names of today."""
        self._load()
        return self._old_names


FAMILIES: dict[str, Family] = {}
"""Every family, by name. A new family is one call of :func:`family`."""


def family(
    name: str, tag: str, package: str, key: str, meaning: str, old_tags: tuple[str, ...] = ()
) -> Family:
    """Declare a family of models; each module of ``package`` registers its models with :func:`model`."""
    FAMILIES[name] = Family(name, tag, package, key, meaning, old_tags)
    return FAMILIES[name]


def model(family_name: str, *names: str, old_names: tuple[str, ...] = ()) -> Callable[[Class], Class]:
    """Class decorator: register a record as the model(s) ``names`` of a family.

    Several names are synonyms of equal standing (``elastic_plastic`` and ``elastic_plastic_hp``);
    ``old_names`` are understood with a note that names the form of today, which is ``names[0]``.
    """

    def register(cls: Class) -> Class:
        owner = FAMILIES[family_name]
        for name in names:
            owner._models[name] = cls
        for name in old_names:
            owner._old_names[name] = names[0]
        return cls

    return register


@dataclass(frozen=True)
class FieldInfo:
    """One declared field of a record: its Python name, type, parameter and default."""

    name: str
    type: Any
    parameter: Parameter
    sub_model: SubModel | None
    default: Any
    section: SectionOf | None = None

    @cached_property
    def record(self) -> type | None:
        """The record class of a field that holds one section, or many of one kind; None for values."""
        if self.section is not None:
            return self.section.record
        hint = without_optional(self.type)
        if get_origin(hint) is tuple and get_args(hint)[-1] is Ellipsis:
            hint = get_args(hint)[0]
        return hint if is_record(hint) else None

    @cached_property
    def many(self) -> bool:
        """Whether a deck may give the field several times."""
        if self.section is not None:
            return self.section.many
        if self.sub_model is not None:
            return self.sub_model.many
        return self.parameter.repeated or (self.record is not None and get_origin(self.type) is tuple)

    @property
    def tag(self) -> str:
        """The name of the field in a deck."""
        if self.sub_model and not self.parameter.tag:
            return FAMILIES[self.sub_model.family].tag
        return self.parameter.tag or self.name

    @property
    def required(self) -> bool:
        """Whether a deck must give the field."""
        return self.default is REQUIRED


def _defaults(record: type) -> Iterator[tuple[str, Any]]:
    if dataclasses.is_dataclass(record):
        for item in dataclasses.fields(record):
            if item.default_factory is not dataclasses.MISSING:
                yield item.name, item.default_factory()
            else:
                yield item.name, item.default
    elif issubclass(record, Section):
        names = {name: None for cls in reversed(record.__mro__) for name in inspect.get_annotations(cls)}
        for name in names:
            owner = next(cls for cls in record.__mro__ if name in inspect.get_annotations(cls))
            yield name, owner.__dict__.get(name, REQUIRED)
    else:
        given = getattr(record, "_field_defaults", {})
        for name in getattr(record, "_fields", ()):
            yield name, given.get(name, REQUIRED)


@cache
def fields(record: type) -> tuple[FieldInfo, ...]:
    """The declared fields of a record; fields without a Parameter or SubModel are not part of a deck."""
    hints = get_type_hints(record, include_extras=True)
    found = []
    for name, default in _defaults(record):
        hint = hints[name]
        if get_origin(hint) is not Annotated:
            continue
        inner, *marks = get_args(hint)
        parameter = next((m for m in marks if isinstance(m, Parameter)), None)
        sub_model = next((m for m in marks if isinstance(m, SubModel)), None)
        section = next((m for m in marks if isinstance(m, SectionOf)), None)
        if parameter is None and sub_model is None:
            continue
        if parameter is None and sub_model is not None:
            parameter = Parameter(FAMILIES[sub_model.family].meaning)
        assert parameter is not None
        found.append(FieldInfo(name, inner, parameter, sub_model, default, section))
    return tuple(found)


def without_optional(hint: Any) -> Any:
    """``X`` for the hint ``X | None``; any other hint unchanged."""
    args = [a for a in get_args(hint) if a is not type(None)]
    if len(args) == 1 and len(get_args(hint)) == 2 and get_origin(hint) is not tuple:
        return args[0]
    return hint


def is_record(hint: Any) -> bool:
    """Whether a type is a record class: a dataclass, a NamedTuple or a Section."""
    if not isinstance(hint, type) or typing.get_origin(hint) is not None:
        return False
    return issubclass(hint, Section) or dataclasses.is_dataclass(hint) or hasattr(hint, "_fields")
