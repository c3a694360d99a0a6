"""Small decks for tests of the runner: two blocks that meet, a block that flows plastically."""

from __future__ import annotations

from pathlib import Path

HYPO = '<constitutive_model type="hypo_elastic"><G>12.e6</G><K>32.e6</K></constitutive_model>'
PLASTIC = """
    <constitutive_model type="comp_neo_hook_plastic">
      <bulk_modulus>32.e6</bulk_modulus><shear_modulus>12.e6</shear_modulus>
      <yield_stress>1.e4</yield_stress><hardening_modulus>1.e5</hardening_modulus>
      <useModifiedEOS>false</useModifiedEOS>
    </constitutive_model>"""


def material(low: str, high: str, velocity: str, model: str = HYPO, name: str = "block") -> str:
    """A box of one material."""
    return f"""
    <material>
      <density>1000.0</density>{model}
      <thermal_conductivity>1.0</thermal_conductivity><specific_heat>5.0</specific_heat>
      <geom_object>
        <box label="{name}"><min>{low}</min><max>{high}</max></box>
        <res>[2,2,1]</res><velocity>{velocity}</velocity><temperature>300</temperature>
      </geom_object>
    </material>"""


LEFT = material("[0.1,0.1,0.0]", "[0.4,0.4,0.1]", "[20.0,3.0,0.0]", name="left")
RIGHT = material("[0.4,0.1,0.0]", "[0.7,0.4,0.1]", "[-20.0,0.0,0.0]", name="right")
CONTACT = "<contact><type>single_velocity</type><materials>[0,1]</materials></contact>"
SAVES = ("p.x", "p.particleID", "p.velocity", "p.stress", "KineticEnergy", "StrainEnergy", "AccStrainEnergy")
EVERY_THREE = "<outputTimestepInterval>3</outputTimestepInterval>"


def deck(
    *,
    materials: str = LEFT + RIGHT + CONTACT,
    saves: tuple[str, ...] = SAVES,
    archiver: str = EVERY_THREE,
    time: str = "<max_Timesteps>8</max_Timesteps>",
    max_time: str = "1.0",
    flags: str = "",
    patches: str = "[2,2,1]",
    extra: str = "",
) -> str:
    """The text of a deck on 8 x 5 x 1 cells of 0.1; parts that a test is about can be replaced."""
    saved = "".join(f'\n    <save label="{label}"/>' for label in saves)
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<Uintah_specification>
  <Meta><title>two blocks</title></Meta>
  <SimulationComponent type="mpm"/>
  <Time>
    <maxTime>{max_time}</maxTime><initTime>0.0</initTime>
    <delt_min>0.0</delt_min><delt_max>1.0</delt_max>
    <timestep_multiplier>0.4</timestep_multiplier>{time}
  </Time>
  <DataArchiver>
    <filebase>blocks.uda</filebase>
    {archiver}{saved}
  </DataArchiver>
  <MPM>
    <time_integrator>explicit</time_integrator>
    <interpolator>linear</interpolator>{flags}
  </MPM>
  <PhysicalConstants><gravity>[0,0,0]</gravity></PhysicalConstants>{extra}
  <MaterialProperties><MPM>{materials}</MPM></MaterialProperties>
  <Grid>
    <BoundaryConditions>
      <Face side="z-"><BCType id="all" var="symmetry" label="Symmetric"/></Face>
      <Face side="z+"><BCType id="all" var="symmetry" label="Symmetric"/></Face>
    </BoundaryConditions>
    <Level>
      <Box label="1">
        <lower>[0,0,0]</lower><upper>[0.8,0.5,0.1]</upper><resolution>[8,5,1]</resolution>
        <patches>{patches}</patches>
      </Box>
    </Level>
  </Grid>
</Uintah_specification>
"""


def write(folder: Path, text: str | None = None, name: str = "blocks.ups") -> Path:
    """Put a deck into a folder."""
    path = folder / name
    path.write_text(deck() if text is None else text)
    return path
