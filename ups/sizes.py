"""How much memory a run takes, and how much its archive, foreseen from a deck."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

BYTES_A_PARTICLE = 700
"""Memory that a particle takes: its state and that of its model, at the start and the end of a step."""

BYTES_A_NODE = 250
"""Memory that a node takes for each material."""

_UNITS = ("B", "kB", "MB", "GB", "TB")
_TENSORS = ("stress", "deformationMeasure", "velGrad", "size", "scalefactor", "rotation")
_VECTORS = ("p.x", "velocity", "disp", "force", "acceleration", "Gradient", "separation", "norm", "tang")


def size_of_output(labels: Iterable[str], counts: Mapping[str, float], *, single: bool = False) -> float:
    """Bytes of one output of some variables.

    Parameters
    ----------
    labels : the variables that are saved; sums over time take nothing to speak of.
    counts : the number of values of labels by what these begin with, such as ``p.`` and ``g.``.
    single : whether numbers are written in single precision.
    """
    width = 4 if single else 8
    return sum(
        width * components(label) * count
        for label in labels
        for prefix, count in counts.items()
        if label.startswith(prefix)
    )


def components(label: str) -> int:
    """How many numbers a variable has: nine for tensors, three for vectors."""
    if any(word in label for word in _TENSORS):
        return 9
    return 3 if any(word in label for word in _VECTORS) else 1


def readable_size(count: float) -> str:
    """Bytes for reading."""
    unit = 0
    while count >= 1000.0 and unit < len(_UNITS) - 1:
        count, unit = count / 1000.0, unit + 1
    return f"{count:.3g} {_UNITS[unit]}"
