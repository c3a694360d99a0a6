"""A block of copper that hits a mirror wall, as a deck of any size."""

from __future__ import annotations

EDGE = 0.01
"""Length of the block's edges, m."""

MARGIN = 3
"""Empty cells beside the block, into which it bulges."""

INTERPOLATORS = ("linear", "gimp", "cpdi", "3rdorderBS")

MODELS = {
    "comp_neo_hook": """
        <constitutive_model type="comp_neo_hook">
          <bulk_modulus> 1.4e11 </bulk_modulus>
          <shear_modulus> 4.8e10 </shear_modulus>
        </constitutive_model>""",
    "elastic_plastic": """
        <constitutive_model type="elastic_plastic">
          <bulk_modulus> 1.4e11 </bulk_modulus>
          <shear_modulus> 4.8e10 </shear_modulus>
          <isothermal> false </isothermal>
          <yield_condition type="vonMises"/>
          <stability_check type="none"/>
          <flow_model type="johnson_cook">
            <A> 90.0e6 </A> <B> 292.0e6 </B> <C> 0.025 </C> <n> 0.31 </n> <m> 1.09 </m>
            <epdot_0> 1.0 </epdot_0> <T_r> 298 </T_r> <T_m> 1356 </T_m>
          </flow_model>
          <equation_of_state type="mie_gruneisen">
            <C_0> 3933 </C_0> <Gamma_0> 1.99 </Gamma_0> <S_alpha> 1.5 </S_alpha>
          </equation_of_state>
        </constitutive_model>""",
}
"""Constitutive models of the block's copper, by name."""


def cells_for(particles: int) -> int:
    """Cells along an edge of the block that hold about so many particles, eight a cell."""
    return max(1, round((particles / 8) ** (1 / 3)))


def block_deck(
    model: str, interpolator: str, particles: int, *, steps: int = 1000, saves: tuple[str, ...] = ("p.x",)
) -> str:
    """The text of the deck: a cube at 190 m/s against a plane, 0 of z, on which it slides freely.

    ``particles`` are met as closely as whole cells allow. ``saves`` are written after the last of ``steps``.
    """
    cells = cells_for(particles)
    across, h = cells + 2 * MARGIN, EDGE / cells
    extra = 0 if interpolator == "linear" else 1
    faces = "\n".join(
        f'      <Face side="{side}"><BCType id="all" label="Symmetric" var="symmetry"/></Face>'
        for side in ("x-", "x+", "y-", "y+", "z-", "z+")
    )
    low, high, top = MARGIN * h, (cells + MARGIN) * h, across * h
    saved = "".join(f'<save label="{label}"/>' for label in saves)
    return f"""<?xml version="1.0"?>
<Uintah_specification>
  <Meta><title>block, {model}, {interpolator}</title></Meta>
  <SimulationComponent type="mpm"/>
  <Time>
    <maxTime> 1.0 </maxTime> <initTime> 0.0 </initTime> <delt_min> 0.0 </delt_min> <delt_max> 1.0 </delt_max>
    <timestep_multiplier> 0.5 </timestep_multiplier> <max_Timesteps> {steps} </max_Timesteps>
  </Time>
  <Grid>
    <BoundaryConditions>
{faces}
    </BoundaryConditions>
    <Level><Box label="1">
      <lower> [0, 0, 0] </lower> <upper> [{top!r}, {top!r}, {top!r}] </upper>
      <resolution> [{across}, {across}, {across}] </resolution>
      <extraCells> [{extra}, {extra}, {extra}] </extraCells> <patches> [1, 1, 1] </patches>
    </Box></Level>
  </Grid>
  <MPM>
    <time_integrator> explicit </time_integrator> <interpolator> {interpolator} </interpolator>
    <minimum_particle_mass> 1.0e-20 </minimum_particle_mass>
    <artificial_viscosity> true </artificial_viscosity>
    <artificial_damping_coeff> 0.0 </artificial_damping_coeff>
  </MPM>
  <PhysicalConstants><gravity> [0, 0, 0] </gravity></PhysicalConstants>
  <MaterialProperties>
    <MPM>
      <material name="copper">
        <density> 8930 </density> <thermal_conductivity> 400 </thermal_conductivity>
        <specific_heat> 386 </specific_heat> <room_temp> 298 </room_temp> <melt_temp> 1356 </melt_temp>{MODELS[model]}
        <geom_object>
          <box> <min> [{low!r}, {low!r}, 0] </min> <max> [{high!r}, {high!r}, {EDGE!r}] </max> </box>
          <res> [2, 2, 2] </res> <velocity> [0, 0, -190] </velocity> <temperature> 298 </temperature>
        </geom_object>
      </material>
      <contact><type> null </type> <materials> [0] </materials></contact>
    </MPM>
  </MaterialProperties>
  <DataArchiver>
    <filebase> block.uda </filebase> <outputTimestepInterval> {steps} </outputTimestepInterval> {saved}
  </DataArchiver>
</Uintah_specification>
"""
