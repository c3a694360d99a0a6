"""What the sub-models of an elastic-plastic material know of a particle."""

from __future__ import annotations

from typing import NamedTuple

from solver.dispatch import inline


class PlasticityState(NamedTuple):
    """State of one particle on which flow stress, shear modulus, melting temperature and the like depend.

    Specific heat, melting temperature and shear modulus are evaluated in this order at the start of a step;
    until each is, the field holds the material's constant.
    """

    plastic_strain: float
    """Equivalent plastic strain."""
    plastic_strain_rate: float
    """Equivalent plastic strain rate, 1/s."""
    strain_rate: float
    """Equivalent rate of the whole deformation sqrt(2/3) |d|, 1/s."""
    temperature: float
    mean_stress: float
    """tr(stress) / 3 at the start of the step, positive in tension."""
    density: float
    """At the end of the step."""
    initial_density: float
    energy: float
    """Specific internal energy at the start of the step, J/kg."""
    bulk_modulus: float
    shear_modulus: float
    melt_temperature: float
    specific_heat: float


@inline
def at_plastic_strain(
    state: PlasticityState, plastic_strain: float, plastic_strain_rate: float
) -> PlasticityState:
    """The same state at another plastic strain and plastic strain rate."""
    return PlasticityState(
        plastic_strain,
        plastic_strain_rate,
        state.strain_rate,
        state.temperature,
        state.mean_stress,
        state.density,
        state.initial_density,
        state.energy,
        state.bulk_modulus,
        state.shear_modulus,
        state.melt_temperature,
        state.specific_heat,
    )


@inline
def with_thermal_properties(
    state: PlasticityState, specific_heat: float, melt_temperature: float, shear_modulus: float
) -> PlasticityState:
    """The same state with its temperature-dependent properties evaluated."""
    return PlasticityState(
        state.plastic_strain,
        state.plastic_strain_rate,
        state.strain_rate,
        state.temperature,
        state.mean_stress,
        state.density,
        state.initial_density,
        state.energy,
        state.bulk_modulus,
        shear_modulus,
        melt_temperature,
        specific_heat,
    )
