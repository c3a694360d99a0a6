"""From elements of a document to the records that are declared: one pass that reads and checks.

Whatever a record declares (see ``solver.declare``) is read here: types, bounds, words, defaults, models of a
family. Whatever a record does not declare is a diagnostic. All problems are reported, not the first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from solver.declare import FAMILIES, Family, FieldInfo, TagGroup, fields, groups, without_optional
from ups.diagnostics import Diagnostics, Fix, Located, did_you_mean, is_certain, suggestion_for
from ups.element import Attribute, Element, Text
from ups.grammar import extension, known_model, known_names, parents_of
from ups.values import FAILED, ValueReader

__all__ = ["FAILED", "Opaque", "Reader"]

Record = TypeVar("Record")


class Opaque:
    """Type of a declared section whose inside is not read here: it belongs to other methods of Uintah."""


@cache
def declared(record: type) -> tuple[tuple[FieldInfo, bool], ...]:
    """The fields of a record and of its extension, each with whether it is the record's own."""
    extra = extension(record)
    own = [(info, True) for info in fields(record)]
    names = {(info.tag, info.parameter.attribute) for info, _ in own}
    added = () if extra is None else fields(extra)
    return (*own, *((i, False) for i in added if (i.tag, i.parameter.attribute) not in names))


def is_of_family(family: Family, tag: str) -> bool:
    """Whether a tag names a model of a family that is chosen by tags, such as a shape."""
    return family.find(tag) is not None or known_model(family.name, tag) is not None


