"""numpy's .npz: one array for each time step, material and variable.

Keys are ``t00051/0/p.stress`` for particles of material 0 and ``t00051/l0/1/g.mass`` for a grid variable
of material 1 on level 0, indexed [x, y, z], with ``.../g.mass/low`` for the index of its first value.
``steps`` and ``times`` list the time steps; ``history/KineticEnergy`` is a table of times and values.
"""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from ups.convert.registry import Format, Options, atomically, register
from ups.convert.selection import Selection


def write(selection: Selection, out: Path, options: Options) -> list[Path]:
    """Write the selection into one file that `numpy.load` reads."""
    out.parent.mkdir(parents=True, exist_ok=True)
    with (
        atomically(out) as partial,
        zipfile.ZipFile(partial, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
    ):

        def put(key: str, values: np.ndarray) -> None:
            with archive.open(f"{key}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, np.ascontiguousarray(values), allow_pickle=False)

        put("steps", np.array([timestep.step for timestep in selection.timesteps], dtype=np.int64))
        put("times", np.array([timestep.time for timestep in selection.timesteps], dtype=float))
        for name, history in selection.archive.reductions.items():
            put(f"history/{name}", np.column_stack([history.times, history.values]))
        for done, timestep in enumerate(selection.timesteps, 1):
            step, place = timestep.step, f"t{timestep.step:05d}"
            for variable in selection.variables:
                if variable.is_particle:
                    for material in selection.materials_of(step, variable.name):
                        values = selection.of_material(step, variable.name, material)
                        put(f"{place}/{material}/{variable.name}", values)
            for level in selection.archive.grid(step).levels if selection.has_grid else ():
                for material, whole in selection.grid_fields(step, level.index):
                    grid_field = selection.cropped(whole)
                    key = f"{place}/l{level.index}/{material}/{grid_field.variable.name}"
                    put(key, grid_field.values)
                    put(f"{key}/low", np.array(grid_field.origin))
            options.progress(done, len(selection.timesteps))
    return [out]


register(Format("NumPy", (".npz",), write))
