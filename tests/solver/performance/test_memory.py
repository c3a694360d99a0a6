"""Bytes a particle: what is stated is what is allocated."""

from __future__ import annotations

import tracemalloc

import numpy as np

from solver.performance.memory import PARTICLE, bytes_of, bytes_of_models
from ups.deck import read_deck
from ups.factory import build

EDGE = 20
DECK = """<Uintah_specification><SimulationComponent type="mpm"/><Meta><title>cube</title></Meta>
<Time><maxTime>1</maxTime><initTime>0</initTime><delt_min>0</delt_min><delt_max>1</delt_max>
<timestep_multiplier>0.5</timestep_multiplier></Time>
<Grid><BoundaryConditions/><Level><Box label="1"><lower>[0,0,0]</lower><upper>[{n},{n},{n}]</upper>
<resolution>[{n},{n},{n}]</resolution><extraCells>[1,1,1]</extraCells></Box></Level></Grid>
<MPM><interpolator>gimp</interpolator></MPM><PhysicalConstants><gravity>[0,0,0]</gravity></PhysicalConstants>
<MaterialProperties><MPM><material><density>1</density><thermal_conductivity>1</thermal_conductivity>
<specific_heat>1</specific_heat><constitutive_model type="elastic_plastic"><bulk_modulus>1</bulk_modulus>
<shear_modulus>1</shear_modulus><yield_condition type="vonMises"/><flow_model type="isotropic_hardening">
<K>1</K><sigma_Y>1</sigma_Y></flow_model><equation_of_state type="default_hypo"/></constitutive_model>
<geom_object><box><min>[0,0,0]</min><max>[{n},{n},{n}]</max></box><res>[2,2,2]</res><velocity>[0,0,0]</velocity>
<temperature>300</temperature></geom_object></material><contact><type>null</type></contact></MPM></MaterialProperties>
<DataArchiver><filebase>cube.uda</filebase><outputTimestepInterval>1</outputTimestepInterval><save label="p.x"/>
</DataArchiver></Uintah_specification>"""


def test_every_model_states_its_bytes() -> None:
    models = bytes_of_models()
    numbers = 3 + 3 + 3 + 1 + 1 + 9 + 9 + 9 + 9 + 1 + 1 + 3 + 1 + 1 + 3 + 1 + 1 + 1 + 1 + 1 + 3
    assert (
        8 * numbers + 4 * (1 + 3) + 8 == PARTICLE
    )  # 32-bit: localized, load curves; at last the failure time
    assert models["comp_neo_hook"] == 0
    assert models["elastic_plastic"] == 8 * (9 + 6)
    assert all(size % 4 == 0 for size in models.values())


def test_particles_take_the_bytes_that_are_stated_and_creation_half_more() -> None:
    deck = read_deck("cube.ups", text=DECK.format(n=EDGE))
    deck.require()
    build(read_deck("cube.ups", text=DECK.format(n=2)))  # what is imported and kept for good
    tracemalloc.start()
    try:
        simulation = build(deck)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    (body,) = simulation.bodies
    count = 8 * EDGE**3
    assert len(body.particles) == count
    assert bytes_of(body.records) == count * (PARTICLE + bytes_of_models()["elastic_plastic"])
    nodes = sum(array.nbytes for array in simulation.nodal)
    assert peak < 1.5 * bytes_of(body.records) + nodes


def test_arrays_are_counted_as_numpy_does() -> None:
    assert bytes_of([(np.zeros(3), np.zeros((2, 3), np.int32)), ()]) == 24 + 24
