"""The one exception of the archive package."""

from __future__ import annotations

import errno
from pathlib import Path


class ArchiveError(Exception):
    """An archive cannot be read or written.

    Attributes
    ----------
    path
        The file or directory at fault.
    message
        What is wrong.
    line
        Line of a text file, counted from one, or None.
    offset
        Byte of a binary file, or None.
    advice
        What to do about it; empty where nothing helps.
    """

    def __init__(
        self,
        path: str | Path,
        message: str,
        *,
        line: int | None = None,
        offset: int | None = None,
        advice: str = "",
    ) -> None:
        self.path = Path(path)
        self.message = message
        self.line = line
        self.offset = offset
        self.advice = advice
        super().__init__(str(self))

    @classmethod
    def from_os_error(cls, path: str | Path, doing: str, error: OSError) -> ArchiveError:
        """Wrap the operating system's complaint (disk full, no permission, ...) about `path`."""
        reason = error.strerror or str(error)
        return cls(
            error.filename or path, f"cannot {doing}: {reason}", advice=_ADVICE.get(error.errno or 0, "")
        )

    def __str__(self) -> str:
        place = str(self.path)
        if self.line is not None:
            place += f":{self.line}"
        if self.offset is not None:
            place += f" (byte {self.offset})"
        return f"{place}: {self.message}" + (f"; {self.advice}" if self.advice else "")


_ADVICE = {
    errno.ENOENT: "check the path",
    errno.EACCES: "check the permissions of the directory",
    errno.EEXIST: "choose another name or remove what is there",
    errno.EMFILE: "close some files or raise the limit of open files",
    errno.ENOSPC: "free space on the disk or write elsewhere",
    errno.EROFS: "the file system is read-only, write elsewhere",
    errno.EDQUOT: "the disk quota is used up, free space or write elsewhere",
}
