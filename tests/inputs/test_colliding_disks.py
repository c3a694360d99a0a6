"""Two disks: what an elastic collision has to keep."""

from __future__ import annotations

import numpy as np
import pytest
from shipped_decks import run_shipped

import ups


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> ups.Result:
    return run_shipped("collidingDisks", tmp_path_factory.mktemp("disks"))


def test_the_kinetic_energy_at_the_start_is_that_of_two_disks(result: ups.Result) -> None:
    # 2 (1/2) rho pi R^2 h v^2 = 0.1257 h with h = 0.05; particles on a lattice fill 208 / 201.06 of a disk.
    exact = 1000.0 * np.pi * 0.2**2 * 0.05 * (0.1**2 + 0.1**2)
    assert result["KineticEnergy"][0] == pytest.approx(exact * 208 * 0.025**2 / (np.pi * 0.04), rel=1e-12)


def test_nothing_changes_before_they_share_a_node(result: ups.Result) -> None:
    times, energy = result.history("KineticEnergy")
    # Surfaces 0.307 m apart close at 0.283 m/s; they share nodes at the diagonal of two cells, 0.141 m.
    assert energy[times < 0.58] == pytest.approx(energy[0], rel=1e-12)
    assert energy[times > 1.0].min() < 0.9 * energy[0]


def test_they_come_almost_to_rest_and_fly_apart(result: ups.Result) -> None:
    # Uintah's sus on this deck: least at 1.438 s, 0.0178 of that at the start; 0.9000 of it at 3 s.
    times, energy = result.history("KineticEnergy")
    assert times[np.argmin(energy)] == pytest.approx(1.43825434, rel=1e-8)
    assert energy.min() / energy[0] == pytest.approx(0.0177618, rel=1e-5)
    assert energy[-1] / energy[0] == pytest.approx(0.9000057, rel=1e-6)


def test_energy_is_kept(result: ups.Result) -> None:
    total = result["KineticEnergy"] + result["StrainEnergy"]
    assert total == pytest.approx(total[0], rel=0.07)
    assert total.max() < 1.01 * total[0]


def test_momentum_is_kept_and_each_disk_turns_back(result: ups.Result) -> None:
    momentum = result["TotalMomentum"]
    one_disk = 0.1 * 6.5 * 0.05
    assert np.abs(momentum).max() < 1e-12 * one_disk
    velocity, position = result["p.velocity"][-1], result["p.x"][-1]
    lower = position.sum(axis=1) < position.sum(axis=1).mean()
    restitution = -velocity[lower, :2].mean(axis=0) / 0.1
    assert restitution[0] == pytest.approx(restitution[1], rel=1e-9)
    assert 0.9 < restitution[0] < 1.0


def test_the_picture_stays_symmetric_about_its_centre(result: ups.Result) -> None:
    position = result["p.x"][-1][:, :2]
    turned = 1.0 - position
    order, turned_order = np.lexsort(position.round(6).T), np.lexsort(turned.round(6).T)
    assert position[order] == pytest.approx(turned[turned_order], abs=1e-9)
