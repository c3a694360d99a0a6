"""A material looked at without a run: one point of it along a strain path, as numbers, CSV or a picture."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TextIO

import numpy as np
from numpy.typing import NDArray

from ups.deck import MaterialSection, find_data_file, read_deck
from ups.diagnostics import DeckError, Diagnostics, suggestion_for
from ups.document import read_document
from ups.materials import MaterialEntry, MaterialFile, common_models, find_material
from ups.reader import Reader

if TYPE_CHECKING:
    from solver.point_driver import Path as StrainPath
    from solver.point_driver import PointHistory

MODES = ("uniaxial-strain", "uniaxial-stress", "simple-shear", "hydrostatic")
"""The strain paths of constant rate."""

FAMILIES = {
    "flow": "flow_model",
    "eos": "equation_of_state",
    "shear": "shear_modulus_model",
    "melting": "melting_temp_model",
    "specific_heat": "specific_heat_model",
}
"""What ``run_point`` calls the choices of a catalogue material -> their tags."""

_PREFERRED = {
    "flow": ("johnson_cook", "mts_model", "steinberg_cochran_guinan"),
    "eos": ("mie_gruneisen", "default_hypo"),
    "shear": ("constant_shear",),
    "melting": ("constant_Tm",),
}
_COMPANIONS = {
    "mts_model": {"shear": "mts_shear"},
    "steinberg_cochran_guinan": {"shear": "scg_shear", "melting": "scg_Tm"},
    "preston_tonks_wallace": {"shear": "ptw_shear"},
}
"""Models that a flow stress was published with, and so is used with where nothing else is asked for."""


def run_point(
    source: str | os.PathLike[str],
    *,
    material: int = 0,
    mode: str = "uniaxial-stress",
    strain: float | Sequence[float] = 0.5,
    strain_rate: float = 1.0,
    temperature: float | None = None,
    isothermal: bool = False,
    steps: int = 1000,
    table: str | os.PathLike[str] | None = None,
    models: Mapping[str, str] | None = None,
) -> PointHistory:
    """Take a point of a material along a strain path of constant rate, or along a table.

    Parameters
    ----------
    source : a deck (``.ups``), or the name of a material of the catalogue.
    material : index of the deck's material.
    mode : one of ``MODES``. strain_rate : 1/s.
    strain : at the end, negative in compression; or the strains at which the path turns, one after the other.
    temperature : at the start, K; the material's ``room_temp`` without.
    isothermal : keep the temperature. steps : time steps.
    table : a file with rows of time and the nine components of F, row by row, in place of a mode.
    models : choices among the models of a catalogue material by the names of ``FAMILIES``, e.g.
        ``{"flow": "mts_model"}``.

    Raises
    ------
    DeckError
        where the deck, the name, a choice or the path is at fault.
    """
    from solver.point_driver import PointDriverError, drive

    path = Path(source)
    if path.suffix == ".ups" or path.is_file():
        if models:
            _refuse("UPS410", "models are chosen for a material of the catalogue; a deck names its own")
        section = _material_of_deck(path, material)
    else:
        section = catalogue_material(os.fspath(source), models)
    try:
        strain_path = _read_table(Path(table), steps) if table else _path(mode, strain, strain_rate, steps)
        return drive(
            section.constitutive_model,
            section.constants,
            strain_path,
            temperature=temperature,
            isothermal=isothermal,
        )
    except PointDriverError as problem:
        _refuse("UPS601", str(problem))


def catalogue_material(name: str, models: Mapping[str, str] | None = None) -> MaterialSection:
    """A material of the catalogue with the models asked for, or with those that suit each other.

    Raises
    ------
    DeckError
        where there is no such material, no constants for a model, or nothing to make a material of.
    """
    entry = find_material(name)
    text = _deck_text(entry, dict(models or {}))
    document = read_document(f"material {entry.name}", text=text, roots=("material",))
    diagnostics = Diagnostics(document.diagnostics)
    reader = Reader(diagnostics, lambda file: find_data_file(file, Path()))
    section = reader.read(MaterialSection, document.root) if document.root is not None else None
    if section is None or diagnostics.has_errors:
        raise DeckError(diagnostics, document.sources)
    return section


def _deck_text(entry: MaterialEntry, models: dict[str, str]) -> str:
    """The ``<material>`` of a deck, made of includes of the catalogue."""
    unknown = [family for family in models if family not in FAMILIES]
    if unknown:
        hint = suggestion_for(unknown[0], FAMILIES)
        _refuse("UPS410", f"no family {unknown[0]!r}; choose among {', '.join(FAMILIES)}", hint)
    if "flow_model" in entry.models:
        kind, files = "elastic_plastic", _plastic_files(entry, models)
    else:
        if models:
            _refuse("UPS410", f"{entry.name} has no models to choose among")
        kind = next(iter(entry.models.get("constitutive_model", ())), "")
        files = [file for file in entry.files if file.model == kind]
    if not kind:
        _refuse("UPS410", f"{entry.name} has constants, and no model of stress")
    own_switch = "<compute_specific_heat>true</compute_specific_heat>" if "specific_heat" in models else ""
    constants = _include(_needed(entry, "material"))
    content = "".join(map(_include, files)) + own_switch
    return f'<material>{constants}<constitutive_model type="{kind}">{content}</constitutive_model></material>'


def _plastic_files(entry: MaterialEntry, models: dict[str, str]) -> list[MaterialFile]:
    """The include files of an elastic-plastic material."""
    flow = _choose(entry, "flow", models.get("flow"))
    wanted = _COMPANIONS.get(flow.model, {}) | models
    others = [
        _choose(entry, family, wanted.get(family))
        for family in ("eos", "shear", "melting", "specific_heat")
        if family in wanted or family in _PREFERRED
    ]
    von_mises = common_models().file_of("yield_condition", "vonMises")
    assert von_mises is not None
    return [_needed(entry, "constitutive_model"), flow, *others, von_mises]


def _choose(entry: MaterialEntry, family: str, model: str | None) -> MaterialFile:
    """The file of a model of a family: the one asked for, or else the preferred of those there are."""
    tag = FAMILIES[family]
    available = [*entry.models.get(tag, ()), *common_models().models.get(tag, ())]
    if model is None:
        model = next((name for name in (*_PREFERRED[family], *available) if name in available), "")
    file = entry.file_of(tag, model) or common_models().file_of(tag, model)
    if file is None:
        message = f"{entry.name} has no constants for {family} {model!r}; there are {', '.join(available)}"
        _refuse("UPS209", message, suggestion_for(model, available))
    return file


def _needed(entry: MaterialEntry, tag: str) -> MaterialFile:
    """The file with the constants that go straight into an element."""
    file = entry.file_of(tag)
    if file is None:
        _refuse("UPS410", f"{entry.name} has no constants for <{tag}> in the catalogue")
    return file


def _include(file: MaterialFile) -> str:
    return f'<include href="{file.path.as_posix()}"/>'


def _material_of_deck(path: Path, index: int) -> MaterialSection:
    deck = read_deck(path)
    materials = deck.require().MaterialProperties.MPM.material
    if not 0 <= index < len(materials):
        _refuse("UPS402", f"{path}: there are materials 0 to {len(materials) - 1}, not {index}")
    return materials[index]


def _path(mode: str, strain: float | Sequence[float], rate: float, steps: int) -> StrainPath:
    from solver.point_driver import PATHS

    if mode not in PATHS:
        _refuse(
            "UPS209", f"no strain path {mode!r}; known are {', '.join(PATHS)}", suggestion_for(mode, PATHS)
        )
    return PATHS[mode](strain, rate, steps)


def _read_table(path: Path, steps: int) -> StrainPath:
    """A path from a file of rows: time and nine components of F; ``#`` begins a comment."""
    from solver.point_driver import tabulated

    try:
        rows = np.loadtxt(path, ndmin=2)
    except OSError as problem:
        _refuse("UPS408", f"{path}: {problem.strerror or problem}")
    except ValueError as problem:
        _refuse(
            "UPS203", f"{path}: {problem}", "a row is a time and nine components of F; # begins a comment"
        )
    if rows.shape[1:] != (10,):
        _refuse(
            "UPS207", f"{path}: each row is a time and nine components of F, here {rows.shape[-1]} numbers"
        )
    return tabulated(rows[:, 0], rows[:, 1:].reshape(-1, 3, 3), steps)


