"""A sample of every constitutive model as a deck writes it; densities and constants of one kind of material."""

from __future__ import annotations


def tags(numbers: str) -> str:
    """XML of ``name=value`` pairs."""
    pairs = (pair.split("=") for pair in numbers.split())
    return "".join(f"<{name}>{value}</{name}>" for name, value in pairs)


FLOW = '<flow_model type="isotropic_hardening"><sigma_Y>2e8</sigma_Y><K>1e9</K></flow_model>'
STEEL = tags("bulk_modulus=160e9 shear_modulus=77e9")
RUBBER = tags("bulk_modulus=2e9 shear_modulus=1e7")
CAP = tags(
    "PEAKI1=1e6 FSLOPE=0.4 STREN=2e7 YSLOPE=0.1 BETA_nonassociativity=1 B0=1e10 B1=0 B2=0 B3=0 B4=0 G0=7e9 G1=0 "
    "G2=0 G3=0 G4=0 p0_crush_curve=-5e7 p1_crush_curve=1e-8 p2_crush_curve=0 p3_crush_curve=0.3 CR=0.5 fluid_B0=0 "
    "fluid_pressure_initial=0 T1_rate_dependence=0 T2_rate_dependence=0"
)
FIBRES = tags(
    "bulk_modulus=1e9 c1=1e6 c2=0 c3=1e5 c4=30 c5=1e7 fiber_stretch=1.1 direction_of_symm=[1,0,0] failure_option=0 "
    "max_fiber_strain=9 max_matrix_strain=9"
)
PRONY = tags("y1=0.1 y2=0.1 y3=0.1 y4=0.1 y5=0.1 y6=0.1 t1=1e-6 t2=1e-5 t3=1e-4 t4=1e-3 t5=1e-2 t6=1e-1")
FOAM = tags(
    "elastic_shear=1e6 bulk=2e7 a0=1e8 a1=2e3 a2=0.1 pc=-1e4 eps0=0 eps1=-0.01 eps2=-0.05 eps3=-0.1 eps4=-0.2 "
    "eps5=-0.3 eps6=-0.4 eps7=-0.5 eps8=-0.6 eps9=-0.7 p0=0 p1=1e5 p2=1.2e5 p3=1.5e5 p4=2e5 p5=3e5 p6=5e5 p7=9e5 "
    "p8=2e6 p9=5e6"
)
BORJA = tags("p0=-9e4 alpha=60 kappatilde=0.018 epse_v0=0")
CLAY = (
    f'<pressure_model type="borja_pressure">{BORJA}</pressure_model>'
    f'<elastic_shear_modulus_model type="borja_shear_modulus"><mu0>5.4e6</mu0>{BORJA}</elastic_shear_modulus_model>'
    '<plastic_yield_condition type="camclay_yield_function"><M>1.05</M></plastic_yield_condition>'
    '<internal_variable_model type="borja_consolidation_pressure"><pc0>-1.2e5</pc0><lambdatilde>0.13</lambdatilde>'
    "<kappatilde>0.018</kappatilde></internal_variable_model>"
)
SCRAM = tags(
    "PR=0.3 CrackParameterA=1e-3 CrackPowerValue=10 CrackMaxGrowthRate=300 StressIntensityF=5e5 CrackFriction=0.35 "
    "InitialCrackRadius=3e-5 CrackGrowthRate=12 G1=944e6 G2=173.8e6 G3=521.2e6 G4=908.5e6 G5=687.5e6 RTau1=0 "
    "RTau2=7.32e3 RTau3=7.32e4 RTau4=7.32e5 RTau5=2e6 Beta=1.5e-4 Gamma=1 DCp_DTemperature=3.31"
)
ICE = tags(
    "coeff_backstress_evol=100e6 exponent_backstress_evol=4 normalizing_backstress=4e6 "
    "coeff_saturation_backstress=0.1e6 exponent_backstress=4 ref_strainrate=1e-8 "
    "normalizing_inelastic_strainrate=5e9 activation_energy=67500 universal_gas_constant=8.3144 temperature=269.15 "
    "exponent_inelastic_strainrate=4 coeff_yieldstress_saturation=0.8e6 exponent_yieldstress=4 "
    "coeff_yieldstress_evol=600e6 exponent_dragstress=4 coeff_dragstress_evol=20e6 coeff_stress_saturation=1e6 "
    "intial_drag=0.05e6 initial_yield=0 integration_parameter_theta=0.5"
)

