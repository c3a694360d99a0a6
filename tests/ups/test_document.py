"""Reading decks: trees, exact positions, includes, broken and hostile input."""

import re
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

import ups.document
from ups.diagnostics import Location, apply_fixes
from ups.document import Comment, Document, Element, locate_include, read_document
from ups.source import SourceFile
from ups.xml_parser import MAX_DEPTH

CORPUS = Path(__file__).resolve().parents[3] / "shared" / "corpus"
needs_corpus = pytest.mark.skipif(not CORPUS.is_dir(), reason="the corpus of decks is not here")

DECK = """<?xml version="1.0" encoding="ISO-8859-1"?>
<!-- a deck -->
<Uintah_specification>
  <Meta><title>Pipe</title></Meta> <!-- behind -->
  <Time>
    <!-- before -->
    <maxTime>  1.0e-3 </maxTime>
    <delt_min>
      0.0 <!-- seconds -->
    </delt_min>
  </Time>
  <MPM type = "explicit"
       label='a &amp; "b"'/>
  <Grid><Level><Box label="1"/><Box label="2"><lower>[0, 0, 0]</lower></Box></Level></Grid>
</Uintah_specification>
<!-- the end -->
"""


def corpus_decks() -> list[str]:
    if not CORPUS.is_dir():
        return []
    return (CORPUS / "accepted.txt").read_text().split() + (CORPUS / "accepted_ice.txt").read_text().split()


def wrapped(body: str) -> str:
    return f"<Uintah_specification>\n{body}\n</Uintah_specification>\n"


def codes(document: Document) -> list[str]:
    return [item.code for item in document.diagnostics]


def only(document: Document):
    """The one diagnostic of a document."""
    (item,) = document.diagnostics
    return item


def marked(document: Document) -> list[str]:
    """The characters that each diagnostic marks."""
    return [at_location(document.sources, item.location) for item in document.diagnostics]


def at_location(sources: dict[str, str], at: Location) -> str:
    line = re.split(r"\r\n|\r|\n", sources[at.file])[at.line - 1]
    return line[at.column - 1 : at.column - 1 + at.length]


def assert_positions(document: Document) -> None:
    """Every tag, attribute and text stands where its location says."""
    assert document.root is not None
    sources = document.sources
    for element in document.root.iter():
        source = element.source.text
        assert at_location(sources, element.location) == element.tag
        assert source[element.start :].startswith(f"<{element.tag}")
        assert source[element.open_end - 1] == source[element.end - 1] == ">"
        if element.close_start < element.end:
            assert source[element.close_start :].startswith(f"</{element.tag}")
        for name, attribute in element.attributes.items():
            assert at_location(sources, attribute.name_location) == attribute.name == name
            raw = source[attribute.start : attribute.end]
            assert unescaped(raw) == attribute.value
            if raw and "\n" not in raw:
                assert at_location(sources, attribute.location) == raw
        for text in element.texts:
            raw = source[text.start : text.end]
            assert unescaped(raw) == text.value
            assert at_location(sources, text.location) == re.split(r"[\r\n]", raw)[0]


def unescaped(raw: str) -> str:
    """The text that a piece of XML source stands for, by lxml."""
    return etree.fromstring(f"<a>{raw}</a>".encode()).text or ""


def outline(element: Element) -> tuple:
    attributes = {name: attribute.value for name, attribute in element.attributes.items()}
    return element.tag, attributes, element.text, [outline(child) for child in element.children]


def lxml_outline(element: etree._Element) -> tuple:
    texts = [element.text, *(node.tail for node in element)]
    text = " ".join(piece.strip() for piece in texts if piece and piece.strip())
    children = [lxml_outline(node) for node in element if isinstance(node.tag, str)]
    return element.tag, dict(element.attrib), text, children


# ------------------------------------------------------------------------------------------- the tree


