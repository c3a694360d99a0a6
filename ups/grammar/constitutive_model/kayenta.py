"""Kayenta, the geomaterial model of Sandia, whose routine is not part of Uintah."""

from __future__ import annotations

from typing import Annotated

from solver.declare import Parameter, Section
from ups.grammar import known, numbers


@known("constitutive_model", "kayenta")
@numbers(
    """
    B1 B2 B3 B4: change of the bulk modulus with pressure and plastic strain
    G1 G2 G3 G4: change of the shear modulus with pressure and plastic strain
    RJS: spacing of the joints
    RKS RKN: stiffness of the joints in shear and across
    A1 A2 A3 A4: constants of the limit surface
    P0 P1 P2 P3: constants of the crush curve
    CR: shape of the cap
    RK: ratio of strengths in extension and compression
    RN HC: kinematic hardening
    CTPSF CTPS CTI1: cut-offs of tension
    T1 T2 T3 T4 T5 T6 T7: rate dependence
    J3TYPE: dependence on the third invariant
    A2PF A4PF CRPF RKPF: constants of the plastic potential
    SUBX: control of sub-steps
    DEJAVU: whether the constants have been checked before
    FAIL0 FAIL1 FAIL2 FAIL3 FAIL4 FAIL5 FAIL6 FAIL7 FAIL8 FAIL9: constants of the failure
    PEAKI1I STRENI FSLOPEI YSLOPEI: the limit surface of the sound material
    PEAKI1F STRENF FSLOPEF YSLOPEF: the limit surface of the failed material
    SOFTENING FAILSTAT DILATLIM SPALLI1: course of the failure
    NU: Poisson's ratio
    EOSID EOS01 EOS02 EOS03 EOS04 EOS05 EOS06 EOS07 EOS08: equation of state
    EOS09 EOS10 EOS11 EOS12 EOS13 EOS14 EOS15 EOS16: equation of state
    FREE01 FREE02 FREE03 FREE04 FREE05 FREE06 FREE07 FREE08: free for tests
    CKN01 CKN02 CKN03 VMAX1 VMAX2 VMAX3 SPACE1 SPACE2 SPACE3: families of joints
    SHRSTIFF1 SHRSTIFF2 SHRSTIFF3: shear stiffness of the families of joints
    TMPRXP TM R0 T0 CS S1 SR CV SQA: thermal constants
    DC01 DC02 DC03 DC04 DC05 DC06 DC07 DC08 DC09 DC10 DC11 DC12 DC13: derived constants
    hugeJ: stretch from which a particle is taken out
    """
)
class Kayenta(Section):
    """A limit surface with cap, kinematic hardening, rate dependence and joints."""

    B0: Annotated[float, Parameter("bulk modulus", unit="Pa")]
    G0: Annotated[float, Parameter("shear modulus", unit="Pa")]
    PEAKI1IDIST: Annotated[str, Parameter("distribution of PEAKI1", old_tags=("PeakI1IDist",))] = ""


@known("constitutive_model", "diamm")
@numbers(
    """
    B0 B1 B2: constants of the bulk modulus
    G0 G1 G2 G3: constants of the shear modulus
    A1 A2 A3 A4 A5 A6 AN: constants of the yield stress
    R0 T0 C0 S1 GP CV TM: Mie-Gruneisen equation of state
    T1 T2 T3 T4 XP SC: rate and temperature dependence
    IDK IDG A2PF TQC F1 TEST DEJAVU: switches of the model
    DC1 DC2 DC3 DC4 DC5 DC6 DC7 DC8 DC9 DC10 DC11 DC12 DC13: derived constants
    """
)
class Diamm(Section):
    """A metal of Sandia, whose routine is not part of Uintah."""


@known("constitutive_model", "TongeRameshPTR")
@numbers(
    """
    PTR_useDamage PTR_usePlasticity PTR_useGranularPlasticity PTR_useOldStress: parts that are switched on
    PTR_artificialViscosity PTR_artificialViscousHeating: artificial viscosity and its heat
    PTR_BulkModulus PTR_ShearModulus PTR_rho_orig: elasticity
    PTR_FlowStress PTR_HardeningModulus PTR_InitialPlasticStrain PTR_J2RelaxationTime: plasticity
    PTR_NumCrackFamilies PTR_MeanFlawSize PTR_FlawDensity PTR_StdFlawSize PTR_FlawDistType: the flaws
    PTR_MinFlawSize PTR_MaxFlawSize PTR_FlawDistExponent PTR_RandomizeFlawDist: distribution of flaws
    PTR_RandomSeed PTR_RandomizeMethod PTR_BinBias: random draw of flaws
    PTR_KIc PTR_FlawFriction PTR_FlawAngle PTR_FlawGrowthExponent PTR_FlawGrowthAlpha: growth of flaws
    PTR_CriticalDamage PTR_MaxDamage PTR_MicroMechPlaneStrain PTR_MaxDamageInc: damage
    PTR_UseDamageTimestep PTR_dt_increaseFactor PTR_IncInitDamage PTR_DoFlawInteraction: damage
    PTR_GPTimeConst PTR_JLoc PTR_GPGranularSlope PTR_GPCohesion PTR_GPYieldSurfType: flow of the powder
    PTR_GPPc PTR_GPJref PTR_GPPref PTR_GPSurfaceType: flow of the powder
    PTR_AbsToll PTR_RelToll PTR_MaxIter PTR_MaxLevels: iterations
    PTR_GFMSm0 PTR_GFMSm1 PTR_GFMSm2 PTR_GFMSp0 PTR_GFMSp1 PTR_GFMSp2 PTR_GFMSp3 PTR_GFMSp4: powder surface
    PTR_GFMSa1 PTR_GFMSa2 PTR_GFMSa3 PTR_GFMSBeta PTR_GFMSPsi PTR_GFMSJ3Type: powder surface
    PTR_ArtVisc1 PTR_ArtVisc2: constants of the artificial viscosity
    PTR_MGC0 PTR_MGGamma0 PTR_MGS1 PTR_MGS2 PTR_MGS3 PTR_MGCv PTR_MGTheta_0: equation of state
    PTR_JMin PTR_MGNPts: equation of state
    """
)
class TongeRamesh(Section):
    """Ceramics under impact: elasticity, damage by flaws, flow of the powder."""
