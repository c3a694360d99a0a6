"""The base of old forms."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from functools import cache
from typing import ClassVar

from ups.diagnostics import Diagnostic, Diagnostics, Fix, Located, Severity
from ups.element import Element


class OldForm:
    """A form that Uintah once took.

    Attributes
    ----------
    code : the code of its notes.
    title : what it finds, in a phrase.
    """

    code: ClassVar[str]
    title: ClassVar[str]

    def modernise(self, root: Element) -> Iterator[Diagnostic]:
        """Change the tree to the form of today, and yield a note for each change."""
        raise NotImplementedError

    def note(self, message: str, at: Located, suggestion: str, fix: Fix | None = None) -> Diagnostic:
        """What was changed."""
        return Diagnostic(self.code, Severity.NOTE, message, at.location, suggestion, fix)


@cache
def all_old_forms() -> tuple[OldForm, ...]:
    """One of each old form of the package."""
    package = importlib.import_module("ups.rules.old_forms")
    for module in pkgutil.iter_modules(package.__path__):
        importlib.import_module(f"{package.__name__}.{module.name}")
    return tuple(form() for form in OldForm.__subclasses__())


def modernise(root: Element, diagnostics: Diagnostics) -> None:
    """Bring a deck's tree up to date in place; the notes go to the diagnostics."""
    for form in all_old_forms():
        diagnostics.extend(form.modernise(root))


def without(parent: Element, *children: Element) -> None:
    """Take children out of the tree."""
    gone = {id(child) for child in children}
    parent.set_content([node for node in parent.content if id(node) not in gone])


def is_gas(material: Element) -> bool:
    """Whether a material of particles is an ideal gas."""
    model = material.get("constitutive_model")
    kind = model.attributes.get("type") if model is not None else None
    return kind is not None and kind.value.strip() == "ideal_gas"
