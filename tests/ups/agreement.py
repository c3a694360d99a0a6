"""How far two archives of one deck are apart."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ups.archive import Archive


def particles_by_id(archive: Archive, step: int, label: str, material: int) -> Any:
    """The values of a variable on the particles, or zones, of a material, in the order of their ids."""
    identity = "p.particleID" if material in archive.materials(step, "p.particleID") else "cz.CZID"
    order = np.argsort(archive.particles(step, identity, material))
    return archive.particles(step, label, material)[order].astype(float)


def disagreement(first: Path, second: Path) -> dict[str, float]:
    """By variable and history the largest difference, over the largest value that ``first`` has in the run.

    Asserts that both have the same steps, variables and particles.
    """
    a, b = Archive(first), Archive(second)
    steps = [t.step for t in a.timesteps]
    assert steps == [t.step for t in b.timesteps]
    difference: dict[str, float] = {}
    scale: dict[str, float] = {}

    def compare(name: str, x: Any, y: Any) -> None:
        assert x.shape == y.shape, name
        scale[name] = max(scale.get(name, 0.0), np.abs(x).max(initial=0.0))
        difference[name] = max(difference.get(name, 0.0), np.abs(x - y).max(initial=0.0))

    for step in steps:
        assert a.labels(step) == b.labels(step)
        for label in a.labels(step):
            for material in a.materials(step, label):
                if a.variables[label].is_particle:
                    compare(label, *(particles_by_id(archive, step, label, material) for archive in (a, b)))
                else:
                    compare(
                        label, *(archive.grid_variable(step, label, material).values for archive in (a, b))
                    )
    assert set(a.reductions) == set(b.reductions)
    for name in a.reductions:
        compare(name, a.reductions[name].values, b.reductions[name].values)
    return {name: difference[name] / (scale[name] or 1.0) for name in difference}
