"""The options of the method: what a deck's ``<MPM>`` section may say."""

from dataclasses import dataclass
from typing import Annotated

from solver.declare import Parameter, Vector

IMPLICIT = "read by the implicit method only"


@dataclass(frozen=True)
class Flags:
    """Options of the material point method, with Uintah's defaults."""

    time_integrator: Annotated[
        str, Parameter("how time is advanced", choices=("explicit", "implicit"), not_run=("implicit",))
    ] = "explicit"
    interpolator: Annotated[
        str,
        Parameter(
            "shape functions between particles and nodes",
            choices=("linear", "gimp", "cpdi", "fast_cpdi", "cpti", "3rdorderBS", "4thorderBS"),
            not_run=("4thorderBS",),
        ),
    ] = "linear"
    cpdi_lcrit: Annotated[
        float, Parameter("longest half diagonal of a particle, in cells, before it is shrunk", gt=0.0)
    ] = 1.0e10
    axisymmetric: Annotated[bool, Parameter("the plane x, y is r, z of a body of revolution")] = False
    XPIC2: Annotated[bool, Parameter("filter velocities by XPIC of order 2 instead of FLIP")] = False
    with_color: Annotated[bool, Parameter("carry a color on particles", tag="withColor")] = False
    gravity: Annotated[
        Vector | None, Parameter("acceleration of gravity, if not in PhysicalConstants", unit="m/s^2")
    ] = None

    artificial_viscosity: Annotated[bool, Parameter("add viscous pressure in compression")] = False
    artificial_viscosity_heating: Annotated[
        bool | None, Parameter("heat by artificial viscosity; default as artificial_viscosity")
    ] = None
    artificial_viscosity_coeff1: Annotated[float, Parameter("linear coefficient", ge=0.0)] = 0.2
    artificial_viscosity_coeff2: Annotated[float, Parameter("quadratic coefficient", ge=0.0)] = 2.0
    artificial_damping_coeff: Annotated[
        float, Parameter("deceleration per nodal velocity", unit="1/s", ge=0.0)
    ] = 0.0

    use_load_curves: Annotated[bool, Parameter("apply the loads of PhysicalBC")] = False
    keep_pressure_normal: Annotated[
        bool, Parameter("turn pressure loads with the surface", tag="keepPressBCNormalToSurface")
    ] = False
    use_CBDI_boundary_condition: Annotated[
        bool, Parameter("apply pressure at the corners of convected particles")
    ] = False
    use_cohesive_zones: Annotated[bool, Parameter("tie bodies by cohesive zones")] = False
    boundary_traction_faces: Annotated[
        tuple[str, ...],
        Parameter(
            "faces whose force, traction and contact area are recorded",
            choices=("xminus", "xplus", "yminus", "yplus", "zminus", "zplus"),
        ),
    ] = ()

    minimum_particle_mass: Annotated[
        float, Parameter("particles lighter than this are removed", unit="kg", ge=0.0)
    ] = 3.0e-15
    minimum_mass_for_acc: Annotated[
        float, Parameter("nodes lighter than this feel no forces", unit="kg", ge=0.0)
    ] = 0.0
    minimum_subcycles_for_F: Annotated[
        int,
        Parameter("positive: at least so many steps of F a time step; else terms of the exponential"),
    ] = 1
    maximum_particle_velocity: Annotated[
        float, Parameter("fastest speed of a particle", gt=0.0, ignored="no longer read by Uintah")
    ] = 3.0e105
    restart_on_large_nodal_velocity: Annotated[
        bool,
        Parameter(
            "repeat a step with a tenth of dt where a node crosses half a cell",
            tag="restartOnLargeNodalVelocity",
        ),
    ] = False
    pressure_stabilization: Annotated[
        bool, Parameter("average the volume change over each cell", tag="DoPressureStabilization")
    ] = False
    gradient_enhanced_projection: Annotated[
        bool,
        Parameter("project velocities with their gradients", tag="UseGradientEnhancedVelocityProjection"),
    ] = False
    colinear_normals: Annotated[
        bool, Parameter("make contact normals of two bodies opposite", tag="computeColinearNormals")
    ] = True
    do_contact_friction_heating: Annotated[
        bool, Parameter("heat by friction", ignored="Uintah multiplies the heat by zero")
    ] = False

    explicit_heat_conduction: Annotated[bool, Parameter("conduct heat", tag="DoExplicitHeatConduction")] = (
        True
    )
    compute_nodal_heat_flux: Annotated[
        bool, Parameter("compute g.HeatFlux", tag="computeNodalHeatFlux", ignored="a diagnostic of Uintah")
    ] = False

    use_prescribed_deformation: Annotated[
        bool, Parameter("move all nodes by a given deformation", tag="UsePrescribedDeformation")
    ] = False
    prescribed_deformation_file: Annotated[
        str, Parameter("rows of time, F, angle and axis", tag="PrescribedDeformationFile")
    ] = "time_defgrad_rotation"
    exact_deformation: Annotated[
        bool, Parameter("take the time steps from the deformation's file", tag="exactDeformation")
    ] = False
    insert_particles: Annotated[
        bool, Parameter("move particles of a color into place at given times", tag="InsertParticles")
    ] = False
    insert_particles_file: Annotated[
        str, Parameter("rows of time, color, displacement and velocity", tag="InsertParticlesFile")
    ] = ""

    refine_particles: Annotated[
        bool, Parameter("split particles that grow too long", unsupported="particles that split")
    ] = False
    granular: Annotated[
        bool, Parameter("granular method", tag="DoGranularMPM", unsupported="the granular method")
    ] = False
    manufactured_solution: Annotated[
        str,
        Parameter(
            "problem with a known solution to run",
            tag="RunMMSProblem",
            choices=("", "AxisAligned", "GeneralizedVortex", "ExpandingRing", "AxisAligned3L"),
            unsupported="manufactured solutions",
        ),
    ] = ""
    scalar_diffusion: Annotated[bool, Parameter("diffuse a concentration", tag="do_scalar_diffusion")] = False
    coupled_flow: Annotated[
        bool, Parameter("couple pore water", tag="coupled_flow_analysis", unsupported="pore water")
    ] = False
    amr: Annotated[bool, Parameter("several levels", tag="AMR")] = False

    delete_geometry_objects: Annotated[
        bool, Parameter("free the shapes after the start", tag="DeleteGeometryObjects", ignored="memory only")
    ] = False
    create_new_particles: Annotated[
        bool,
        Parameter(
            "convert failed particles into those of a copy of their material, with a velocity field of its own; "
            "the copy of material m follows it, so that the deck's materials have the indices 0, 2, 4, ..."
        ),
    ] = False
    manual_new_material: Annotated[
        bool,
        Parameter("convert failed particles into those of the material whose geom_object holds <null/>"),
    ] = False
    can_add_material: Annotated[
        bool, Parameter("allow new materials", tag="CanAddMPMMaterial", ignored="no longer read by Uintah")
    ] = False
    cap_density: Annotated[
        bool,
        Parameter("limit the density", tag="DoCapDensity", ignored="read by a few models in MPMICE only"),
    ] = False
    average_deformation: Annotated[
        bool, Parameter("average F", tag="DoDefGradAveraging", ignored="no longer read by Uintah")
    ] = False
    interpolate_temperature: Annotated[
        bool,
        Parameter(
            "temperature to the grid each step",
            tag="interpolateParticleTempToGridEveryStep",
            ignored=IMPLICIT,
        ),
    ] = True
    temperature_solve: Annotated[bool, Parameter("solve for temperature", ignored=IMPLICIT)] = False
    test_negative_temperatures: Annotated[
        bool, Parameter("stop at negative temperatures", tag="testForNegTemps_mpm", ignored="MPMICE only")
    ] = True
    use_volume_integral: Annotated[bool, Parameter("J integrals", ignored="fracture only")] = False
    dynamic: Annotated[bool, Parameter("with inertia", ignored=IMPLICIT)] = True
    solver: Annotated[str, Parameter("linear solver", choices=("petsc", "simple"), ignored=IMPLICIT)] = (
        "simple"
    )
    convergence_criteria_disp: Annotated[float, Parameter("of displacement", ge=0.0, ignored=IMPLICIT)] = (
        1.0e-10
    )
    convergence_criteria_energy: Annotated[float, Parameter("of energy", ge=0.0, ignored=IMPLICIT)] = 4.0e-10
    implicit_heat_conduction: Annotated[
        bool, Parameter("conduct heat implicitly", tag="DoImplicitHeatConduction", ignored=IMPLICIT)
    ] = False
    transient_implicit_heat_conduction: Annotated[
        bool, Parameter("in time", tag="DoTransientImplicitHeatConduction", ignored=IMPLICIT)
    ] = True
    do_mechanics: Annotated[bool, Parameter("solve for motion", tag="DoMechanics", ignored=IMPLICIT)] = True
    do_grid_reset: Annotated[bool, Parameter("reset the grid each step", ignored=IMPLICIT)] = True
    num_iters_to_decrease_delT: Annotated[int, Parameter("iterations", ge=0, ignored=IMPLICIT)] = 12
    num_iters_to_increase_delT: Annotated[int, Parameter("iterations", ge=0, ignored=IMPLICIT)] = 4
    iters_before_timestep_restart: Annotated[int, Parameter("iterations", ge=0, ignored=IMPLICIT)] = 25
    delT_decrease_factor: Annotated[float, Parameter("factor", ignored=IMPLICIT)] = 0.6
    delT_increase_factor: Annotated[float, Parameter("factor", ignored=IMPLICIT)] = 2.0
    with_gauss_solver: Annotated[
        bool, Parameter("find the electric field of ions", unsupported="charged diffusion")
    ] = False
    do_auto_cycle_bc: Annotated[
        bool, Parameter("turn the flux at limits of the concentration", unsupported="cycling of charge")
    ] = False
    auto_cycle_use_minmax: Annotated[bool, Parameter("by extremes", ignored="do_auto_cycle_bc only")] = False
    auto_cycle_max: Annotated[float, Parameter("upper limit", ignored="do_auto_cycle_bc only")] = 0.9
    auto_cycle_min: Annotated[float, Parameter("lower limit", ignored="do_auto_cycle_bc only")] = 0.1
    water_damping_coef: Annotated[float, Parameter("of pore water", ignored="coupled flow only")] = 0.0
    solid_damping_coef: Annotated[float, Parameter("of the skeleton", ignored="coupled flow only")] = 0.0
    pore_pressure_filter: Annotated[
        bool, Parameter("smooth pore pressure", tag="PorePressureFilter", ignored="coupled flow only")
    ] = False
    granular_critical_x: Annotated[
        float, Parameter("critical stretch", tag="GranularMPMVcrix", ignored="granular only")
    ] = 1.04
    granular_critical_y: Annotated[
        float, Parameter("critical stretch", tag="GranularMPMVcriy", ignored="granular only")
    ] = 1.04
    granular_critical_z: Annotated[
        float, Parameter("critical stretch", tag="GranularMPMVcriz", ignored="granular only")
    ] = 1.0

    def faults(self) -> list[tuple[str, str]]:
        """Options that exclude each other, each with why."""
        if self.create_new_particles and self.manual_new_material:
            return [("manual_new_material", "with create_new_particles every material has its copy already")]
        return []
