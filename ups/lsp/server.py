"""The server: the language server protocol on one side, the rest of this package on the other."""

from __future__ import annotations

import asyncio
import os
import re
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from lsprotocol import types
from pygls.lsp.server import LanguageServer
from pygls.uris import from_fs_path, to_fs_path

from ups.diagnostics import Diagnostic, Edit, Location, Severity
from ups.fixes import is_own_data, repaired
from ups.lsp.completion import Proposal, Sort, proposals
from ups.lsp.definition import definition
from ups.lsp.hover import explanation
from ups.lsp.positions import Positions
from ups.lsp.project import Project, place
from ups.lsp.spot import Kind, OpenTag, Spot, spot_at

PAUSE = 0.15
"""How long the typing must pause before a deck is checked again, in seconds."""

FIX_ALL = types.CodeActionKind.SourceFixAll

_SEVERITIES = {
    Severity.ERROR: types.DiagnosticSeverity.Error,
    Severity.WARNING: types.DiagnosticSeverity.Warning,
    Severity.NOTE: types.DiagnosticSeverity.Information,
}
_TAGS = {
    "UPS304": types.DiagnosticTag.Unnecessary,
    "UPS014": types.DiagnosticTag.Unnecessary,
    "UPS301": types.DiagnosticTag.Deprecated,
    "UPS302": types.DiagnosticTag.Deprecated,
    "UPS303": types.DiagnosticTag.Deprecated,
    "UPS305": types.DiagnosticTag.Deprecated,
    "UPS306": types.DiagnosticTag.Deprecated,
}
"""How editors show what has no effect, and what is old."""

_KINDS = {
    Sort.TAG: types.CompletionItemKind.Field,
    Sort.ATTRIBUTE: types.CompletionItemKind.Property,
    Sort.MODEL: types.CompletionItemKind.Class,
    Sort.WORD: types.CompletionItemKind.EnumMember,
    Sort.LABEL: types.CompletionItemKind.Variable,
    Sort.FILE: types.CompletionItemKind.File,
}


_STOP = re.compile(r"\$\d+")


