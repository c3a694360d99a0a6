"""Texts of a deck as values: numbers, words and vectors, with what is wrong and how to repair it."""

from __future__ import annotations

import math
import re
from typing import Any, get_args, get_origin

from solver.declare import FieldInfo, Parameter
from ups.diagnostics import Diagnostic, Diagnostics, Fix, Severity, did_you_mean, is_certain, suggestion_for
from ups.element import Attribute, Element, Text

NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\Z")
_WITH_UNIT = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s+[A-Za-z]")
_INTEGER = re.compile(r"[-+]?\d+\Z")
_MOST_DIGITS = 18
_SPECIAL = {"inf", "+inf", "-inf", "nan"}
_SEPARATOR = re.compile(r"[,\s]+")


class Failure:
    """Stands for a value that could not be read; a diagnostic says why."""


FAILED = Failure()

Place = Element | Attribute | Text


def number(text: str) -> float | None:
    """A text as a number, or None where it is none; nothing is reported."""
    text = text.strip()
    return float(text) if NUMBER.match(text) or text.lower() in _SPECIAL else None


def numbers(text: str) -> list[float] | None:
    """The numbers of a text such as ``[1, 2, 3]`` (brackets are optional), or None where one is none."""
    inner = text.strip().removeprefix("[").removesuffix("]").strip()
    found = [number(word) for word in _SEPARATOR.split(inner) if word]
    return None if any(v is None for v in found) else [v for v in found if v is not None]


class ValueReader:
    """Converts texts to the declared types; what is wrong goes to the diagnostics."""

    def __init__(self, diagnostics: Diagnostics) -> None:
        self.diagnostics = diagnostics
        self.errors = 0

    def error(
        self, code: str, message: str, at: Any, suggestion: str | None = None, fix: Fix | None = None
    ) -> None:
        """Report an error; ``at`` is anything that has a location, or a location."""
        self.errors += 1
        location = getattr(at, "location", at)
        self.diagnostics.add(Diagnostic(code, Severity.ERROR, message, location, suggestion, fix))

    def value(self, info: FieldInfo, hint: Any, text: str, at: Place, what: str) -> Any:
        """The value of a declared field, or FAILED after diagnostics.

        ``hint`` is the type, ``at`` the place to show, ``what`` how messages call the value.
        """
        value = self._convert(hint, text.strip(), at, what)
        if value is FAILED or not self._is_allowed(info.parameter, value, at, what):
            return FAILED
        return value

    def _convert(self, hint: Any, text: str, at: Place, what: str) -> Any:
        if hint is bool:
            return self._boolean(text, at, what)
        if hint is int:
            return self._integer(text, at, what)
        if hint is float:
            return self._number(text, at, what)
        if get_origin(hint) is tuple:
            return self._sequence(hint, text, at, what)
        return text

    def _boolean(self, text: str, at: Place, what: str) -> Any:
        if text in ("true", "false"):
            return text == "true"
        meant = {"1": "true", "0": "false", "yes": "true", "no": "false"}.get(text.lower())
        meant = meant or did_you_mean(text, ("true", "false"))
        certain = text.lower() in ("true", "false", "1", "0", "yes", "no")
        fix = Fix((_replaced(at, meant),), safe=certain) if meant and is_whole(at, text) else None
        suggestion = f"did you mean {meant}?" if meant else None
        self.error("UPS205", f"{what} is {text!r}; it must be true or false", at, suggestion, fix)
        return FAILED

    def _number(self, text: str, at: Place, what: str) -> Any:
        if NUMBER.match(text):
            if math.isfinite(value := float(text)):
                return value
            self.error("UPS208", f"{what} is {text}; no number in a deck is that large", at)
            return FAILED
        if text.lower() in _SPECIAL:
            advice = "leave it out, or write a number that is large enough"
            self.error("UPS203", f"{what} is {text!r}; Uintah reads digits only", at, advice)
            return FAILED
        repaired = _repaired_number(text)
        suggestion = f"did you mean {repaired}?" if repaired else None
        fix = Fix((_replaced(at, repaired),), safe=False) if repaired and is_whole(at, text) else None
        self.error("UPS203", f"{what} is {text!r}; it must be a number", at, suggestion, fix)
        return FAILED

    def _integer(self, text: str, at: Place, what: str) -> Any:
        if _INTEGER.match(text):
            if len(text) <= _MOST_DIGITS:
                return int(text)
            self.error("UPS208", f"{what} is {text[:20]}...; no whole number in a deck is that large", at)
            return FAILED
        if NUMBER.match(text) and abs(float(text)) < 10.0**_MOST_DIGITS and float(text) == int(float(text)):
            whole = str(int(float(text)))
            fix = Fix((_replaced(at, whole),)) if is_whole(at, text) else None
            message = f"{what} is {text!r}; a whole number is expected"
            self.diagnostics.warning("UPS204", message, at, f"write {whole}", fix)
            return int(whole)
        self.error("UPS204", f"{what} is {text!r}; it must be a whole number", at)
        return FAILED

    def _sequence(self, hint: Any, text: str, at: Place, what: str) -> Any:
        args = get_args(hint)
        open_ended = args[-1] is Ellipsis
        if open_ended and numbers(text) and "[" not in text and "]" not in text:
            text = f"[{text}]"  # Uintah takes a list without brackets
        if not (text.startswith("[") and text.endswith("]")):
            self._not_a_vector(text, at, what, open_ended, len(args))
            return FAILED
        inner = text[1:-1].strip()
        if open_ended:
            parts = [part for part in _SEPARATOR.split(inner) if part]
        else:
            parts = [part.strip() for part in inner.split(",")] if inner else []
        if not open_ended and len(parts) != len(args):
            message = f"{what} has {len(parts)} components, not {len(args)}: {text}"
            self.error("UPS207", message, at, f"write it as {_example(len(args))}")
            return FAILED
        values = [self._convert(args[0], part, at, f"a component of {what}") for part in parts]
        return FAILED if any(v is FAILED for v in values) else tuple(values)

    def _not_a_vector(self, text: str, at: Place, what: str, open_ended: bool, length: int) -> None:
        form = "[a, b, ...]" if open_ended else _example(length)
        given = numbers(text)
        fix = None
        if given and (open_ended or len(given) == length):
            inner = text.removeprefix("[").removesuffix("]").strip()
            written = ", ".join(_SEPARATOR.split(inner))
            fix = Fix((_replaced(at, f"[{written}]"),), safe=True)
        self.error("UPS206", f"{what} is {text!r}; write it as {form}", at, f"write it as {form}", fix)

    def _is_allowed(self, parameter: Parameter, value: Any, at: Place, what: str) -> bool:
        """Whether a value is one of the words, or within the bounds, that its parameter declares."""
        for item in value if isinstance(value, tuple) else (value,):
            if isinstance(item, str):
                if parameter.choices and item not in parameter.choices:
                    self._not_a_choice(parameter, item, at, what)
                    return False
            elif not isinstance(item, bool) and (problem := bound_problem(parameter, item)):
                unit = f" {parameter.unit}" if parameter.unit else ""
                self.error("UPS208", f"{what} is {item:g}{unit}; {parameter.meaning} must be {problem}", at)
                return False
        return True

    def _not_a_choice(self, parameter: Parameter, word: str, at: Place, what: str) -> None:
        legal = ", ".join(choice for choice in parameter.choices if choice)
        nearest = did_you_mean(word, parameter.choices)
        fix = None
        if nearest and is_whole(at, word):
            fix = Fix((_replaced(at, nearest),), safe=is_certain(word, nearest, parameter.choices))
        suggestion = suggestion_for(word, parameter.choices)
        self.error("UPS209", f"{what} is {word!r}; it must be one of {legal}", at, suggestion, fix)


