"""The variables of Uintah that a deck may save: label, meaning and unit."""

from __future__ import annotations

from typing import NamedTuple

from ups.labels import KNOWN_LABELS


class Label(NamedTuple):
    """A variable that an archive may keep."""

    meaning: str = ""
    unit: str = ""


_TABLE = """
p.x | position of particles | m
p.particleID | number that identifies a particle |
p.mass | mass of particles | kg
p.volume | volume of particles | m^3
p.velocity | velocity of particles | m/s
p.displacement | displacement of particles since the start | m
p.acceleration | acceleration of particles | m/s^2
p.temperature | temperature of particles | K
p.tempPrevious | temperature of particles one step earlier | K
p.temperatureGradient | gradient of the temperature | K/m
p.stress | Cauchy stress of particles | Pa
p.deformationMeasure | deformation gradient F of particles |
p.velGrad | velocity gradient of particles | 1/s
p.size | edges of particles at the start, in cells, as columns |
p.scalefactor | edges of deformed particles as columns | m
p.color | number that particles carry along |
p.externalforce | force of loads on particles | N
p.loadCurveID | load curves that act on particles |
p.localizedMPM | 0 for sound particles, more for failed ones |
p.damage | damage of particles |
p.surface | 1 on the surface of a body, else 0 |
p.q | viscous pressure of compression | Pa
p.dTdt | rate of heating by the material itself | K/s
p.externalHeatRate | heat that loads bring | K/s
p.plasticStrain | equivalent plastic strain |
p.plasticStrainRate | rate of the equivalent plastic strain | 1/s
p.strainRate | equivalent strain rate | 1/s
p.porosity | volume share of voids |
p.rotation | rotation of particles, R of F = R U |
p.energy | specific internal energy | J/kg
p.alpha | sum of the plastic multipliers |
p.timeofloc | time at which a particle failed | s
p.stretch | stretch of fibres |
p.fiberdir | direction of fibres |
p.fail | failure of fibres and matrix |
p.crackRad | radius of cracks | m
p.progressF | share of the explosive that has burned |
p.evp | plastic volume strain |
p.eve | elastic volume strain |
p.capX | hydrostatic strength | Pa
p.kappa | where the cap begins | Pa
p.porePressure | pressure of the pore fluid | Pa
cz.area | area of a cohesive zone | m^2
cz.norm | normal of a cohesive zone, from the bottom to the top material |
cz.tang | first tangent of a cohesive zone |
cz.disptop | displacement of the top material at a cohesive zone | m
cz.dispbottom | displacement of the bottom material at a cohesive zone | m
cz.separation | displacement of the top material against the bottom one | m
cz.force | force of a cohesive zone on the bottom material | N
cz.failed | 0 while a cohesive zone is sound, then steps of opening since it failed, at most 1000 |
cz.topmat | index of the top material of a cohesive zone |
cz.botmat | index of the bottom material of a cohesive zone |
cz.CZID | number that tells cohesive zones apart |
p.concentration | concentration of a diffusing substance |
p.concPrevious | the same, one step earlier |
p.concentrationGradient | its gradient | 1/m
p.flux | flux of the substance, up the gradient | m/s
p.diffusivity | diffusion coefficient | m^2/s
p.externalScalarFlux | rate of the concentration by fluxes through the surface | 1/s
p.area | sides of particles that carry a load, across x, y and z | m^2
p.swelling | logarithmic strain by a diffusing substance |
p.p_c | preconsolidation of clay | Pa
p.elasticStrain | elastic strain |
g.mass | mass at nodes | kg
g.volume | volume at nodes | m^3
g.velocity | velocity at nodes at the start of the step | m/s
g.velocity_star | velocity at nodes at the end of the step | m/s
g.acceleration | acceleration at nodes | m/s^2
g.internalforce | force of the stresses at nodes | N
g.externalforce | force of the loads at nodes | N
g.temperature | temperature at nodes | K
g.temperatureRate | rate of the temperature at nodes | K/s
g.stressFS | stress at nodes, averaged by volume | Pa
g.color | color at nodes |
g.concentration | concentration at nodes at the start of the step |
g.concentrationStar | concentration at nodes at the end of the step |
g.concentrationRate | rate of the concentration at nodes | 1/s
g.surfnorm | normal of a body's surface at nodes |
g.contact | 1 where bodies touch |
KineticEnergy | kinetic energy of all particles | J
StrainEnergy | work of the stresses in the step | J
AccStrainEnergy | work of the stresses since the start | J
ThermalEnergy | heat of all particles | J
TotalMass | mass of all particles | kg
TotalMomentum | momentum of all particles | kg m/s
TotalVolumeDeformed | volume of all particles | m^3
CenterOfMassPosition | centre of mass | m
CenterOfMassVelocity | velocity of the centre of mass | m/s
RigidReactionForce | force on a body of prescribed motion | N
RigidReactionTorque | torque on a body of prescribed motion | N m
SumTransmittedForce | force handed on by force-transmitting materials | N
NC_CCweight | weight of a node for the cells around it |
rho_CC | density of a material in cells | kg/m^3
press_CC | pressure in cells | Pa
press_equil_CC | pressure in cells after equilibration | Pa
temp_CC | temperature of a material in cells | K
vel_CC | velocity of a material in cells | m/s
vol_frac_CC | volume share of a material in cells |
sp_vol_CC | specific volume of a material in cells | m^3/kg
speedSound_CC | speed of sound of a material in cells | m/s
delP_Dilatate | change of pressure by dilatation | Pa
delP_MassX | change of pressure by exchange of mass | Pa
TotalIntEng | internal energy of all materials | J
"""

