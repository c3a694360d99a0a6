"""Pictures of histories: sums over the body, step by step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path

import numpy as np

from ups.archive import Archive, ArchiveError, Reduction
from ups.archive.units import unit_of, with_unit
from ups.diagnostics import did_you_mean
from ups.pictures import flat

_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".pdf", ".svg")
_COMPONENTS = {3: ("X", "Y", "Z"), 9: ("XX", "XY", "XZ", "YX", "YY", "YZ", "ZX", "ZY", "ZZ")}
_LINES = ("-", "--", "-.", ":")
"""How curves of one unit are drawn in turn, so that each is seen where they coincide."""


@dataclass(frozen=True)
class Curve:
    """A number over time.

    Attributes
    ----------
    quantity
        What it is, the same for components and materials.
    name
        What it is called in the legend.
    unit
        Its unit, empty where it is not known.
    times, values
        Shape (n,).
    """

    quantity: str
    name: str
    unit: str
    times: np.ndarray
    values: np.ndarray


def plot_histories(
    archive_path: str | Path, names: Sequence[str], out: str | Path, *, others: Sequence[str | Path] = ()
) -> Path:
    """Draw histories over time, those of one unit on axes of their own.

    Parameters
    ----------
    archive_path
        The archive.
    names
        Histories, such as ``KineticEnergy`` or ``KineticEnergy_1`` for material 1; of a vector also one
        component, ``TotalMomentum:X``. None names all histories of numbers.
    out
        The picture; its suffix chooses the format.
    others
        Archives whose histories of the same names are drawn, too.

    Raises
    ------
    ArchiveError
        Where a history is not there or the picture cannot be written.
    """
    out = Path(out)
    archives = [Archive(path) for path in (archive_path, *others)]
    if out.suffix.lower() not in _SUFFIXES:
        message = f"no format of pictures is known by the suffix {out.suffix!r}"
        raise ArchiveError(out, message, advice=f"give a name ending in {', '.join(_SUFFIXES)}")
    wanted = names or _numbers(archives[0])
    curves = [
        curve
        for name in wanted
        for archive in archives
        for curve in _curves(archive, name, f" ({archive.path.name})" if others else "")
    ]
    if not curves:
        raise ArchiveError(archives[0].path, "there are no histories to show")
    try:
        flat.save(_draw(archives[0], curves), out)
    except OSError as error:
        raise ArchiveError.from_os_error(out, "write the picture", error) from error
    return out


def _numbers(archive: Archive) -> list[str]:
    return [name for name, history in archive.reductions.items() if history.values.ndim == 1]


def _curves(archive: Archive, name: str, source: str) -> list[Curve]:
    """Each component of a history, or the one asked for; their names end with the source."""
    label, colon, wanted = name.partition(":")
    if label not in archive.reductions:
        nearest = did_you_mean(label, archive.reductions)
        there = f"there are: {', '.join(archive.reductions) or 'none'}"
        advice = f"did you mean {nearest}? {there}" if nearest else there
        raise ArchiveError(archive.path, f"there is no history {label}", advice=advice)
    history: Reduction = archive.reductions[label]
    if np.isnan(history.times).any():
        raise ArchiveError(
            archive.path, f"the history {label} has no times", advice="let the deck write them"
        )
    if history.values.ndim == 1:
        components: tuple[str, ...] = ()
        found = [(label, history.values)]
    else:
        components = _COMPONENTS.get(history.values.shape[1], ())
        pairs = zip(components, history.values.T, strict=True)
        found = [(f"{label}:{c}", values) for c, values in pairs if not colon or c == wanted]
    if colon and wanted not in components:
        advice = f"there are: {', '.join(components)}" if components else "it is a number"
        raise ArchiveError(archive.path, f"the history {label} has no component {wanted}", advice=advice)
    unit = unit_of(history.name)
    return [Curve(history.name, title + source, unit, history.times, values) for title, values in found]


def _draw(archive: Archive, curves: Sequence[Curve]) -> flat.Figure:
    from matplotlib.figure import Figure

    units = list(dict.fromkeys(curve.unit for curve in curves))
    figure = Figure(figsize=(8.0, 1.0 + 3.4 * len(units)), dpi=120, layout="constrained")
    rows = figure.subplots(len(units), 1, sharex=True, squeeze=False)[:, 0]
    for axes, unit in zip(rows, units, strict=True):
        group = [curve for curve in curves if curve.unit == unit]
        for curve, line in zip(group, cycle(_LINES), strict=False):
            mark = "." if len(curve.times) == 1 else None
            axes.plot(curve.times, curve.values, line, label=curve.name, linewidth=1.4, marker=mark)
        names = {curve.name for curve in group} if len(group) == 1 else {curve.quantity for curve in group}
        axes.set_ylabel(with_unit(names.pop() if len(names) == 1 else "", unit).strip() or "value")
        if len(group) > 1:
            axes.legend(fontsize=8)
        axes.ticklabel_format(useMathText=True)
        axes.grid(alpha=0.3)
    rows[-1].set_xlabel("time [s]")
    figure.suptitle(archive.index.title or archive.path.resolve().name, fontsize=10)
    return figure
