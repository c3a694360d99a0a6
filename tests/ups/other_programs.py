"""Archives as programs other than this one leave them."""

from pathlib import Path


def without_checksums(folder: Path) -> Path:
    """Remove the checksums that only this program writes, so that a file may be changed; return the folder."""
    for path in list(folder.glob("**/*.crc32")):
        path.unlink()
    return folder