class Reader(ValueReader):
    """Reads records from elements and remembers where each came from.

    Parameters
    ----------
    diagnostics : where problems go.
    open_file : the path of a data file that a deck names; raises FileNotFoundError.
    complete : whether the document is: in one that is not, nothing is said to be missing.

    Attributes
    ----------
    unsupported : what the deck asks for that this program knows and does not run, with its place.
    runs : whether the deck's method is one that this program runs, so that it can tell what has no effect.
    """

    def __init__(
        self, diagnostics: Diagnostics, open_file: Callable[[str], Path], complete: bool = True
    ) -> None:
        super().__init__(diagnostics)
        self.open_file = open_file
        self.complete = complete
        self.unsupported: list[tuple[str, Located]] = []
        self.runs = True
        self._named_pieces: Any = None
        self._places: dict[int, tuple[Any, Element]] = {}
        self._records: dict[int, Any] = {}

    def place(self, record: Any) -> Element | None:
        """The element that a record was read from."""
        found = self._places.get(id(record))
        return found[1] if found else None

    def record(self, element: Element) -> Any | None:
        """The record that was read from an element, or None where that failed."""
        return self._records.get(id(element))

    def read(
        self, record: type[Record], element: Element, chosen_by: str = "", family: Family | None = None
    ) -> Record | None:
        """Read a record from the children and attributes of an element, or return None after diagnostics.

        ``chosen_by`` says what chose the record: a child's tag, ``"@"`` and an attribute, or ``"text"``;
        ``family`` is the family that it was chosen from.
        """
        errors = self.errors
        declaration: Any = record
        children = _Children(element)
        self._check_children(declaration, element, children, chosen_by, family)
        values: dict[str, Any] = {}
        for info, own in declared(declaration):
            value = self._field(info, element, children)
            if own and value is not FAILED:
                values[info.name] = value
        for group in groups(declaration):
            self._check_group(group, record, element)
        self._check_attributes(record, element, chosen_by)
        if element.texts and chosen_by != "text":
            message = f"<{element.tag}> takes tags, not text: {element.text[:40]!r}"
            self.error("UPS201", message, element.texts[0], "remove the text")
        if self.errors > errors:
            return None
        made: Record | None = self._make(record, values, element)
        return made

    def _make(self, record: Any, values: dict[str, Any], element: Element) -> Any:
        """Construct a record, let it read its files, and report what it finds wrong with itself."""
        if any(i.required and i.name not in values for i in fields(record)):
            return None
        try:
            made: Any = record(**values)
            if callable(getattr(made, "load", None)):
                made = made.load(self.open_file) or made
            faults = made.faults() if hasattr(made, "faults") else []
        except FileNotFoundError as problem:
            self.error("UPS408", str(problem), _file_element(record, element))
            return None
        except (ValueError, OSError) as problem:
            self.error("UPS502", str(problem), _subject(str(problem), element))
            return None
        for name, message in faults:
            tag = next((i.tag for i in fields(record) if i.name == name), name)
            self.error("UPS502", message, element.get(tag) or element)
        if faults:
            return None
        self._places[id(made)] = (made, element)
        self._records[id(element)] = made
        return made

    # ---- fields --------------------------------------------------------------------------------------------

    def _field(self, info: FieldInfo, element: Element, children: _Children) -> Any:
        if info.parameter.attribute:
            return self._attribute(info, element)
        if info.sub_model is not None:
            return self._models(info, element, children)
        found = children.named(info.tag, *info.parameter.old_tags)
        for child in found:
            if child.tag in info.parameter.old_tags:
                self._old_tag(child, info.tag)
        if not found:
            return self._missing(info, element) if info.required else info.default
        if info.many:
            return self._many(info, found)
        for extra in found[1:]:
            message = f"<{extra.tag}> is given more than once in <{element.tag}>"
            line = found[0].location.line
            self.error("UPS104", message, extra, f"remove one of them; the first is on line {line}")
        value = self._one(info, found[0])
        self._say_effect(info, value, found[0])
        return value

    def _many(self, info: FieldInfo, found: list[Element]) -> Any:
        """The values of a tag that may be given several times."""
        record = info.record
        if record is not None:
            values = [self.read(record, child) for child in found]
        else:
            hint = without_optional(info.type).__args__[0]
            values = [self._leaf(info, hint, child) for child in found]
        self._say_effect(info, values, found[0])
        return FAILED if any(v is None or v is FAILED for v in values) else tuple(values)

    def _one(self, info: FieldInfo, child: Element) -> Any:
        """The value of one child: a record, a switch that is on by being there, or a value."""
        hint = without_optional(info.type)
        if hint is Opaque:
            return child
        if hint is bool and not child.texts and not child.children and info.default is False:
            return True
        record = info.record
        if record is not None:
            value = self.read(record, child)
            return FAILED if value is None else value
        return self._leaf(info, hint, child)

    def _say_effect(self, info: FieldInfo, value: Any, child: Element) -> None:
        """Note what has no effect, or is not supported, unless it says what holds anyway."""
        parameter = info.parameter
        if parameter.ignored and self.runs:
            self.diagnostics.note("UPS304", f"<{child.tag}> has no effect: {parameter.ignored}", child)
        elif parameter.unsupported and value is not FAILED and value != info.default:
            self.say_unsupported(f"<{child.tag}> ({parameter.meaning}) needs {parameter.unsupported}", child)
        elif value in parameter.not_run:
            self.say_unsupported(f"<{child.tag}> {value}", child)

    def say_unsupported(self, what: str, at: Located) -> None:
        """Note that a deck asks for something that this program knows and does not run."""
        self.diagnostics.note("UPS412", f"{what}: known, not supported by this program", at)
        self.unsupported.append((what, at))

    def _missing(self, info: FieldInfo, element: Element) -> Any:
        if not self.complete:
            return FAILED
        parameter = info.parameter
        what = f"attribute {info.tag!r}" if parameter.attribute else f"<{info.tag}>"
        unit = f", in {parameter.unit}" if parameter.unit else ""
        code = "UPS111" if parameter.attribute else "UPS101"
        self.error(code, f"<{element.tag}> needs {what}: {parameter.meaning}{unit}", element, f"add {what}")
        return FAILED

    def _old_tag(self, child: Element, today: str) -> None:
        fix = Fix(tuple(child.renamed(today)))
        message = f"<{child.tag}> is an old name of <{today}>"
        self.diagnostics.note("UPS301", message, child, f"write <{today}>", fix)

    def _attribute(self, info: FieldInfo, element: Element) -> Any:
        names = (info.tag, *info.parameter.old_tags)
        given = next((element.attributes[n] for n in names if n in element.attributes), None)
        if given is None:
            return self._missing(info, element) if info.required else info.default
        hint = without_optional(info.type)
        return self.value(info, hint, given.value, given, f"attribute {given.name!r}")

    def _leaf(self, info: FieldInfo, hint: Any, child: Element) -> Any:
        """The value of a tag that holds text alone."""
        for grandchild in child.children:
            message = f"<{grandchild.tag}> does not belong in <{child.tag}>, which holds a value"
            self.error("UPS103", message, grandchild, _where_it_belongs(grandchild))
        if child.children:
            return FAILED
        for name, attribute in child.attributes.items():
            if name not in info.parameter.tag_attributes:
                self._unknown_attribute(child, attribute, info.parameter.tag_attributes)
        if not child.texts:
            if hint is str and not info.required:
                return info.default
            message = f"<{child.tag}> is empty: {info.parameter.meaning} is to be given"
            self.error("UPS202", message, child)
            return FAILED
        if len(child.texts) > 1:
            self.error("UPS210", f"the value of <{child.tag}> is split by a comment", child.texts[1])
            return FAILED
        return self.value(info, hint, child.text, child.texts[0], f"<{child.tag}>")

    def _check_group(self, group: TagGroup, record: type, element: Element) -> None:
        """Check tags (or attributes) of which one must, or at most one may, be given."""
        attributes = {i.tag for i, _ in declared(record) if i.parameter.attribute}
        given = [
            n for n in group.names if n in element.attributes or (n not in attributes and element.get(n))
        ]
        names = ", ".join(n if n in attributes else f"<{n}>" for n in group.names)
        if len(given) > 1:
            at = element.get(given[1]) or element.attributes.get(given[1]) or element
            self.error("UPS106", f"<{element.tag}> takes only one of {names}", at, "remove one of them")
        elif not given and group.needed and self.complete:
            what = f"one of {names}" if len(group.names) > 1 else names
            self.error("UPS106", f"<{element.tag}> needs {what}", element, f"add {names}")

    # ---- models --------------------------------------------------------------------------------------------

    def _models(self, info: FieldInfo, element: Element, children: _Children) -> Any:
        assert info.sub_model is not None
        family = FAMILIES[info.sub_model.family]
        if family.key == "tag":
            found = children.of_families.get(family.name, [])
        else:
            found = children.named(info.tag, *family.old_tags)
        models = [self.model(family, child) for child in found]
        if any(m is None for m in models):
            return FAILED
        if not models:
            return self._missing_model(info, family, element) if info.required else info.default
        if info.sub_model.many:
            return tuple(models)
        for extra in found[1:]:
            self.error("UPS104", f"<{element.tag}> can hold one {family.meaning} only", extra)
        return models[0]

    def _missing_model(self, info: FieldInfo, family: Family, element: Element) -> Any:
        if self.complete:
            choices = ", ".join(sorted(family.models)[:12])
            what = f"<{info.tag}> ({family.meaning})" if family.key != "tag" else f"a {family.meaning}"
            add = (
                f"<{info.tag}>" if family.key != "tag" else f"<{next(iter(sorted(family.models)), '')}>, say"
            )
            self.error("UPS101", f"<{element.tag}> needs {what}: {choices}", element, f"add {add}")
        return FAILED

    def model(self, family: Family, element: Element) -> Any | None:
        """Read the model of a family that an element names; None after diagnostics."""
        if family.name == "geometry" and family.find(element.tag) is not None:
            return self._piece(family, element)
        if family.tag and element.tag in family.old_tags:
            self._old_tag(element, family.tag)
        key, at = self._model_name(family, element)
        if at is None:
            return None
        record = family.find(key)
        if record is None:
            return self._known_model(family, key, at, element)
        if family.today(key) != key:
            self._old_name(key, family.today(key), at)
        return self.read(record, element, family.key, family)

    def _old_name(self, old: str, today: str, at: Any) -> None:
        fix = Fix((at.replaced(today),)) if isinstance(at, Attribute | Text) else None
        message = f"{old!r} is an old name of {today!r}"
        self.diagnostics.note("UPS303", message, at, f"write {today}", fix)

    def _known_model(self, family: Family, name: str, at: Any, element: Element) -> Any | None:
        """A model that Uintah has and this program does not run: its tags are checked all the same."""
        record = known_model(family.name, name)
        if record is None:
            self._unknown_model(family, name, at)
            return None
        self.say_unsupported(f"{family.meaning}: {name!r} is a model of Uintah", at)
        return self.read(record, element, family.key, family)

    def _model_name(self, family: Family, element: Element) -> tuple[str, Any]:
        """The name by which an element chooses a model, and where it stands (None if it is missing)."""
        if family.key == "tag":
            return element.tag, element
        if family.key == "text":
            return element.text, element.texts[0] if element.texts else element
        if family.key.startswith("@"):
            attribute = element.attributes.get(family.key[1:])
            if attribute is None:
                message = f"<{element.tag}> needs the attribute {family.key[1:]!r}: {family.meaning}"
                self.error("UPS111", message, element)
                return "", None
            return attribute.value.strip(), attribute
        child = element.get(family.key)
        if child is None:  # one that is misspelt is reported with the other children
            child = next((c for c in element.children if did_you_mean(c.tag, (family.key,))), None)
        if child is None or not child.texts:
            self.error("UPS101", f"<{element.tag}> needs <{family.key}>: {family.meaning}", child or element)
            return "", None
        for attribute in child.attributes.values():
            self._unknown_attribute(child, attribute, ())
        return child.text, child.texts[0]

    def _unknown_model(self, family: Family, name: str, at: Any) -> None:
        names = [*family.models, *(n for n in known_names(family.name) if n not in family.models)]
        nearest = did_you_mean(name, names)
        fix = None
        if nearest and isinstance(at, Attribute | Text):
            fix = Fix((at.replaced(nearest),), safe=is_certain(name, nearest, names))
        self.error(
            "UPS209",
            f"{family.meaning}: unknown {name!r}; known are {', '.join(sorted(names))}",
            at,
            suggestion_for(name, names),
            fix,
        )

    def _piece(self, family: Family, element: Element) -> Any | None:
        """A geometry piece; one with a label and nothing in it refers to an earlier piece."""
        if self._named_pieces is None:
            from solver.geometry.named_pieces import NamedPieces

            self._named_pieces = NamedPieces()
        record = family.find(element.tag)
        assert record is not None
        label = element.attributes.get("label") or element.attributes.get("name")
        try:
            if label is not None and not element.children:
                return self._named_pieces.refer(element.tag, label.value)
            piece = self.read(record, element)
            if piece is not None and not any(a.tag == "PhysicalBC" for a in element.ancestors()):
                # As in Uintah, pieces of loads are not known by name elsewhere.
                self._named_pieces.define(element.tag, piece)
            return piece
        except ValueError as problem:
            fix = None
            if label is not None and element.children:
                name = f"{label.value}, line {label.location.line}"
                fix = Fix((label.replaced(name),), safe=not _is_referred_to(element, label.value))
            self.error(
                "UPS410" if not element.children else "UPS407", str(problem), label or element, None, fix
            )
            return None

    # ---- what nobody declared ------------------------------------------------------------------------------

    def _check_children(
        self, record: type, element: Element, children: _Children, chosen_by: str, family: Family | None
    ) -> None:
        """Sort the children by the fields they belong to; report those that belong to none."""
        known = {chosen_by}
        by_tag: list[Family] = []
        for info, _ in declared(record):
            if info.sub_model is None:
                known |= set() if info.parameter.attribute else {info.tag, *info.parameter.old_tags}
                continue
            family = FAMILIES[info.sub_model.family]
            if family.key == "tag":
                by_tag.append(family)
            else:
                known |= {info.tag, *family.old_tags}
        for child in element.children:
            if child.tag in known:
                continue
            owner = next((f for f in by_tag if is_of_family(f, child.tag)), None)
            if owner is not None:
                children.of_families.setdefault(owner.name, []).append(child)
            elif family is None or not self._of_another_model(child, family):
                self._unknown_child(child, known, by_tag, children)

    def _of_another_model(self, child: Element, family: Family) -> bool:
        """Whether a child belongs to another model of the family than the chosen one; it is reported."""
        models = [
            *family.models.items(),
            *((n, known_model(family.name, n)) for n in known_names(family.name)),
        ]
        owners = [
            n for n, cls in models if cls is not None and any(i.tag == child.tag for i, _ in declared(cls))
        ]
        if owners:
            parent = child.parent.tag if child.parent else ""
            message = f"<{child.tag}> is not read by this <{parent}>: it belongs to {', '.join(owners[:4])}"
            fix = Fix((child.removed(),), safe=False)
            self.diagnostics.warning("UPS105", message, child, "remove it, or choose that type", fix)
        return bool(owners)

    def _unknown_child(
        self, child: Element, known: Iterable[str], by_tag: list[Family], children: _Children
    ) -> None:
        """Report a child that nobody declared, and read it as what it probably means."""
        parent = children.element
        of_family = {name: f for f in by_tag for name in (*f.models, *known_names(f.name))}
        absent = [tag for tag in sorted(known) if tag and parent.get(tag) is None]
        nearest = did_you_mean(child.tag, absent) or did_you_mean(child.tag, [*sorted(known), *of_family])
        if nearest is None:
            belongs = _where_it_belongs(child)
            code = "UPS103" if belongs else "UPS102"
            what = "does not belong in" if belongs else "is unknown in"
            message = f"<{child.tag}> {what} <{parent.tag}>" if belongs else _unknown(child)
            self.error(code, message, child, belongs)
            return
        fix = Fix(tuple(child.renamed(nearest)), safe=False)
        self.error("UPS102", _unknown(child), child, f"did you mean <{nearest}>?", fix)
        if nearest not in of_family and parent.get(nearest) is None:
            children.meant.setdefault(nearest, []).append(child)

    def _check_attributes(self, record: type, element: Element, chosen_by: str) -> None:
        known = {
            n for i, _ in declared(record) if i.parameter.attribute for n in (i.tag, *i.parameter.old_tags)
        }
        if chosen_by.startswith("@"):
            known.add(chosen_by[1:])
        for name, attribute in element.attributes.items():
            if name not in known:
                self._unknown_attribute(element, attribute, known)

    def _unknown_attribute(self, element: Element, attribute: Attribute, known: Iterable[str]) -> None:
        nearest = did_you_mean(attribute.name, sorted(known))
        fix = (
            Fix((attribute.renamed(nearest),), safe=False)
            if nearest
            else Fix((attribute.removed(),), safe=False)
        )
        message = f"<{element.tag}> takes no attribute {attribute.name!r}"
        suggestion = f"did you mean {nearest}?" if nearest else "remove it"
        self.error("UPS112", message, attribute.name_location, suggestion, fix)


