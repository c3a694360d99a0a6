"""How a tag or a model looks in a deck: from the decks and materials that ship, or written as it is declared."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from solver.declare import Family, FieldInfo, without_optional
from ups.diagnostics import Diagnostics
from ups.element import Element
from ups.reader import declared
from ups.source import load_source
from ups.xml_parser import parse_xml

_PROGRAM = Path(__file__).resolve().parent.parent
_MOST_LINES = 16


def example_of_model(family: Family, name: str, record: type) -> str:
    """A model as a deck chooses it."""
    for element in _elements():
        if _chooses(element, family, name) and (text := _short(element)):
            return text
    return "\n".join(_written(family, name, record))


def example_of_tag(info: FieldInfo, tag: str, parents: set[str]) -> str:
    """A tag or an attribute as a deck gives it; empty for a section that no deck shows in a few lines."""
    if info.parameter.attribute:
        return f'{tag}="{_value(info)}"'
    for element in _elements():
        if element.tag == tag and element.parent is not None and element.parent.tag in parents:
            text = _short(element)
            if text:
                return text
    return "" if info.record is not None or info.sub_model is not None else f"<{tag}> {_value(info)} </{tag}>"


@cache
def _elements() -> tuple[Element, ...]:
    """Every element of the files that ship, decks first."""
    found: list[Element] = []
    for path in (*sorted(_PROGRAM.glob("inputs/**/*.ups")), *sorted(_PROGRAM.glob("materialdata/**/*.xml"))):
        source = load_source(path, Diagnostics())
        root = parse_xml(source, Diagnostics()).root if source is not None else None
        found += root.iter() if root is not None else ()
    return tuple(found)


def _chooses(element: Element, family: Family, name: str) -> bool:
    if family.key == "tag":
        return element.tag == name
    if element.tag != family.tag:
        return False
    if family.key.startswith("@"):
        attribute = element.attributes.get(family.key[1:])
        return attribute is not None and attribute.value.strip() == name
    if family.key == "text":
        return element.text == name
    child = element.get(family.key)
    return child is not None and child.text == name


def _short(element: Element) -> str:
    """The element as it stands in its file, without the indentation; empty where it is long."""
    text = element.source.text
    line = text.rfind("\n", 0, element.start) + 1
    before = text[line : element.start]
    shown = (
        before + text[element.start : element.end]
        if not before.strip()
        else text[element.start : element.end]
    )
    return "" if shown.count("\n") >= _MOST_LINES else textwrap.dedent(shown.expandtabs()).strip("\n")


def _written(family: Family, name: str, record: type) -> Iterator[str]:
    """A model with what it requires, as a deck would give it."""
    if family.key == "text":
        yield f"<{family.tag}> {name} </{family.tag}>"
        return
    tag = name if family.key == "tag" else family.tag
    choice = f' {family.key[1:]}="{name}"' if family.key.startswith("@") else ""
    needed = [i for i, _ in declared(record) if i.required and not i.parameter.attribute]
    lines = [
        f"  <{i.tag}> {_value(i)} </{i.tag}>" for i in needed if i.record is None and i.sub_model is None
    ]
    if family.key == "type":
        lines.insert(0, f"  <type> {name} </type>")
    if not lines and len(needed) == 0:
        yield f"<{tag}{choice}/>"
        return
    yield from (f"<{tag}{choice}>", *lines, f"</{tag}>")


def _value(info: FieldInfo) -> str:
    """A value that a field may have: its default, a word of its choice, or a number within its bounds."""
    parameter, default = info.parameter, info.default
    choices = [c for c in parameter.choices if c]
    if choices:
        return choices[0]
    hint = without_optional(info.type)
    if hint is bool:
        return "true"
    if isinstance(default, tuple) and default:
        return "[" + ", ".join(f"{v:g}" if isinstance(v, float) else str(v) for v in default) + "]"
    if isinstance(default, float | int) and not info.required:
        return f"{default:g}"
    if hint is str:
        return "..."
    low = next((b for b in (parameter.gt, parameter.ge) if b is not None), None)
    high = next((b for b in (parameter.lt, parameter.le) if b is not None), None)
    number = (
        1.0
        if low is None and high is None
        else (low or 0.0) + (1.0 if high is None else 0.5 * (high - (low or 0.0)))
    )
    one = f"{number:.0f}" if hint is int else f"{number:.1f}"
    return f"[{one}, {one}, {one}]" if hint not in (int, float) else one
