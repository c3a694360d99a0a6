"""How fast `ups convert` writes a step of many particles, and in how much memory.

    python benchmarks/convert_speed.py [--particles 10000000] [--out .vtu] [--jobs N]

An archive of one step is made in a temporary folder: positions, velocities, stresses, volumes and identities
of particles in a smooth motion. Three things are measured, each in a process of its own:

- copying the bytes of the step through zlib at the level that `ups convert` uses, into a file;
- `ups convert`, from its start to its end;
- the largest memory that it held, mapped parts of the archive included.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path

import numpy as np

from ups.archive import ArchiveWriter, Box, Grid, Variable
from ups.convert.vtkxml import BLOCK, ZLIB_LEVEL

GOAL_SPEED, GOAL_MEMORY = 0.5, 2.5


def write_archive(path: Path, count: int) -> int:
    """Write the archive; return the bytes of its step."""
    side = round(count ** (1 / 3)) + 1
    grid = Grid.single_level(Box((0, 0, 0), (side,) * 3).split((2, 2, 2)), spacing=(1.0 / side,) * 3)
    places = (np.stack(np.unravel_index(np.arange(count), (side,) * 3), axis=1) + 0.5) / side
    waves = np.sin(2 * np.pi * places) + 1e-6 * np.random.default_rng(1).standard_normal(places.shape)
    fields = {
        Variable("p.x", "ParticleVariable", "Point"): places + 1e-3 * waves / side,
        Variable("p.velocity", "ParticleVariable", "Vector"): waves[:, ::-1] * 10.0,
        Variable("p.stress", "ParticleVariable", "Matrix3"): waves[:, :, None] * waves[:, None, :] * 1e9,
        Variable("p.volume", "ParticleVariable", "double"): (1.0 + 1e-3 * waves[:, 0]) / side**3,
        Variable("p.particleID", "ParticleVariable", "long64"): np.arange(count, dtype=np.int64) << 16,
    }
    with ArchiveWriter.create(path, grid, input_xml="<Uintah_specification/>") as writer:
        writer.write_timestep(1, 0.1, 0.1, {variable: {0: values} for variable, values in fields.items()})
    return sum(values.nbytes for values in fields.values())


def copy_through_zlib(source: Path, target: Path) -> float:
    """Seconds to compress a file into another, block by block."""
    begin = time.perf_counter()
    with source.open("rb") as read, target.open("wb") as write:
        while block := read.read(BLOCK):
            write.write(zlib.compress(block, ZLIB_LEVEL))
    return time.perf_counter() - begin


def convert(archive: Path, out: Path, jobs: list[str]) -> tuple[float, int]:
    """Seconds that `ups convert` takes, and its peak memory in bytes."""
    command = [sys.executable, "-m", "cli", "convert", str(archive), str(out), *jobs]
    begin = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _pid, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(command)} failed")
    return time.perf_counter() - begin, usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--particles", type=int, default=10_000_000)
    parser.add_argument("--out", default=".vtu", help="suffix of the format")
    parser.add_argument("--jobs", help="as for ups convert")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        archive = Path(folder) / "a.uda"
        # a process of its own, as memory that was freed there is not held here
        if (made := os.fork()) == 0:
            write_archive(archive, given.particles)
            os._exit(0)
        os.waitpid(made, 0)
        data = archive / "t00001" / "l0" / "p00000.data"
        size = data.stat().st_size
        copied = copy_through_zlib(data, Path(folder) / "copy")
        out = Path(folder) / f"out{given.out}"
        seconds, memory = convert(archive, out, ["--jobs", given.jobs] if given.jobs else [])
        written = sum(file.stat().st_size for file in Path(folder).glob("out*") if file.is_file())
    print(f"step: {given.particles} particles, {size / 1e6:.0f} MB; {out.name}: {written / 1e6:.0f} MB")
    print(f"copied through zlib in {copied:.1f} s, converted in {seconds:.1f} s: ", end="")
    print(f"{copied / seconds:.2f} of the speed (goal {GOAL_SPEED})")
    print(f"peak memory {memory / 1e6:.0f} MB: {memory / size:.2f} of a step (goal at most {GOAL_MEMORY})")


if __name__ == "__main__":
    main()
