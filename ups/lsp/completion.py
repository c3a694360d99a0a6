"""What may be typed at the cursor: tags, attributes, models, words, saved labels, files to include."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from enum import Enum
from functools import partial
from pathlib import Path
from typing import NamedTuple

import materialdata
from solver.declare import FAMILIES, Family, FieldInfo, without_optional
from ups.explain import describe, explain_model
from ups.lsp.context import Inside, inside, models
from ups.lsp.spot import Kind, OpenTag, Spot, children
from ups.reader import declared

INCLUDED_SUFFIXES = (".xml", ".ups")
_TRUE_FALSE = ("true", "false")


class Sort(Enum):
    """What is proposed."""

    TAG = "tag"
    ATTRIBUTE = "attribute"
    MODEL = "model"
    WORD = "word"
    LABEL = "label"
    FILE = "file"


class Proposal(NamedTuple):
    """One thing that may be typed in the place of the characters ``start:end``.

    ``snippet`` is what is put in, with ``$1``, ``$2`` where the author goes on; ``missing`` that it must be there
    and is not.
    """

    label: str
    sort: Sort
    snippet: str
    start: int
    end: int
    detail: str = ""
    about: Callable[[], str] | None = None
    missing: bool = False
    runs: bool = True


def proposals(
    spot: Spot, path: tuple[OpenTag, ...], text: str, component: str, file: Path | None = None
) -> Iterator[Proposal]:
    """What may be typed at a spot; ``path`` are the tags that are open there, see ``ups.lsp.hover``."""
    if spot.kind is Kind.CLOSING and spot.parents:
        name = spot.parents[-1].tag
        ended = text[spot.end : spot.end + 1] == ">"
        yield Proposal(name, Sort.TAG, name if ended else f"{name}>", spot.start, spot.end)
    elif spot.kind is Kind.TAG:
        yield from _tags(spot, path, text, component)
    elif spot.kind is Kind.ATTRIBUTE and spot.owner is not None:
        yield from _attributes(spot, inside((*path, spot.owner), text, component), spot.owner)
    elif spot.kind is Kind.VALUE and spot.owner is not None:
        yield from _values(spot, inside((*path, spot.owner), text, component), spot.owner, file)
    elif spot.kind is Kind.TEXT and path:
        yield from _texts(spot, path, text, component)


# ---- tags --------------------------------------------------------------------------------------------------


def _tags(spot: Spot, path: tuple[OpenTag, ...], text: str, component: str) -> Iterator[Proposal]:
    """The tags that may stand in the innermost open one; required ones that are missing are marked."""
    found = inside(path, text, component)
    if found is None:
        return
    here = spot.owner.start if spot.owner is not None else -1
    given = (
        {child.tag for child, _ in children(text, spot.parents[-1]) if child.start != here}
        if spot.parents
        else ()
    )
    indent = _indent(text, spot.start)
    bare = text[spot.end : spot.end + 1] not in (">", "/", " ")
    allowed = [c for c in _children_of(found) if c[1].sub_model is not None or c[0] not in given or c[1].many]
    needed = [
        (tag, info) for tag, info, _, _ in allowed if info.required and tag not in given and _is_one_tag(info)
    ]
    if len(needed) > 1 and bare:
        writer, names = _Snippet(), ", ".join(tag for tag, _ in needed)
        whole = f"\n{indent}<".join(writer.element(info, tag, indent) for tag, info in needed)
        yield Proposal("all required tags", Sort.TAG, whole, spot.start, spot.end, names, missing=True)
    for tag, info, own, runs in allowed:
        snippet = _Snippet().element(info, tag, indent) if bare else tag
        missing = info.required and tag not in given
        yield Proposal(
            tag, Sort.TAG, snippet, spot.start, spot.end, describe(info), missing=missing, runs=own and runs
        )


def _children_of(found: Inside) -> Iterator[tuple[str, FieldInfo, bool, bool]]:
    """Tag, field, whether the record itself declares it, and whether this program runs it."""
    if found.family is not None and found.family.key == "type" and found.info is not None:
        yield "type", found.info, True, True
    for info, own in declared(found.record) if found.record is not None else ():
        if info.parameter.attribute:
            continue
        if info.sub_model is not None and FAMILIES[info.sub_model.family].key == "tag":
            for name, _, runs in models(FAMILIES[info.sub_model.family]):
                yield name, info, own, runs
        else:
            yield info.tag, info, own, True


class _Snippet:
    """Writes an element with what it needs, and a stop wherever the author has to say something."""

    def __init__(self) -> None:
        self.stops = 0

    def element(self, info: FieldInfo, tag: str, indent: str) -> str:
        """The inside of an opening bracket: ``tag>...</tag>``."""
        family = FAMILIES[info.sub_model.family] if info.sub_model is not None else None
        if family is not None and family.key.startswith("@"):
            return f'{tag} {family.key[1:]}="{self._stop()}">\n{indent}  {self._stop()}\n{indent}</{tag}>'
        record = info.record
        if family is not None and family.key == "tag":
            record = next((cls for name, cls, _ in models(family) if name == tag), None)
        if family is not None and family.key == "type" and tag != "type":
            return f"{tag}>\n{indent}  <type>{self._stop()}</type>\n{indent}</{tag}>"
        if record is None:
            return f"{tag}>{self._stop()}</{tag}>"
        return self._section(record, tag, indent)

    def _section(self, record: type, tag: str, indent: str) -> str:
        needed = [i for i, _ in declared(record) if i.required]
        attributes = "".join(f' {i.tag}="{self._stop()}"' for i in needed if i.parameter.attribute)
        inner = [i for i in needed if not i.parameter.attribute and _is_one_tag(i)]
        if not inner:
            all_attributes = all(i.parameter.attribute for i, _ in declared(record))
            if all_attributes:
                return f"{tag}{attributes}/>"
            return f"{tag}{attributes}>\n{indent}  {self._stop()}\n{indent}</{tag}>"
        lines = "".join(f"\n{indent}  <{self.element(i, i.tag, indent + '  ')}" for i in inner)
        return f"{tag}{attributes}>{lines}\n{indent}</{tag}>"

    def _stop(self) -> str:
        self.stops += 1
        return f"${self.stops}"


def _is_one_tag(info: FieldInfo) -> bool:
    """Whether a field is a tag of one name, other than shapes and loads."""
    return info.sub_model is None or FAMILIES[info.sub_model.family].key != "tag"


def _indent(text: str, offset: int) -> str:
    """The blanks at the start of a line."""
    line = text[text.rfind("\n", 0, offset) + 1 : offset]
    return line[: len(line) - len(line.lstrip())]


# ---- attributes and values -----------------------------------------------------------------------------------


def _attributes(spot: Spot, owner: Inside | None, tag: OpenTag) -> Iterator[Proposal]:
    if owner is None:
        return
    if owner.family is not None and owner.family.key.startswith("@"):
        name = owner.family.key[1:]
        if name not in tag.attributes or name == spot.word:
            yield Proposal(
                name, Sort.ATTRIBUTE, f'{name}="$1"', spot.start, spot.end, owner.family.meaning, missing=True
            )
    for info, own in declared(owner.record) if owner.record is not None else ():
        if info.parameter.attribute and (info.tag not in tag.attributes or info.tag == spot.word):
            yield Proposal(
                info.tag,
                Sort.ATTRIBUTE,
                f'{info.tag}="$1"',
                spot.start,
                spot.end,
                describe(info),
                missing=info.required,
                runs=own,
            )


def _values(spot: Spot, owner: Inside | None, tag: OpenTag, file: Path | None) -> Iterator[Proposal]:
    if tag.tag == "include" and spot.attribute == "href":
        yield from _files(spot, file)
    elif tag.tag == "save" and spot.attribute == "label":
        yield from _labels(spot)
    elif tag.tag == "BCType" and spot.attribute in ("label", "var"):
        yield from _conditions(spot)
    elif tag.tag == "SimulationComponent" and spot.attribute == "type":
        yield from _components(spot)
    elif owner is not None and owner.family is not None and owner.family.key == f"@{spot.attribute}":
        yield from _model_names(spot, owner.family)
    elif owner is not None and owner.record is not None:
        info = next(
            (i for i, _ in declared(owner.record) if i.parameter.attribute and i.tag == spot.attribute), None
        )
        yield from _words(spot, info)


def _texts(spot: Spot, path: tuple[OpenTag, ...], text: str, component: str) -> Iterator[Proposal]:
    """The words that the value of a tag may be."""
    own, outer = inside(path, text, component), inside(path[:-1], text, component)
    if own is not None and own.family is not None and own.family.key == "text":
        yield from _model_names(spot, own.family)
    elif outer is not None and outer.family is not None and outer.family.key == path[-1].tag:
        yield from _model_names(spot, outer.family)
    elif own is not None:
        yield from _words(spot, own.info)


def _model_names(spot: Spot, family: Family) -> Iterator[Proposal]:
    for name, record, runs in models(family):
        about = partial(explain_model, name, family, record, runs)
        yield Proposal(name, Sort.MODEL, name, spot.start, spot.end, family.meaning, about, runs=runs)


def _words(spot: Spot, info: FieldInfo | None) -> Iterator[Proposal]:
    if info is None or info.record is not None:
        return
    words = _TRUE_FALSE if without_optional(info.type) is bool else info.parameter.choices
    for word in words:
        if word:
            yield Proposal(word, Sort.WORD, word, spot.start, spot.end, info.parameter.meaning)


def _labels(spot: Spot) -> Iterator[Proposal]:
    from ups.grammar.saved_labels import LABELS

    for name, label in LABELS.items():
        unit = f" ({label.unit})" if label.unit else ""
        yield Proposal(name, Sort.LABEL, name, spot.start, spot.end, f"{label.meaning}{unit}")


def _conditions(spot: Spot) -> Iterator[Proposal]:
    from ups.rules.boundary_value import KINDS, LABELS

    for word in LABELS if spot.attribute == "label" else KINDS:
        what = "what the face prescribes" if spot.attribute == "label" else "kind of condition"
        yield Proposal(word, Sort.WORD, word, spot.start, spot.end, what)


def _components(spot: Spot) -> Iterator[Proposal]:
    from ups.grammar.components import COMPONENTS

    for name, component in COMPONENTS.items():
        yield Proposal(name, Sort.WORD, name, spot.start, spot.end, component.meaning, runs=component.runs)


def _files(spot: Spot, file: Path | None) -> Iterator[Proposal]:
    """The files beside the deck that may be included, and the material files of the program."""
    folder = file.parent if file is not None else Path()
    try:
        beside = sorted(p.name for p in folder.iterdir() if p.suffix in INCLUDED_SUFFIXES and p != file)
    except OSError:
        beside = []
    for name in beside:
        yield Proposal(name, Sort.FILE, name, spot.start, spot.end, "a file beside this one")
    for path in sorted(materialdata.ROOT.rglob("*.xml")):
        detail = f"constants of {path.parent.name.replace('_', ' ')}"
        yield Proposal(path.name, Sort.FILE, path.name, spot.start, spot.end, detail)
