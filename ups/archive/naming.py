"""Names of archives: numbered directories, and a link to the newest."""

from __future__ import annotations

import os
from pathlib import Path

from ups.archive.errors import ArchiveError


def next_numbered_directory(filebase: str | Path) -> Path:
    """First unused name among ``filebase.000``, ``filebase.001``, ...; nothing is created."""
    base = Path(filebase)
    number = 0
    while os.path.lexists(candidate := base.with_name(f"{base.name}.{number:03d}")):
        number += 1
    return candidate


def point_link(link: Path, directory: Path) -> None:
    """Make `link` a symbolic link to `directory`, replacing a link but nothing else.

    The link is relative, so that both can be moved together. (Uintah stores the name as it was
    given, which leads nowhere when that holds a folder.) A file or folder called like the link is
    left as it is.

    Raises
    ------
    ArchiveError
        Where the link cannot be made.
    """
    if os.path.lexists(link) and not link.is_symlink():
        return
    temporary = link.with_name(f".{link.name}.{os.getpid()}")
    try:
        temporary.symlink_to(os.path.relpath(directory, link.parent))
        temporary.replace(link)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise ArchiveError.from_os_error(link, "make the link", error) from error