def test_tree_of_a_deck():
    document = read_document("pipe.ups", text=DECK)
    root = document.root
    assert not document.diagnostics
    assert document.complete
    assert [child.tag for child in root.children] == ["Meta", "Time", "MPM", "Grid"]
    assert root.find("Time/maxTime").text == "1.0e-3"
    assert root.find("Time/delt_min").text == "0.0"
    assert root.find("Time/nothing") is None
    assert root.get("MPM").attributes["label"].value == 'a & "b"'
    assert root.get("MPM").text == ""
    lower = root.find("Grid/Level/Box/lower")
    assert lower.text == "[0, 0, 0]"
    assert lower.path == "Uintah_specification/Grid/Level/Box/lower"
    assert [ancestor.tag for ancestor in lower.ancestors()] == ["Box", "Level", "Grid", root.tag]
    assert len(root.find("Grid/Level").all("Box")) == 2
    assert root.parent is None


def test_positions_of_a_deck():
    root = read_document("pipe.ups", text=DECK).root
    assert root.find("Time/maxTime").location == Location("pipe.ups", 7, 6, 7)
    assert root.find("Time/maxTime").text_location == Location("pipe.ups", 7, 16, 6)
    assert root.find("Time/delt_min").text_location == Location("pipe.ups", 9, 7, 3)
    assert root.get("MPM").attributes["type"].location == Location("pipe.ups", 12, 16, 8)
    assert root.get("MPM").attributes["label"].name_location == Location("pipe.ups", 13, 8, 5)
    assert root.get("Time").text_location == root.get("Time").location
    assert_positions(read_document("pipe.ups", text=DECK))


def test_comments_split_a_text():
    root = read_document("d", text=wrapped("<a>1 <!-- x --> 2</a><b><c/> left <c/> right </b>")).root
    assert [text.value for text in root.get("a").texts] == ["1", "2"]
    assert root.get("a").text == "1 2"
    assert [text.value for text in root.get("b").texts] == ["left", "right"]


def test_cdata_and_processing_instructions():
    body = "<a><![CDATA[ x < y & z ]]></a><b>1<?note <c> ?></b>"
    document = read_document("d", text=wrapped(body))
    assert not document.diagnostics
    assert document.root.get("a").text == "x < y & z"
    assert document.root.get("a").text_location.column == body.index("x") + 1
    assert document.root.get("b").text == "1"


names = st.text("aBé_", min_size=1, max_size=3)
values = st.text("ab 1.é€\U0001f600\n&<>\"'[],", max_size=12)


@st.composite
def elements(draw, depth=0):
    tag = draw(names)
    attributes = draw(st.dictionaries(names, values, max_size=2))
    quote = draw(st.sampled_from("\"'"))
    entity = {'"': "&quot;", "'": "&#39;"}[quote]
    opening = tag + "".join(
        f"\n {name} = {quote}{escaped(value).replace(quote, entity)}{quote}"
        for name, value in attributes.items()
    )
    pieces = []
    if depth < 3:
        pieces = draw(st.lists(st.one_of(elements(depth + 1), values.map(escaped), comments), max_size=4))
    return f"<{opening}/>" if not pieces else f"<{opening} >{''.join(pieces)}</{tag} >"


def escaped(value: str) -> str:
    return value.replace("&", "&amp;").replace("<", "&#x3C;").replace(">", "&gt;")


comments = st.sampled_from(
    ["<!---->", "<!-- <a b='&'> -->", "<?pi </a> ?>", "<![CDATA[ </x> é ]]>", "\r\n", "\t"]
)


@settings(max_examples=80, deadline=None)
@given(st.lists(elements(), max_size=4).map("\n".join))
def test_any_tree_is_read_as_lxml_reads_it_with_every_position(body):
    text = wrapped(body)
    document = read_document("d", text=text)
    assert not document.diagnostics
    # lxml joins a text around a comment only by its tails; the blanks between pieces do not matter here
    expected = lxml_outline(etree.fromstring(text.encode()))
    assert without_blanks(outline(document.root)) == without_blanks(expected)
    sources = document.sources
    for element in document.root.iter():
        assert at_location(sources, element.location) == element.tag
        for attribute in element.attributes.values():
            assert at_location(sources, attribute.name_location) == attribute.name
            assert element.source.text[attribute.start - 1] == element.source.text[attribute.end]
        for piece in element.texts:
            begins = element.source.text[piece.start]
            assert begins == piece.value[0] or begins == "&"


