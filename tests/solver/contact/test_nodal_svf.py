from __future__ import annotations

import numpy as np
import pytest

from solver.contact.nodal_svf import NodalVolumeFraction


@pytest.mark.parametrize("use_svf", [True, False])
def test_drag_agrees_with_its_equation(scene, use_svf):
    s = scene()
    s.node_to_cell_weight[::3] = 0.25
    mass, before = s.nodal.mass, s.nodal.velocity_star.copy()
    expected = before.copy()
    for n in np.flatnonzero(s.owned_nodes):
        w = 8.0 * s.node_to_cell_weight[n]
        fraction = w * s.nodal.volume[:, n] / s.cell_volume
        factor = fraction[0] * fraction[2] if use_svf else float(mass[0, n] > 0.1 and mass[2, n] > 0.1)
        force = 7.0 * s.cell_volume * factor * (before[2, n] - before[0, n])
        expected[0, n] += force * s.dt / (w * mass[0, n])
        expected[2, n] -= force * s.dt / (w * mass[2, n])
    NodalVolumeFraction(materials=(0, 2), myu=7.0, use_svf=use_svf).apply(2, s)
    assert not np.array_equal(expected, before)
    np.testing.assert_allclose(s.nodal.velocity_star, expected, rtol=1e-12)


def test_drag_acts_after_the_forces_only(scene):
    s = scene(2)
    before = s.nodal.velocity.copy()
    NodalVolumeFraction(myu=7.0, use_svf=False).apply(1, s)
    np.testing.assert_array_equal(s.nodal.velocity, before)


def test_drag_needs_two_materials():
    NodalVolumeFraction(myu=1.0, use_svf=True).check(2)
    NodalVolumeFraction(materials=(0, 2), myu=1.0, use_svf=True).check(3)
    with pytest.raises(ValueError, match="nodal_svf acts on two <materials>, here it has 3"):
        NodalVolumeFraction(myu=1.0, use_svf=True).check(3)
