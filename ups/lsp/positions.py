"""Places in a text as editors count them (lines from 0, units of an encoding) and as characters from its start."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable

_LINE_END = re.compile(r"\r\n|\r|\n")


class Positions:
    """Converts the places of one text.

    Parameters
    ----------
    text : the text.
    units : how many units of the editor a string takes; UTF-16 code units unless it agreed to others.
    """

    def __init__(self, text: str, units: Callable[[str], int]) -> None:
        self.text = text
        self.units = units
        self._starts = [0, *(match.end() for match in _LINE_END.finditer(text))]

    def position(self, offset: int) -> tuple[int, int]:
        """Line and units before an offset."""
        offset = min(max(offset, 0), len(self.text))
        line = bisect_right(self._starts, offset) - 1
        return line, self.units(self.text[self._starts[line] : offset])

    def offset(self, line: int, units: int) -> int:
        """The offset of a line and units; beyond the end of a line that end, beyond the last line the end."""
        if line >= len(self._starts):
            return len(self.text)
        offset, end = self._starts[line], self.end_of_line(line)
        while units > 0 and offset < end:
            units -= self.units(self.text[offset])
            offset += 1
        return offset

    def end_of_line(self, line: int) -> int:
        """The offset at which a line ends, before its line break."""
        end = _LINE_END.search(self.text, self._starts[line])
        return end.start() if end else len(self.text)

    def of_column(self, line: int, column: int) -> int:
        """The offset of a place as diagnostics give it: line and column from 1, in characters."""
        if line > len(self._starts):
            return len(self.text)
        return min(self._starts[line - 1] + column - 1, self.end_of_line(line - 1))