class DeckServer(LanguageServer):
    """The language server with the files that its editor has open."""

    def __init__(self) -> None:
        super().__init__("ups", _version(), text_document_sync_kind=types.TextDocumentSyncKind.Full)
        self.project = Project()
        self._waiting: dict[str, asyncio.TimerHandle] = {}
        self._published: set[str] = set()

    # ---- checking ------------------------------------------------------------------------------------------

    def changed(self, uri: str, pause: float = PAUSE) -> None:
        """Take the text of a file from the editor, and check its decks when the typing pauses."""
        path = _path(uri)
        self.project.open(path, self.workspace.get_text_document(uri).source)
        if path in self._waiting:
            self._waiting.pop(path).cancel()
        self._waiting[path] = asyncio.get_running_loop().call_later(pause, self._check, path)

    def closed(self, uri: str) -> None:
        """Forget the text of a file; what was found in decks that are not open any more goes."""
        path = _path(uri)
        if path in self._waiting:
            self._waiting.pop(path).cancel()
        self.project.close(path)
        self._publish()

    def settle(self) -> None:
        """Do the checks that wait for a pause."""
        for path, handle in list(self._waiting.items()):
            handle.cancel()
            self._check(path)

    def _check(self, path: str) -> None:
        self._waiting.pop(path, None)
        self.project.check(path)
        self._publish()

    def _publish(self) -> None:
        """Send what was found, file by file, and an empty list for each file that is not concerned any more."""
        findings = self.project.findings()
        for path in sorted(self._published - findings.keys()):
            self._send(path, [])
        for path, found in findings.items():
            self._send(path, found)
        self._published = set(findings)

    def _send(self, path: str, found: list[Diagnostic]) -> None:
        items = [self.diagnostic(d, path) for d in found]
        self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(_uri(path), items))

    # ---- places --------------------------------------------------------------------------------------------

    def positions(self, path: str) -> Positions:
        """The places of a file, as the editor has it or as it is on the disk."""
        return Positions(self.text(path), self.workspace.position_codec.client_num_units)

    def text(self, path: str) -> str:
        """The text of a file, as the editor has it or as the deck that it belongs to was read."""
        real = os.path.realpath(path)
        if real in self.project.texts:
            return self.project.texts[real]
        document = self.project.document_of(real)
        files = document.files if document is not None else []
        return next((file.text for file in files if os.path.realpath(file.name) == real), "")

    def range_of(self, positions: Positions, start: int, end: int) -> types.Range:
        """The characters ``start:end`` of a file."""
        return types.Range(
            types.Position(*positions.position(start)), types.Position(*positions.position(end))
        )

    def marked(self, at: Location, positions: Positions) -> types.Range:
        """What a location marks."""
        start = positions.of_column(at.line, at.column)
        return self.range_of(positions, start, start + at.length)

    def spot(self, uri: str, position: types.Position) -> tuple[Spot, tuple[OpenTag, ...], Positions]:
        """What stands at a place of an open file, and the tags around it from the root of the deck on."""
        path = _path(uri)
        positions = self.positions(path)
        spot = spot_at(positions.text, positions.offset(position.line, position.character))
        return spot, self.project.path_of(path, spot.parents), positions

    # ---- conversion ----------------------------------------------------------------------------------------

    def diagnostic(self, found: Diagnostic, path: str) -> types.Diagnostic:
        """A finding as editors take it."""
        message = f"{found.message}\n{found.suggestion}" if found.suggestion else found.message
        return types.Diagnostic(
            range=self.marked(place(found, path), self.positions(path)),
            message=message,
            severity=_SEVERITIES[found.severity],
            code=found.code,
            source="ups",
            tags=[_TAGS[found.code]] if found.code in _TAGS else None,
        )

    def workspace_edit(self, edits: tuple[Edit, ...]) -> types.WorkspaceEdit:
        """The edits of a repair, by file."""
        changes: dict[str, list[types.TextEdit]] = {}
        for edit in edits:
            area = self.range_of(self.positions(edit.file), edit.start, edit.end)
            changes.setdefault(_uri(edit.file), []).append(types.TextEdit(area, edit.replacement))
        return types.WorkspaceEdit(changes=changes)

    def item(self, proposal: Proposal, positions: Positions, snippets: bool) -> types.CompletionItem:
        """A proposal as editors take it: what must be there first, what this program does not run last."""
        plain = _STOP.sub("", proposal.snippet)
        edit = types.TextEdit(
            self.range_of(positions, proposal.start, proposal.end), proposal.snippet if snippets else plain
        )
        order = 0 if proposal.missing else 1 if proposal.runs else 2
        detail = proposal.detail if proposal.runs else f"{proposal.detail} (known, not supported by ups run)"
        about = proposal.about() if proposal.about is not None else ""
        return types.CompletionItem(
            label=proposal.label,
            kind=_KINDS[proposal.sort],
            detail=detail,
            documentation=types.MarkupContent(types.MarkupKind.Markdown, f"```text\n{about}\n```")
            if about
            else None,
            sort_text=f"{order}{proposal.label}",
            filter_text=proposal.label,
            text_edit=edit,
            insert_text_format=types.InsertTextFormat.Snippet
            if snippets
            else types.InsertTextFormat.PlainText,
        )

    # ---- repairs -------------------------------------------------------------------------------------------

    def actions(self, uri: str, area: types.Range) -> Iterator[types.CodeAction]:
        """The repairs of what was found in a part of a file, and of all of it."""
        path = os.path.realpath(_path(uri))
        positions = self.positions(path)
        first = positions.offset(area.start.line, area.start.character)
        last = positions.offset(area.end.line, area.end.character)
        found = self.project.findings().get(path, [])
        for diagnostic in found:
            at = place(diagnostic, path)
            start = positions.of_column(at.line, at.column)
            if start <= last and first <= start + at.length:
                yield from self._actions_for(diagnostic, at, positions, path)
        texts, count = repaired(
            found, {path: positions.text, **_under_other_names(found, path, positions.text)}
        )
        if count:
            text = next(iter(texts.values()))
            whole = types.TextEdit(self.range_of(positions, 0, len(positions.text)), text)
            yield types.CodeAction(
                f"Do all {count} safe repairs", FIX_ALL, edit=types.WorkspaceEdit(changes={uri: [whole]})
            )

    def _actions_for(
        self, found: Diagnostic, at: Location, positions: Positions, path: str
    ) -> Iterator[types.CodeAction]:
        shown = [self.diagnostic(found, path)]
        fix = found.fix
        if fix is not None and not any(is_own_data(edit.file) for edit in fix.edits):
            title = (found.suggestion or f"repair {found.code}").removeprefix("did you mean ").rstrip("?")
            if found.suggestion and found.suggestion.startswith("did you mean "):
                title = f"write {title}"
            edit = self.workspace_edit(fix.edits)
            yield types.CodeAction(
                title[:1].upper() + title[1:], types.CodeActionKind.QuickFix, shown, fix.safe, edit=edit
            )
        end = positions.end_of_line(at.line - 1)
        if found.severity is not Severity.ERROR and spot_at(positions.text, end).kind is Kind.TEXT:
            comment = types.TextEdit(
                self.range_of(positions, end, end), f" <!-- ups: ignore {found.code} -->"
            )
            edit = types.WorkspaceEdit(changes={_uri(path): [comment]})
            yield types.CodeAction(
                f"Keep {found.code} quiet on this line", types.CodeActionKind.QuickFix, shown, edit=edit
            )