def without_blanks(tree: tuple) -> tuple:
    tag, attributes, text, children = tree
    return tag, attributes, re.sub(r"\s", "", text), [without_blanks(child) for child in children]


@needs_corpus
@pytest.mark.parametrize("name", corpus_decks())
def test_decks_of_the_corpus(name, monkeypatch):
    monkeypatch.chdir(CORPUS)
    path = Path("inputs") / name
    document = read_document(path)
    assert not document.diagnostics
    assert document.complete
    if path.stat().st_size < 60_000:
        assert_positions(document)
    if not document.includes:
        assert outline(document.root) == lxml_outline(etree.parse(path).getroot())
    again = read_document("input.xml", text=document.to_xml())
    assert outline(again.root) == outline(document.root)


@needs_corpus
def test_a_typical_deck_is_read_fast(monkeypatch):
    monkeypatch.chdir(CORPUS)
    best = min(elapsed(lambda: read_document("inputs/MPM/taylorImpact.ups")) for _ in range(5))
    assert best < 0.02


def elapsed(action) -> float:
    begin = time.perf_counter()
    action()
    return time.perf_counter() - begin


# -------------------------------------------------------------------------------------------- writing


def test_to_xml_keeps_everything_and_its_comments():
    document = read_document("pipe.ups", text=DECK)
    assert document.to_xml() == (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        "<!-- a deck -->\n"
        "<Uintah_specification>\n"
        "  <Meta>\n"
        "    <title>Pipe</title>\n"
        "  </Meta> <!-- behind -->\n"
        "  <Time>\n"
        "    <!-- before -->\n"
        "    <maxTime>1.0e-3</maxTime>\n"
        "    <delt_min>0.0 <!-- seconds --></delt_min>\n"
        "  </Time>\n"
        '  <MPM type="explicit" label="a &amp; &quot;b&quot;"/>\n'
        "  <Grid>\n"
        "    <Level>\n"
        '      <Box label="1"/>\n'
        '      <Box label="2">\n'
        "        <lower>[0, 0, 0]</lower>\n"
        "      </Box>\n"
        "    </Level>\n"
        "  </Grid>\n"
        "</Uintah_specification>\n"
        "<!-- the end -->\n"
    )


def test_edits_rename_replace_and_remove():
    text = wrapped("  <old a='1' b='2'>5</old>\n  <gone>x</gone>\n  <c/><empty/>")
    root = read_document("d", text=text).root
    old = root.get("old")
    edits = [
        *old.renamed("new"),
        old.texts[0].replaced("< 6"),
        old.attributes["a"].replaced("'"),
        old.attributes["b"].removed(),
        root.get("gone").removed(),
        root.get("empty").removed(),
        *root.get("c").renamed("d"),
    ]
    for edit in sorted(edits, key=lambda edit: -edit.start):
        text = text[: edit.start] + edit.replacement + text[edit.end :]
    assert text == wrapped("  <new a='&apos;'>&lt; 6</new>\n  <d/>")


def test_an_edit_of_an_attribute_name_and_of_a_whole_element():
    text = wrapped("<save lable='p.x'/>")
    save = read_document("d", text=text).root.get("save")
    rename = save.attributes["lable"].renamed("label")
    assert text[: rename.start] + rename.replacement + text[rename.end :] == wrapped("<save label='p.x'/>")
    whole = save.replaced("<load/>")
    assert text[: whole.start] + whole.replacement + text[whole.end :] == wrapped("<load/>")


# ------------------------------------------------------------------------------------------ encodings


