"""``python -m benchmarks``: measure, compare with the history, and draw the roofline."""

from __future__ import annotations

import json
import platform
from collections.abc import Iterable
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import click

from benchmarks.history import append, changes, last, ratios
from benchmarks.measure import measure
from benchmarks.suite import Case, blocks, quick_blocks, reference_decks
from solver.performance.report import Report
from solver.team import available_cores
from ups.diagnostics import DeckError, Severity

STEPS, QUICK_STEPS = 20, 8


@click.command()
@click.option("--quick", is_flag=True, help="Two blocks only, in less than a minute.")
@click.option(
    "--particles",
    type=int,
    multiple=True,
    default=(64_000, 512_000),
    help="Sizes of the blocks; not with --quick.",
)
@click.option("--only", metavar="TEXT", default="", help="Cases whose name contains TEXT.")
@click.option("--threads", type=click.IntRange(min=1), default=1, show_default=True)
@click.option("--steps", type=click.IntRange(min=1), help="Steps of each case whose median is taken.")
@click.option("--json", "results", type=click.Path(path_type=Path), help="Write all results there.")
@click.option("--plot", type=click.Path(path_type=Path), help="Write a picture of the roofline there.")
@click.option("--remember", metavar="LABEL", help="Add the results to benchmarks/history.json.")
def main(
    quick: bool,
    particles: tuple[int, ...],
    only: str,
    threads: int,
    steps: int | None,
    results: Path | None,
    plot: Path | None,
    remember: str | None,
) -> None:
    """Measure the speed of the program, and compare it with the history."""
    cases = quick_blocks() if quick else [*blocks(particles), *reference_decks()]
    chosen = [case for case in cases if only in case.name]
    if not chosen:
        raise click.BadParameter(f"no case has {only!r} in its name", param_hint="--only")
    reports = measured(chosen, steps or (QUICK_STEPS if quick else STEPS), threads)
    click.echo(changes(reports, last()))
    if results is not None:
        results.write_text(json.dumps(as_json(reports), indent=1) + "\n")
    if plot is not None:
        from benchmarks.roofline import draw

        draw(reports, plot)
    if remember is not None:
        append(remember, reports)


def measured(cases: Iterable[Case], steps: int, threads: int) -> dict[str, Report]:
    """The reports by case, printed as they come."""
    reports = {}
    for case in cases:
        try:
            report = measure(case.deck(), steps=steps, threads=threads)
        except DeckError as problem:
            errors = [d.message for d in problem.diagnostics if d.severity is Severity.ERROR]
            click.echo(f"{case.name}\nleft out: {errors[0]}\n")
            continue
        reports[case.name] = report
        click.echo(f"{case.name}\n{report.table()}")
        if case.sus is not None:
            click.echo(
                f"sus: {case.sus * report.steps / report.seconds:.2f} times as long a step on its machine"
            )
        click.echo()
    return reports


def as_json(reports: dict[str, Report]) -> dict[str, Any]:
    """The machine and all results."""
    return {
        "machine": {
            "processor": processor(),
            "cores": available_cores(),
            "system": platform.platform(),
            "versions": {"python": platform.python_version()}
            | {name: version(name) for name in ("numpy", "numba", "llvmlite")},
        },
        "cases": {
            name: {**asdict(report), "machine": report.machine._asdict(), "ratios": ratios(report)._asdict()}
            for name, report in reports.items()
        },
    }


def processor() -> str:
    """The processor's name, as well as the system tells it."""
    facts = Path("/proc/cpuinfo")
    if facts.exists():
        for line in facts.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor()


if __name__ == "__main__":
    main()
