"""``python -m benchmarks.memory``: bytes a particle by constitutive model, and the peak of a run in fact."""

from __future__ import annotations

import resource
import sys
import tempfile
from pathlib import Path

import click

from benchmarks.block import block_deck
from solver.performance.memory import PARTICLE, bytes_of, bytes_of_models
from ups.deck import read_deck
from ups.run import Observer, Run
from ups.session import run_deck

STEPS = 2
SAVES = ("p.x", "p.stress", "p.temperature", "p.particleID")


@click.command()
@click.option(
    "--particles",
    type=click.IntRange(min=1),
    metavar="N",
    help="Run two steps of an elastic-plastic block of N particles, write it, and print the peak of memory.",
)
def main(particles: int | None) -> None:
    """Print the bytes a particle of each constitutive model, or the memory of a run."""
    if particles is None:
        click.echo(table())
    else:
        with tempfile.TemporaryDirectory() as folder:
            run_deck(
                read_deck(
                    "block.ups",
                    text=block_deck("elastic_plastic", "gimp", particles, steps=STEPS, saves=SAVES),
                ),
                output=Path(folder) / "block.uda",
                observers=[Peak()],
            )


def table() -> str:
    """The bytes of all models in Markdown; those that take the same stand together."""
    by_size: dict[int, list[str]] = {}
    for name, size in bytes_of_models().items():
        by_size.setdefault(size, []).append(name)
    lines = ["| constitutive model | its state | with the particle |", "|---|---|---|"]
    for size in sorted(by_size):
        names = ", ".join(f"`{name}`" for name in sorted(by_size[size], key=str.lower))
        lines.append(f"| {names} | {size} | {PARTICLE + size} |")
    return "\n".join(lines)


class Peak(Observer):
    """Prints the largest resident memory of the process after each stage of a run."""

    def begin(self, run: Run) -> None:
        """After the particles are made."""
        self._say("particles made", run)

    def after_step(self, run: Run) -> None:
        """After a step, the last of which is also written."""
        self._say(f"step {run.steps_done}{' and its output' if run.is_last else ''}", run)

    def _say(self, stage: str, run: Run) -> None:
        bodies = run.simulation.bodies
        count = sum(len(body.particles) for body in bodies)
        arrays = sum(bytes_of(body.records) for body in bodies)
        click.echo(
            f"{stage}: peak {1e-9 * peak():.2f} GB, {peak() / count:.0f} bytes a particle "
            f"({count} particles, whose arrays take {1e-9 * arrays:.2f} GB)"
        )


def peak() -> int:
    """The largest resident memory of this process until now, bytes."""
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


if __name__ == "__main__":
    main()