@pytest.mark.parametrize(
    ("encoding", "declared"),
    [
        ("utf-8", ""),
        ("utf-8-sig", ""),
        ("utf-8-sig", "UTF-8"),
        ("utf-8", "utf-8"),
        ("latin-1", "ISO-8859-1"),
        ("latin-1", "iso-8859-1"),
        ("cp1252", "windows-1252"),
        ("utf-16", "UTF-16"),
        ("utf-16", ""),
        ("utf-16-le", "UTF-16LE"),
        ("utf-16-be", ""),
        ("ascii", "UTF-16"),
    ],
)
def test_encodings(tmp_path, encoding, declared):
    word = "plain" if encoding == "ascii" else "Größe"
    declaration = f'<?xml version="1.0" encoding="{declared}"?>\n' if declared else ""
    text = declaration + wrapped(f"<title>{word} x</title><{word}>1</{word}>")
    path = tmp_path / "deck.ups"
    path.write_bytes(text.encode(encoding))
    document = read_document(path)
    assert not document.diagnostics
    assert document.root.get("title").text == f"{word} x"
    assert_positions(document)
    (file,) = document.files
    assert file.encode(file.text) == path.read_bytes()


def test_bytes_that_do_not_fit_the_encoding_are_shown(tmp_path):
    path = tmp_path / "deck.ups"
    path.write_bytes(wrapped("<a>1</a>\n<b>2 \xb0C</b>").encode("latin-1"))
    document = read_document(path)
    found = only(document)
    assert (found.code, found.location.line, found.location.column) == ("UPS004", 3, 6)
    assert "0xB0" in found.message
    assert document.root.get("a").text == "1"


def test_unknown_encoding(tmp_path):
    path = tmp_path / "deck.ups"
    path.write_bytes(b'<?xml version="1.0" encoding="klingon"?>\n' + wrapped("<a/>").encode())
    document = read_document(path)
    assert codes(document) == ["UPS004"]
    assert marked(document) == ["klingon"]


def test_characters_that_the_encoding_lacks_are_written_as_references():
    assert SourceFile("d", "", "latin-1").encode("é €") == b"\xe9 &#8364;"


def test_nul_bytes(tmp_path):
    path = tmp_path / "deck.ups"
    path.write_bytes(wrapped("<a>\0</a>").encode())
    document = read_document(path)
    assert codes(document) == ["UPS005"]
    assert document.root is None
    assert not document.complete


def test_other_control_characters_are_reported_and_read_over():
    document = read_document("d", text=wrapped("<a>1\x0c</a>"))
    assert codes(document) == ["UPS005"]
    assert "U+000C" in only(document).message
    assert document.root.get("a").text == "1"


@settings(max_examples=200, deadline=None)
@given(st.one_of(st.binary(max_size=60), st.text("<>/ab='\"&;!-[]?x \n", max_size=40).map(str.encode)))
def test_no_input_is_a_traceback(tmp_path_factory, data):
    path = tmp_path_factory.getbasetemp() / "fuzzed.ups"
    path.write_bytes(data)
    document = read_document(path)
    try:
        root = etree.fromstring(data, etree.XMLParser(resolve_entities=False, no_network=True))
    except etree.XMLSyntaxError:
        assert document.diagnostics.has_errors
    else:
        assert document.diagnostics or root.tag == "Uintah_specification"
    for item in document.diagnostics:
        assert item.location.line >= 1
        assert item.location.column >= 1


# ------------------------------------------------------------------------------------------ broken XML


