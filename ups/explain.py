"""What a tag, a model, a saved label or a code means: the answers of ``ups explain``."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Iterator
from textwrap import indent
from typing import Any, get_args, get_origin

import solver.interpolation  # noqa: F401 - a family that no record of a deck names: its models are words
from solver.declare import FAMILIES, Family, FieldInfo, Parameter, fields, without_optional
from ups.diagnostics import CODES, did_you_mean
from ups.examples import example_of_model, example_of_tag
from ups.grammar import known_model, known_names
from ups.grammar.index import Place, places

_WORDS = {float: "a number", int: "a whole number", bool: "true or false", str: "text"}
_MOST_PLACES = 12
_WITH_STATE = ("constitutive_model", "damage", "erosion")
"""The families whose models keep a state for each particle."""


def explain(name: str) -> str | None:
    """Everything that is known under a name, as text; None where there is nothing.

    ``name`` is a code (UPS102), a tag (``<density>`` or density), an attribute, a model, a path such as
    ``material/density``, a word that a tag chooses from, or a label of ``<save>``.
    """
    name = name.strip().strip("<>/")
    if is_code(name.upper()):
        return explain_code(name.upper())
    places()  # the walk over the language meets, and so loads, the families of all models
    label = explain_label(name)
    parts = [*_models(name), *_tags(name), *([label] if label else [])]
    parts = parts or list(_words(name))
    return "\n\n".join(parts) if parts else None


def suggestion(name: str) -> str | None:
    """A known name that was probably meant."""
    from ups.grammar.saved_labels import LABELS

    tags = {place.tag for place in places()}
    models = {n for family in list(FAMILIES.values()) for n in (*family.models, *known_names(family.name))}
    return did_you_mean(name, [*sorted(tags), *sorted(models), *LABELS, *all_codes()])


# ---- codes -------------------------------------------------------------------------------------------------


def all_codes() -> dict[str, str]:
    """Every code with its title, those of rules included."""
    from ups.rules.rule import all_rules

    all_rules()
    _old_forms()
    return dict(sorted(CODES.items()))


def is_code(name: str) -> bool:
    """Whether a name is one of the codes."""
    return name in all_codes()


def explain_code(code: str) -> str:
    """The page of a code."""
    from ups.rules.form_pages import PAGES
    from ups.rules.rule import all_rules

    pages = [PAGES[code]] if code in PAGES else []
    pages += [
        inspect.cleandoc(rule.__doc__ or "") for rule in (*all_rules(), *_old_forms()) if rule.code == code
    ]
    return "\n\n".join([f"{code}: {CODES[code]}", *pages])


def _old_forms() -> tuple[Any, ...]:
    from ups.rules.old_forms.old_form import all_old_forms

    return all_old_forms()


# ---- models ------------------------------------------------------------------------------------------------


def _models(name: str) -> Iterator[str]:
    for family in list(FAMILIES.values()):
        record = family.models.get(family.old_names.get(name, name)) or known_model(family.name, name)
        if record is not None:
            runs = name in family.models or name in family.old_names
            example = example_of_model(family, family.old_names.get(name, name), record)
            page = explain_model(name, family, record, runs)
            yield f"{page}\n  example:\n{indent(example, '    ')}"


def explain_model(name: str, family: Family, record: type, runs: bool) -> str:
    """The page of a model of a family: meaning, equation, source and parameters."""
    return "\n".join(_model_lines(name, family, record, runs))


def _model_lines(name: str, family: Family, record: type, runs: bool) -> Iterator[str]:
    yield f"{name}: {family.meaning}" + ("" if runs else " (known, not supported by ups run)")
    yield f"  chosen by {_choice(name, family)}"
    yield from (f"  {line}".rstrip() for line in inspect.cleandoc(record.__doc__ or "").splitlines())
    own = fields(record)
    if own:
        yield "  parameters:"
        width = max(len(info.tag) for info in own)
        yield from (f"    {info.tag:{width}}  {describe(info)}" for info in own)


def _choice(name: str, family: Family) -> str:
    """How a deck chooses a model."""
    if family.key == "tag":
        return f"<{name}>"
    if family.key == "text":
        return f"<{family.tag}>{name}</{family.tag}>"
    if family.key.startswith("@"):
        return f'<{family.tag} {family.key[1:]}="{name}">'
    return f"<{family.tag}> <{family.key}>{name}</{family.key}>"


# ---- tags --------------------------------------------------------------------------------------------------


def _tags(name: str) -> Iterator[str]:
    parent, _, tag = name.rpartition("/")
    parent = parent.rpartition("/")[2]
    found = [p for p in places() if tag in (p.tag, *p.info.parameter.old_tags, *_old_tags(p.info))]
    found = [p for p in found if not parent or p.parent == parent]
    groups: dict[str, list[Place]] = {}
    for place in found:
        groups.setdefault(describe(place.info), []).append(place)
    for text, places_of in groups.items():
        kind = "attribute" if places_of[0].info.parameter.attribute else "tag"
        today = places_of[0].tag
        shown = f"<{today}>" if kind == "tag" else today
        where = list(dict.fromkeys(_where(p) for p in places_of))
        more = f" and {len(where) - _MOST_PLACES} more" if len(where) > _MOST_PLACES else ""
        unsupported = "" if any(p.runs for p in places_of) else " (known, not supported by ups run)"
        page = f"{shown}: {text}{unsupported}\n  {kind} of {', '.join(where[:_MOST_PLACES])}{more}"
        example = example_of_tag(places_of[0].info, today, {p.parent for p in places_of})
        yield f"{page}\n  example:\n{indent(example, '    ')}" if example else page


def _words(name: str) -> Iterator[str]:
    """The tags and attributes of which a word is one of the values."""
    for place in {(p.tag, p.parent, p.info.parameter): p for p in places()}.values():
        if name in place.info.parameter.choices:
            yield f"{name}: a value of {place.tag} in {_where(place)}: {describe(place.info)}"


def _where(place: Place) -> str:
    return f'<{place.parent} type="{place.model}">' if place.model else f"<{place.parent}>"


def describe(info: FieldInfo) -> str:
    """A declared field in one line: meaning, type, unit, bounds, default."""
    parameter = info.parameter
    parts = [parameter.meaning, _type_of(info)]
    parts += [f"in {parameter.unit}"] if parameter.unit else []
    parts += [text] if (text := bounds(parameter)) else []
    parts += [f"one of {', '.join(c for c in parameter.choices if c)}"] if parameter.choices else []
    parts.append("required" if info.required else _default(info))
    parts += [f"no effect: {parameter.ignored}"] if parameter.ignored else []
    old = (*parameter.old_tags, *_old_tags(info))
    parts += [f"once called {', '.join(old)}"] if old else []
    parts += [f"source: {parameter.source}"] if parameter.source else []
    return "; ".join(part for part in parts if part)


def _old_tags(info: FieldInfo) -> tuple[str, ...]:
    """Tags by which earlier versions of Uintah chose a model."""
    return FAMILIES[info.sub_model.family].old_tags if info.sub_model is not None else ()


def _type_of(info: FieldInfo) -> str:
    if info.sub_model is not None:
        names = ", ".join(sorted(FAMILIES[info.sub_model.family].models))
        return f"one of {names}"
    if info.record is not None:
        return "a section" + (", any number of times" if info.many else "")
    hint = without_optional(info.type)
    if get_origin(hint) is tuple:
        first, *rest = get_args(hint)
        word = {float: "numbers", int: "whole numbers"}.get(first, "words")
        return f"a list of {word}" if rest == [Ellipsis] else f"{1 + len(rest)} {word} [a, b, c]"
    return _WORDS.get(hint, "")


def bounds(parameter: Parameter) -> str:
    """The bounds of a number in words; empty where there are none."""
    signs: Iterable[tuple[str, float | None]] = (
        (">", parameter.gt),
        (">=", parameter.ge),
        ("<", parameter.lt),
        ("<=", parameter.le),
    )
    return " and ".join(f"{sign} {value:g}" for sign, value in signs if value is not None)


def _default(info: FieldInfo) -> str:
    value = info.default
    if value is None or value == "" or value == () or info.record is not None or info.sub_model is not None:
        return "optional"
    shown = (
        f"{value:g}"
        if isinstance(value, float)
        else str(value).lower()
        if isinstance(value, bool)
        else str(value)
    )
    return f"default {shown}"


# ---- labels ------------------------------------------------------------------------------------------------


def explain_label(name: str) -> str | None:
    """What a variable of ``<save>`` means, and which models compute it; None where there is none of that name."""
    from ups.grammar.saved_labels import LABELS

    label = LABELS.get(name)
    if label is None:
        return None
    unit = f", in {label.unit}" if label.unit else ""
    page = f'<save label="{name}"/>: {label.meaning or "a variable of another method"}{unit}'
    models = [f"{tag} {', '.join(names)}" for tag, names in _computed_by(name).items()]
    return f"{page}\n  computed by {'; '.join(models)}" if models else page


def _computed_by(label: str) -> dict[str, list[str]]:
    """Tag of a family -> the models of it that keep a variable for each particle."""
    from solver.particles import state_variables

    found: dict[str, list[str]] = {}
    for family in (FAMILIES[name] for name in _WITH_STATE):
        for name, record in family.models.items():
            state = _state_of(record)
            if state is not None and any(v.label == label for v in state_variables(state).values()):
                found.setdefault(family.tag, []).append(name)
    return found


def _state_of(record: type) -> type | None:
    """The state arrays of a model as it is without options; None where that depends on what a deck says."""
    from solver.materials.constitutive import state_record

    required = {info.name: 1.0 for info in fields(record) if info.required}
    try:
        return state_record(record(**required))
    except (TypeError, ValueError, AttributeError):
        return None


def explain_command(name: str) -> tuple[str, int]:
    """What ``ups explain NAME`` prints, and its exit status."""
    text = explain(name)
    if text is not None:
        return text, 0
    nearest = suggestion(name.strip().strip("<>/"))
    return f"nothing is known about {name!r}" + (f"; did you mean {nearest}?" if nearest else ""), 1
