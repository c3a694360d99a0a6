"""An elastic-plastic material that swells by diffusion."""

from __future__ import annotations

from typing import Annotated, Any

import solver.materials.elastic_plastic  # declares the families of its parts
from solver.declare import Parameter, Section, SubModel
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
    flow_model: Annotated[Any, SubModel("flow_stress")] = None
    yield_condition: Annotated[Any, SubModel("yield_condition")] = None
    equation_of_state: Annotated[Any, SubModel("equation_of_state")] = None
    shear_modulus_model: Annotated[Any, SubModel("shear_modulus")] = None
    melting_temp_model: Annotated[Any, SubModel("melting")] = None
    deviatoric_stress_model: Annotated[Any, SubModel("deviatoric_stress")] = None
    stability_check: Annotated[Any, SubModel("stability")] = None
    plastic_convergence_algo: Annotated[Any, SubModel("return_algorithm")] = None
