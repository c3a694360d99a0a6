"""Decks with a diffusing substance, from the text to the archive."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from small_decks import deck, material, write

import ups
from ups.diagnostics import DeckError
from ups.lint import lint_text

ON = "<do_scalar_diffusion>true</do_scalar_diffusion>"
SWELLING = """
    <constitutive_model type="rf_elastic_plastic">
      <bulk_modulus>32.e6</bulk_modulus><shear_modulus>12.e6</shear_modulus>
      <volume_expansion_coeff>0.1</volume_expansion_coeff>
      <flow_model type="isotropic_hardening"><sigma_Y>1e6</sigma_Y><K>0</K></flow_model>
    </constitutive_model>"""
GROWING = """<diffusion_model type="constant_rate"><constant_rate>4.0</constant_rate>
      <diffusivity>1e-3</diffusivity><max_concentration>1.0</max_concentration></diffusion_model>"""
FICK = """<diffusion_model type="jg"><diffusivity>0.5</diffusivity><max_concentration>1.0</max_concentration>
      </diffusion_model>"""


def bar(models: str, start: str = "0.0") -> str:
    return material("[0.1,0.1,0.0]", "[0.5,0.3,0.1]", "[0.0,0.0,0.0]", models).replace(
        "</geom_object>", f"<concentration>{start}</concentration></geom_object>"
    )


def test_a_free_bar_swells_by_the_strain_of_its_lattice(tmp_path: Path) -> None:
    # in the plane the walls of z hold: F = diag(e, e, 1) with the strain of plane stress in z pressed
    path = write(
        tmp_path,
        deck(
            materials=bar(SWELLING + GROWING),
            flags=ON + "<artificial_damping_coeff>50.0</artificial_damping_coeff>",
            time="",
            max_time="0.1",
            archiver="<outputInterval>0.1</outputInterval><outputLastTimestep>true</outputLastTimestep>",
            saves=("p.x", "p.concentration", "p.swelling", "p.stress", "p.deformationMeasure", "p.volume"),
        ),
    )
    result = ups.read(path).run(output=tmp_path / "swells.uda")
    c = result["p.concentration"][-1]
    np.testing.assert_allclose(c, 0.4, rtol=0.02)
    strain = 0.1 * c.mean()
    F = result["p.deformationMeasure"][-1].mean(axis=0)
    # held in z, free in x and y: Poisson's ratio adds nu times the strain that z is denied
    nu = (3 * 32 - 2 * 12) / (2 * (3 * 32 + 12))
    expected = np.exp(strain * (1 + nu))
    assert F[0, 0] == pytest.approx(expected, abs=2e-3)
    assert F[1, 1] == pytest.approx(expected, abs=2e-3)
    assert F[2, 2] == pytest.approx(1.0, abs=1e-9)


def test_a_substance_spreads_and_stays(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        deck(
            materials=bar(SWELLING + FICK + "<do_conc_reduction>true</do_conc_reduction>", "0.25"),
            flags=ON,
            saves=("p.x", "p.concentration", "g.concentration", "g.concentrationRate", "TotalConc"),
        ),
    )
    result = ups.read(path).run(output=tmp_path / "spreads.uda")
    np.testing.assert_allclose(result["p.concentration"][-1], 0.25, rtol=1e-12)
    assert result["g.concentration"][-1].max() == pytest.approx(0.25)
    total = np.loadtxt(tmp_path / "spreads.uda" / "TotalConc.dat")
    np.testing.assert_allclose(total[:, 1], 0.25 * 4 * 2 * 4, rtol=1e-12)


def test_a_material_without_a_law(tmp_path: Path) -> None:
    path = write(tmp_path, deck(materials=bar(SWELLING), flags=ON))
    with pytest.raises(DeckError) as found:
        ups.read(path).run(output=tmp_path / "none.uda")
    assert any("needs a <diffusion_model>" in d.message for d in found.value.diagnostics)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (deck(materials=bar(SWELLING + FICK.replace('"jg"', '"jgg"')), flags=ON), "UPS209"),
        (deck(materials=bar(SWELLING + FICK.replace("diffusivity>", "difusivity>")), flags=ON), "UPS102"),
        (deck(materials=bar(SWELLING + FICK.replace("0.5", "-1.0")), flags=ON), "UPS208"),
        (deck(materials=bar(SWELLING + FICK.replace('"jg"', '"non_linear2"')), flags=ON), "UPS412"),
        (
            deck(materials=bar(SWELLING + FICK), flags=ON + "<with_gauss_solver>true</with_gauss_solver>"),
            "UPS412",
        ),
    ],
)
def test_what_is_wrong_or_not_run_is_said(text: str, code: str) -> None:
    assert code in {d.code for d in lint_text(text).diagnostics}


def test_several_levels_are_refused(tmp_path: Path) -> None:
    text = deck(materials=bar(SWELLING + FICK), flags=ON).replace('type="mpm"', 'type="amrmpm"')
    with pytest.raises(DeckError) as found:
        ups.read(write(tmp_path, text)).run(output=tmp_path / "levels.uda")
    assert any("amrmpm" in d.message for d in found.value.diagnostics)