def create_server() -> DeckServer:
    """The server with its features."""
    server = DeckServer()

    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    def did_open(ls: DeckServer, params: types.DidOpenTextDocumentParams) -> None:
        ls.changed(params.text_document.uri, pause=0.0)

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    def did_change(ls: DeckServer, params: types.DidChangeTextDocumentParams) -> None:
        ls.changed(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_SAVE)
    def did_save(ls: DeckServer, params: types.DidSaveTextDocumentParams) -> None:
        ls.changed(params.text_document.uri, pause=0.0)

    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    def did_close(ls: DeckServer, params: types.DidCloseTextDocumentParams) -> None:
        ls.closed(params.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_HOVER)
    def hover(ls: DeckServer, params: types.HoverParams) -> types.Hover | None:
        uri = params.text_document.uri
        spot, path, positions = ls.spot(uri, params.position)
        found = explanation(spot, path, positions.text, ls.project.component_of(_path(uri)))
        if found is None:
            return None
        area = ls.range_of(positions, found.start, found.end)
        return types.Hover(types.MarkupContent(types.MarkupKind.Markdown, found.text), area)

    @server.feature(
        types.TEXT_DOCUMENT_COMPLETION,
        types.CompletionOptions(trigger_characters=["<", "/", '"', "'", " ", ">"]),
    )
    def completion(ls: DeckServer, params: types.CompletionParams) -> types.CompletionList:
        uri = params.text_document.uri
        spot, path, positions = ls.spot(uri, params.position)
        snippets = _takes_snippets(ls.client_capabilities)
        component = ls.project.component_of(_path(uri))
        found = proposals(spot, path, positions.text, component, Path(_path(uri)))
        return types.CompletionList(False, [ls.item(p, positions, snippets) for p in found])

    @server.feature(types.TEXT_DOCUMENT_DEFINITION)
    def go_to_definition(ls: DeckServer, params: types.DefinitionParams) -> types.Location | None:
        path = _path(params.text_document.uri)
        spot, _, _ = ls.spot(params.text_document.uri, params.position)
        found = definition(spot, Path(path), ls.project.document_of(path))
        if found is None:
            return None
        return types.Location(_uri(found.file), ls.marked(found, ls.positions(found.file)))

    @server.feature(
        types.TEXT_DOCUMENT_CODE_ACTION, types.CodeActionOptions([types.CodeActionKind.QuickFix, FIX_ALL])
    )
    def code_action(ls: DeckServer, params: types.CodeActionParams) -> list[types.CodeAction]:
        ls.settle()
        wanted = tuple(map(_kind, params.context.only or ("",)))
        actions = ls.actions(params.text_document.uri, params.range)
        return [action for action in actions if _kind(action.kind).startswith(wanted)]

    return server


def serve() -> None:
    """Talk to an editor over the standard input and output until it leaves."""
    create_server().start_io()


def _under_other_names(found: list[Diagnostic], path: str, text: str) -> dict[str, str]:
    """The text of a file under the names that the edits of findings give it."""
    names = {edit.file for d in found if d.fix is not None for edit in d.fix.edits}
    return {name: text for name in names if os.path.realpath(name) == path}


def _kind(kind: types.CodeActionKind | str | None) -> str:
    """The name of a kind of action."""
    return kind.value if isinstance(kind, types.CodeActionKind) else kind or ""


def _takes_snippets(capabilities: types.ClientCapabilities) -> bool:
    completion = capabilities.text_document.completion if capabilities.text_document else None
    item = completion.completion_item if completion else None
    return bool(item and item.snippet_support)


def _path(uri: str) -> str:
    """The path of a file that an editor names; a text that was never saved has its name instead."""
    return to_fs_path(uri) or uri


def _uri(path: str) -> str:
    return from_fs_path(os.path.realpath(path)) or path


def _version() -> str:
    try:
        return version("ups-mpm")
    except PackageNotFoundError:
        return "0"
