"""UPS306."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, Fix, register_code
from ups.element import Attribute, Element
from ups.rules.old_forms.old_form import OldForm

JOHNSON_COOK = ("D1", "D2", "D3", "D4", "D5")


class BareDamage(OldForm):
    """The constants of Johnson and Cook's damage stand in a material without a damage model around them.

    **Why.** Once the constants ``<D1>`` to ``<D5>`` were given in the material itself; today they belong in
    ``<damage_model type="johnson_cook">``. Uintah's validator stops at ``<D1>``.

    **Example.** ``<material> ... <D1>0.05</D1> <D2>3.44</D2> ... </material>``

    **Repair.** Put ``<damage_model type="johnson_cook">`` around them; ``--fix`` does it in the file that
    holds them.
    """

    code = register_code("UPS306", "damage constants without a damage model")
    title = "damage constants without a damage model"

    def modernise(self, root: Element) -> Iterator[Diagnostic]:
        """Wrap the constants of every material of particles."""
        for material in root.find_all("MaterialProperties/MPM/material"):
            given = [child for child in material.children if child.tag in JOHNSON_COOK]
            if not given or material.get("damage_model") is not None:
                continue
            wrapper = _wrapped(material, given)
            message = f"{', '.join(f'<{child.tag}>' for child in given)} belong in a damage model"
            yield self.note(message, given[0], 'write <damage_model type="johnson_cook">', _fix(given))
            _replace(material, given, wrapper)


def _wrapped(material: Element, given: list[Element]) -> Element:
    first = given[0]
    wrapper = Element("damage_model", first.source, first.start, material)
    wrapper.open_end = wrapper.close_start = wrapper.end = first.open_end
    wrapper.attributes["type"] = Attribute(
        "type", "johnson_cook", first.source, first.start, first.start, first.open_end
    )
    wrapper.set_content(list(given))
    return wrapper


def _replace(material: Element, given: list[Element], wrapper: Element) -> None:
    gone = {id(child) for child in given}
    place = next(i for i, node in enumerate(material.content) if id(node) in gone)
    rest = [node for node in material.content if id(node) not in gone]
    rest.insert(place, wrapper)
    material.set_content(rest)


def _fix(given: list[Element]) -> Fix | None:
    """The text edits, where the constants stand together in one file."""
    first, last = given[0], given[-1]
    if any(child.source is not first.source for child in given):
        return None
    between = first.source.text[first.start : last.end]
    if between.count("<") - 2 * between.count("<!--") > 2 * len(given):
        return None
    line = first.source.text.rfind("\n", 0, first.start) + 1
    indent = first.source.text[line : first.start]
    indent = indent if not indent.strip() else ""
    opening = first.source.edit(first.start, first.start, f'<damage_model type="johnson_cook">\n{indent}')
    closing = last.source.edit(last.end, last.end, f"\n{indent}</damage_model>")
    return Fix((opening, closing))
