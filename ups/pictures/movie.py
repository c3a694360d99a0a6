"""Movies: a picture for each time step, as .gif or .mp4."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from ups.archive import Archive, ArchiveError
from ups.pictures.plot import frame_pixels
from ups.pictures.view import Slice, View, range_of

Progress = Callable[[int, int], None]
"""Called after each frame with the number done and the number of all."""


_NEARLY_WHITE = 248
"""Colours from here on are the background, which quantising blends with the edges of letters."""


def movie(
    archive_path: str | Path,
    out: str | Path,
    variable: str | None = None,
    *,
    plane: Slice | None = None,
    materials: Sequence[int] | None = None,
    level: int = 0,
    limits: tuple[float, float] | None = None,
    mirrored: Sequence[int] = (),
    width: int | None = None,
    frames_per_second: float = 10.0,
    progress: Progress | None = None,
) -> Path:
    """Make a movie of a variable, a frame for each time step that has it, all with the same colour bar.

    Parameters
    ----------
    archive_path, variable, plane, materials, level, limits, mirrored, width
        As for `ups.pictures.plot.plot`; limits are by default those over all time steps.
    out
        The movie, ``.gif`` or ``.mp4``.
    frames_per_second
        How fast it runs.
    progress
        Called after each frame.

    Raises
    ------
    ArchiveError
        Where the archive does not hold what is asked for, the movie cannot be written, or ffmpeg, which
        makes .mp4, is not there.
    """
    out = Path(out)
    if out.suffix.lower() not in _WRITERS:
        message = f"no format of movies is known by the suffix {out.suffix!r}"
        raise ArchiveError(out, message, advice=f"give a name ending in {' or '.join(_WRITERS)}")
    archive = Archive(archive_path)
    if not archive.timesteps:
        raise ArchiveError(archive.path, "there are no time steps")
    view = View.choose(archive, variable, materials=materials, level=level, plane=plane, mirrored=mirrored)
    label = view.named.source.name
    steps = [t.step for t in archive.timesteps if label in archive.labels(t.step)]
    shown = range_of(view, steps, limits)

    def frames() -> Iterator[np.ndarray]:
        for done, step in enumerate(steps, 1):
            yield frame_pixels(view, step, shown, width)
            if progress is not None:
                progress(done, len(steps))

    try:
        _WRITERS[out.suffix.lower()](out, frames(), frames_per_second)
    except OSError as error:
        raise ArchiveError.from_os_error(out, "write the movie", error) from error
    return out


def _write_gif(out: Path, frames: Iterator[np.ndarray], frames_per_second: float) -> None:
    """Write frames as they come; all share the colours of the first, or the bar would flicker."""
    from PIL import Image

    first = Image.fromarray(next(frames)).quantize(256)
    colours = np.array(first.getpalette(), dtype=np.uint8).reshape(-1, 3)
    colours[(colours >= _NEARLY_WHITE).all(axis=1)] = 255
    first.putpalette(colours.tobytes())
    rest = (Image.fromarray(frame).quantize(palette=first, dither=Image.Dither.NONE) for frame in frames)
    duration = max(20, round(1000.0 / frames_per_second))
    first.save(out, save_all=True, append_images=rest, duration=duration, loop=0)


def _write_mp4(out: Path, frames: Iterator[np.ndarray], frames_per_second: float) -> None:
    """Hand frames to ffmpeg, cut to even numbers of pixels as its encoder needs."""
    program = _ffmpeg(out)
    first = _even(next(frames))
    height, width = first.shape[:2]
    command = [program, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24"]
    command += ["-s", f"{width}x{height}", "-r", f"{frames_per_second:g}", "-i", "-"]
    command += ["-pix_fmt", "yuv420p", "-movflags", "+faststart", str(out)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdin is not None  # as a pipe was asked for
        assert process.stderr is not None
        try:
            process.stdin.write(first.tobytes())
            for frame in frames:
                process.stdin.write(_even(frame).tobytes())
            process.stdin.close()
        except BrokenPipeError:
            pass  # ffmpeg has given up, and says why
        complaint = process.stderr.read().decode(errors="replace").strip()
    if process.returncode != 0:
        raise ArchiveError(
            out, f"ffmpeg failed: {complaint.splitlines()[-1] if complaint else 'no reason given'}"
        )


def _even(frame: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(frame[: frame.shape[0] // 2 * 2, : frame.shape[1] // 2 * 2])


def _ffmpeg(out: Path) -> str:
    """Path of ffmpeg: the one installed, or that of the package imageio-ffmpeg."""
    found = shutil.which("ffmpeg")
    if found:
        return found
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        return str(get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        advice = "install ffmpeg, or pip install imageio-ffmpeg, or write a .gif"
        raise ArchiveError(out, "a .mp4 is made by ffmpeg, which is not here", advice=advice) from None


_WRITERS: dict[str, Callable[[Path, Iterator[np.ndarray], float], None]] = {
    ".gif": _write_gif,
    ".mp4": _write_mp4,
}
"""Writers by suffix."""
