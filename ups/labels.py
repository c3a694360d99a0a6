"""Labels of Uintah: those that a deck may name in ``<save>``, and where a concentration at nodes is found."""

from __future__ import annotations

_PARTICLES = """
    AreniscaFlag BackStress BackStressIso COHER CapX CapXDY ElasticStress Iota IotaDY JThermal Kappa P3
    PorePressure S0 SpecificStrainEnergy StressQS TGROW Zeta ZetaDY acceleration alpha alphaMin area
    averageMoment avgConc bElBar backStress backstress bbarElastic beBar bulkModulus capX chemHeatRate
    concPrevious concentration concentrationGradient crHeatRate crackDensity crackOpening crackRad crimp
    currentsize damage defGradBot defGradCen defGradTop defgrad_in_plane deformRate deltaGamma diffusivity
    drag elasticStrain elasticStrainVol elasticStress elasticVolStrain energy ep epsf eqps erosion
    esGradPotential esPotential ev0 eve evp evv externalHeatFlux externalScalarFlux externalforcecorner1
    externalforcecorner2 externalforcecorner3 externalforcecorner4 fail fiberDir fiberFracture fiberdir
    fluidacceleration fluidmass fluidvelocity flux hardeningModulus history1 history2 history3 history4
    history5 history6 hotspotPhi1 hotspotPhi2 hotspotT1 hotspotT2 initialYieldStress kappa kappaState
    lastlevel leftStretch lightingTime localized mtStress mu muGradient negCharge negChargeFlux
    negChargeGrad norm normal normal0 normalDotAvStress normalRotRate p3 p_sv_minLabel partitionUnity
    peakI1IDist permittivity plasticCumEqStrain plasticStrain plasticStrainRate plasticStrainVol plasticTemp
    plasticTempInc plasticVolStrain porePressure porepressure porepressureFilter porosity posCharge
    posChargeFlux posChargeGrad prescribedporepressure pressure progressF progressdelF rand refinedMPM
    rotAcc rotMass rotation saturation shearModulus solidmass statevar strain strainRate stressBot stressCen
    stressQS stressTop stress_e stress_e_d stress_e_v stress_ve_d stress_ve_v stressrate stretch surfgrad
    sv_minLabel tang1 tang2 tempAlpha1 thickBot thickBot0 thickTop thickTop0 timeofloc type varf veHeatRate
    velocitySSPlus volHeatRate volumedeformed xx yield yieldStress
"""
_NODES = """
    HeatFlux NegCharge PorePressure PosCharge VelocityOld alphaMaterial color concentration
    concentrationRate concentrationStar contact dTdt displacement externalHeatFlux externalHeatRate
    externalfluidforce externalscalarflux flowinertiaforce fluidacceleration fluidmass fluidmassbar
    fluidvelocity fluidvelocitystar hydrostaticStressRD internaldragforce internalfluidforce lscontactforce
    massall matlProminence mu normAlphaToBeta normalRotAcc normalRotMass normalRotMoment normalRotRate
    normtraction position sp_vol sp_vol_src stress sum_S surf surfgrad surfnorm temperatureStar
    temperaturenobc thermalContactTemperatureRate velocityBC velocitySPLusSSPlus zoi
"""
_OTHERS = """
    BndyContactArea_xminus BndyContactArea_xplus BndyContactArea_yminus BndyContactArea_yplus
    BndyContactArea_zminus BndyContactArea_zplus BndyContactCellArea_xminus BndyContactCellArea_xplus
    BndyContactCellArea_yminus BndyContactCellArea_yplus BndyContactCellArea_zminus
    BndyContactCellArea_zplus BndyForce_xminus BndyForce_xplus BndyForce_yminus BndyForce_yplus
    BndyForce_zminus BndyForce_zplus BndyTraction_xminus BndyTraction_xplus BndyTraction_yminus
    BndyTraction_yplus BndyTraction_zminus BndyTraction_zplus F G K NTractionZMinus NumInCell
    NumLocalizedInCell NumNearParticles RigidReactionForce RigidReactionTorque SpecificVol Suction
    SumTransmittedTorque TotalConc TotalIntEng TotalLocalizedParticle TotalMomentOfInertia burning c
    c.volume countTime crackedEnough cz.CZID cz.area cz.botmat cz.dispbottom cz.disptop cz.failed cz.force
    cz.norm cz.separation cz.tang cz.topmat dTdt_NC delF detonating frictionalWork gradPAccNC heatRate_CC
    inductionTime ls.MidToEndVector ls.linesegID mach massBurnFraction particleCount peakI1IDist
    pointsPerCurve press_CC refineFlag rho_CC sp_vol_CC t.tracerID temp_CC totalHeatReleased totalMassBurned
    vel_CC vol_frac_CC vorticity
"""

KNOWN_LABELS: frozenset[str] = frozenset(
    [f"p.{name}" for name in _PARTICLES.split()] + [f"g.{name}" for name in _NODES.split()] + _OTHERS.split()
)
"""To save one of these where a deck does not provide it is worth a warning; any other is a mistake."""

CONCENTRATIONS = {
    "g.concentration": "concentration",
    "g.concentrationnobc": "projected",
    "g.concentrationRate": "rate",
    "g.concentrationStar": "star",
    "g.hydrostaticStressRD": "mean_stress",
    "g.externalscalarflux": "external",
}
"""Label -> field of solver.diffusion.interface.NodalConcentration."""

TOTAL_CONCENTRATION = "TotalConc"
"""The sum of the concentrations of the particles of materials with ``do_conc_reduction``."""
