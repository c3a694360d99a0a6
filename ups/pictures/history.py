"""Pictures of histories: sums over the body, step by step."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ups.archive import Archive, ArchiveError, Reduction
from ups.archive.units import unit_of, with_unit
from ups.diagnostics import did_you_mean
from ups.pictures import flat

_SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".pdf", ".svg")
_COMPONENTS = {3: ("X", "Y", "Z"), 9: ("XX", "XY", "XZ", "YX", "YY", "YZ", "ZX", "ZY", "ZZ")}


def plot_histories(archive_path: str | Path, names: Sequence[str], out: str | Path) -> Path:
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

    Raises
    ------
    ArchiveError
        Where a history is not there or the picture cannot be written.
    """
    out = Path(out)
    archive = Archive(archive_path)
    if out.suffix.lower() not in _SUFFIXES:
        message = f"no format of pictures is known by the suffix {out.suffix!r}"
        raise ArchiveError(out, message, advice=f"give a name ending in {', '.join(_SUFFIXES)}")
    curves = [curve for name in names or _numbers(archive) for curve in _curves(archive, name)]
    if not curves:
        raise ArchiveError(archive.path, "there are no histories to show")
    try:
        flat.save(_draw(archive, curves), out)
    except OSError as error:
        raise ArchiveError.from_os_error(out, "write the picture", error) from error
    return out


def _numbers(archive: Archive) -> list[str]:
    return [name for name, history in archive.reductions.items() if history.values.ndim == 1]


def _curves(archive: Archive, name: str) -> list[tuple[str, str, np.ndarray, np.ndarray]]:
    """Name, unit, times and values of each component of a history, or of the one asked for."""
    label, colon, wanted = name.partition(":")
    if label not in archive.reductions:
        nearest = did_you_mean(label, archive.reductions)
        there = f"there are: {', '.join(archive.reductions) or 'none'}"
        advice = f"did you mean {nearest}? {there}" if nearest else there
        raise ArchiveError(archive.path, f"there is no history {label}", advice=advice)
    history: Reduction = archive.reductions[label]
    unit = unit_of(history.name)
    if np.isnan(history.times).any():
        raise ArchiveError(
            archive.path, f"the history {label} has no times", advice="let the deck write them"
        )
    if history.values.ndim == 1:
        components: tuple[str, ...] = ()
        curves = [(label, unit, history.times, history.values)]
    else:
        components = _COMPONENTS.get(history.values.shape[1], ())
        pairs = zip(components, history.values.T, strict=True)
        curves = [(f"{label}:{c}", unit, history.times, v) for c, v in pairs if not colon or c == wanted]
    if colon and wanted not in components:
        advice = f"there are: {', '.join(components)}" if components else "it is a number"
        raise ArchiveError(archive.path, f"the history {label} has no component {wanted}", advice=advice)
    return curves


def _draw(archive: Archive, curves: Sequence[tuple[str, str, np.ndarray, np.ndarray]]) -> flat.Figure:
    from matplotlib.figure import Figure

    units = list(dict.fromkeys(unit for _name, unit, _times, _values in curves))
    figure = Figure(figsize=(8.0, 1.0 + 3.4 * len(units)), dpi=120, layout="constrained")
    rows = figure.subplots(len(units), 1, sharex=True, squeeze=False)[:, 0]
    for axes, unit in zip(rows, units, strict=True):
        group = [curve for curve in curves if curve[1] == unit]
        for name, _unit, times, values in group:
            axes.plot(times, values, label=name, linewidth=1.2, marker="." if len(times) == 1 else None)
        alone = group[0][0] if len(group) == 1 else ""
        axes.set_ylabel(with_unit(alone, unit).strip() or "value")
        if not alone:
            axes.legend(fontsize=8)
        axes.grid(alpha=0.3)
    rows[-1].set_xlabel("time [s]")
    figure.suptitle(archive.index.title or archive.path.resolve().name, fontsize=10)
    return figure