@pytest.mark.parametrize(
    ("body", "code", "line", "mark", "words"),
    [
        ("<m>\n<density>7\n<cp>4</cp>\n</m>", "UPS003", 3, "density", "never closed: </m> on line 5"),
        ("<G>\n <B>\n  <lo>1</lo>\n</G>", "UPS003", 3, "B", "never closed: </G> on line 5"),
        ("<density>7</densty>", "UPS003", 2, "densty", "does not match <density>, opened on line 2"),
        ("<lower>7</upper>", "UPS003", 2, "upper", "does not match <lower>"),
        ("<a>\n</b>\n</a>", "UPS003", 3, "b", "without an opening tag"),
        ("<a>1<a/>", "UPS003", 2, "a", "never closed"),
        ("<a>x & y</a>", "UPS002", 2, "&", "bare &"),
        ("<a>1 < 2</a>", "UPS002", 2, "<", "bare <"),
        ("<a>1 &nbsp; 2</a>", "UPS002", 2, "&nbsp;", "&nbsp; is not defined"),
        ("<a b='x & y'/>", "UPS002", 2, "&", "bare & in the value of attribute b"),
        ("<a type=mpm/>", "UPS002", 2, "mpm/", "must stand in straight quotes"),
        ("<a b=“x”/>", "UPS002", 2, "“x”/", "must stand in straight quotes"),
        ('<s l="p.x/>\n<s l="p.v"/>', "UPS002", 2, '"', "no closing quote"),
        ("<s l='p.x/>", "UPS002", 2, "'p.x/", "no closing quote"),
        ("<a type/>", "UPS002", 2, "type", "has no value"),
        ("<a t='1' t='2'/>", "UPS002", 2, "t", "given twice"),
        ("<a\n<b/>", "UPS002", 2, "a", "does not end with >"),
        ("< a>2</a>", "UPS002", 2, "< a", "blank between <"),
        ("<!-- a -- b -->", "UPS002", 2, "--", "two hyphens"),
        ("<a/>\n<!-- a", "UPS002", 3, "<", "comment <!-- that begins here does not end"),
        ("<a>1</>", "UPS002", 2, "</", "closing tag without a name"),
        ("<<a>1</a>", "UPS002", 2, "<<", "two < in a row"),
        ("<a> ]]> </a>", "UPS002", 2, "]]>", "not allowed"),
    ],
)
def test_broken_xml_is_explained_where_it_is(body, code, line, mark, words):
    document = read_document("d", text=wrapped(body))
    found = only(document)
    assert (found.code, found.location.line) == (code, line)
    assert marked(document) == [mark]
    assert words in found.message


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no XML element"),
        (" \n ", "no XML element"),
        ("not XML", "does not begin with a tag"),
        ("</a>", "without an opening tag"),
        (wrapped("<a/>") + "<b/>", "nothing may follow"),
        ("\n<?xml version='1.0'?>\n" + wrapped("<a/>"), "very first characters"),
        ("<Uintah_specification>\n<a>1</a>\n", "never closed: the file ends first"),
    ],
)
def test_broken_ends(text, words):
    assert words in only(read_document("d", text=text)).message


def test_reading_goes_on_after_a_tag_that_is_not_closed():
    text = wrapped("<m>\n <density>7\n <cp>4</cp>\n</m>\n<Time>\n <a>1</b>\n</Time>\n<Grid>x & y</Grid>")
    document = read_document("d", text=text)
    assert [(item.code, item.location.line) for item in document.diagnostics] == [
        ("UPS003", 3),
        ("UPS003", 7),
        ("UPS002", 9),
    ]
    assert document.complete
    root = document.root
    assert [child.tag for child in root.get("m").children] == ["density", "cp"]
    assert root.find("m/density").text == "7"
    assert root.find("Time/a").text == "1"
    assert root.get("Grid").text == "x & y"
    assert all(child.parent is parent for parent in root.iter() for child in parent.children)


def test_elements_indented_like_an_unclosed_one_are_its_siblings():
    document = read_document("d", text=wrapped("  <Time>\n    <maxTime>1</maxTime>\n  <Grid>\n  </Grid>"))
    assert [child.tag for child in document.root.children] == ["Time", "Grid"]


@pytest.mark.parametrize("body", ["<m>\n<density>7\n<cp>4</cp>\n</m>", "<a>x & y < 2 &z</a>"])
def test_fixes_of_broken_xml_make_it_well_formed(body):
    document = read_document("d", text=wrapped(body))
    fixed, _ = apply_fixes(document.diagnostics, document.sources)
    again = read_document("d", text=fixed["d"])
    assert not again.diagnostics
    assert outline(again.root) == outline(document.root)


def test_a_truncated_deck_is_not_complete():
    for end in range(len("<Uintah_specification>"), DECK.index("</Uintah_specification>"), 7):
        document = read_document("d", text=DECK[:end])
        assert document.diagnostics.has_errors
    assert not read_document("d", text=DECK[: DECK.index("</Time>")]).complete


def test_line_ends_of_every_system():
    for end in ("\n", "\r\n", "\r"):
        document = read_document("d", text=wrapped("<a>\n<b>é</b>\n</c>\n</a>").replace("\n", end))
        assert only(document).location.line == 4
        assert_positions(document)


