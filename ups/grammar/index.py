"""Where each tag of the language may stand: a walk over all declarations."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

from solver.declare import FAMILIES, FieldInfo, fields


class Place(NamedTuple):
    """One place where a tag (or attribute) may stand."""

    tag: str
    parent: str
    """Tag of the element that holds it."""
    model: str
    """Name of the model that the parent chose; empty where it is no model."""
    record: type
    info: FieldInfo
    runs: bool
    """Whether this program runs decks that give it."""


@cache
def places() -> tuple[Place, ...]:
    """Every place of every tag, sections in the order of their declaration."""
    from ups.grammar.components import COMPONENTS

    found: list[Place] = []
    seen: set[tuple[type, str, str]] = set()
    for component in COMPONENTS.values():
        if component.record is not None:
            found += _walk(component.load(), "Uintah_specification", "", component.runs, seen)
    return tuple(found)


def _walk(
    record: type, parent: str, model: str, runs: bool, seen: set[tuple[type, str, str]]
) -> Iterator[Place]:
    from ups.grammar import extension, known_model, known_names

    if (record, parent, model) in seen:
        return
    seen.add((record, parent, model))
    extra = extension(record)
    groups = [(info, runs) for info in fields(record)]
    groups += [] if extra is None else [(info, False) for info in fields(extra)]
    for info, supported in groups:
        if info.sub_model is None:
            yield Place(info.tag, parent, model, record, info, supported)
            if info.record is not None:
                yield from _walk(info.record, info.tag, "", supported, seen)
            continue
        family = FAMILIES[info.sub_model.family]
        if family.key != "tag":
            yield Place(info.tag, parent, model, record, info, supported)
        models = [(name, cls, supported) for name, cls in family.models.items()]
        models += [
            (name, cls, False)
            for name in known_names(family.name)
            if name not in family.models and (cls := known_model(family.name, name)) is not None
        ]
        for name, cls, runs_model in models:
            tag = name if family.key == "tag" else info.tag
            if family.key == "tag":
                yield Place(tag, parent, model, record, info, runs_model)
            yield from _walk(cls, tag, name, runs_model, seen)


@cache
def tag_index() -> dict[str, tuple[str, ...]]:
    """Tag -> the tags of the elements that may hold it; attributes are left out."""
    found: dict[str, dict[str, None]] = {}
    for place in places():
        if not place.info.parameter.attribute:
            for tag in (place.tag, *place.info.parameter.old_tags):
                found.setdefault(tag, {})[place.parent] = None
    return {tag: tuple(parents) for tag, parents in found.items()}
