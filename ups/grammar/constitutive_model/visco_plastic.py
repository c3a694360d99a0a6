"""Viscoplasticity of ice (SUVIC-I)."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import Parameter, Section, SectionOf, SubModel
from solver.materials.equation_of_state import EQUATION_OF_STATE
from solver.materials.melting import MELTING
from solver.materials.shear_modulus import SHEAR_MODULUS
from solver.materials.stability import STABILITY
from ups.grammar import known


class SuvicI(Section):
    """Strain-rate history dependent unified viscoplasticity for ice."""

    type: Annotated[str, Parameter("the model", choices=("suvic_i",), attribute=True)]
    coeff_backstress_evol: Annotated[float, Parameter("rate of the back stress")] = 0.0
    exponent_backstress_evol: Annotated[float, Parameter("exponent of its saturation")] = 0.0
    normalizing_backstress: Annotated[float, Parameter("reference back stress", unit="Pa")] = 0.0
    coeff_saturation_backstress: Annotated[float, Parameter("saturated back stress", unit="Pa")] = 0.0
    exponent_backstress: Annotated[float, Parameter("exponent of the back stress")] = 0.0
    ref_strainrate: Annotated[float, Parameter("reference strain rate", unit="1/s")] = 0.0
    normalizing_inelastic_strainrate: Annotated[float, Parameter("reference rate of flow", unit="1/s")] = 0.0
    activation_energy: Annotated[float, Parameter("activation energy", unit="J/mol")] = 0.0
    universal_gas_constant: Annotated[float, Parameter("gas constant", unit="J/(mol K)")] = 8.3144
    temperature: Annotated[float, Parameter("temperature", unit="K")] = 0.0
    exponent_inelastic_strainrate: Annotated[float, Parameter("exponent of the rate of flow")] = 0.0
    coeff_yieldstress_saturation: Annotated[float, Parameter("saturated yield stress", unit="Pa")] = 0.0
    exponent_yieldstress: Annotated[float, Parameter("exponent of the yield stress")] = 0.0
    coeff_yieldstress_evol: Annotated[float, Parameter("rate of the yield stress")] = 0.0
    exponent_dragstress: Annotated[float, Parameter("exponent of the drag stress")] = 0.0
    coeff_dragstress_evol: Annotated[float, Parameter("rate of the drag stress")] = 0.0
    coeff_stress_saturation: Annotated[float, Parameter("saturated stress", unit="Pa")] = 0.0
    intial_drag: Annotated[float, Parameter("drag stress at the start", unit="Pa")] = 0.0
    initial_yield: Annotated[float, Parameter("yield stress at the start", unit="Pa")] = 0.0
    integration_parameter_theta: Annotated[float, Parameter("weight of the end of the step")] = 0.5


@known("constitutive_model", "visco_plastic")
class ViscoPlastic(Section):
    """A hypoelastic material with viscoplastic flow."""

    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    shear_modulus: Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)]
    visco_plasticity_model: Annotated[
        Any, SectionOf("ups.grammar.constitutive_model.visco_plastic:SuvicI"), Parameter("law of the flow")
    ] = None
    equation_of_state: Annotated[Any, SubModel(EQUATION_OF_STATE.name)] = None
    stability_check: Annotated[Any, SubModel(STABILITY.name)] = None
    shear_modulus_model: Annotated[Any, SubModel(SHEAR_MODULUS.name)] = None
    melting_temp_model: Annotated[Any, SubModel(MELTING.name)] = None
    coeff_thermal_expansion: Annotated[float, Parameter("thermal expansion", unit="1/K")] = 0.0
    useModifiedEOS: Annotated[bool, Parameter("stiffen in compression")] = False
    remove_particles: Annotated[bool, Parameter("remove what fails")] = True
    zero_stress_upon_failure: Annotated[bool, Parameter("let failed particles carry no stress")] = False
    allow_no_tension: Annotated[bool, Parameter("let failed particles carry no tension")] = False
    check_failure: Annotated[bool, Parameter("let particles fail")] = False
    use_polar_decomposition_RMB: Annotated[bool, Parameter("polar decomposition by iteration")] = False
    tolerance: Annotated[float, Parameter("tolerance of the flow")] = 1.0e-10
    initial_material_temperature: Annotated[float, Parameter("temperature at the start", unit="K")] = 294.0
    failure_variable_mean: Annotated[float, Parameter("mean strength")] = 0.0
    failure_variable_std: Annotated[float, Parameter("standard deviation of the strength")] = 0.0
    failure_variable_distrib: Annotated[str, Parameter("distribution of the strength")] = "constant"
    failure_by_stress: Annotated[bool, Parameter("compare stress, not strain")] = False
    failure_by_pressure: Annotated[bool, Parameter("compare pressure")] = False
