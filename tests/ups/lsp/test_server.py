"""The language server as an editor sees it: a client that talks to it over standard in and out."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

pytest.importorskip("pygls")

from lsprotocol import types
from pygls.lsp.client import LanguageClient
from small_decks import LEFT, deck

ROOT = Path(__file__).resolve().parents[3]
SOON = 20.0

Session = Callable[["Editor"], Awaitable[None]]


class Editor:
    """An editor: a client that remembers what the server published last, by file."""

    def __init__(self) -> None:
        self.client = LanguageClient("editor", "1")
        self.published: dict[str, list[types.Diagnostic]] = {}
        self.news = asyncio.Event()
        self.versions: dict[Path, int] = {}

        @self.client.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def publish(params: types.PublishDiagnosticsParams) -> None:
            self.published[params.uri] = list(params.diagnostics)
            self.news.set()

    async def start(self, snippets: bool = True) -> types.InitializeResult:
        await self.client.start_io(sys.executable, "-c", "import cli; cli.main(['lsp'])", cwd=ROOT)
        item = types.ClientCompletionItemOptions(snippet_support=snippets)
        completion = types.CompletionClientCapabilities(completion_item=item)
        capabilities = types.ClientCapabilities(
            text_document=types.TextDocumentClientCapabilities(completion=completion)
        )
        result = await self.client.initialize_async(types.InitializeParams(capabilities=capabilities))
        self.client.initialized(types.InitializedParams())
        return result

    async def stop(self) -> None:
        await self.client.shutdown_async(None)
        self.client.exit(None)
        await self.client.stop()

    def open(self, path: Path, text: str) -> None:
        self.versions[path] = 1
        item = types.TextDocumentItem(path.as_uri(), "xml", 1, text)
        self.client.text_document_did_open(types.DidOpenTextDocumentParams(item))

    def type(self, path: Path, text: str) -> None:
        self.versions[path] += 1
        document = types.VersionedTextDocumentIdentifier(self.versions[path], path.as_uri())
        change = types.TextDocumentContentChangeWholeDocument(text)
        self.client.text_document_did_change(types.DidChangeTextDocumentParams(document, [change]))

    def close(self, path: Path) -> None:
        document = types.TextDocumentIdentifier(path.as_uri())
        self.client.text_document_did_close(types.DidCloseTextDocumentParams(document))

    async def sees(self, path: Path, codes: list[str]) -> list[types.Diagnostic]:
        """Wait until exactly these codes are published for a file."""

        def seen() -> bool:
            found = self.published.get(path.as_uri())
            return found is not None and [d.code for d in found] == codes

        async def wait() -> None:
            while not seen():
                await self.news.wait()
                self.news.clear()

        try:
            await asyncio.wait_for(wait(), SOON)
        except TimeoutError:
            pytest.fail(f"{path.name}: {self.published.get(path.as_uri())} instead of {codes}")
        return self.published[path.as_uri()]


def edit(session: Session, **options: bool) -> None:
    """Start a server, do something with it as an editor, and stop it."""

    async def do() -> None:
        editor = Editor()
        await editor.start(**options)
        try:
            await session(editor)
        finally:
            await editor.stop()

    asyncio.run(do())


def place(text: str, part: str, into: int = 1) -> types.Position:
    """The place a few characters into a part of a text, in UTF-16 code units."""
    before = text[: text.index(part) + into]
    line = before.rpartition("\n")[2]
    return types.Position(before.count("\n"), len(line.encode("utf-16-le")) // 2)


def applied(text: str, changes: list[types.TextEdit]) -> str:
    """A text with edits done."""
    lines = text.splitlines(keepends=True)

    def offset(at: types.Position) -> int:
        return sum(map(len, lines[: at.line])) + at.character

    for change in sorted(changes, key=lambda c: offset(c.range.start), reverse=True):
        start, end = offset(change.range.start), offset(change.range.end)
        text = text[:start] + change.new_text + text[end:]
    return text


def test_findings_follow_what_is_typed_and_not_what_is_saved(tmp_path):
    path = tmp_path / "deck.ups"
    path.write_text(deck())
    wrong = deck(materials=LEFT.replace("density>", "densty>"))

    async def session(editor: Editor) -> None:
        editor.open(path, deck())
        await editor.sees(path, [])
        editor.type(path, wrong)
        (found,) = await editor.sees(path, ["UPS102"])
        assert found.severity == types.DiagnosticSeverity.Error
        assert found.range.start == place(wrong, "<densty>")
        assert "did you mean <density>?" in found.message
        editor.type(path, deck())
        await editor.sees(path, [])
        editor.type(path, wrong)
        await editor.sees(path, ["UPS102"])
        editor.close(path)
        await editor.sees(path, [])

    edit(session)
    assert path.read_text() == deck()


def test_a_finding_is_shown_in_the_included_file_that_holds_the_cause(tmp_path):
    deck_path, included = tmp_path / "deck.ups", tmp_path / "box.xml"
    good = "<Uintah_Include>\n  <velocity>[1,0,0]</velocity>\n</Uintah_Include>\n"
    included.write_text(good)
    text = deck().replace("<velocity>[20.0,3.0,0.0]</velocity>", '<include href="box.xml"/>')

    async def session(editor: Editor) -> None:
        editor.open(deck_path, text)
        await editor.sees(deck_path, [])
        await editor.sees(included, [])
        editor.open(included, good.replace("[1,0,0]", "[1,0]"))
        (found,) = await editor.sees(included, ["UPS207"])
        assert found.range.start.line == 1
        assert editor.published[deck_path.as_uri()] == []
        at = place(text, "box.xml")
        params = types.DefinitionParams(types.TextDocumentIdentifier(deck_path.as_uri()), at)
        target = await editor.client.text_document_definition_async(params)
        assert target.uri == included.as_uri()
        # the tags around the include say what may stand in the file
        before = good.replace("<velocity>", "<|<velocity>")
        editor.type(included, before.replace("|", ""))
        items = await completion(editor, included, place(before, "|", 0))
        assert "temperature" in items

    deck_path.write_text(text)
    edit(session)


def test_a_file_that_no_deck_includes_is_checked_for_its_form(tmp_path):
    path = tmp_path / "alone.xml"

    async def session(editor: Editor) -> None:
        editor.open(path, "<Uintah_Include><density>1</densty></Uintah_Include>")
        await editor.sees(path, ["UPS003"])
        editor.type(path, "<Uintah_Include><density>1</density></Uintah_Include>")
        await editor.sees(path, [])

    edit(session)


async def completion(editor: Editor, path: Path, at: types.Position) -> dict[str, types.CompletionItem]:
    params = types.CompletionParams(types.TextDocumentIdentifier(path.as_uri()), at)
    found = await editor.client.text_document_completion_async(params)
    return {item.label: item for item in found.items}


def test_completion_and_hover(tmp_path):
    path = tmp_path / "deck.ups"
    text = deck().replace("<title>two blocks", "<title>\U0001f600é", 1)

    async def session(editor: Editor) -> None:
        editor.open(path, text)
        await editor.sees(path, [])
        items = await completion(editor, path, place(text, "linear<"))
        edits = items["gimp"].text_edit
        assert isinstance(edits, types.TextEdit)
        assert "<interpolator>gimp</interpolator>" in applied(text, [edits])
        typed = text.replace("<density>", "<\n<density>", 1)
        editor.type(path, typed)
        items = await completion(editor, path, place(typed, "<\n<density>"))
        assert "$1" in items["damage_model"].text_edit.new_text
        params = types.HoverParams(types.TextDocumentIdentifier(path.as_uri()), place(typed, "specific_heat"))
        found = await editor.client.text_document_hover_async(params)
        assert "J/(kg K)" in found.contents.value

    edit(session)


def test_an_editor_without_snippets_gets_plain_text(tmp_path):
    path = tmp_path / "deck.ups"
    text = deck().replace("<density>", "<\n<density>", 1)

    async def session(editor: Editor) -> None:
        editor.open(path, text)
        items = await completion(editor, path, place(text, "<\n<density>"))
        assert "$" not in items["damage_model"].text_edit.new_text

    edit(session, snippets=False)


def test_repairs_are_offered_and_do_what_they_say(tmp_path):
    path = tmp_path / "deck.ups"
    line = "\n    <UseMomentumForm>true</UseMomentumForm>"
    wrong = deck(flags=line).replace("<interpolator>linear", "<interpolator>linxar")

    async def actions(editor: Editor, part: str, *only: str) -> dict[str, types.CodeAction]:
        at = types.Range(place(wrong, part), place(wrong, part))
        context = types.CodeActionContext([], only=list(only) or None)
        params = types.CodeActionParams(types.TextDocumentIdentifier(path.as_uri()), at, context)
        return {a.title: a for a in await editor.client.text_document_code_action_async(params) or []}

    async def session(editor: Editor) -> None:
        editor.open(path, wrong)
        found = await actions(editor, "linxar", "quickfix")
        (repair,) = found.values()
        assert repair.title == "Write linear"
        assert not repair.is_preferred
        assert applied(wrong, repair.edit.changes[path.as_uri()]) == deck(flags=line)
        found = await actions(editor, "UseMomentum")
        assert set(found) == {"Remove it", "Keep UPS304 quiet on this line", "Do all 1 safe repairs"}
        right = wrong.replace(line, "")
        assert applied(wrong, found["Remove it"].edit.changes[path.as_uri()]) == right
        assert applied(wrong, found["Do all 1 safe repairs"].edit.changes[path.as_uri()]) == right
        quiet = applied(wrong, found["Keep UPS304 quiet on this line"].edit.changes[path.as_uri()])
        editor.type(path, quiet)
        await editor.sees(path, ["UPS209"])

    edit(session)


def test_half_typed_decks_never_stop_the_server(tmp_path):
    path = tmp_path / "deck.ups"
    text = deck()

    async def session(editor: Editor) -> None:
        editor.open(path, "")
        for end in range(0, len(text), 97):
            editor.type(path, text[:end])
            await completion(editor, path, place(text, text[: max(end, 1)], end))
        editor.type(path, text)
        await editor.sees(path, [])

    edit(session)


def test_without_pygls_the_command_says_what_to_install():
    from click.testing import CliRunner

    import cli

    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "pygls", None)
        result = CliRunner().invoke(cli.main, ["lsp"])
    assert result.exit_code == 1
    assert "pip install" in result.output
