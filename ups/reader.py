"""From elements of a document to the records that are declared: one pass that reads and checks.

Whatever a record declares (see ``solver.declare``) is read here: types, bounds, words, defaults, models of a
family. Whatever a record does not declare is a diagnostic. All problems are reported, not the first.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, get_args, get_origin

from solver.declare import FAMILIES, Family, FieldInfo, fields, is_record, without_optional
from ups.diagnostics import Diagnostics, Fix, Located, Severity, did_you_mean, suggestion_for
from ups.element import Attribute, Element, Text
from ups.known import KNOWN_MODELS, KNOWN_TAGS

Record = TypeVar("Record")

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\Z")
_SPECIAL = {"inf", "+inf", "-inf", "nan"}


class Opaque:
    """Type of a declared section whose inside is not read here: it belongs to other methods of Uintah."""


class Failure:
    """Stands for a value that could not be read; a diagnostic says why."""


FAILED = Failure()


class Reader:
    """Reads records from elements and remembers where each came from.

    Parameters
    ----------
    diagnostics : where problems go.
    open_file : the path of a data file that a deck names; raises FileNotFoundError.
    """

    def __init__(self, diagnostics: Diagnostics, open_file: Callable[[str], Path]) -> None:
        from solver.geometry.named_pieces import NamedPieces

        self.diagnostics = diagnostics
        self.open_file = open_file
        self.named_pieces = NamedPieces()
        self._places: dict[int, tuple[Any, Element]] = {}

    def place(self, record: Any) -> Element | None:
        """The element that a record was read from."""
        found = self._places.get(id(record))
        return found[1] if found else None

    def read(
        self, record: type[Record], element: Element, known_tags: tuple[str, ...] = (), named_by_text: bool = False
    ) -> Record | None:
        """Read a record from the children and attributes of an element, or return None after diagnostics.

        ``known_tags`` are children that somebody else reads; ``named_by_text`` says that the element's text
        chose the record.
        """
        failures = self.diagnostics.count(Severity.ERROR)
        values: dict[str, Any] = {}
        for info in fields(record):
            value = self._field(info, element)
            if value is not FAILED:
                values[info.name] = value
        self._check_children(record, element, known_tags)
        self._check_attributes(record, element)
        if element.texts and not named_by_text:
            self.diagnostics.error(
                "UPS201", f"<{element.tag}> takes tags, not text: {element.text[:40]!r}", element.texts[0]
            )
        if self.diagnostics.count(Severity.ERROR) > failures:
            return None
        return self._make(record, values, element)

    def _make(self, record: type[Record], values: dict[str, Any], element: Element) -> Record | None:
        """Construct a record, let it read its files, and report what it finds wrong with itself."""
        try:
            made: Any = record(**values)
            if callable(getattr(made, "load", None)):
                made = made.load(self.open_file) or made
            faults = made.faults() if hasattr(made, "faults") else []
        except FileNotFoundError as problem:
            self.diagnostics.error("UPS408", str(problem), self._file_element(record, element))
            return None
        except (ValueError, OSError) as problem:
            self.diagnostics.error("UPS502", str(problem), element)
            return None
        for name, message in faults:
            tag = next((i.tag for i in fields(record) if i.name == name), name)
            self.diagnostics.error("UPS502", message, element.get(tag) or element)
        if faults:
            return None
        self._places[id(made)] = (made, element)
        return made  # type: ignore[no-any-return]  # a Record by construction

    def _file_element(self, record: type, element: Element) -> Element:
        for info in fields(record):
            child = element.get(info.tag)
            if info.type is str and child is not None and "file" in info.tag:
                return child
        return element

    # ---- fields --------------------------------------------------------------------------------------------

    def _field(self, info: FieldInfo, element: Element) -> Any:
        if info.parameter.attribute:
            return self._attribute(info, element)
        if info.sub_model is not None:
            return self._models(info, element)
        found = [c for c in element.children if c.tag in (info.tag, *info.parameter.old_tags)]
        for child in found:
            if child.tag != info.tag:
                self._old_tag(child, info.tag)
        hint = without_optional(info.type)
        if get_origin(hint) is tuple and get_args(hint)[-1] is Ellipsis and is_record(get_args(hint)[0]):
            records = [self.read(get_args(hint)[0], child) for child in found]
            if not found and info.required:
                return self._missing(info, element)
            return FAILED if any(r is None for r in records) else tuple(records)
        for extra in found[1:]:
            self.diagnostics.error(
                "UPS104", f"<{info.tag}> is given more than once in <{element.tag}>", extra, "remove one of them"
            )
        if not found:
            return self._missing(info, element) if info.required else info.default
        child = found[0]
        if info.parameter.ignored:
            self._ignored(child, info)
        if hint is Opaque or hint is bool and not child.texts and not child.children and info.default is False:
            return True if hint is bool else child
        if is_record(hint):
            value = self.read(hint, child)
            return FAILED if value is None else value
        return self._value(info, hint, child)

    def _ignored(self, child: Element, info: FieldInfo) -> None:
        self.diagnostics.note("UPS304", f"<{info.tag}> has no effect: {info.parameter.ignored}", child)

    def _missing(self, info: FieldInfo, element: Element) -> Any:
        what = f"attribute {info.tag!r}" if info.parameter.attribute else f"<{info.tag}>"
        code = "UPS111" if info.parameter.attribute else "UPS101"
        unit = f", in {info.parameter.unit}" if info.parameter.unit else ""
        self.diagnostics.error(
            code, f"<{element.tag}> needs {what}: {info.parameter.meaning}{unit}", element, f"add {what}"
        )
        return FAILED

    def _old_tag(self, child: Element, today: str) -> None:
        self.diagnostics.note(
            "UPS301",
            f"<{child.tag}> is an old name of <{today}>",
            child,
            f"write <{today}>",
            Fix(tuple(child.renamed(today))),
        )

    def _attribute(self, info: FieldInfo, element: Element) -> Any:
        names = (info.tag, *info.parameter.old_tags)
        given = next((element.attributes[n] for n in names if n in element.attributes), None)
        if given is None:
            return self._missing(info, element) if info.required else info.default
        return self._value_of_text(info, without_optional(info.type), given.value, given, f"attribute {info.tag!r}")

    # ---- models --------------------------------------------------------------------------------------------

    def _models(self, info: FieldInfo, element: Element) -> Any:
        assert info.sub_model is not None
        family = FAMILIES[info.sub_model.family]
        if family.key == "tag":
            names = {*family.models, *family.old_names}
            found = [c for c in element.children if c.tag in names]
        else:
            found = [c for c in element.children if c.tag in (family.tag, *family.old_tags)]
        models = [self.model(family, child) for child in found]
        if any(m is None for m in models):
            return FAILED
        if info.sub_model.many:
            if not models and info.required:
                return self._missing_model(family, element)
            return tuple(models)
        for extra in found[1:]:
            self.diagnostics.error("UPS104", f"<{element.tag}> can hold one {family.meaning} only", extra)
        if not models:
            return self._missing_model(family, element) if info.required else info.default
        return models[0]

    def _missing_model(self, family: Family, element: Element) -> Any:
        choices = ", ".join(sorted(family.models)[:12])
        what = f"<{family.tag}>" if family.tag else "a shape"
        self.diagnostics.error("UPS101", f"<{element.tag}> needs {what} ({family.meaning}): {choices}", element)
        return FAILED

    def model(self, family: Family, element: Element) -> Any | None:
        """Read the model of a family that an element names; None after diagnostics."""
        if family.name == "geometry":
            return self._piece(family, element)
        if family.tag and element.tag != family.tag and family.key != "tag":
            self._old_tag(element, family.tag)
        key, at = self._model_name(family, element)
        if at is None:
            return None
        if key in family.old_names:
            today = family.old_names[key]
            fix = Fix((at.replaced(today),)) if isinstance(at, Attribute | Text) else None
            self.diagnostics.note("UPS303", f"{key!r} is an old name of {today!r}", at, f"write {today}", fix)
            key = today
        if key not in family.models:
            self._unknown_model(family, key, at)
            return None
        known = (family.key,) if not family.key.startswith("@") else ()
        return self.read(family.models[key], element, known, named_by_text=family.key == "text")

    def _model_name(self, family: Family, element: Element) -> tuple[str, Any]:
        """The name by which an element chooses a model, and where that name stands (None if it is missing)."""
        if family.key == "tag":
            return element.tag, element
        if family.key == "text":
            return element.text, element.texts[0] if element.texts else element
        if family.key.startswith("@"):
            attribute = element.attributes.get(family.key[1:])
            if attribute is None:
                self.diagnostics.error(
                    "UPS111", f"<{element.tag}> needs the attribute {family.key[1:]!r}: {family.meaning}", element
                )
                return "", None
            return attribute.value.strip(), attribute
        child = element.get(family.key)
        if child is None or not child.texts:
            self.diagnostics.error(
                "UPS101", f"<{element.tag}> needs <{family.key}>: {family.meaning}", child or element
            )
            return "", None
        return child.text, child.texts[0]

    def _unknown_model(self, family: Family, name: str, at: Located) -> None:
        if name in KNOWN_MODELS.get(family.name, ()):
            self.diagnostics.error(
                "UPS412", f"{family.meaning}: {name!r} is a model of Uintah that this program does not run", at
            )
            return
        names = [*family.models, *family.old_names, *KNOWN_MODELS.get(family.name, ())]
        self.diagnostics.error(
            "UPS209",
            f"{family.meaning}: unknown {name!r}; known are {', '.join(sorted(family.models))}",
            at,
            suggestion_for(name, names),
        )

    def _piece(self, family: Family, element: Element) -> Any | None:
        """A geometry piece; one with a label and nothing in it refers to an earlier piece."""
        label = element.attributes.get("label") or element.attributes.get("name")
        try:
            if label is not None and not element.children:
                return self.named_pieces.refer(element.tag, label.value)
            piece = self.read(family.models[element.tag], element)
            if piece is not None and not any(a.tag == "PhysicalBC" for a in element.ancestors()):
                # As in Uintah, pieces of loads are not known by name elsewhere.
                self.named_pieces.define(element.tag, piece)
            return piece
        except ValueError as problem:
            self.diagnostics.error("UPS410" if not element.children else "UPS407", str(problem), label or element)
            return None

    # ---- values --------------------------------------------------------------------------------------------

    def _value(self, info: FieldInfo, hint: Any, child: Element) -> Any:
        for grandchild in child.children:
            self.diagnostics.error("UPS103", f"<{grandchild.tag}> does not belong in <{child.tag}>", grandchild)
        if child.children:
            return FAILED
        for name, attribute in child.attributes.items():
            self.diagnostics.error("UPS112", f"<{child.tag}> takes no attribute {name!r}", attribute)
        if not child.texts:
            if hint is str and not info.required:
                return info.default
            self.diagnostics.error(
                "UPS202", f"<{child.tag}> is empty: {info.parameter.meaning} is to be given", child
            )
            return FAILED
        if len(child.texts) > 1:
            self.diagnostics.error("UPS210", f"the value of <{child.tag}> is split by a comment", child.texts[1])
            return FAILED
        return self._value_of_text(info, hint, child.text, child.texts[0], f"<{child.tag}>")

    def _value_of_text(self, info: FieldInfo, hint: Any, text: str, at: Any, what: str) -> Any:
        value = self._convert(hint, text.strip(), at, what)
        if value is FAILED or not self._within_bounds(info, value, at, what):
            return FAILED
        return value

    def _convert(self, hint: Any, text: str, at: Any, what: str) -> Any:
        if hint is bool:
            return self._boolean(text, at, what)
        if hint is int:
            return self._integer(text, at, what)
        if hint is float:
            return self._number(text, at, what)
        if get_origin(hint) is tuple:
            return self._sequence(hint, text, at, what)
        return text

    def _boolean(self, text: str, at: Any, what: str) -> Any:
        if text in ("true", "false"):
            return text == "true"
        meant = {"1": "true", "0": "false", "yes": "true", "no": "false"}.get(text.lower()) or did_you_mean(
            text, ("true", "false")
        )
        fix = Fix((at.replaced(meant),), safe=text.lower() == meant) if meant else None
        self.diagnostics.error(
            "UPS205", f"{what} is {text!r}; it must be true or false", at, f"did you mean {meant}?" if meant else None, fix
        )
        return FAILED

    def _number(self, text: str, at: Any, what: str) -> Any:
        if _NUMBER.match(text) or text.lower() in _SPECIAL:
            return float(text)
        self.diagnostics.error("UPS203", f"{what} is {text!r}; it must be a number", at, _repaired_number(text))
        return FAILED

    def _integer(self, text: str, at: Any, what: str) -> Any:
        if re.fullmatch(r"[-+]?\d+", text):
            return int(text)
        if _NUMBER.match(text) and float(text) == int(float(text)):
            self.diagnostics.warning(
                "UPS204", f"{what} is {text!r}; a whole number is expected", at, f"write {int(float(text))}"
            )
            return int(float(text))
        self.diagnostics.error("UPS204", f"{what} is {text!r}; it must be a whole number", at)
        return FAILED

    def _sequence(self, hint: Any, text: str, at: Any, what: str) -> Any:
        args = get_args(hint)
        open_ended = args[-1] is Ellipsis
        if not (text.startswith("[") and text.endswith("]")):
            example = "[a, b, c]" if not open_ended else "[a, b, ...]"
            self.diagnostics.error("UPS206", f"{what} is {text!r}; write it as {example}", at)
            return FAILED
        inner = text[1:-1].strip()
        parts = [p.strip() for p in re.split(r"[,\s]+" if open_ended else ",", inner) if p.strip() or not open_ended]
        if not inner:
            parts = []
        if not open_ended and len(parts) != len(args):
            self.diagnostics.error("UPS207", f"{what} has {len(parts)} components, not {len(args)}: {text}", at)
            return FAILED
        values = [self._convert(args[0], part, at, f"a component of {what}") for part in parts]
        return FAILED if any(v is FAILED for v in values) else tuple(values)

    def _within_bounds(self, info: FieldInfo, value: Any, at: Any, what: str) -> bool:
        parameter = info.parameter
        values = value if isinstance(value, tuple) else (value,)
        for v in values:
            if parameter.choices and isinstance(v, str) and v not in parameter.choices:
                legal = ", ".join(c for c in parameter.choices if c)
                self.diagnostics.error(
                    "UPS209",
                    f"{what} is {v!r}; it must be one of {legal}",
                    at,
                    suggestion_for(v, parameter.choices),
                )
                return False
            if isinstance(v, bool) or not isinstance(v, int | float):
                continue
            problem = _bound_problem(parameter, v)
            if problem:
                unit = f" {parameter.unit}" if parameter.unit else ""
                self.diagnostics.error("UPS208", f"{what} is {v:g}{unit}; {parameter.meaning} must be {problem}", at)
                return False
        return True

    # ---- what nobody declared ------------------------------------------------------------------------------

    def _check_children(self, record: type, element: Element, known_tags: tuple[str, ...]) -> None:
        known = set(known_tags)
        for info in fields(record):
            if info.parameter.attribute:
                continue
            if info.sub_model is not None and FAMILIES[info.sub_model.family].key == "tag":
                family = FAMILIES[info.sub_model.family]
                known |= {*family.models, *family.old_names}
            elif info.sub_model is not None:
                family = FAMILIES[info.sub_model.family]
                known |= {family.tag, *family.old_tags}
            else:
                known |= {info.tag, *info.parameter.old_tags}
        for child in element.children:
            if child.tag in known:
                continue
            if child.tag in KNOWN_TAGS.get(element.tag, ()):
                self.diagnostics.note(
                    "UPS412", f"<{child.tag}> in <{element.tag}> is known, and not used by this program", child
                )
                continue
            nearest = did_you_mean(child.tag, sorted(known))
            fix = Fix(tuple(child.renamed(nearest)), safe=False) if nearest else None
            self.diagnostics.error(
                "UPS102",
                f"unknown tag <{child.tag}> in <{element.tag}>",
                child,
                f"did you mean <{nearest}>?" if nearest else None,
                fix,
            )

    def _check_attributes(self, record: type, element: Element) -> None:
        known = {n for i in fields(record) if i.parameter.attribute for n in (i.tag, *i.parameter.old_tags)}
        keys = {f.key[1:] for f in FAMILIES.values() if f.key.startswith("@") and element.tag in (f.tag, *f.old_tags)}
        for name, attribute in element.attributes.items():
            if name not in known | keys:
                self.diagnostics.error(
                    "UPS112",
                    f"<{element.tag}> takes no attribute {name!r}",
                    attribute.name_location,
                    suggestion_for(name, sorted(known | keys)),
                )


def _bound_problem(parameter: Any, v: float) -> str:
    """What a number must be and is not, or nothing."""
    if parameter.gt is not None and not v > parameter.gt:
        return f"greater than {parameter.gt:g}"
    if parameter.ge is not None and not v >= parameter.ge:
        return f"at least {parameter.ge:g}"
    if parameter.lt is not None and not v < parameter.lt:
        return f"less than {parameter.lt:g}"
    if parameter.le is not None and not v <= parameter.le:
        return f"at most {parameter.le:g}"
    return "a number" if math.isnan(v) else ""


def _repaired_number(text: str) -> str | None:
    """The number that a mistyped one may have meant."""
    candidate = re.sub(r"[dD](?=[-+]?\d+$)", "e", text.replace(",", ".").replace(" ", ""))
    candidate = re.sub(r"[^-+.\deE]", "", candidate)
    return f"did you mean {candidate}?" if candidate != text and _NUMBER.match(candidate) else None
