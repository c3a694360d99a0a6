"""An elastic-plastic material that swells by diffusion."""

from __future__ import annotations

from typing import Annotated, Any

from solver.declare import Parameter, Section, SubModel
from solver.materials.deviatoric_stress import DEVIATORIC_STRESS
from solver.materials.equation_of_state import EQUATION_OF_STATE
from solver.materials.flow_stress import FLOW_STRESS
from solver.materials.melting import MELTING
from solver.materials.return_algorithm import RETURN_ALGORITHM
from solver.materials.shear_modulus import SHEAR_MODULUS
from solver.materials.stability import STABILITY
from solver.materials.yield_condition import YIELD_CONDITION
from ups.grammar import known


@known("constitutive_model", "rf_elastic_plastic")
class DiffusionElasticPlastic(Section):
    """An elastic-plastic electrode that swells by diffusion."""

    bulk_modulus: Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
    shear_modulus: Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)]
    volume_expansion_coeff: Annotated[float, Parameter("swelling by a unit of concentration")] = 0.0
    useModifiedEOS: Annotated[bool, Parameter("stiffen in compression")] = False
    tolerance: Annotated[float, Parameter("tolerance of the flow stress")] = 1.0e-10
    initial_material_temperature: Annotated[float, Parameter("temperature at the start", unit="K")] = 294.0
    taylor_quinney_coeff: Annotated[float, Parameter("part of the plastic work that becomes heat")] = 0.9
    isothermal: Annotated[bool, Parameter("leave out the material's own heating")] = False
    do_melting: Annotated[bool, Parameter("let shear stress vanish above melting")] = True
    evolve_porosity: Annotated[bool, Parameter("let voids grow")] = True
    evolve_damage: Annotated[bool, Parameter("let damage grow")] = True
    check_TEPLA_failure_criterion: Annotated[bool, Parameter("fail at the critical porosity")] = True
    check_max_stress_failure: Annotated[bool, Parameter("fail at the critical stress")] = False
    flow_model: Annotated[Any, SubModel(FLOW_STRESS.name)] = None
    yield_condition: Annotated[Any, SubModel(YIELD_CONDITION.name)] = None
    equation_of_state: Annotated[Any, SubModel(EQUATION_OF_STATE.name)] = None
    shear_modulus_model: Annotated[Any, SubModel(SHEAR_MODULUS.name)] = None
    melting_temp_model: Annotated[Any, SubModel(MELTING.name)] = None
    deviatoric_stress_model: Annotated[Any, SubModel(DEVIATORIC_STRESS.name)] = None
    stability_check: Annotated[Any, SubModel(STABILITY.name)] = None
    plastic_convergence_algo: Annotated[Any, SubModel(RETURN_ALGORITHM.name)] = None