@pytest.mark.parametrize("tag", ["Uintah_Include", "Uintah_specificaton", "html"])
def test_wrong_root(tag):
    document = read_document("d", text=f"<{tag}/>")
    assert codes(document) == ["UPS008"]
    assert marked(document) == [tag]
    assert not read_document("d", text=f"<{tag}/>", roots=(tag,)).diagnostics


@pytest.mark.parametrize("name", ["missing.ups", ".", "nul\0name"])
def test_files_that_cannot_be_read(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    document = read_document(name)
    assert codes(document) == ["UPS001"]
    assert document.root is None
    assert document.to_xml() == ""


# ------------------------------------------------------------------------------------------- hostile


def test_entities_are_refused_at_once():
    lines = "".join(f'<!ENTITY l{i} "&l{i - 1};&l{i - 1};&l{i - 1};&l{i - 1};">\n' for i in range(1, 40))
    bomb = f'<!DOCTYPE a [\n<!ENTITY l0 "ha">\n{lines}]>\n' + wrapped("<a>&l39;</a>")
    begin = time.perf_counter()
    document = read_document("d", text=bomb)
    assert time.perf_counter() - begin < 0.5
    assert codes(document) == ["UPS006"]


def test_no_file_is_read_through_an_entity(tmp_path):
    secret = tmp_path / "secret"
    secret.write_text("TOP-SECRET")
    text = f'<!DOCTYPE a [<!ENTITY x SYSTEM "{secret.as_uri()}">]>\n' + wrapped("<a>&x;</a>")
    document = read_document("d", text=text)
    assert codes(document) == ["UPS006"]
    assert "TOP-SECRET" not in repr(document.diagnostics) + document.to_xml()


def test_a_plain_doctype_does_no_harm():
    document = read_document(
        "d", text='<!DOCTYPE Uintah_specification SYSTEM "input.dtd">\n' + wrapped("<a/>")
    )
    assert not document.diagnostics


def test_endless_nesting_is_refused():
    begin = time.perf_counter()
    document = read_document("d", text="<Uintah_specification>" + "<a>" * 3_500_000)
    assert time.perf_counter() - begin < 5
    assert codes(document) == ["UPS007"]
    assert not document.complete


def test_nesting_up_to_the_limit_is_read():
    inner = MAX_DEPTH - 1
    document = read_document("d", text=wrapped("<a>" * inner + "</a>" * inner))
    assert not document.diagnostics
    assert document.to_xml().count("<a") == inner


def test_large_files_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("ups.source.MAX_BYTES", 1000)
    path = tmp_path / "deck.ups"
    path.write_text(wrapped("<a/>" * 300))
    assert codes(read_document(path)) == ["UPS007"]


def test_a_long_comment_is_read_in_linear_time():
    begin = time.perf_counter()
    document = read_document("d", text=wrapped(f"<!--{'x' * 8_000_000}--><a b='{'y' * 2_000_000}'/>"))
    assert time.perf_counter() - begin < 5
    assert len(document.root.get("a").attributes["b"].value) == 2_000_000


# ------------------------------------------------------------------------------------------- includes


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty working directory, and a function that writes files in it."""
    monkeypatch.chdir(tmp_path)

    def write(name: str, text: str) -> Path:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    return write


def included(body: str, root: str = "Uintah_Include") -> str:
    return f"<?xml version='1.0'?>\n<{root}>\n{body}\n</{root}>\n"


def test_include_inserts_the_children_in_place(folder):
    folder("deck.ups", wrapped("<m>\n<a>1</a>\n<include href='x.xml'/>\n<d>4</d>\n</m>"))
    folder("x.xml", included("<!-- from x --><b>2</b>\n<c k='v'>3</c>"))
    document = read_document("deck.ups")
    m = document.root.get("m")
    assert not document.diagnostics
    assert [child.tag for child in m.children] == ["a", "b", "c", "d"]
    assert m.get("b").path == "Uintah_specification/m/b"
    assert m.get("b").parent is m
    assert m.get("b").location == Location("x.xml", 3, 17, 1)
    assert m.get("d").location == Location("deck.ups", 5, 2, 1)
    assert [file.name for file in document.files] == ["deck.ups", "x.xml"]
    assert [(item.href, item.path) for item in document.includes] == [("x.xml", Path("x.xml"))]
    assert any(isinstance(node, Comment) for node in m.content)
    assert "<!-- from x -->" in document.to_xml()
    assert_positions(document)


def test_includes_nest_and_are_relative_to_their_own_file(folder):
    folder("decks/deck.ups", wrapped("<include href='../data/x.xml'/>"))
    folder("data/x.xml", included("<a><include href='more/y.xml'/></a><include href='more/y.xml'/>"))
    folder("data/more/y.xml", included("<b>1</b>", root="Uintah_specification"))
    document = read_document("decks/deck.ups")
    assert outline(document.root)[3] == [("a", {}, "", [("b", {}, "1", [])]), ("b", {}, "1", [])]
    assert [file.name for file in document.files] == ["decks/deck.ups", "data/x.xml", "data/more/y.xml"]


SECTIONS = included(
    "<init type='one'><p>1</p></init>\n<init type='two' size='big'><p>2</p></init>\n"
    "<deep>\n<wall><q>3</q></wall>\n</deep>\n<deep><floor>4</floor></deep>\n<value>5 5</value>"
)


@pytest.mark.parametrize(
    ("attributes", "expected"),
    [
        ("section='init'", [("init", "")]),
        ("section='init' type='two'", [("init", "")]),
        ("section='init' type='two' size='big' excludeSectionTag='true'", [("p", "2")]),
        ("section='deep/wall/q'", [("q", "3")]),
        ("section='deep/floor/'", [("floor", "4")]),
        ("section='deep/wall' excludeSectionTag='true'", [("q", "3")]),
        ("section='init' need_applies_to='ignored here'", [("init", "")]),
        ("section='deep' excludeSectionTag=''", [("deep", "")]),
    ],
)
def test_sections(folder, attributes, expected):
    folder("x.xml", SECTIONS)
    document = read_document("deck.ups", text=wrapped(f"<m><include href='x.xml' {attributes}/></m>"))
    assert not document.diagnostics
    assert [(child.tag, child.text) for child in document.root.get("m").children] == expected


def test_a_section_without_its_tag_may_be_a_text(folder):
    folder("x.xml", SECTIONS)
    text = wrapped("<m><include href='x.xml' section='value' excludeSectionTag='yes'/></m>")
    document = read_document("deck.ups", text=text)
    assert document.root.get("m").text == "5 5"
    assert document.root.get("m").text_location.file == "x.xml"


@pytest.mark.parametrize(
    ("attributes", "code", "mark", "suggestion"),
    [
        ("href='x.xml' section='deep/wal'", "UPS013", "deep/wal", "did you mean deep/wall?"),
        ("href='x.xml' section='init' type='six'", "UPS013", "include", None),
        ("href='y.xml'", "UPS011", "y.xml", "did you mean x.xml?"),
        ("href='sub/x.xm'", "UPS011", "sub/x.xm", None),
        ("href='http://example.org/x.xml'", "UPS011", "http://example.org/x.xml", None),
        ("href='html.xml'", "UPS008", "html.xml", None),
        ("href=''", "UPS010", "'", 'write <include href="FILE"/>'),
        ("ref='x.xml'", "UPS010", "include", 'write <include href="FILE"/>'),
        ("href='deck.ups'", "UPS012", "deck.ups", None),
        ("href='loop.xml'", "UPS012", "./again.xml", None),
    ],
)
def test_includes_that_cannot_be_resolved(folder, attributes, code, mark, suggestion):
    folder("x.xml", SECTIONS)
    folder("html.xml", "<html/>")
    folder("loop.xml", included("<include href='again.xml'/>"))
    folder("again.xml", included("<x/><include href='./again.xml'/>"))
    folder("deck.ups", wrapped(f"<a>1</a>\n<include {attributes}/>\n<b>2</b>"))
    document = read_document("deck.ups")
    found = only(document)
    assert found.code == code
    assert marked(document) == [mark]
    if suggestion:
        assert found.suggestion == suggestion
    assert not document.complete
    assert document.root.get("a").text == "1"
    assert document.root.get("b").text == "2"


def test_broken_xml_in_an_include_is_reported_in_its_own_file_once(folder):
    folder("x.xml", included("<a>\n<b>1</a>"))
    document = read_document("deck.ups", text=wrapped("<include href='x.xml'/><include href='x.xml'/>"))
    found = only(document)
    assert (found.location.file, found.location.line) == ("x.xml", 4)


def test_includes_that_multiply_are_refused(folder):
    for i in range(30):
        folder(f"{i}.xml", included(f"<include href='{i + 1}.xml'/>" * 2))
    folder("30.xml", included("<a/>"))
    begin = time.perf_counter()
    document = read_document("deck.ups", text=wrapped("<include href='0.xml'/>"))
    assert time.perf_counter() - begin < 10
    assert codes(document) == ["UPS007"]


def test_depth_counts_through_includes(folder):
    half = MAX_DEPTH // 2 + 5
    folder("x.xml", included("<a>" * half + "</a>" * half))
    nested = "<a>" * half + "<include href='x.xml'/>" + "</a>" * half
    assert codes(read_document("deck.ups", text=wrapped(nested))) == ["UPS007"]


# ------------------------------------------------------------------------------ where includes are found


@pytest.fixture
def program(tmp_path, monkeypatch):
    """A stand-in for the program's own folders, with an empty working directory beside it."""
    root = tmp_path / "program"
    for name in ("inputs/MPM/in.xml", "materialdata/steel.xml", "materialdata/metals/copper.xml"):
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(included("<a/>"))
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    monkeypatch.setattr(ups.document, "_PROGRAM_ROOT", root)
    return root


@pytest.mark.parametrize(
    ("href", "found"),
    [
        ("inputs/MPM/in.xml", "inputs/MPM/in.xml"),
        ("MPM/in.xml", "inputs/MPM/in.xml"),
        ("materialdata/MPM/in.xml", "inputs/MPM/in.xml"),
        ("steel.xml", "materialdata/steel.xml"),
        ("inputs/steel.xml", "materialdata/steel.xml"),
        ("inputs/MPM/MaterialData/steel.xml", "materialdata/steel.xml"),
        ("inputs/MPM/MaterialData/copper.xml", "materialdata/metals/copper.xml"),
        ("metals/copper.xml", "materialdata/metals/copper.xml"),
        ("../MaterialData/copper.xml", "materialdata/metals/copper.xml"),
    ],
)
def test_the_programs_own_files_are_found(program, href, found):
    assert locate_include(href, "deck.ups") == program / found


def test_the_programs_own_files_are_not_guessed(program):
    for href in ("nothing.xml", "in.xml", "", "  ", "..", "a\0b", "*.xml", "[", "x" * 5000):
        assert locate_include(href, "deck.ups") is None


def test_order_of_the_search(folder, program, tmp_path):
    name = "inputs/MPM/in.xml"
    deck = "decks/inputs/MPM/deck.ups"
    assert locate_include(name, deck) == program / name
    above = folder(f"work/decks/{name}", included("<a/>"))
    assert locate_include(name, deck) == above
    searched = folder(f"library/{name}", included("<a/>"))
    assert locate_include(name, deck, [tmp_path / "library"]) == searched
    # the working directory of these fixtures is the folder `work`
    folder(f"work/{name}", included("<a/>"))
    assert locate_include(name, deck, [tmp_path / "library"]) == Path(name)
    folder(f"work/decks/inputs/MPM/{name}", included("<a/>"))
    assert locate_include(name, deck, [tmp_path / "library"]) == Path("decks/inputs/MPM") / name


def test_absolute_href(folder, tmp_path):
    path = folder("elsewhere/x.xml", included("<a/>"))
    assert locate_include(str(path), "deck.ups") == path
    assert locate_include(str(tmp_path / "nothing.xml"), "deck.ups") is None
