"""Parameters and state of the Arenisca models, declared once for all of them."""

from __future__ import annotations

from typing import Annotated, NamedTuple, TypeAlias

from solver.declare import Parameter
from solver.particles import Array, StateVariable

_UNUSED = "Uintah requires and never uses it"
_UNREAD = "Uintah's grammar has it, its model does not read it"

PeakI1: TypeAlias = Annotated[
    float, Parameter("first invariant (tension positive) at the vertex of the shear limit", unit="Pa", ge=0.0)
]
Fslope: TypeAlias = Annotated[float, Parameter("slope of sqrt(J2) over -I1 at the vertex", ge=0.0)]
Stren: TypeAlias = Annotated[float, Parameter("shear limit sqrt(J2) at high pressure", unit="Pa", ge=0.0)]
Yslope: TypeAlias = Annotated[float, Parameter("slope of sqrt(J2) over -I1 at high pressure", ge=0.0)]
Beta: TypeAlias = Annotated[
    float, Parameter("ratio of plastic shear to that of associated flow; 1: associated", gt=0.0)
]
B0: TypeAlias = Annotated[float, Parameter("bulk modulus at low pressure", unit="Pa", gt=0.0)]
B1: TypeAlias = Annotated[float, Parameter("bulk modulus gained up to high pressure", unit="Pa", ge=0.0)]
B2: TypeAlias = Annotated[float, Parameter("first invariant over which it is gained", unit="Pa", ge=0.0)]
B3: TypeAlias = Annotated[float, Parameter("bulk modulus lost by plastic compaction", unit="Pa")]
B4: TypeAlias = Annotated[float, Parameter("plastic volume strain over which it is lost")]
G0: TypeAlias = Annotated[float, Parameter("shear modulus at low pressure", unit="Pa", gt=0.0)]
G1: TypeAlias = Annotated[
    float, Parameter("Poisson ratio at low pressure, where G2 is given; 0: constant shear modulus")
]
G2: TypeAlias = Annotated[float, Parameter("Poisson ratio gained up to high pressure; 0: see G1")]
UnusedShear: TypeAlias = Annotated[float, Parameter("a constant of the shear modulus", ignored=_UNUSED)]
P0: TypeAlias = Annotated[
    float, Parameter("first invariant at which pores begin to close, negative", unit="Pa", lt=0.0)
]
P1: TypeAlias = Annotated[float, Parameter("rate of the crush curve", unit="1/Pa")]
P2: TypeAlias = Annotated[float, Parameter("a constant of the crush curve", unit="1/Pa^2", ignored=_UNUSED)]
P3: TypeAlias = Annotated[
    float, Parameter("plastic volume strain of all pores, positive; 0: no pores", ge=0.0)
]
CapRatio: TypeAlias = Annotated[
    float, Parameter("length of the cap over the length of the yield surface, along the hydrostat", gt=0.0)
]
FluidB0: TypeAlias = Annotated[float, Parameter("bulk modulus of the pore fluid; 0: dry", unit="Pa", ge=0.0)]
FluidPressure: TypeAlias = Annotated[
    float, Parameter("pressure of the pore fluid at the start", unit="Pa", ge=0.0)
]
T1: TypeAlias = Annotated[
    float, Parameter("T1 of the relaxation time T1 / rate^T2; 0: no rate dependence", unit="s", ge=0.0)
]
T2: TypeAlias = Annotated[
    float, Parameter("T2 of the relaxation time T1 / rate^T2; 0: no rate dependence", ge=0.0)
]
SubSteps: TypeAlias = Annotated[
    float, Parameter("sub-steps of a step beyond which a particle is removed", ge=1.0)
]
Disaggregation: TypeAlias = Annotated[
    bool,
    Parameter("whether a body created with more volume than its mass fills crushes down to it, less stiff"),
]
Distribution: TypeAlias = Annotated[
    str,
    Parameter(
        "PEAKI1 of particles as 'weibull, mean, modulus, reference volume, seed'; seed 0: the size effect "
        "alone; empty or a number: PEAKI1 for all",
        source="Brannon and Strack, Sandia National Laboratories",
    ),
]
UnreadModulus: TypeAlias = Annotated[float, Parameter("a bulk modulus", unit="Pa", ignored=_UNREAD)]
UnreadHardening: TypeAlias = Annotated[float, Parameter("a modulus", unit="Pa", ignored=_UNREAD)]


class CapState(NamedTuple):
    """What a particle remembers, (n,) or (n, 3, 3); tensors in the frame that R of F = R U turns.

    The quasi-static stress alone is in the laboratory frame, as the stress of the particle is.
    """

    peak_i1: Annotated[Array, StateVariable("p.peakI1IDist")]
    pore_pressure: Annotated[Array, StateVariable("p.PorePressure")]
    plastic_strain: Annotated[Array, StateVariable("p.ep", "Matrix3")]
    plastic_volume_strain: Annotated[Array, StateVariable("p.evp")]
    elastic_volume_strain: Annotated[Array, StateVariable("p.eve")]
    cap: Annotated[Array, StateVariable("p.CapX")]
    """I1 - zeta at which the cap meets the hydrostat, negative."""
    zeta: Annotated[Array, StateVariable("p.Zeta")]
    """Trace of the isotropic back stress, -3 times the pore pressure felt by the skeleton."""
    crush_limit: Annotated[Array, StateVariable("p.P3")]
    """Plastic volume strain, positive, at which no pores are left."""
    static_stress: Annotated[Array, StateVariable("p.StressQS", "Matrix3")]
    """The stress without rate dependence."""
