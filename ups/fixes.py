"""Repairs: doing what diagnostics propose, in the files that hold the cause."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from ups.diagnostics import Diagnostic, Diagnostics, apply_fixes
from ups.source import load_source

_OWN_DATA = Path(__file__).resolve().parent.parent / "materialdata"


def repaired(
    diagnostics: Iterable[Diagnostic], sources: Mapping[str, str], *, unsafe: bool = False
) -> tuple[dict[str, str], int]:
    """Do the fixes of diagnostics in texts.

    Parameters
    ----------
    diagnostics : what was found; fixes that overlap an earlier one wait for the next round.
    sources : text of each file by name; files of the program's own data are left alone.
    unsafe : whether fixes that may not be what the author meant are done too.

    Returns
    -------
    the changed texts by file name, and how many fixes were done.
    """
    chosen = []
    for diagnostic in diagnostics:
        fix = diagnostic.fix
        if fix is None or not (fix.safe or unsafe):
            continue
        chosen.append(replace(diagnostic, fix=replace(fix, safe=True)))
    own = {name for name in sources if is_own_data(name)}
    return apply_fixes(chosen, {name: text for name, text in sources.items() if name not in own})


def is_own_data(name: str) -> bool:
    """Whether a file is one of the program's own, which repairs leave alone."""
    return Path(name).resolve().is_relative_to(_OWN_DATA)


def write(texts: Mapping[str, str]) -> None:
    """Write changed texts to their files, each in its own encoding.

    Raises
    ------
    OSError : a file cannot be read or written.
    """
    for name, text in texts.items():
        source = load_source(name, Diagnostics())
        if source is None:
            raise OSError(f"cannot read {name}")
        Path(name).write_bytes(source.encode(text))


def difference(sources: Mapping[str, str], texts: Mapping[str, str]) -> str:
    """What would change, as a unified diff."""
    parts: list[str] = []
    for name in sorted(texts):
        before, after = sources[name].splitlines(keepends=True), texts[name].splitlines(keepends=True)
        parts += difflib.unified_diff(before, after, name, name)
    return "".join(line if line.endswith("\n") else line + "\n" for line in parts)
