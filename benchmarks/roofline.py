"""A picture of the roofline: how many operations a second each phase makes, over how many it makes a byte."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from solver.performance.phases import Phase
from solver.performance.report import Report

COLOURS = {
    Phase.TO_GRID: "tab:blue",
    Phase.GRID: "tab:gray",
    Phase.TO_PARTICLES: "tab:orange",
    Phase.STRESS: "tab:red",
}
MARKERS = "osD^vP*XhH<>"


def draw(reports: Mapping[str, Report], file: Path) -> None:
    """Write the picture; each case has a marker, each phase a colour, both in units of the case's own machine."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(9.0, 5.5), layout="constrained")
    flops = float(np.median([report.machine.flops for report in reports.values()]))
    bandwidth = float(np.median([report.machine.bandwidth for report in reports.values()]))
    balance = flops / bandwidth
    intensity = np.geomspace(0.02, 30.0, 200)
    axes.plot(intensity, np.minimum(intensity / balance, 1.0), "k-", linewidth=1.5)
    axes.plot(intensity, np.minimum(intensity / balance, 1.0) / 3.0, "k:", linewidth=1.0)
    axes.annotate("a third of it", (0.2, 0.2 / balance / 4.0), fontsize=8, va="top")
    for n, (name, report) in enumerate(reports.items()):
        for row in report.phases:
            if row.phase in COLOURS and row.operations and row.bytes and row.flops_share:
                axes.plot(
                    row.operations / row.bytes,
                    row.flops_share,
                    MARKERS[n % len(MARKERS)],
                    color=COLOURS[row.phase],
                    alpha=0.8,
                )
        axes.plot([], [], MARKERS[n % len(MARKERS)], color="0.4", label=name)
    for phase, colour in COLOURS.items():
        axes.plot([], [], "s", color=colour, label=str(phase))
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("operations a byte (model)")
    axes.set_ylabel("operations a second, share of measured peak")
    axes.set_title(f"roofline: {1e-9 * flops:.3g} GFLOP/s multiply-add, {1e-9 * bandwidth:.3g} GB/s triad")
    axes.grid(True, which="both", alpha=0.2)
    axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.savefig(file, dpi=120)
    pyplot.close(figure)
