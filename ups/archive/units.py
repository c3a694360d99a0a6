"""Units of the variables that Uintah's labels name, for decks in SI as the shipped ones are.

Archives do not store units: a deck may use any consistent set. What is given here is what the numbers
are in when the deck's are in metres, kilograms, seconds and kelvins.
"""

from __future__ import annotations

_PLAIN = {
    "x": "m",
    "position": "m",
    "displacement": "m",
    "velocity": "m/s",
    "velocity_star": "m/s",
    "acceleration": "m/s^2",
    "velocityGradient": "1/s",
    "mass": "kg",
    "volume": "m^3",
    "stress": "Pa",
    "stressFS": "Pa",
    "temperature": "K",
    "temperatureRate": "K/s",
    "temperatureGradient": "K/m",
    "externalforce": "N",
    "internalforce": "N",
    "plasticStrainRate": "1/s",
    "deformationMeasure": "1",
    "plasticStrain": "1",
    "damage": "1",
    "concentration": "1",
    "concentrationGradient": "1/m",
    "concentrationRate": "1/s",
    "concentrationStar": "1",
    "diffusivity": "m^2/s",
    "area": "m^2",
    "swelling": "1",
    "p_c": "Pa",
    "elasticStrain": "1",
    "porosity": "1",
    "cz.area": "m^2",
    "cz.disptop": "m",
    "cz.dispbottom": "m",
    "cz.separation": "m",
    "cz.force": "N",
    "press_CC": "Pa",
    "press_equil_CC": "Pa",
    "temp_CC": "K",
    "rho_CC": "kg/m^3",
    "vel_CC": "m/s",
    "sp_vol_CC": "m^3/kg",
    "vol_frac_CC": "1",
    "mom_L_ME_CC": "kg m/s",
    "KineticEnergy": "J",
    "StrainEnergy": "J",
    "AccStrainEnergy": "J",
    "ThermalEnergy": "J",
    "TotalMass": "kg",
    "TotalMomentum": "kg m/s",
    "TotalVolumeDeformed": "m^3",
    "CenterOfMassPosition": "kg m",  # the sum of mass times position, in spite of its name
    "RigidReactionForce": "N",
    "RigidReactionTorque": "N m",
    "SumTransmittedForce": "N",
    "delT": "s",
}
"""Units by label without the prefix that says where it sits; "1" is dimensionless."""

_SITES = ("p.", "g.", "c.")


def plain_name(label: str) -> str:
    """Label without the prefix that says where it sits: ``stress`` for ``p.stress``."""
    return label[2:] if label.startswith(_SITES) and len(label) > 2 else label


def unit_of(label: str) -> str:
    """Unit of a variable or history in a deck of SI units; empty where it is not known.

    >>> unit_of("p.stress"), unit_of("BndyForce_xminus"), unit_of("p.color")
    ('Pa', 'N', '')
    """
    if label.startswith(("BndyForce_", "BndyContactForce_")):
        return "N"
    if label.startswith("BndyTraction_"):
        return "Pa"
    return _PLAIN.get(plain_name(label), "")


def with_unit(label: str, unit: str) -> str:
    """Label of an axis: the name, and the unit in brackets where there is one."""
    return f"{label} [{unit}]" if unit and unit != "1" else label
