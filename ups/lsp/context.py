"""Which record of the language declares the inside of a tag that is open at the cursor."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from solver.declare import FAMILIES, Family, FieldInfo
from ups.grammar import known_model, known_names
from ups.grammar.components import COMPONENTS
from ups.lsp.spot import OpenTag, children
from ups.reader import declared, is_of_family

DEFAULT_COMPONENT = "mpm"


class Inside(NamedTuple):
    """The inside of a tag: the record that declares it, the model chosen, and the field that holds the tag."""

    record: type | None
    info: FieldInfo | None = None
    family: Family | None = None
    model: str = ""


def inside(path: tuple[OpenTag, ...], text: str, component: str) -> Inside | None:
    """What may stand in the last of some nested tags, the first being the root; None where nobody knows.

    ``text`` is the file of the tags, ``component`` the method that the deck is for.
    """
    method = COMPONENTS.get(component) or COMPONENTS[DEFAULT_COMPONENT]
    found: Inside | None = Inside(method.load() if method.record else COMPONENTS[DEFAULT_COMPONENT].load())
    for tag in path[1:]:
        if found is None or found.record is None:
            return None
        found = _step(found.record, tag, text)
    return found


def _step(record: type, tag: OpenTag, text: str) -> Inside | None:
    """The inside of a tag that stands in a record."""
    for info, _ in declared(record):
        if info.parameter.attribute:
            continue
        if info.sub_model is None:
            if tag.tag in (info.tag, *info.parameter.old_tags):
                return Inside(info.record, info)
            continue
        family = FAMILIES[info.sub_model.family]
        if family.key == "tag":
            if is_of_family(family, tag.tag):
                return Inside(record_of(family, tag.tag), info, family, tag.tag)
        elif tag.tag in (info.tag, *family.old_tags):
            name = chosen(family, tag, text)
            return Inside(record_of(family, name), info, family, name)
    return None


def chosen(family: Family, tag: OpenTag, text: str) -> str:
    """The name of the model that a tag chooses; empty where it is not typed yet."""
    if family.key.startswith("@"):
        return tag.attributes.get(family.key[1:], "").strip()
    if family.key == "text":
        following = text[tag.end : text.find("<", tag.end)]
        return following.strip()
    return next((value for child, value in children(text, tag) if child.tag == family.key), "")


def record_of(family: Family, name: str) -> type | None:
    """The record of a model, run by this program or only known; None without one of that name."""
    return (family.find(name) or known_model(family.name, name)) if name else None


def models(family: Family) -> Iterator[tuple[str, type, bool]]:
    """Every model of a family: its name, its record, and whether this program runs it."""
    for name, record in family.models.items():
        yield name, record, True
    for name in known_names(family.name):
        known = known_model(family.name, name)
        if name not in family.models and known is not None:
            yield name, known, False
