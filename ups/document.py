"""Read a deck: its XML with every position, and the files that it includes in their places.

``<include href="F" section="a/b" excludeSectionTag="true" attr="value"/>`` stands for the children of
the root of F, or for the element at a path of tags below the root (whose attributes are those that the
include gives besides), or for what is in that element. Includes nest and may stand anywhere.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import materialdata
from ups.diagnostics import Diagnostics, Fix, Located, did_you_mean, suggestion_for
from ups.element import Attribute, Comment, Element, Text, to_xml
from ups.source import SourceFile, load_source
from ups.xml_parser import MAX_ELEMENTS, ParsedFile, parse_xml

__all__ = [
    "Attribute",
    "Comment",
    "Document",
    "Element",
    "Include",
    "SourceFile",
    "Text",
    "locate_include",
    "read_document",
]

DECK_ROOTS = ("Uintah_specification",)
INCLUDE_ROOTS = ("Uintah_Include", "Uintah_specification")
MAX_INCLUDES = 5000
"""How many includes a deck may resolve, all levels together."""

MAX_INCLUDED_CHARACTERS = 64 * 1024 * 1024
"""How many characters all includes of a deck may bring together; a file counts each time."""

_PROGRAM_ROOT = Path(__file__).resolve().parent.parent
_DATA_FOLDERS = ("inputs", "materialdata")
_NOT_MATCHED = frozenset({"href", "section", "excludeSectionTag", "need_applies_to"})


@dataclass(frozen=True)
class Include:
    """An include that was resolved: the ``<include>`` element, its `href` as written, and the file found."""

    element: Element
    href: str
    path: Path


@dataclass
class Document:
    """A deck as read: its tree with all includes in place, and what is wrong with its XML.

    `root` is None when there is no tree at all. `complete` is False when a file had to be given up in the
    middle or an include is missing, so that something missing from the tree may not be missing from the
    deck. `files` are all files in the order of reading, the deck first.
    """

    path: Path
    root: Element | None
    diagnostics: Diagnostics
    files: list[SourceFile] = field(default_factory=list)
    includes: list[Include] = field(default_factory=list)
    complete: bool = True
    comments_before: list[Comment] = field(default_factory=list)
    comments_after: list[Comment] = field(default_factory=list)

    @property
    def sources(self) -> dict[str, str]:
        """The text of every file by its name in locations, for the renderers of diagnostics."""
        return {file.name: file.text for file in self.files}

    def to_xml(self) -> str:
        """Write the deck with its includes in place, indented, with comments; "" when there is no tree."""
        if self.root is None:
            return ""
        return to_xml(self.root, self.comments_before, self.comments_after)


def read_document(
    path: str | os.PathLike[str],
    *,
    text: str | None = None,
    unsaved: Mapping[str, str] | None = None,
    search: Iterable[str | os.PathLike[str]] = (),
    roots: tuple[str, ...] = DECK_ROOTS,
) -> Document:
    """Read a deck and all its includes.

    `text` is taken instead of the file's content when given (`path` then names it, and says where its
    includes are). `unsaved` has texts to take instead of what files hold, by their real paths, as an editor
    has them. `search` are further folders to look for includes in (see `locate_include`). `roots` are
    the tags that the root may have. Nothing is raised for bad input: see `Document.diagnostics`.
    """
    folders = tuple(Path(folder) for folder in search)
    return _DeckReader(folders, unsaved or {}).read(os.fspath(path), text, roots)


def locate_include(
    href: str, including_file: str | os.PathLike[str], search: Iterable[str | os.PathLike[str]] = ()
) -> Path | None:
    """Find the file that an include means, or None.

    Looked for beside the including file, then from the working directory, then in the folders `search`,
    then in the folders above the including file when `href` begins with ``inputs/`` (decks that are run
    from above their ``inputs`` folder), then in the program's own ``inputs`` and ``materialdata``; each
    time also with a leading ``inputs/`` or ``materialdata/`` dropped or added. Last, a file of this
    name, or of the name that it has today, anywhere in the program's ``materialdata``.
    """
    href = href.strip()
    if not href or "\x00" in href:
        return None
    for candidate in _candidates(href, Path(including_file), [Path(folder) for folder in search]):
        if os.path.isfile(candidate):
            return candidate
    return materialdata.find(href, _PROGRAM_ROOT / "materialdata")


def _candidates(href: str, including_file: Path, search: list[Path]) -> list[Path]:
    """List the paths that `locate_include` tries, in its order."""
    first, _, rest = href.partition("/")
    in_data_folder = first in _DATA_FOLDERS and bool(rest)
    variants = [href, rest] if in_data_folder else [href, *(f"{folder}/{href}" for folder in _DATA_FOLDERS)]
    beside = including_file.parent
    above = including_file.absolute().parents if in_data_folder else ()
    own = [_PROGRAM_ROOT, *(_PROGRAM_ROOT / folder for folder in _DATA_FOLDERS)]
    paths = [beside / href, Path(href)]
    paths += [folder / href for folder in (*search, *above)]
    paths += [folder / variant for variant in variants for folder in (beside, Path(), *search, *own)]
    return [Path(os.path.normpath(path)) for path in paths]


class _DeckReader:
    """Reads one deck: the files it has met and the tree that grows from them."""

    def __init__(self, search: tuple[Path, ...], unsaved: Mapping[str, str]) -> None:
        self.search = search
        self.unsaved = unsaved
        self.files: dict[str, SourceFile | None] = {}
        self.diagnostics = Diagnostics()
        self.includes: list[Include] = []
        self.complete = True
        self.included_characters = 0
        self.resolved = 0
        self.room = MAX_ELEMENTS
        self.exhausted = False

    def read(self, name: str, text: str | None, roots: tuple[str, ...]) -> Document:
        source = SourceFile(name, text) if text is not None else self._load(name)
        self.files[name] = source
        parsed = parse_xml(source, self.diagnostics) if source else ParsedFile(complete=False)
        self.room -= parsed.elements
        self.complete = self.complete and parsed.complete
        root = parsed.root
        if root is not None:
            self._check_root(root, roots)
            root.set_content(self._expand(root.content, root, (os.path.realpath(name),)))
        return Document(
            Path(name),
            root,
            self.diagnostics,
            [file for file in self.files.values() if file],
            self.includes,
            self.complete,
            parsed.before,
            parsed.after,
        )

    def _load(self, name: str) -> SourceFile | None:
        text = self.unsaved.get(os.path.realpath(name)) if self.unsaved else None
        return load_source(name, self.diagnostics) if text is None else SourceFile(name, text)

    def _check_root(self, root: Element, roots: tuple[str, ...]) -> None:
        if root.tag in roots:
            return
        wanted = " or ".join(f"<{tag}>" for tag in roots)
        if root.tag in INCLUDE_ROOTS:
            message = f"the root is <{root.tag}>: this is a file to be included by a deck, not a deck"
            self.diagnostics.error("UPS008", message, root)
        else:
            suggestion = suggestion_for(root.tag, roots, "<{}>") or f"a deck begins with {wanted}"
            fix = Fix(tuple(root.renamed(roots[0])), safe=False)
            self.diagnostics.error("UPS008", f"the root is <{root.tag}>, not {wanted}", root, suggestion, fix)

    def _expand(
        self, content: list[Element | Comment], parent: Element, chain: tuple[str, ...]
    ) -> list[Element | Comment]:
        """Replace every include in the content, at any depth, by what it stands for."""
        expanded: list[Element | Comment] = []
        for node in content:
            if isinstance(node, Comment):
                expanded.append(node)
                continue
            node.parent = parent
            if node.tag == "include":
                expanded += self._included(node, parent, chain)
                continue
            if node.content:
                node.set_content(self._expand(node.content, node, chain))
            expanded.append(node)
        return expanded

    def _included(self, include: Element, parent: Element, chain: tuple[str, ...]) -> list[Element | Comment]:
        """Return what an include stands for; nothing, and a diagnostic, when it cannot be resolved."""
        source = self._source_of(include, chain)
        depth = sum(1 for _ in include.ancestors())
        parsed = parse_xml(source, self.diagnostics, depth, self.room) if source else None
        self.room -= parsed.elements if parsed is not None else 0
        if parsed is None or parsed.root is None:
            self.complete = False
            return []
        self.complete = self.complete and parsed.complete
        root, href = parsed.root, include.attributes["href"]
        if root.tag not in INCLUDE_ROOTS:
            wanted = " or ".join(f"<{tag}>" for tag in INCLUDE_ROOTS)
            message = f"the root of {root.source.name} is <{root.tag}>; a file to include has {wanted}"
            self.diagnostics.error("UPS008", message, href)
            self.complete = False
            return []
        selected = self._select(include, root)
        if selected is None:
            self.complete = False
            return []
        self.includes.append(Include(include, href.value, Path(root.source.name)))
        inner_chain = (*chain, os.path.realpath(root.source.name))
        if selected is not root and not _is_set(include, "excludeSectionTag"):
            return self._expand([selected], parent, inner_chain)
        parent.texts += selected.texts
        return self._expand(selected.content, parent, inner_chain)

    def _source_of(self, include: Element, chain: tuple[str, ...]) -> SourceFile | None:
        """Find and read the file that an include names; None, and a diagnostic, without one."""
        href = include.attributes.get("href")
        if href is None or not href.value.strip():
            self.diagnostics.error(
                "UPS010", "<include> does not say which file", href or include, 'write <include href="FILE"/>'
            )
            return None
        path = locate_include(href.value, include.source.name, self.search)
        if path is None:
            self._report_missing(href)
            return None
        self._say_renamed(href, path.name)
        name = os.fspath(path)
        real = os.path.realpath(name)
        if real in chain:
            loop = " -> ".join(os.path.basename(file) for file in (*chain[chain.index(real) :], real))
            self.diagnostics.error("UPS012", f"the file includes itself: {loop}", href)
            return None
        if name not in self.files:
            self.files[name] = self._load(name)
        source = self.files[name]
        if source is not None and not source.text.lstrip().startswith("<"):
            # no line of such a file is shown: a deck from a stranger may name any file of its reader
            self.files[name] = None
            self.diagnostics.error("UPS002", f"{href.value.strip()} is not an XML file", href)
            return None
        return source if source and self._within_limits(source, href) else None

    def _say_renamed(self, href: Attribute, today: str) -> None:
        """Note that a file was found under another name than the deck gives it."""
        folder, slash, written = href.value.strip().rpartition("/")
        if written != today:
            fix = Fix((href.replaced(f"{folder}{slash}{today}"),))
            self.diagnostics.note(
                "UPS305", f"{written} is an older name of {today}", href, f"write {folder}{slash}{today}", fix
            )

    def _within_limits(self, source: SourceFile, at: Located) -> bool:
        """Count what is included; False, and one diagnostic, when a deck includes without end."""
        if self.exhausted:
            return False
        self.resolved += 1
        self.included_characters += len(source.text)
        self.exhausted = self.resolved > MAX_INCLUDES or self.included_characters > MAX_INCLUDED_CHARACTERS
        if self.exhausted:
            self.diagnostics.error("UPS007", "the includes of this deck are too many or too large", at)
        return not self.exhausted

    def _select(self, include: Element, root: Element) -> Element | None:
        """Find what section and attributes of the include ask for; the root when there is no section."""
        section = include.attributes.get("section")
        if section is None or not section.value.strip("/ "):
            return root
        wanted = {name: item.value for name, item in include.attributes.items() if name not in _NOT_MATCHED}
        path = "/".join(tag for tag in section.value.strip().split("/") if tag)
        found = list(root.find_all(path))
        for element in found:
            own = element.attributes
            if all(name in own and own[name].value == value for name, value in wanted.items()):
                return element
        if found:
            asked = " ".join(f'{name}="{value}"' for name, value in wanted.items())
            message = f"no section <{path}> of {root.source.name} has {asked}"
            self.diagnostics.error("UPS013", message, include)
            return None
        self.diagnostics.error(
            "UPS013",
            f"no section {path} in {root.source.name}",
            section,
            suggestion_for(path, _sections(root)),
        )
        return None

    def _report_missing(self, href: Attribute) -> None:
        """Say that no file fits an href, and name the file that may have been meant."""
        if "://" in href.value:
            message = f"cannot include {href.value}: only local files are read"
            self.diagnostics.error("UPS011", message, href)
            return
        written = Path(href.value.strip())
        folders: dict[Path, None] = {}
        for candidate in _candidates(os.fspath(written), Path(href.source.name), list(self.search)):
            folders.setdefault(candidate.parent)
        names = [name for folder in folders for name in _file_names(folder)]
        names += sorted(path.name for path in (_PROGRAM_ROOT / "materialdata").rglob("*.xml"))
        nearest = did_you_mean(written.name, names)
        suggestion = nearest and f"did you mean {(written.parent / nearest).as_posix()}?"
        self.diagnostics.error("UPS011", f"include file {written.as_posix()} not found", href, suggestion)


def _is_set(include: Element, name: str) -> bool:
    attribute = include.attributes.get(name)
    return attribute is not None and attribute.value != ""


def _sections(root: Element) -> list[str]:
    """List the paths of all elements below the root, as an include's section gives them."""
    return [element.path.partition("/")[2] for element in root.iter() if element is not root]


def _file_names(folder: Path) -> list[str]:
    """List the files of a folder by name; none when it cannot be listed."""
    try:
        return sorted(entry.name for entry in folder.iterdir())
    except OSError:
        return []
