"""Particles as Uintah makes them: how many, where, how large, in which order, and what they start with."""

import json
import math
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest
from deck_bodies import bodies_of, object_of
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from solver.creation import GeometryObject, ParticleIds, create_particles
from solver.geometry.box import Box
from solver.geometry.cylinder import Cylinder
from solver.geometry.file import File
from solver.geometry.null import Null
from solver.geometry.sphere import Sphere
from solver.geometry.tri import Tri
from solver.geometry.union import Union
from solver.grid import Grid, Patch
from solver.materials.constitutive import Material

REFERENCE = Path(__file__).parents[3] / "shared" / "reference"
MATERIAL = Material(1000.0, 1.0, 1.0, 1.0, 294.0, 1.0e9, 0.0)


def grid_with(cells=(12, 12, 12), patches=(1, 1, 1), upper=(1.0, 1.0, 1.0)):
    blocks = []
    for i, j, k in np.ndindex(*patches):
        low, high = (np.array(cells) * (np.array([i, j, k]) + end) // patches for end in (0, 1))
        blocks.append(Patch(len(blocks), tuple(low.tolist()), tuple(high.tolist())))
    spacing = tuple(u / n for u, n in zip(upper, cells, strict=True))
    return Grid((0.0, 0.0, 0.0), spacing, cells, (1, 1, 1), (0, 0, 0), tuple(blocks))


def body(*pieces, res=(2, 2, 2), velocity=(0.0, 0.0, 0.0), temperature=300.0, **more):
    return GeometryObject(pieces, res, velocity, temperature, **more)


def create(objects, grid, **options):
    return create_particles(objects, grid, MATERIAL, ParticleIds(grid), **options)


BALL = Sphere((0.5, 0.5, 0.5), 0.3)


# Decks with one material for each line, run with Uintah's sus to its first output, before the first step. The
# numbers are the count of particles, their volume, and sums over the n particles in the order of the archive,
# p = 1, 2, .. n: of p (x + 10 y + 100 z) / n^2, and of p (number in the cell) / n^2.
SPHERE = "<sphere><origin>{}</origin><radius>{}</radius></sphere>"
TORUS = (
    "<torus><center>[.5,.5,.5]</center><major_radius>.3</major_radius><minor_radius>.13</minor_radius>"
    "<axis>{}</axis><theta>{}</theta></torus>"
)
CYLINDER = "<cylinder><bottom>[.5,.5,.2]</bottom><top>[.5,.5,.8]</top><radius>.3</radius></cylinder>"
SMOOTH = (
    "<smoothcyl><discretization_scheme>{}</discretization_scheme><bottom>{}</bottom><top>{}</top>"
    "<outer_radius>.3</outer_radius><inner_radius>.1</inner_radius><num_radial>5</num_radial>"
    "<num_axial>4</num_axial><num_angular>37</num_angular><arc_start_angle>{}</arc_start_angle>"
    "<arc_angle>{}</arc_angle></smoothcyl>"
)


def levels(count):
    return f"<numLevelsParticleFilling>{count}</numLevelsParticleFilling>"


SUS = {
    "shapes": (
        grid_with(patches=(2, 2, 1)),
        {},
        [
            (
                [
                    (SPHERE.format("[.3,.3,.3]", 0.22), "[2,2,2]", ""),
                    (SPHERE.format("[.6,.6,.6]", 0.3), "[2,1,3]", ""),
                ],
                (1790, 0.15760030864197533, 32.341428562449494, 1.1589360506850597),
            ),
            (
                [
                    (
                        "<ellipsoid><origin>[.5,.5,.5]</origin><v1>[0.2,-0.4,0.25]</v1><v2>[0.2,0.1,0.0]</v2>"
                        "<v3>[-0.05,0.1,0.2]</v3></ellipsoid>",
                        "[2,2,2]",
                        "",
                    ),
                    (
                        "<ellipsoid><origin>[.5,.5,.5]</origin><rx>.2</rx><ry>.3</ry><rz>.4</rz></ellipsoid>",
                        "[2,2,2]",
                        "",
                    ),
                ],
                (2908, 0.21035879629629628, 28.634447053362575, 4.8075861258322625),
            ),
            (
                [
                    (TORUS.format("x", 0.4), "[2,2,2]", ""),
                    (TORUS.format("y", 0.3), "[2,2,2]", ""),
                    (TORUS.format("z", -0.7), "[2,2,2]", "<volumeFraction>.5</volumeFraction>"),
                ],
                (4152, 0.3003472222222222, 26.658451835238456, 6.144113812411597),
            ),
        ],
    ),
    "filling levels": (
        grid_with(patches=(2, 2, 1)),
        {},
        [
            (
                [
                    (SPHERE.format("[.3,.3,.3]", 0.22), "[1,1,1]", levels(3)),
                    (SPHERE.format("[.7,.7,.7]", 0.25), "[1,2,1]", levels(-3)),
                ],
                (2686, 0.11714228877314817, 41.17267002459319, 5.954797746124662),
            ),
            (
                [
                    (
                        CYLINDER + "<box><min>[.05,.05,.05]</min><max>[.3,.3,.31]</max></box>",
                        "[2,2,2]",
                        levels(-2),
                    )
                ],
                (4000, 0.18098958333333331, 28.8352440625, 4.250149125),
            ),
            (
                [(CYLINDER, "[1,1,1]", levels(-4))],
                (14680, 0.17097077546296302, 29.591826469604662, 24.18760913567552),
            ),
        ],
    ),
    "affine transformation": (
        grid_with(),
        {},
        [
            (
                [
                    (
                        "<box><min>[0,0,0]</min><max>[.25,.25,.25]</max></box>",
                        "[2,2,2]",
                        "<affineTransformation_A0>[1.2,.1,0]</affineTransformation_A0>"
                        "<affineTransformation_A1>[.05,.9,.1]</affineTransformation_A1>"
                        "<affineTransformation_A2>[0,.2,1.1]</affineTransformation_A2>"
                        "<affineTransformation_b>[.1,.2,.05]</affineTransformation_b>",
                    )
                ],
                (216, 0.018101562499999998, 14.71713605967078, 1.0905135459533608),
            )
        ],
    ),
    "rings": (
        grid_with(patches=(2, 2, 1)),
        {},
        [
            (
                [(SMOOTH.format("pie_slices", "[.5,.5,.1]", "[.5,.5,.8]", 0, 360), "[1,1,1]", "")],
                (740, 0.17592918860102838, 26.845125932797252, 1.0650146092037984),
            ),
            (
                [
                    (SMOOTH.format("constant_particle_volumes", *ends, 20, 290), "[1,1,1]", "")
                    for ends in (("[.5,.5,.1]", "[.5,.5,.8]"), ("[.1,.5,.5]", "[.8,.5,.5]"))
                ],
                (920, 0.26389378290154264, 26.009788665391586, 2.515180765595463),
            ),
            (
                [
                    (
                        SMOOTH.format("constant_particle_volumes", "[.5,.1,.5]", "[.5,.8,.5]", 20, 290),
                        "[1,1,1]",
                        "",
                    )
                ],
                (460, 0.13194689145077132, 30.08084243272275, 2.779319470699433),
            ),
        ],
    ),
    "axisymmetric": (
        grid_with((12, 12, 1), (2, 2, 1)),
        {"axisymmetric": True},
        [
            (
                [
                    (
                        "<cylinder><bottom>[.5,.5,0]</bottom><top>[.5,.5,1]</top><radius>.3</radius></cylinder>",
                        "[2,2,1]",
                        levels(-3),
                    ),
                    (
                        "<box><min>[0,0,0]</min><max>[.2,.2,1]</max></box>",
                        "[2,2,1]",
                        "<volumeFraction>.5</volumeFraction>",
                    ),
                ],
                (797, 0.17466001157407407, 28.0980132457716, 7.777729849545582),
            )
        ],
    ),
    "patches of unequal size": (
        grid_with((31, 23, 17), (2, 3, 2), (0.97, 1.03, 0.9)),
        {},
        [
            (
                [
                    (
                        "<union>"
                        + SPHERE.format("[.3,.3,.3]", 0.22)
                        + SPHERE.format("[.5,.6,.5]", 0.25)
                        + "</union>",
                        "[3,3,3]",
                        "",
                    )
                ],
                (39615, 0.10884510766438413, 26.93184742000535, 5.96853746210469),
            )
        ],
    ),
}


def weighted(values):
    return float((np.arange(1, len(values) + 1) * values).sum() / len(values) ** 2)


def bodies_in(objects):
    state = "<velocity>[0,0,0]</velocity><temperature>12</temperature>"
    text = "<geom_object>{}<res>{}</res>" + state + "{}</geom_object>"
    return [object_of(ElementTree.fromstring(text.format(*parts)), {}, Path()) for parts in objects]


@pytest.mark.parametrize("case", SUS)
def test_bodies_are_those_that_uintah_makes(case):
    grid, options, materials = SUS[case]
    ids = ParticleIds(grid)
    for objects, (count, volume, places, numbers) in materials:
        particles = create_particles(bodies_in(objects), grid, MATERIAL, ids, **options).particles
        assert len(particles) == count
        assert particles.volume.sum() == pytest.approx(volume, rel=1e-12)
        assert weighted(particles.position @ [1.0, 10.0, 100.0]) == pytest.approx(places, rel=1e-12)
        assert weighted(particles.id & 0xFFFF) == pytest.approx(numbers, rel=1e-12)


def test_surface_particles_are_those_that_uintah_finds():
    grid, _, materials = SUS["shapes"]
    found = [
        create(bodies_in(objects), grid, find_surface=True).particles.surface for objects, _ in materials
    ]
    assert [surface.sum() for surface in found] == [761.0, 1008.0, 1984.0]


@pytest.mark.skipif(not REFERENCE.exists(), reason="reference runs are not here")
@pytest.mark.parametrize("deck", sorted(p.name for p in REFERENCE.glob("*")))
def test_reference_decks(deck):
    grid, axisymmetric, materials = bodies_of(REFERENCE / deck / "deck.ups")
    counts = json.loads((REFERENCE / deck / "run.json").read_text())["particles"]
    first_output = np.load(REFERENCE / deck / "particles.npz")
    ids = ParticleIds(grid)
    for index, (material, objects) in enumerate(materials):
        particles = create_particles(objects, grid, material, ids, axisymmetric=axisymmetric).particles
        sus = {name: first_output[f"t00001/{index}/{name}"] for name in ("p.particleID", "p.x", "p.mass")}
        assert len(particles) == counts[f"t00001/{index}"]
        order = np.argsort(particles.id)
        found = order[np.searchsorted(particles.id[order], sus["p.particleID"])]
        assert np.array_equal(particles.id[found], sus["p.particleID"])
        # The output is after one step, in which nothing moves farther than a fraction of a particle.
        assert np.abs(particles.position[found] - sus["p.x"]).max() < 0.1 * min(grid.spacing)
        assert particles.mass[found] == pytest.approx(sus["p.mass"], rel=1e-14)


def test_order_in_a_cell_and_of_cells():
    grid = grid_with((2, 1, 2))
    x = create([body(Box((0, 0, 0), (1, 1, 1)), res=(1, 2, 2))], grid).particles.position
    rows = [
        (cx, y, cz + z)
        for cz in (0.0, 0.5)
        for cx in (0.25, 0.75)
        for y in (0.25, 0.75)
        for z in (0.125, 0.375)
    ]
    assert x == pytest.approx(np.array(rows))


def test_the_counter_of_a_cell_goes_on_through_objects_and_materials():
    grid = grid_with((4, 2, 2))
    ids = ParticleIds(grid)
    left = body(Box((0, 0, 0), (0.25, 0.5, 0.5)))
    first = create_particles([left, left], grid, MATERIAL, ids)
    second = create_particles([left], grid, MATERIAL, ids)
    assert list(first.particles.id) == list(range(16))
    assert list(first.object) == [0] * 8 + [1] * 8
    assert list(second.particles.id) == list(range(16, 24))


@given(
    st.lists(st.tuples(st.integers(0, 3), st.integers(0, 1), st.integers(0, 2)), min_size=1, max_size=40),
    st.integers(0, 40),
)
def test_ids_are_cell_and_number_whatever_the_order(cells, split):
    grid = grid_with((4, 2, 3))
    ids = ParticleIds(grid)
    positions = (np.array(cells) + 0.5) * np.array(grid.spacing)
    given_ids = np.concatenate([ids.assign(positions[:split]), ids.assign(positions[split:])])
    born: dict[tuple[int, int, int], int] = {}
    for (i, j, k), identity in zip(cells, given_ids, strict=True):
        assert identity == born.setdefault((i, j, k), 0) + (i << 16) + (j << 32) + (k << 48)
        born[i, j, k] += 1
    assert ids.born.sum() == len(cells)


def test_a_cell_cannot_hold_more_particles_than_ids_can_number():
    grid = grid_with((1, 1, 1))
    with pytest.raises(ValueError, match="more than 65536 particles in a cell"):
        create([body(Box((0, 0, 0), (1, 1, 1)), res=(41, 40, 40))], grid)


def test_patches_are_the_outer_loop():
    grid = grid_with((4, 4, 4), (2, 1, 1))
    made = create([body(BALL), body(Box((0, 0, 0), (1, 1, 0.25)))], grid)
    assert np.all(np.diff(made.patch) >= 0)
    for patch in (0, 1):
        assert np.all(np.diff(made.object[made.patch == patch]) >= 0)
        x = made.particles.position[made.patch == patch, 0]
        assert np.all((x < 0.5) == (patch == 0))


def test_initial_state():
    grid = grid_with((4, 4, 1))
    given = body(
        Box((0, 0, 0), (0.5, 0.5, 1)),
        res=(2, 1, 1),
        velocity=(1.0, -2.0, 3.0),
        temperature=350.0,
        color=7.0,
        volume_fraction=0.25,
    )
    made = create([given], grid)
    p = made.particles
    assert len(p) == 8
    assert p.volume == pytest.approx(np.full(8, 0.03125))
    assert p.mass == pytest.approx(np.full(8, 7.8125))
    assert np.array_equal(p.size, np.tile(np.diag([0.5, 1.0, 1.0]), (8, 1, 1)))
    assert np.array_equal(p.velocity, np.tile([1.0, -2.0, 3.0], (8, 1)))
    assert set(p.temperature) == set(p.previous_temperature) == {350.0}
    assert set(p.color) == {7.0}
    assert np.array_equal(p.deformation_gradient, np.tile(np.eye(3), (8, 1, 1)))
    assert not p.stress.any()
    assert made.spacing == pytest.approx(np.array([[0.125, 0.25, 1.0]]))


def test_filling_levels_follow_a_curved_surface():
    exact = 4.0 / 3.0 * math.pi * 0.3**3
    grid = grid_with((4, 4, 4))
    coarse, fine = (
        create([body(BALL, res=(1, 1, 1), filling_levels=n)], grid).particles.volume.sum() for n in (1, -4)
    )
    assert fine == pytest.approx(exact, rel=0.06)
    assert abs(coarse - exact) > 2.0 * abs(fine - exact)


def test_particles_of_filling_levels_do_not_overlap():
    grid = grid_with((6, 6, 6))
    p = create([body(BALL, res=(1, 1, 1), filling_levels=-3)], grid).particles
    half = 0.5 * np.array([np.diag(s) for s in p.size]) * grid.spacing[0]
    apart = np.abs(p.position[:, None] - p.position[None]) - (half[:, None] + half[None])
    overlap = np.all(apart < -1e-12, axis=2)
    np.fill_diagonal(overlap, False)
    assert not overlap.any()
    corners = p.position[:, None] + 0.5 * half[:, None] * (2.0 * np.array(list(np.ndindex(2, 2, 2))) - 1.0)
    larger = half[:, 0] > half.min() * 1.5
    assert BALL.inside(corners[larger].reshape(-1, 3)).all()


@given(st.lists(st.floats(-0.2, 0.2), min_size=9, max_size=9))
def test_affine_maps_move_particles_and_scale_their_volumes(entries):
    grid = grid_with((4, 4, 4))
    box = Box((0.25, 0.25, 0.25), (0.5, 0.5, 0.5))
    A = np.eye(3) + np.array(entries).reshape(3, 3)
    shift = np.array([0.5, 0.5, 0.5]) - A @ [0.375, 0.375, 0.375]
    rows = dict(zip(("map_row_x", "map_row_y", "map_row_z"), map(tuple, A.tolist()), strict=True))
    plain = create([body(box)], grid).particles
    mapped = create([body(box, **rows, map_shift=tuple(shift))], grid).particles
    assert mapped.position == pytest.approx(plain.position @ A.T + shift)
    assert mapped.size == pytest.approx(A @ plain.size)
    assert mapped.volume == pytest.approx(np.linalg.det(A) * plain.volume)
    assert mapped.mass == pytest.approx(1000.0 * mapped.volume)


def test_an_affine_map_into_another_patch():
    grid = grid_with((4, 4, 4), (2, 1, 1))
    made = create([body(Box((0, 0, 0), (0.5, 1, 1)), map_shift=(0.25, 0.0, 0.0))], grid)
    assert len(made.particles) == 256
    assert np.array_equal(made.patch, (made.particles.position[:, 0] > 0.5).astype(int))
    assert len(np.unique(made.particles.id)) == 256


def test_axisymmetric_volumes_are_those_of_a_radian():
    grid = grid_with((8, 4, 1))
    made = create([body(Box((0.25, 0, 0), (1, 1, 1)), res=(2, 2, 1))], grid, axisymmetric=True)
    assert made.particles.volume.sum() == pytest.approx(0.5 * (1.0 - 0.0625))


def test_surface_particles_have_a_neighbour_outside():
    grid = grid_with((4, 4, 4))
    made = create([body(Box((0.25, 0.25, 0.25), (0.75, 0.75, 0.75)))], grid, find_surface=True)
    inner = np.all(np.abs(made.particles.position - 0.5) < 0.125, axis=1)
    assert np.array_equal(made.particles.surface == 0.0, inner)
    assert np.array_equal(made.loadable, ~inner)


def test_in_one_layer_of_cells_the_flat_faces_are_no_surface():
    grid = grid_with((4, 4, 1))
    made = create([body(Box((0.25, 0.25, 0), (0.75, 0.75, 1)), res=(2, 2, 1))], grid, find_surface=True)
    assert made.particles.surface.sum() == 12
    assert len(made.particles) == 16


def test_surface_is_not_looked_for_in_vain():
    assert not create([body(BALL)], grid_with((4, 4, 4))).particles.surface.any()


def test_many_pieces_are_one_body():
    grid = grid_with((8, 8, 8))
    other = Cylinder((0.2, 0.2, 0.1), (0.8, 0.3, 0.9), 0.15)
    together = create([body(BALL, other)], grid).particles
    union = create([body(Union((BALL, other)))], grid).particles
    assert np.array_equal(together.position, union.position)
    assert len(together) > len(create([body(BALL)], grid).particles)


def mesh_of_a_cube(folder):
    corners = np.array(list(np.ndindex(2, 2, 2)), float)
    np.savetxt(folder / "cube.pts", 0.25 + 0.5 * corners)
    np.savetxt(folder / "cube.tri", ConvexHull(corners).simplices, fmt="%d")
    return Tri("cube").load(lambda name: folder / name)


def test_materials_of_triangles_are_made_row_by_row(tmp_path):
    """The particles are the same as cell by cell; their order is by z, then y, then x, as in Uintah."""
    grid = grid_with((8, 8, 8), (2, 1, 1))
    cube = mesh_of_a_cube(tmp_path)
    rows = create([body(cube)], grid).particles
    cells = create([body(Box((0.25, 0.25, 0.25), (0.75, 0.75, 0.75)))], grid).particles
    assert {tuple(x) for x in rows.position} == {tuple(x) for x in cells.position}
    for patch in (rows.position[:, 0] < 0.5, rows.position[:, 0] > 0.5):
        x = rows.position[patch]
        assert np.array_equal(x, x[np.lexsort(x.T)])
    mixed = create([body(cube), body(Null())], grid).particles
    assert np.array_equal(mixed.position, cells.position)


def file_body(folder, rows, variables, **more):
    (folder / "body").write_text("\n".join(" ".join(f"{v:.17g}" for v in row) for row in rows))
    return body(File("body", variables).load(lambda name: folder / name), **more)


def test_listed_particles_take_what_the_file_says_and_else_the_object(tmp_path):
    grid = grid_with((2, 2, 2), (2, 1, 1))
    rows = [
        (0.9, 0.1, 0.1, 1.0, 2.0, 3.0, 0.0, 0.0, 1.0),
        (0.1, 0.1, 0.1, 4.0, 5.0, 6.0, 1.0, 0.0, 0.0),
        (0.6, 0.9, 0.9, 7.0, 8.0, 9.0, 0.0, 1.0, 0.0),
    ]
    given = file_body(tmp_path, rows, ("p.velocity", "p.normal"), res=(1, 2, 1), temperature=310.0)
    made = create([given], grid, find_surface=True)
    by_patch = np.array([rows[1], rows[0], rows[2]])
    assert np.array_equal(made.particles.position, by_patch[:, :3])
    assert np.array_equal(made.particles.velocity, by_patch[:, 3:6])
    assert np.array_equal(made.normal, by_patch[:, 6:])
    assert made.particles.volume == pytest.approx(np.full(3, 0.0625))
    assert set(made.particles.temperature) == set(made.particles.previous_temperature) == {310.0}
    assert set(made.particles.surface) == {1.0}
    assert made.loadable.all()


def test_listed_load_curves_are_not_looked_for(tmp_path):
    given = file_body(tmp_path, [(0.5, 0.5, 0.5, 2, 0, 0)], ("p.loadCurveID",))
    made = create([given], grid_with((2, 2, 2)), find_surface=True)
    assert list(made.particles.load_curve[0]) == [2, 0, 0]
    assert not made.loadable.any()


def test_nothing_to_make():
    grid = grid_with((2, 2, 2))
    assert len(create([], grid).particles) == 0
    assert len(create([body(Null()), body(Sphere((9.0, 9.0, 9.0), 1.0))], grid).particles) == 0


def test_particles_outside_the_grid(tmp_path):
    outside = file_body(tmp_path, [(0.5, 0.5, 0.5), (1.0, 0.5, 0.5), (0.5, 3.0, 0.5)], ())
    with pytest.raises(
        ValueError, match=r"2 of 3 particles lie outside the grid, the first at \(1, 0.5, 0.5\)"
    ):
        create([outside], grid_with((2, 2, 2)))
    with pytest.raises(ValueError, match="outside the grid"):
        create([body(BALL, map_shift=(0.5, 0.0, 0.0))], grid_with((4, 4, 4)))


def test_an_axisymmetric_body_beyond_the_axis():
    patch = Patch(0, (0, 0, 0), (4, 4, 1))
    grid = Grid((-0.5, 0.0, 0.0), (0.25, 0.25, 1.0), (4, 4, 1), (0, 0, 0), (0, 0, 0), (patch,))
    with pytest.raises(ValueError, match="must lie at x > 0"):
        create([body(Box((-0.5, 0, 0), (0.5, 1, 1)))], grid, axisymmetric=True)


def test_file_pieces_with_different_variables(tmp_path):
    first = file_body(tmp_path, [(0.5, 0.5, 0.5)], ())
    second = file_body(tmp_path, [(0.5, 0.5, 0.5, 9.0)], ("p.color",))
    with pytest.raises(ValueError, match="must have the same variables"):
        create([body(*first.pieces, *second.pieces)], grid_with((2, 2, 2)))


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (body, "no shape in it"),
        (lambda: body(BALL, res=(2, 0, 2)), "res is 0; it must be at least 1"),
        (lambda: body(BALL, volume_fraction=0.0), "volumeFraction is 0; it must be greater than 0"),
        (lambda: body(BALL, File("body")), "need a geom_object of their own"),
        (lambda: body(BALL, map_row_x=(-1.0, 0.0, 0.0)), "inside out"),
    ],
)
def test_wrong_objects(make, says):
    with pytest.raises(ValueError, match=says):
        make()
