"""The parameters that the elastic-plastic metals share, each declared once."""

from __future__ import annotations

from typing import Annotated, Any, TypeAlias

from solver.declare import Parameter, SubModel

BulkModulus: TypeAlias = Annotated[float, Parameter("bulk modulus", unit="Pa", gt=0.0)]
ShearModulus: TypeAlias = Annotated[float, Parameter("shear modulus", unit="Pa", ge=0.0)]
FlowModel: TypeAlias = Annotated[Any, SubModel("flow_stress")]
YieldCondition: TypeAlias = Annotated[Any, SubModel("yield_condition")]
EquationOfState: TypeAlias = Annotated[Any, SubModel("equation_of_state")]
ShearModulusModel: TypeAlias = Annotated[Any, SubModel("shear_modulus")]
MeltingTempModel: TypeAlias = Annotated[Any, SubModel("melting")]
SpecificHeatModel: TypeAlias = Annotated[Any, SubModel("specific_heat")]
DeviatoricStressModel: TypeAlias = Annotated[Any, SubModel("deviatoric_stress")]
StabilityCheck: TypeAlias = Annotated[Any, SubModel("stability")]
DamageModel: TypeAlias = Annotated[Any, SubModel("damage")]
ReturnAlgorithm: TypeAlias = Annotated[Any, SubModel("return_algorithm")]
TaylorQuinney: TypeAlias = Annotated[
    float, Parameter("part of the plastic work that becomes heat", ge=0.0, le=1.0)
]
Isothermal: TypeAlias = Annotated[bool, Parameter("whether the material's own heating is left out")]
ComputeSpecificHeat: TypeAlias = Annotated[
    bool, Parameter("whether specific_heat_model is used instead of the material's specific_heat")
]
DoMelting: TypeAlias = Annotated[bool, Parameter("whether shear stress vanishes above melting")]
EvolvePorosity: TypeAlias = Annotated[bool, Parameter("whether voids nucleate and grow")]
MeanPorosity: TypeAlias = Annotated[float, Parameter("mean porosity at the start", ge=0.0, lt=1.0)]
PorositySpread: TypeAlias = Annotated[
    float, Parameter("standard deviation of the porosity at the start", ge=0.0)
]
PorosityDistribution: TypeAlias = Annotated[Any, SubModel("distribution")]
CriticalPorosity: TypeAlias = Annotated[float, Parameter("porosity at failure", gt=0.0, le=1.0)]
NucleatedFraction: TypeAlias = Annotated[
    float, Parameter("volume fraction of the particles at which voids nucleate", ge=0.0)
]
NucleationStrain: TypeAlias = Annotated[float, Parameter("mean plastic strain of nucleation")]
NucleationSpread: TypeAlias = Annotated[
    float, Parameter("standard deviation of the plastic strain of nucleation", gt=0.0)
]
CheckPorosity: TypeAlias = Annotated[bool, Parameter("whether a particle fails at the critical porosity")]
BreakByStrain: TypeAlias = Annotated[
    bool,
    Parameter(
        "whether the criterion of porosity f^2 / f_c^2 > 1 becomes TEPLA-F as it was published, "
        "f^2 / f_c^2 + D^2 > 1 with the damage D of johnson_cook or hancock_mackenzie"
    ),
]
CheckStress: TypeAlias = Annotated[bool, Parameter("whether a particle fails at the critical stress")]
CriticalStress: TypeAlias = Annotated[
    float, Parameter("largest principal stress at failure", unit="Pa", gt=0.0)
]
Tolerance: TypeAlias = Annotated[
    float, Parameter("tolerance of the flow stress", ignored="no flow model of Uintah's uses it")
]
ReferenceTemperature: TypeAlias = Annotated[
    float,
    Parameter(
        "temperature of the reference state",
        unit="K",
        ignored="internal energy is integrated, not derived from temperature",
    ),
]
ThermalExpansion: TypeAlias = Annotated[
    float,
    Parameter("linear thermal expansion", unit="1/K", ignored="only the implicit integrator has it"),
]
ModifiedEos: TypeAlias = Annotated[
    bool,
    Parameter(
        "a power law instead of the bulk modulus in expansion, beside a gas",
        ignored="only the coupled gas-solid method asks the material for its density at a pressure",
    ),
]
EvolveDamage: TypeAlias = Annotated[bool, Parameter("whether damage grows with plastic strain")]
