"""The user pages of findings that come from reading a deck, not from a rule: XML, tags and values."""

from __future__ import annotations

PAGES: dict[str, str] = {
    "UPS001": "The file does not exist or may not be read. Check the path and its permissions.",
    "UPS002": "The file is not well-formed XML. Nothing behind the place can be trusted; repair it first.",
    "UPS003": (
        "A tag is not closed, or closed by another name, as in ``<radius>0.5</radus>``. Reading goes "
        "on behind it as well as it can; further findings may follow from this one."
    ),
    "UPS004": (
        "Bytes do not fit the encoding that the first line declares. Save the file as UTF-8, or "
        'declare ``encoding="ISO-8859-1"``.'
    ),
    "UPS005": (
        "A character stands in the file that XML forbids, often a stray byte of another program. Remove it."
    ),
    "UPS006": (
        "Declarations of entities are not read, since they can hide other files or grow without end. "
        "Write the text in their place."
    ),
    "UPS007": "The file, its nesting or its includes are beyond what any deck needs.",
    "UPS008": (
        "A deck has the root ``<Uintah_specification>``; a file to include may also have "
        "``<Uintah_Include>``."
    ),
    "UPS010": "``<include>`` needs ``href``: the file to put in its place.",
    "UPS011": (
        "An included file was not found: beside the including file, from the working directory, in "
        "``inputs/`` above, or among the program's own material files."
    ),
    "UPS012": "Files include each other in a circle.",
    "UPS013": "The included file has no section of that name (or none with these attributes).",
    "UPS014": "A comment ``<!-- ups: ignore CODE -->`` keeps nothing quiet any more. Remove it.",
    "UPS101": (
        "A tag is missing without which the section cannot be read. Uintah stops with ``Required "
        "parameter not found``. Add the tag that the message names."
    ),
    "UPS102": (
        "No section has this tag here; Uintah's validator stops, and without it the tag would be "
        "ignored in silence. Mostly it is misspelt: the nearest tag is suggested."
    ),
    "UPS103": "The tag exists, but belongs in another section, which the message names.",
    "UPS104": (
        "A tag stands twice where one is allowed; Uintah's validator stops, its reader would take the first."
    ),
    "UPS105": (
        "The tag belongs to another model of the family than the chosen one and is not read. Uintah "
        "lets most of these pass; they mislead whoever reads the deck."
    ),
    "UPS106": "Of several tags a deck gives exactly one: none, or more than one, is given.",
    "UPS111": "An attribute is missing without which the tag cannot be read.",
    "UPS112": "The tag takes no such attribute; mostly it is misspelt.",
    "UPS201": "Text stands where only tags may stand; it would be ignored.",
    "UPS202": "A tag that needs a value is empty.",
    "UPS203": "The value must be a number, such as ``1.0e-3``; a comma or a unit is no part of one.",
    "UPS204": "The value must be a whole number.",
    "UPS205": "The value must be ``true`` or ``false``, in lower case.",
    "UPS206": "The value must be a vector ``[a, b, c]`` in brackets, with commas.",
    "UPS207": "A vector has too few or too many components.",
    "UPS208": "The value is outside the range that makes sense, such as a negative density.",
    "UPS209": "The value must be one of some words, which the message lists; the nearest is suggested.",
    "UPS210": "The value of a tag is split by a comment or a tag; Uintah reads the first piece only.",
    "UPS211": "Characters follow the value; Uintah ignores them in silence.",
    "UPS301": "A tag has another name today; the old one is understood.",
    "UPS303": "A model or word has another name today; the old one is understood.",
    "UPS305": "An include file has another name today; the old one is understood.",
    "UPS410": "A name (of a piece of geometry) is used before it is given, or nowhere given.",
    "UPS411": "The shapes of a material hold no point of the particle lattice.",
    "UPS412": (
        "Uintah knows this method, model or option; this program does not run it yet. The deck's tags "
        "are checked all the same; ``ups run`` refuses it."
    ),
    "UPS404": "Times must increase from point to point.",
    "UPS501": "The property must be positive.",
    "UPS601": "The run was stopped.",
    "UPS602": (
        "A particle's state became infinite or was turned inside out; the time step may be too long "
        "or the constants wrong."
    ),
    "UPS603": "The archive cannot be read.",
    "UPS604": "The archive cannot be written.",
}
"""Code -> what it means and what to do."""
