"""UPS408."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, did_you_mean
from ups.element import Element
from ups.rules.rule import DeckView, Rule


class DataFile(Rule):
    """A data file that the deck names is not there.

    **Why.** Profiles of prescribed motion, inserted particles and cohesive segments come from files. They are
    looked for in the working directory, beside the deck, and in the folders above it. A run stops where one is
    missing; a check only warns, since it may be made elsewhere.

    **Example.** ``<PrescribedDeformationFile>inputs/MPM/twist.txt</PrescribedDeformationFile>``

    **Repair.** Correct the path, or run from the folder that it starts in.
    """

    code = "UPS408"
    title = "data file not found"

    def check(self, deck: DeckView) -> Iterator[Diagnostic]:
        """Look for the files of the options of the method and of cohesive zones."""
        if deck.switch("MPM/UsePrescribedDeformation"):
            yield from self._check(deck, deck.find("MPM/PrescribedDeformationFile"))
        if deck.switch("MPM/InsertParticles"):
            yield from self._check(deck, deck.find("MPM/InsertParticlesFile"))
        for zone in deck.all("MaterialProperties/MPM/cohesive_zone"):
            yield from self._check(deck, zone.get("cz_filename"))

    def _check(self, deck: DeckView, element: Element | None) -> Iterator[Diagnostic]:
        if element is None or not element.texts:
            return
        try:
            deck.deck.reader.open_file(element.text)
        except FileNotFoundError as problem:
            nearest = _nearest(deck, element.text)
            yield self.warning(
                str(problem), element.texts[0], f"did you mean {nearest}?" if nearest else None
            )
        except (OSError, ValueError) as problem:
            yield self.warning(f"{element.text!r}: {problem}", element.texts[0])


def _nearest(deck: DeckView, name: str) -> str | None:
    """A file beside the deck that was probably meant."""
    try:
        files = [path.name for path in deck.deck.path.parent.iterdir() if path.is_file()]
    except OSError:
        return None
    return did_you_mean(name.rpartition("/")[2], sorted(files))