def _refuse(code: str, message: str, suggestion: str | None = None) -> NoReturn:
    diagnostics = Diagnostics()
    diagnostics.error(code, message, None, suggestion)
    raise DeckError(diagnostics)


# ---- what comes out ----------------------------------------------------------------------------------------


def columns(history: PointHistory) -> dict[str, NDArray[Any]]:
    """Every quantity of a history as named columns of numbers, tensors by component (``stress_xy``)."""
    table: dict[str, NDArray[Any]] = {
        "time": history.time,
        "strain": history.strain,
        "temperature": history.temperature,
        "equivalent_stress": history.equivalent_stress,
        "pressure": history.pressure,
        "localized": history.localized,
    }
    tensors = {"stress": history.stress, "F": history.deformation_gradient} | history.state
    for name, values in tensors.items():
        if values.ndim == 1:
            table[name] = values
            continue
        for index in np.ndindex(values.shape[1:]):
            table[f"{name}_{''.join('xyz'[i] for i in index)}"] = values[(slice(None), *index)]
    return table


def write_csv(history: PointHistory, file: str | os.PathLike[str] | TextIO) -> None:
    """Write all columns of a history as CSV, with a line of names; raises DeckError where it cannot."""
    if not isinstance(file, str | os.PathLike):
        table = columns(history)
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table)
        writer.writerows(zip(*(values.tolist() for values in table.values()), strict=True))
        return
    try:
        with open(file, "w", encoding="utf-8", newline="") as stream:
            write_csv(history, stream)
    except OSError as problem:
        _refuse("UPS408", f"{os.fspath(file)}: {problem.strerror or problem}")