class _Children:
    """The children of an element by the field that they belong to."""

    def __init__(self, element: Element) -> None:
        self.element = element
        self.by_tag: dict[str, list[Element]] = {}
        for child in element.children:
            self.by_tag.setdefault(child.tag, []).append(child)
        self.of_families: dict[str, list[Element]] = {}
        self.meant: dict[str, list[Element]] = {}
        """Children under a misspelt tag, by the tag that was probably meant."""

    def named(self, *tags: str) -> list[Element]:
        """The children with one of these tags, or those that are probably meant so."""
        found = [child for tag in tags for child in self.by_tag.get(tag, ())]
        return found or [child for tag in tags for child in self.meant.get(tag, ())]


def _unknown(child: Element) -> str:
    return f"unknown tag <{child.tag}> in <{child.parent.tag if child.parent else ''}>"


def _where_it_belongs(child: Element) -> str | None:
    """Where a tag that stands in the wrong place belongs, or None when no section has it."""
    parents = parents_of(child.tag)
    return f"it belongs in {' or '.join(f'<{p}>' for p in parents[:4])}" if parents else None


def _subject(message: str, element: Element) -> Element:
    """The child that a message begins with, or the element."""
    word = message.partition(" ")[0].strip("<>")
    return element.get(word) or element


def _is_referred_to(piece: Element, label: str) -> bool:
    """Whether a deck uses the name of a piece anywhere in place of its shape."""
    *_, root = piece.ancestors()
    return any(
        element.tag == piece.tag
        and not element.children
        and any(a.value == label for n, a in element.attributes.items() if n in ("label", "name"))
        for element in root.iter()
    )


def _file_element(record: type, element: Element) -> Element:
    """The tag of an element that names a file, or the element."""
    for info in fields(record):
        child = element.get(info.tag)
        if info.type is str and child is not None and "file" in info.tag:
            return child
    return element