def is_whole(at: Place, text: str) -> bool:
    """Whether a text is all of what stands at a place, so that replacing the place replaces the text."""
    return isinstance(at, Attribute | Text) and at.value.strip() == text


def _replaced(at: Place, text: str) -> Any:
    assert isinstance(at, Attribute | Text)
    return at.replaced(text)


def _example(length: int) -> str:
    return f"[{', '.join('abcdefgh'[:length])}]"


def bound_problem(parameter: Parameter, value: float) -> str:
    """What a number must be and is not, or nothing."""
    if math.isnan(value):
        return "a number"
    if parameter.gt is not None and not value > parameter.gt:
        return f"greater than {parameter.gt:g}"
    if parameter.ge is not None and not value >= parameter.ge:
        return f"at least {parameter.ge:g}"
    if parameter.lt is not None and not value < parameter.lt:
        return f"less than {parameter.lt:g}"
    if parameter.le is not None and not value <= parameter.le:
        return f"at most {parameter.le:g}"
    return ""


def _repaired_number(text: str) -> str | None:
    """The number that a mistyped one may have meant."""
    with_unit = _WITH_UNIT.match(text)
    if with_unit:
        return with_unit.group(1)
    candidate = re.sub(r"[dD](?=[-+]?\d+$)", "e", text.replace(",", ".").replace(" ", ""))
    candidate = re.sub(r"[^-+.\deE]", "", candidate)
    return candidate if candidate != text and NUMBER.match(candidate) else None