SAMPLES: dict[str, str] = {
    "Arenisca3": CAP,
    "Arenisca4": CAP,
    "ArrudaBoyce8": RUBBER + tags("beta=3"),
    "Kelvin_Voigt": tags("elastic_shear=1e7 elastic_bulk=1e8 viscous_shear=1e2"),
    "Maxwell_Weichert": tags("bulk_modulus=1e9 terminal_shear_modulus=1e6")
    + "<viscoelastic_series><mode>"
    + tags("relaxation_time=1e-4 partial_shear_modulus=5e6")
    + "</mode></viscoelastic_series>",
    "MohrCoulomb": tags("G=1e7 K=2e7 c=1e4 Phi=30 Psi=0 Version=11"),
    "SVK": tags("YoungsModulus=2e9 PR=0.3"),
    "TH_water": tags("a=2e-7 b=2.6 co=4205.7 ko=5e-10 To=277 L=8e-6 vo=1.00008e-3"),
    "UCNH": STEEL,
    "UCNHVar": "<variable_properties><entry>"
    + tags("color=0 bulk_modulus=1e9 shear_modulus=5e8 yield_stress=1e7 hardening_modulus=1e8")
    + "</entry><entry>"
    + tags("color=1 bulk_modulus=2e9 shear_modulus=9e8 yield_stress=2e7 hardening_modulus=1e8")
    + "</entry></variable_properties>",
    "camclay": CLAY,
    "cnh_mms": RUBBER,
    "comp_mooney_rivlin": tags("he_constant_1=1e5 he_constant_2=2e4 he_PR=0.45"),
    "comp_neo_hook": RUBBER,
    "comp_neo_hook_plastic": STEEL + tags("yield_stress=2e8 hardening_modulus=1e9"),
    "elastic_plastic": STEEL + FLOW,
    "elastic_plastic_hp": STEEL + FLOW,
    "gao_elastic": STEEL + tags("alpha=0.1"),
    "hyperelastic_plastic": STEEL + FLOW,
    "hypo_elastic": tags("G=77e9 K=160e9"),
    "ideal_gas": tags("gamma=1.4 specific_heat=718 Pref=8.616e7"),
    "jwlpp_mpm": tags(
        "ignition_pressure=1e30 murnaghan_K=2e9 murnaghan_n=7 jwl_A=1e11 jwl_B=5e9 jwl_C=1e9 jwl_R1=4 jwl_R2=1 "
        "jwl_om=0.3 reaction_G=1e-10 reaction_b=1.2"
    ),
    "murnaghanMPM": tags("K=3e8 gamma=7 viscosity=1 pressure=1e5 rho0=1000"),
    "mw_visco_elastic": tags(
        "e_shear_modulus=1e7 e_bulk_modulus=1e8 ve_shear_modulus=1e7 ve_bulk_modulus=1e7 ve_volumetric_viscosity=1e3 "
        "ve_deviatoric_viscosity=1e3"
    ),
    "nonlocal_drucker_prager": STEEL + tags("alpha=0.1 alpha_p=0 k_o=2e8 h_nonlocal=-1e8 l_nonlocal=0.1"),
    "p_alpha": tags(
        "Ps=1e9 Pe=1e8 rhoS=1200 K0=5e9 Ks=2e10 T_0=300 C_0=4000 Gamma_0=1.5 S_alpha=1.5 shear_modulus=1e9"
    ),
    "program_burn": tags(
        "K=5e-10 n=7 A=6e11 B=9e9 C=1e9 R1=4.4 R2=1.2 om=0.3 rho0=1000 starting_location=[0,0,0] D=8000"
    ),
    "rf_elastic_plastic": STEEL + FLOW + tags("volume_expansion_coeff=0.1"),
    "rigid": "",
    "soil_foam": FOAM,
    "trans_iso_hyper": FIBRES,
    "visco_plastic": tags("bulk_modulus=9e9 shear_modulus=3.5e9")
    + f'<visco_plasticity_model type="suvic_i">{ICE}</visco_plasticity_model>',
    "visco_scram": SCRAM,
    "visco_trans_iso_hyper": FIBRES + PRONY,
    "water": tags("bulk_modulus=2e9 viscosity=1e-3 gamma=7"),
}
