"""The language as a RELAX NG schema, written from the declarations, so that editors check and complete decks.

Sections of a deck have their tags in any order, which RELAX NG can say and XML Schema cannot. The schema is
for decks with their includes in place, and lets ``<include>`` stand anywhere. Bounds are left to lint.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, get_args, get_origin
from xml.sax.saxutils import escape, quoteattr

from solver.declare import FAMILIES, Family, FieldInfo, fields, without_optional
from ups.grammar import extension, known_model, known_names

_NUMBER = r"\s*[\-+]?(\d+\.?\d*|\.\d+)([eE][\-+]?\d+)?\s*"
_NUMBERS = r"\s*\[?[^\[\]<>]*\]?\s*"
_WHOLE = r"\s*[\-+]?\d+(\.0*)?\s*"
_VECTOR = r"\s*\[[^\[\],]+,[^\[\],]+,[^\[\],]+\]\s*"


def relax_ng(component: str = "") -> str:
    """The schema of decks, of all methods or of one.

    Raises
    ------
    ValueError : there is no such method.
    """
    from ups.grammar.components import COMPONENTS

    if component and component not in COMPONENTS:
        raise ValueError(f"there is no method {component!r}; known are {', '.join(COMPONENTS)}")
    names = [component] if component else [n for n, c in COMPONENTS.items() if c.record is not None]
    records = list(dict.fromkeys(COMPONENTS[n].load() for n in names if COMPONENTS[n].record is not None))
    return _Writer().write(records)


class _Writer:
    """Collects one named pattern a record, and writes those that are used."""

    def __init__(self) -> None:
        self.names: dict[tuple[type, str], str] = {}
        self.patterns: dict[str, str] = {}

    def write(self, roots: list[type]) -> str:
        choices = "".join(f'<ref name="{self._ref(root, "")}"/>' for root in roots)
        body = "\n".join(f'<define name="{name}">{text}</define>' for name, text in self.patterns.items())
        return (
            '<?xml version="1.0" encoding="UTF-8"?>\n'
            '<grammar xmlns="http://relaxng.org/ns/structure/1.0" '
            'datatypeLibrary="http://www.w3.org/2001/XMLSchema-datatypes">\n'
            f'<start><element name="Uintah_specification"><choice>{choices}</choice></element></start>\n'
            f"{body}\n{_ANYTHING}</grammar>\n"
        )

    def _ref(self, record: type, chosen_by: str) -> str:
        """The name of the pattern for the inside of a record."""
        key = (record, chosen_by)
        if key not in self.names:
            base = record.__name__
            number = sum(1 for r, _ in self.names if r.__name__ == base)
            self.names[key] = f"{base}{number or ''}"
            self.patterns[self.names[key]] = ""
            self.patterns[self.names[key]] = self._inside(record, chosen_by)
        return self.names[key]

    def _inside(self, record: type, chosen_by: str) -> str:
        extra = extension(record)
        own = list(fields(record))
        tags = {i.tag for i in own}
        own += [] if extra is None else [i for i in fields(extra) if i.tag not in tags]
        parts = [self._field(info) for info in own]
        if chosen_by and not chosen_by.startswith("@") and chosen_by not in ("tag", "text"):
            parts.append(f"<optional><element name={quoteattr(chosen_by)}><text/></element></optional>")
        parts.append('<zeroOrMore><element name="include"><ref name="anything"/></element></zeroOrMore>')
        return f"<interleave>{''.join(parts)}</interleave>"

    def _field(self, info: FieldInfo) -> str:
        if info.sub_model is not None:
            return self._models(info, FAMILIES[info.sub_model.family])
        if info.parameter.attribute:
            forms = [
                f"<attribute name={quoteattr(name)}>{_data(info)}</attribute>"
                for name in (info.tag, *info.parameter.old_tags)
            ]
            one = _choice(forms)
            return one if info.required else f"<optional>{one}</optional>"
        inside = f'<ref name="{self._ref(info.record, "")}"/>' if info.record is not None else _leaf(info)
        forms = [
            f"<element name={quoteattr(tag)}>{inside}</element>"
            for tag in (info.tag, *info.parameter.old_tags)
        ]
        return _counted(_choice(forms), info)

    def _models(self, info: FieldInfo, family: Family) -> str:
        models: dict[str, type] = dict(family.models)
        for name in known_names(family.name):
            cls = known_model(family.name, name)
            if cls is not None:
                models.setdefault(name, cls)
        for old, today in family.old_names.items():
            models.setdefault(old, models[today])
        if family.key == "tag":
            forms = [
                f'<element name={quoteattr(n)}><ref name="{self._ref(c, "")}"/></element>'
                for n, c in models.items()
            ]
            if family.name == "geometry":
                forms += [f"<element name={quoteattr(name)}>{_LABEL}</element>" for name in models]
            return f"<zeroOrMore>{_choice(forms)}</zeroOrMore>"
        inside = _choice([self._chosen(family, name, cls) for name, cls in models.items()])
        forms = [f"<element name={quoteattr(tag)}>{inside}</element>" for tag in (info.tag, *family.old_tags)]
        return _counted(_choice(forms), info)

    def _chosen(self, family: Family, name: str, cls: type) -> str:
        if family.key == "text":
            return f'<value type="token">{escape(name)}</value>'
        ref = f'<ref name="{self._ref(cls, "")}"/>'
        value = f'<value type="token">{escape(name)}</value>'
        if family.key.startswith("@"):
            return f"<group><attribute name={quoteattr(family.key[1:])}>{value}</attribute>{ref}</group>"
        return f"<interleave><element name={quoteattr(family.key)}>{value}</element>{ref}</interleave>"


_LABEL = '<choice><attribute name="label"/><attribute name="name"/></choice>'
"""All that a piece of geometry needs which refers to an earlier one."""

_ANYTHING = """<define name="anything"><zeroOrMore><choice><attribute><anyName/></attribute><text/>
<element><anyName/><ref name="anything"/></element></choice></zeroOrMore></define>
"""


def _counted(pattern: str, info: FieldInfo) -> str:
    if info.many:
        return f"<oneOrMore>{pattern}</oneOrMore>" if info.required else f"<zeroOrMore>{pattern}</zeroOrMore>"
    return pattern if info.required else f"<optional>{pattern}</optional>"


def _choice(forms: list[str]) -> str:
    return forms[0] if len(forms) == 1 else f"<choice>{''.join(forms)}</choice>"


def _leaf(info: FieldInfo) -> str:
    """The content of a tag that holds a value."""
    hint = without_optional(info.type)
    if hint is Any or getattr(hint, "__name__", "") == "Opaque":
        return '<ref name="anything"/>'
    names = "".join(
        f"<optional><attribute name={quoteattr(n)}/></optional>" for n in info.parameter.tag_attributes
    )
    data = _data(info)
    if hint is bool and info.default is False:
        data = f"<choice>{data}<empty/></choice>"
    if hint is str and not info.required:
        data = f"<choice>{data}<empty/></choice>"
    return names + data


def _data(info: FieldInfo) -> str:
    """The values that a leaf or an attribute may have."""
    hint = without_optional(info.type)
    if info.parameter.repeated:
        hint = get_args(hint)[0]
    choices = [c for c in info.parameter.choices if c]
    if hint is str and choices:
        return _choice([f'<value type="token">{escape(c)}</value>' for c in choices])
    if hint is bool:
        return '<choice><value type="token">true</value><value type="token">false</value></choice>'
    pattern = next(_patterns(hint), None)
    return (
        "<text/>"
        if pattern is None
        else f'<data type="string"><param name="pattern">{escape(pattern)}</param></data>'
    )


def _patterns(hint: Any) -> Iterator[str]:
    if hint is float:
        yield _NUMBER + r"|\s*[\-+]?(inf|nan)\s*"
    elif hint is int:
        yield _WHOLE
    elif get_origin(hint) is tuple:
        yield _NUMBERS if get_args(hint)[-1] is Ellipsis else _VECTOR


def schema_command(component: str = "") -> tuple[str, int]:
    """What ``ups schema`` prints, and its exit status."""
    try:
        return relax_ng(component).rstrip("\n"), 0
    except ValueError as problem:
        return str(problem), 2
