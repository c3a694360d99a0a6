"""UPS304."""

from __future__ import annotations

from collections.abc import Iterator

from ups.diagnostics import Diagnostic, Fix
from ups.element import Element
from ups.rules.old_forms.old_form import OldForm, is_gas, without

_GRAIN = "materials of particles take their pressure from the constitutive model"

OBSOLETE: dict[str, dict[str, str]] = {
    "MPM": {
        "UseMomentumForm": "velocities follow from momentum always",
        "accumulate_strain_energy": "save AccStrainEnergy instead",
        "delete_rogue_particles": "particles that leave the grid are removed always",
        "turn_on_adiabatic_heating": "materials heat unless <isothermal> says otherwise",
        "use_particle_normals": "contact laws choose how they find normals",
        "computeNormals": "contact laws choose how they find normals",
        "useLogisticRegression": "choose a contact of type friction_LR",
        "d_ndim": "the grid says how many dimensions there are",
        "extra_solver_flushes": "read by a linear solver of earlier versions",
        "ForceBC_force_increment_factor": "forces follow their load curves",
    },
    "material": {
        "heat_transfer_coefficient": "heat is exchanged through thermal contact",
        "velocity_field": "every material has its own velocity field",
        "burn": "reactions are given in <Models>",
    },
    "PhysicalConstants": {
        "ideal_gas_constant": "each gas gives its own constant",
        "pressure": "the surroundings' pressure is <reference_pressure>",
    },
    "turbulence": {"turb_Pr": "the turbulent Prandtl number is fixed"},
    "DDT1": {"rho0": "the material gives its density"},
    "CFD": {"CanAddICEMaterial": "materials cannot be added during a run"},
    "constitutive_model": {"StrainEnergy": "nothing reads it"},
}
"""Parent -> tag -> why nothing reads it."""

OF_PARTICLES: dict[str, str] = {"gamma": _GRAIN, "EOS": _GRAIN}
"""Tags of gases that materials of particles used to have."""


class ObsoleteTag(OldForm):
    """A tag that earlier versions of Uintah read, and nothing reads today.

    **Why.** Uintah's validator stops at the first of these, although the deck means the same without them.

    **Example.** ``<MPM> <UseMomentumForm>true</UseMomentumForm> ... </MPM>``

    **Repair.** Remove the tag; ``--fix`` does it.
    """

    code = "UPS304"
    title = "tag without effect"

    def modernise(self, root: Element) -> Iterator[Diagnostic]:
        """Remove obsolete tags wherever they stand."""
        for parent in list(root.iter()):
            table = OBSOLETE.get(parent.tag, {})
            if parent.tag == "material" and parent.parent is not None and parent.parent.tag == "MPM":
                table = table | _gas_tags(parent)
            gone = [child for child in parent.children if child.tag in table]
            for child in gone:
                message = f"<{child.tag}> in <{parent.tag}> has no effect today: {table[child.tag]}"
                yield self.note(message, child, "remove it", Fix((child.removed(),)))
            if gone:
                without(parent, *gone)


def _gas_tags(material: Element) -> dict[str, str]:
    """The tags of a gas that a material of particles has without need."""
    return {tag: why for tag, why in OF_PARTICLES.items() if not (tag == "gamma" and is_gas(material))}
