"""UPS302."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, Fix
from ups.element import Element
from ups.rules.old_forms.old_form import OldForm, is_gas, without


class MovedTag(OldForm):
    """A tag stands where earlier versions of Uintah had it.

    **Why.** ``<erosion>`` once was an option of the method and now belongs to each material; ``<gamma>`` of a
    gas made of particles once stood in the material and now stands in its constitutive model.

    **Example.** ``<MPM> <erosion algorithm="ZeroStress"/> </MPM>``

    **Repair.** Move it; ``--fix`` does it where the file of both is the same.
    """

    code = "UPS302"
    title = "old form of an element"

    def modernise(self, root: Element) -> Iterator[Diagnostic]:
        """Move what stands in an old place."""
        yield from self._erosion(root)
        for material in root.find_all("MaterialProperties/MPM/material"):
            model, gamma = material.get("constitutive_model"), material.get("gamma")
            if model is not None and gamma is not None and is_gas(material) and model.get("gamma") is None:
                yield self._moved(gamma, model, material)

    def _moved(self, child: Element, target: Element, parent: Element) -> Diagnostic:
        fix = None
        if child.source is target.source and child.source is parent.source:
            text = child.source.text[child.start : child.end]
            insert = target.source.edit(target.open_end, target.open_end, f"\n{_indent(child)}  {text}")
            fix = Fix((child.removed(), insert))
        without(parent, child)
        target.set_content([*target.content, child])
        message = f"<{child.tag}> belongs in <{target.tag}> today"
        return self.note(message, child, f"move it into <{target.tag}>", fix)

    def _erosion(self, root: Element) -> Iterator[Diagnostic]:
        """An erosion of the method becomes that of every material without one."""
        for options in root.find_all("MPM"):
            erosion = options.get("erosion")
            if erosion is None:
                continue
            materials = [
                m for m in root.find_all("MaterialProperties/MPM/material") if m.get("erosion") is None
            ]
            text = erosion.source.text[erosion.start : erosion.end]
            edits = [m.source.edit(m.open_end, m.open_end, f"\n{_indent(m)}  {text}") for m in materials]
            same_file = all(m.source is erosion.source for m in materials)
            without(options, erosion)
            for material in materials:
                material.content = [*material.content, erosion]
                material.children = [*material.children, erosion]
            fix = Fix((erosion.removed(), *edits)) if same_file else None
            message = "<erosion> belongs in each <material> today"
            yield self.note(message, erosion, "move it into the materials", fix)


def _indent(element: Element) -> str:
    """The blanks before an element on its line."""
    line = element.source.text.rfind("\n", 0, element.start) + 1
    before = element.source.text[line : element.start]
    return before if not before.strip() else ""