LABELS: dict[str, Label] = {}
"""Label -> what it is; labels of other methods have no meaning here."""

for _line in _TABLE.strip().splitlines():
    _name, _meaning, _unit = (part.strip() for part in _line.split("|"))
    LABELS[_name] = Label(_meaning, _unit)

_OTHERS = """
    BndyForce_xminus BndyForce_xplus BndyForce_yminus BndyForce_yplus BndyForce_zminus BndyForce_zplus
    BndyTraction_xminus BndyTraction_xplus BndyTraction_yminus BndyTraction_yplus BndyTraction_zminus
    BndyTraction_zplus BndyContactArea_xminus BndyContactArea_xplus BndyContactArea_yminus
    BndyContactArea_yplus BndyContactArea_zminus BndyContactArea_zplus BndyContactCellArea_xminus
    BndyContactCellArea_xplus BndyContactCellArea_yminus BndyContactCellArea_yplus
    BndyContactCellArea_zminus BndyContactCellArea_zplus NTractionXMinus NTractionXPlus NTractionYMinus
    NTractionYPlus NTractionZMinus NTractionZPlus D F HeatReleaseRate ICE_totalIntEng MPM_totalIntEng Li1
    Li2 Li3 Li4 Li5 MaxConc MinConc MesoBurn.BurningCell MesoBurn.SurfTemp Simple_Burn::onSurface
    Simple_Burn::surfaceTemp SteadyBurn.BurningCell SteadyBurn.SurfTemp SteadyBurn.numPPC
    UnsteadyBurn.BurningCell UnsteadyBurn.PartSurfTemp UnsteadyBurn.PartSurfTempGrad UnsteadyBurn.SurfTemp
    UnsteadyBurn.SurfTempGrad TMV_CC Tdot TempX_FC TempY_FC TempZ_FC TotalConc TotalEng_src
    TotalIntEng_src TotalMass_src TotalMom_src adjOutIntervals aveSurfTemp beta burnedMass compressiblity
    cumulativeEnergyReleased cumulativeEnergyReleased_src dTdt_CC dVdt_CC delF detLocalTo dispInc dispNew
    dt_chemistry dt_chemistry_limiter eng_L_ME_CC eng_adv eng_exch_error f_theta flaggedCells gamma
    gradPAccNC grad_P_XFC grad_P_YFC grad_P_ZFC grad_dp_XFC grad_dp_YFC grad_dp_ZFC imp_delP
    intE_source_CC int_eng_L_CC ignitionTime kurtosis logLaw_roughness mag_div_vel_CC mass_L_CC mass_adv
    maxMach_xminus maxMach_xplus maxMach_yminus maxMach_yplus maxMach_zminus maxMach_zplus max_RHS
    modelEng_src modelMass_src modelMom_src modelVol_src mom_L_CC mom_L_ME_CC mom_adv mom_exch_error
    mom_source_CC onSurface pressX_FC pressY_FC pressZ_FC pressureNC rhs rho_micro_CC shearTurbStrss
    normalTurbStrss sp_volX_FC sp_volY_FC sp_volZ_FC sp_vol_L_CC sp_vol_adv sp_vol_src_CC specific_heat
    sum_imp_delP sum_rho_CC surfaceTemp tau_X_FC tau_Y_FC tau_Z_FC term2 term3 thermalCond totalCVMomentum
    totalFluxes totalIntEngExchanged totalMassExchanged total_viscosity_CC turb_viscosity_CC uvel_FC
    uvel_FCME velTau_CC vel_CC_Xchange temp_CC_Xchange viscosity viscous_src_CC viscousFlowFlag
    vol_fracX_FC vol_fracY_FC vol_fracZ_FC vvel_FC vvel_FCME wvel_FC wvel_FCME SGS_ReynoldsStress matrix
    radiationVolq abskg sigmaT4 divQ c SpecificVol Suction nPPC t.x t.tracerID t.velocity g.massF0
    g.massF1 g.velocityF0 g.velocityF1 g.internalforceF0 g.internalforceF1 g.surfnormF0 g.surfnormF1
    p.fluidvelocity p.porepressureFilter+ p.porepressure+ p.stress+ p.deformationMeasure+ p.normalRotRate
    g.normalRotAcc g.normalRotMass g.normalRotMoment p.plasticEnergy p.ArenaBETA p.ArenaCR p.ArenaFSLOPE
    p.ArenaPEAKI1 p.ArenaSTREN p.ArenaT1 p.ArenaT2 p.ArenaYSLOPE p.AreniscaFlag p.arenisca_kappa p.p_q
    p.elasticStrainVol p.plasticStrainVol
"""

for _name in (*_OTHERS.split(), *KNOWN_LABELS):
    LABELS.setdefault(_name, Label())

PATTERNS = (
    r"p\.PTR_\w+",
    r"(mag_grad|sum|mean|variance|covariance|skewness|kurtosis|totalSum|spatialAvg)_[\w.\-]+",
    r"(mean|covariance)_\w+_vel_CC",
    r"scalar[-_][\w\-]+",
    r"diffCoef-\w+",
    r"p\.scalar-\w+",
    r"\w+_CC_(prime|turbFlux)",
    r"SLIP_\w+",
    r"Total\w+_src",
)
"""Forms of labels that are made from names in the deck."""
