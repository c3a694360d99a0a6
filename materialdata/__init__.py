"""Material constants as include files, one folder a material, one file a model.

Files have the names that Uintah's decks give them today; ``names.toml`` lists older and other ones,
``sources.toml`` the publications that the comments in the files name. A comment after a constant is
``unit; source`` or ``unit; source; remark``. ``ups.materials`` reads them as a catalogue.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path, PurePosixPath
from typing import Any

ROOT = Path(__file__).resolve().parent
"""The folder of the include files."""

_LEADING = frozenset({"", ".", "..", "/", "inputs", "materialdata", "MPM", "MaterialData"})


def find(href: str, root: Path = ROOT) -> Path | None:
    """Find the file under ``root`` that an include means by its name, today's or an older one; else None.

    Folders that only lead to the material files (``inputs/MPM/MaterialData/``) do not matter. Any other
    folder has to be one of ``root``: in its ``Cu_BU`` and the like Uintah keeps files of the same names in
    other units.
    """
    parts = PurePosixPath(href).parts
    while parts and parts[0] in _LEADING:
        parts = parts[1:]
    if not parts or not parts[-1].endswith(".xml"):
        return None
    path = _by_name(root).get(_today(parts[-1].removesuffix(".xml")))
    if path is None or parts[:-1] not in ((), path.relative_to(root).parts[:-1]):
        return None
    return path


@cache
def sources() -> dict[str, str]:
    """The publications by the names that comments give them."""
    return _table("sources.toml")


@cache
def _by_name(root: Path) -> dict[str, Path]:
    """Every include file under a folder by its name in words of today."""
    return {_today(path.stem): path for path in sorted(root.rglob("*.xml"))}


@cache
def _words() -> dict[str, dict[str, str]]:
    """Kind of word -> word, old or new -> word of today."""
    return {
        kind: {word: today for today, others in words.items() for word in (today, *others)}
        for kind, words in _table("names.toml").items()
    }


def _table(name: str) -> dict[str, Any]:
    import tomllib  # here, as most decks name their includes by today's words

    with (ROOT / name).open("rb") as file:
        return tomllib.load(file)


def _today(stem: str) -> str:
    """A file's name with the words for its model and its material replaced by those of today."""
    words = _words()
    if stem in words["files"]:
        return words["files"][stem]
    model = max((word for word in words["models"] if stem.startswith(word)), key=len, default="")
    if not model:
        return stem
    material = stem.removeprefix(model)
    return words["models"][model] + words["materials"].get(material, material)
