"""The catalogue of materials: what ``materialdata`` holds, read from its files."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import materialdata
from ups.diagnostics import DeckError, Diagnostics, suggestion_for
from ups.document import INCLUDE_ROOTS, Comment, Element, read_document

if TYPE_CHECKING:
    from rich.console import Console

COMMON_FOLDER = "any_material"
"""The folder of include files that choose a model without a constant of a material."""

_CONTENT_OF = {
    "MaterialConst": ("material", ""),
    "MatConst": ("material", ""),
    "IsotropicElastic": ("constitutive_model", ""),
    "IsoElastic": ("constitutive_model", ""),
    "JohnsonCookDamage": ("damage_model", "johnson_cook"),
    "JCDamage": ("damage_model", "johnson_cook"),
    "MaxwellWeichert": ("constitutive_model", "Maxwell_Weichert"),
    "TimeTemp": ("constitutive_model", ""),
    "ViscoSCRAM": ("constitutive_model", "visco_scram"),
}
"""What the name of a file of plain constants begins with -> the element around its include, and its model."""


@dataclass(frozen=True)
class Constant:
    """A constant of a material, with what the comment beside it says.

    Attributes
    ----------
    tag, value : as a deck has them. unit : SI; "-" for a pure number.
    source : the full reference. remark : what else there is to say, or "".
    """

    tag: str
    value: str
    unit: str
    source: str
    remark: str


@dataclass(frozen=True)
class MaterialFile:
    """An include file of a material.

    Attributes
    ----------
    path : where it is; a deck includes it by its name.
    title : what it holds.
    tag, model : the model that it is for, e.g. ``flow_model`` and ``johnson_cook``; the model is "" for
        constants of the material itself, and elastic moduli, which several models take.
    whole : whether the file holds the element of the model; False for its content alone.
    """

    path: Path
    title: str
    tag: str
    model: str
    whole: bool
    constants: tuple[Constant, ...]


@dataclass(frozen=True)
class MaterialEntry:
    """A material of the catalogue.

    Attributes
    ----------
    name : as ``find_material`` takes it. files : its include files.
    """

    name: str
    files: tuple[MaterialFile, ...]

    @property
    def models(self) -> dict[str, tuple[str, ...]]:
        """Tag of a family -> names of the models that there are constants for."""
        named = [file for file in self.files if file.model]
        tags = sorted({file.tag for file in named})
        return {tag: tuple(file.model for file in named if file.tag == tag) for tag in tags}

    @property
    def sources(self) -> tuple[str, ...]:
        """The references of all constants, sorted."""
        return tuple(sorted({constant.source for constant in self.constants}))

    @property
    def constants(self) -> tuple[Constant, ...]:
        """All constants, file by file."""
        return tuple(constant for file in self.files for constant in file.constants)

    def file_of(self, tag: str, model: str = "") -> MaterialFile | None:
        """The file with the constants of a model, or of the material itself; None without one."""
        return next((file for file in self.files if (file.tag, file.model) == (tag, model)), None)


@cache
def catalogue() -> tuple[MaterialEntry, ...]:
    """Every material that comes with the program, by name.

    Raises
    ------
    DeckError
        where a file of the catalogue is not well formed.
    """
    folders = {path.parent for path in materialdata.ROOT.glob("*/*.xml")}
    names = sorted((folder.name for folder in folders), key=str.lower)
    return tuple(_entry(name) for name in names if name != COMMON_FOLDER)


@cache
def common_models() -> MaterialEntry:
    """The models that need no constants of a material, as if they were a material."""
    return _entry(COMMON_FOLDER)


def find_material(name: str) -> MaterialEntry:
    """The material of a name, whatever its capitals, blanks, hyphens and underscores.

    Raises
    ------
    DeckError
        where there is none.
    """
    entries = {_plain(entry.name): entry for entry in catalogue()}
    if _plain(name) in entries:
        return entries[_plain(name)]
    names = [entry.name for entry in catalogue()]
    diagnostics = Diagnostics()
    message = f"no material {name!r} in the catalogue; known are {', '.join(names)}"
    diagnostics.error("UPS410", message, None, suggestion_for(name, names))
    raise DeckError(diagnostics)


def print_catalogue(name: str = "", file: TextIO | None = None) -> None:
    """Print the catalogue as a table, or the files and constants of one material.

    Raises
    ------
    DeckError
        where no material has the name.
    """
    from rich.console import Console

    console = Console(file=file)
    if name:
        _print_material(console, find_material(name))
    else:
        _print_overview(console)


def _print_overview(console: Console) -> None:
    """A row for each material: the models that there are constants for, and where these come from."""
    from rich.table import Table

    table = Table("material", "models with constants", "sources", show_lines=True)
    keys = {reference: key for key, reference in materialdata.sources().items()}
    for entry in catalogue():
        models = [f"{tag}: {', '.join(names)}" for tag, names in entry.models.items()]
        sources = [keys.get(reference, reference) for reference in entry.sources]
        table.add_row(entry.name, "\n".join(models), "\n".join(sorted(sources)))
    console.print(table)
    console.print("ups materials NAME lists the constants of a material with their sources.")


def _print_material(console: Console, entry: MaterialEntry) -> None:
    """The files of a material, each with its constants, then the references by number."""
    from rich.table import Table

    numbers = {source: number for number, source in enumerate(entry.sources, start=1)}
    for file in entry.files:
        table = Table(
            "constant", "value", "unit", "source", "remark", title=f"{file.path.name}: {file.title}"
        )
        for constant in file.constants:
            source = f"({numbers[constant.source]})"
            table.add_row(constant.tag, constant.value, constant.unit, source, constant.remark)
        console.print(table)
    for source, number in numbers.items():
        console.print(f"({number}) {source}", highlight=False)


def _plain(name: str) -> str:
    return "".join(letter for letter in name.lower() if letter.isalnum())


def _entry(folder: str) -> MaterialEntry:
    paths = sorted((materialdata.ROOT / folder).glob("*.xml"))
    return MaterialEntry(folder, tuple(_read(path) for path in paths))


def _read(path: Path) -> MaterialFile:
    """Read an include file with its comments."""
    document = read_document(path, roots=INCLUDE_ROOTS)
    if document.root is None or document.diagnostics.has_errors:
        raise DeckError(document.diagnostics, document.sources)
    title = " ".join(comment.value.strip() for comment in document.comments_before)
    element = next((child for child in document.root.children if "type" in child.attributes), None)
    if element is not None:
        model = element.attributes["type"].value
        return MaterialFile(path, title, element.tag, model, True, tuple(_constants(element)))
    tag, model = next(
        (content for start, content in _CONTENT_OF.items() if path.name.startswith(start)), ("material", "")
    )
    return MaterialFile(path, title, tag, model, False, tuple(_constants(document.root)))


def _constants(parent: Element) -> Iterator[Constant]:
    """The constants of an element, each with the comment behind it."""
    for node, following in zip_longest(parent.content, parent.content[1:]):
        if isinstance(node, Element):
            if node.children:
                yield from _constants(node)
                continue
            note = following.value if isinstance(following, Comment) else ""
            unit, source, remark = ([*map(str.strip, note.split(";", 2)), "", "", ""])[:3]
            yield Constant(node.tag, node.text, unit, materialdata.sources().get(source, source), remark)
