"""What ``ups explain`` says of the tag, attribute, model, label or code under the cursor."""

from __future__ import annotations

from typing import NamedTuple

from solver.declare import FieldInfo
from ups.explain import describe, explain, explain_code, explain_label, explain_model, is_code
from ups.lsp.context import Inside, inside, models
from ups.lsp.spot import Kind, OpenTag, Spot
from ups.reader import declared


class Explanation(NamedTuple):
    """A text in Markdown about the characters ``start:end``."""

    text: str
    start: int
    end: int


def explanation(spot: Spot, path: tuple[OpenTag, ...], text: str, component: str) -> Explanation | None:
    """What there is to say of a spot; None where that is nothing.

    ``path`` are the tags that are open at the spot, in an included file with those around the include before them.
    """
    about = _about(spot, path, text, component)
    return Explanation(about, spot.start, spot.end) if about and spot.word else None


def _about(spot: Spot, path: tuple[OpenTag, ...], text: str, component: str) -> str | None:
    if spot.kind is Kind.SKIPPED:
        return explain_code(spot.word) if is_code(spot.word) else None
    if spot.kind in (Kind.TAG, Kind.CLOSING) and spot.owner is not None:
        around = path if spot.kind is Kind.TAG else path[:-1]
        tag = spot.owner if spot.kind is Kind.TAG else path[-1] if path else spot.owner
        return _of_tag(inside((*around, tag), text, component), spot.word)
    if spot.kind is Kind.TEXT and path:
        return _of_value(
            spot.word, inside(path, text, component), inside(path[:-1], text, component), path[-1].tag
        )
    if spot.owner is None:
        return None
    owner = inside((*path, spot.owner), text, component)
    if spot.kind is Kind.ATTRIBUTE:
        return _of_attribute(spot.word, owner)
    if spot.owner.tag == "save" and spot.attribute == "label":
        return explain_label(spot.word)
    return _model(owner) if owner is not None and _chooses(owner, spot.attribute) else None


def _chooses(owner: Inside, attribute: str) -> bool:
    """Whether an attribute of a tag chooses its model."""
    return owner.family is not None and owner.family.key == f"@{attribute}"


def _of_tag(found: Inside | None, tag: str) -> str | None:
    if found is None or found.info is None:
        return _preformatted(explain(tag))
    if found.model and found.family is not None and found.family.key != "text":
        return _model(found)
    return f"**<{tag}>**: {describe(found.info)}"


def _of_attribute(name: str, owner: Inside | None) -> str | None:
    if owner is None or owner.record is None:
        return None
    if _chooses(owner, name) and owner.family is not None:
        known = ", ".join(sorted(n for n, _, _ in models(owner.family)))
        return f"**{name}**: {owner.family.meaning}; one of {known}"
    info = _attribute(owner.record, name)
    return f"**{name}**: {describe(info)}" if info is not None else None


def _attribute(record: type, name: str) -> FieldInfo | None:
    found = (i for i, _ in declared(record) if i.parameter.attribute)
    return next((i for i in found if name in (i.tag, *i.parameter.old_tags)), None)


def _of_value(word: str, own: Inside | None, outer: Inside | None, tag: str) -> str | None:
    """What a word of text means: the model that it chooses, or the tag whose value it is."""
    if own is not None and own.family is not None and own.family.key == "text":
        return _model(own)
    if outer is not None and outer.family is not None and outer.family.key == tag:
        return _model(outer)
    return f"**<{tag}>**: {describe(own.info)}" if own is not None and own.info is not None else None


def _model(found: Inside) -> str | None:
    if found.record is None or found.family is None:
        return None
    runs = found.family.find(found.model) is not None
    return _preformatted(explain_model(found.model, found.family, found.record, runs))


def _preformatted(text: str | None) -> str | None:
    """A page of ``ups explain`` as Markdown; its columns stay columns."""
    return f"```text\n{text}\n```" if text else None