def print_history(history: PointHistory, rows: int = 11, file: TextIO | None = None) -> None:
    """Print strain, stress, temperature and plastic strain at evenly spaced times."""
    from rich.console import Console
    from rich.table import Table

    shown = {
        "time, s": history.time,
        history.strain_name: history.strain,
        "von Mises, MPa": history.equivalent_stress / 1.0e6,
        "pressure, MPa": history.pressure / 1.0e6,
        "T, K": history.temperature,
    }
    if history.plastic_strain is not None:
        shown["plastic strain"] = history.plastic_strain
    table = Table(*shown)
    for row in np.unique(np.linspace(0, len(history.time) - 1, rows).round().astype(int)):
        table.add_row(*(f"{values[row] + 0.0:.5g}" for values in shown.values()))
    Console(file=file).print(table)


def plot_history(history: PointHistory, file: str | os.PathLike[str], title: str = "") -> None:
    """Draw stress and temperature over strain as PNG; raises DeckError where the file cannot be written."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 7.2), layout="constrained")
    stress, heat = figure.subplots(2, 1, sharex=True)
    stress.plot(history.strain, history.equivalent_stress / 1.0e6, label="equivalent")
    for axis, name in enumerate("xyz"):
        stress.plot(
            history.strain, history.stress[:, axis, axis] / 1.0e6, "--", label=f"$\\sigma_{{{name * 2}}}$"
        )
    stress.set(ylabel="stress, MPa", title=title)
    stress.legend()
    heat.plot(history.strain, history.temperature)
    heat.set(xlabel=history.strain_name, ylabel="temperature, K")
    for panel in (stress, heat):
        panel.grid(alpha=0.3)
    try:
        figure.savefig(file, format="png", dpi=150)
    except OSError as problem:
        _refuse("UPS408", f"{os.fspath(file)}: {problem.strerror or problem}")
