"""Shadows from distance fields: straight edges, grids against functions, steps, and what must not change."""

import numpy as np
import pytest
import shadelab as sl
from shadelab.light import AmbientLight, DirectionalLight, DiskLight, PointLight

SHADOW = sl.shadow
UP = [0, 1, 0]


def slab(p):
    """The half-space x < 0, between heights 1.5 and 2.5: thicker than the penumbrae of the tests are wide."""
    q = np.stack([p[:, 0], np.abs(p[:, 1] - 2.0) - 0.5], -1)
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(-1), 0)


def ball(p, radius=0.5, height=1.5):
    return np.linalg.norm(p - np.array([0, height, 0], p.dtype), axis=-1) - radius


def ground(n=41, half=1.5, dtype=np.float64):
    x = np.linspace(-half, half, n)
    x, z = np.meshgrid(x, x)
    return np.stack([x, 0 * x, z], -1).astype(dtype)


# The slab's lower and upper edge, of which the one or the other hides the more.
EDGES = [[[0, y, 0], [0, 0, 1], [-1, 0, 0]] for y in (1.5, 2.5)]


@pytest.mark.parametrize("light", [0.2, 0.5])
def test_penumbra_of_a_straight_edge(scenes, light):
    x = np.linspace(-0.6, 0.6, 241)
    points = np.stack([x, 0 * x, 0 * x], -1)
    given = scenes.rect_light(side=light)
    knobs = {"step": 0.02, "max_steps": 4096}
    exact = SHADOW.half_plane(points, None, given, EDGES)
    outer = SHADOW.distance_field(slab, points, UP, given, penumbra="outer", **knobs)
    centered = SHADOW.distance_field(slab, points, UP, given, **knobs)
    # The field measures square to the ray and the light's side lies level: up to 1 % here.
    assert np.abs(centered - exact)[x > 0].max() < 0.01
    assert np.abs(outer - np.clip(2 * exact - 1, 0, 1)).max() < 0.02
    # Within the hard shadow the slab's lower face may be nearer than its side.
    assert np.abs(centered - exact).max() < 0.1
    assert (np.diff(centered) >= -1e-9).all() and centered[0] == 0 and centered[-1] == 1


def test_a_disk_has_the_profile_of_a_chord():
    x = np.linspace(0.001, 0.6, 50)
    points = np.stack([x, 0 * x, 0 * x], -1)
    light = DiskLight((0, 4, 0), (0, -1, 0), 0.25)
    lit = SHADOW.distance_field(slab, points, UP, light, step=0.02, max_steps=4096)
    assert np.abs(lit - SHADOW.half_plane(points, None, light, EDGES)).max() < 0.02


@pytest.mark.parametrize("method", ["between", "step"])
@pytest.mark.parametrize("penumbra", ["outer", "centered"])
def test_a_grid_of_a_function_tends_to_the_function(scenes, method, penumbra):
    points, light = ground(), scenes.rect_light(side=0.6)
    knobs = {"method": method, "penumbra": penumbra, "offset": 0.05, "step": 0.3, "max_steps": 1024}
    exact = SHADOW.distance_field(ball, points, UP, light, **knobs)
    bounds = [(-2, -0.2, -2), (2, 4, 2)]
    errors = []
    for n in (16, 64):
        grid = SHADOW.distance_grid(ball, bounds, resolution=n, dtype=np.float64)
        errors.append(np.abs(SHADOW.distance_field(grid, points, UP, light, **knobs) - exact).max())
    # Interpolation is off by the cell's square over the ball's radius; steps differ a little besides.
    assert errors[1] < 0.03 and errors[1] < 0.5 * errors[0]
    assert 0.1 < ((exact > 0) & (exact < 1)).mean() < 0.9


def test_a_mesh_gives_the_field_of_its_shape():
    sphere = sl.mesh.icosphere(4, 0.5)
    bvh = sl.accel.BVH(sphere.positions + np.float32([0, 1.5, 0]), sphere.faces)
    grid = SHADOW.distance_grid(bvh, resolution=24)
    nodes = np.stack(np.meshgrid(*(grid.low[i] + grid.cell * np.arange(grid.distances.shape[i]) for i in range(3)),
                                 indexing="ij"), -1)  # fmt: skip
    # An icosphere of 5,120 faces lies up to 0.2 % of its radius inside of the sphere.
    assert np.abs(grid.distances - ball(nodes.reshape(-1, 3)).reshape(nodes.shape[:3])).max() < 2e-3
    assert grid.nbytes == 4 * grid.distances.size and grid.distances.dtype == np.float32
    # 10 % of the extent to each side.
    np.testing.assert_allclose(grid.low, [-0.6, 0.9, -0.6], atol=1e-3)
    plain = SHADOW.distance_grid(bvh, resolution=24, sign="none")
    np.testing.assert_array_equal(plain.distances, np.abs(grid.distances))


def test_solids_one_by_one_have_an_inside_where_they_touch(scenes):
    floor = scenes.quad(0.0, (-2, 2), (-2, 2))
    box = sl.mesh.box((1, 1, 1))
    standing = (box.positions + np.float32([0, 0.5, 0]), box.faces)
    grid = SHADOW.distance_grid(
        [sl.accel.BVH(*floor), sl.accel.BVH(*standing)], [(-2, -1, -2), (2, 3, 2)], resolution=8
    )
    # At the box's middle: half a side inside.
    assert grid.distances[4, 3, 4] == pytest.approx(-0.5)
    assert grid.distances[4, 0, 4] == pytest.approx(1.0)


@pytest.mark.parametrize("shape", ["edges", "round"])
def test_points_between_steps_are_those_of_edges(scenes, shape):
    """Of steps as long as the field allows, against tiny ones: right beside an edge, too near beside what is round."""
    points, light = ground(81), scenes.rect_light(side=0.8)

    def post(p):
        q = np.abs(p - np.array([0, 1.5, 0])) - np.array([1e-3, 1e-3, 9])
        return np.linalg.norm(np.maximum(q, 0), axis=-1)

    field = post if shape == "edges" else ball
    fine = SHADOW.distance_field(field, points, UP, light, method="step", step=0.01, max_steps=4096, offset=1e-3)
    error = {
        m: SHADOW.distance_field(field, points, UP, light, method=m, offset=1e-3) - fine for m in ("between", "step")
    }
    rms = {m: np.sqrt(np.mean(e**2)) for m, e in error.items()}
    # Steps alone find too little, never too much.
    assert error["step"].min() > -2e-3
    if shape == "edges":
        assert rms["between"] < 0.2 * rms["step"]
    else:
        assert rms["between"] < 0.05 and error["between"].mean() < 0


def test_hard_shadows_as_the_light_shrinks(scenes):
    points = ground(61)
    light = PointLight((0.3, 4.0, 0.2))
    sphere = sl.mesh.icosphere(5, 0.5)
    bvh = sl.accel.BVH(sphere.positions + np.float32([0, 1.5, 0]), sphere.faces)
    traced = SHADOW.ray_traced(bvh, points, None, light)
    for knobs in ({"k": 1e6}, {"light_size": 1e-6}):
        for penumbra in ("outer", "centered"):
            # Steps shorten near the surface, so that rays along it need many.
            lit = SHADOW.distance_field(
                ball, points, None, light, penumbra=penumbra, max_steps=4096, offset=1e-4, **knobs
            )
            # The mesh is 0.1 % smaller than the ball; a hundredth of the outline's points lie between.
            assert (np.abs(lit - traced) > 0.01).mean() < 0.01
    assert 0.02 < (traced == 0).mean() < 0.5


def test_width_and_hardness_are_one_knob(scenes):
    points = ground(31)
    grid = SHADOW.distance_grid(ball, [(-2, 0, -2), (2, 4, 2)], resolution=32, dtype=np.float64)
    sun = DirectionalLight((0.2, -1.0, 0.1))
    a = SHADOW.distance_field(grid, points, UP, sun, k=1 / np.tan(0.05))
    np.testing.assert_allclose(a, SHADOW.distance_field(grid, points, UP, sun, light_size=0.1), atol=1e-9)
    # The harder, the fewer points in penumbra.
    shares = [
        ((lit > 0) & (lit < 1)).mean()
        for lit in (SHADOW.distance_field(grid, points, UP, sun, k=k) for k in (4, 16, 64))
    ]
    assert shares[0] > 1.5 * shares[1] and shares[1] > 2 * shares[2] > 0


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_nothing_blocks_and_rays_past_the_grid_are_lit(scenes, dtype):
    grid = SHADOW.distance_grid(lambda p: np.full(len(p), 9.0), [(-1, 0, -1), (1, 2, 1)], resolution=4, dtype=dtype)
    points = np.array([[0, 0, 0], [5, 0, 0], [0, 0, -7]], dtype)
    found = SHADOW.distance_field(grid, points, UP, scenes.rect_light(), full_output=True)
    assert found.lit.dtype == dtype and found.lit.tolist() == [1, 1, 1]
    assert found.steps[1] == 0 and found.along.tolist() == [0, 0, 0] and found.closest.tolist() == [1, 1, 1]
    # In the middle of something all is dark.
    grid = SHADOW.distance_grid(lambda p: np.full(len(p), -9.0), [(-1, 0, -1), (1, 2, 1)], resolution=4, dtype=dtype)
    assert SHADOW.distance_field(grid, points[0], UP, scenes.rect_light()) == 0


def test_a_receiver_does_not_shade_itself(scenes):
    floor = scenes.quad(0.0, (-2, 2), (-2, 2))
    grid = SHADOW.distance_grid(sl.accel.BVH(*floor), [(-2, -0.25, -2), (2, 3.75, 2)], resolution=33, sign="none")
    points = ground(41, 1.9, np.float32)
    for light in (scenes.rect_light(side=2.0), DirectionalLight((1.0, -0.1, 0.0))):
        knobs = {"light_size": 0.3} if isinstance(light, DirectionalLight) else {}
        assert (SHADOW.distance_field(grid, points, UP, light, **knobs) == 1).all()


def test_the_same_bits_for_any_number_of_threads(scenes):
    grid = SHADOW.distance_grid(ball, [(-2, 0, -2), (2, 4, 2)], resolution=24)
    points, before, results = ground(120, 1.5, np.float32), sl.threads(), []
    try:
        for n in (1, 3):
            sl.set_threads(n)
            for level in sl.simd_levels():
                with sl.simd(level):
                    results.append(SHADOW.distance_field(grid, points, UP, scenes.rect_light()))
    finally:
        sl.set_threads(before)
    assert all(np.array_equal(results[0], r) for r in results)


def test_nan_stays_where_it_is(scenes):
    grid = SHADOW.distance_grid(ball, [(-2, 0, -2), (2, 4, 2)], resolution=24)
    points, normals = np.zeros((4, 3)), np.array([UP] * 4, float)
    points[1, 0], normals[2, 1] = np.nan, np.inf
    for field in (grid, ball):
        found = SHADOW.distance_field(field, points, normals, scenes.rect_light(), full_output=True)
        for a, dark in ((found.lit, 0), (found.closest, -1)):
            assert np.isnan(a[1:3]).all() and a[0] == dark and a[3] == dark


def test_errors_name_the_argument(scenes):
    light, box = scenes.rect_light(), [(-1, -1, -1), (1, 1, 1)]
    grid = SHADOW.distance_grid(ball, box, resolution=2)
    look = SHADOW.distance_field
    with pytest.raises(TypeError, match="field: expected a DistanceGrid"):
        look(None, [0, 0, 0], None, light)
    with pytest.raises(TypeError, match="light: expected"):
        look(grid, [0, 0, 0], None, AmbientLight((1, 1, 1)))
    with pytest.raises(ValueError, match="light_size: the light has no extent"):
        look(grid, [0, 0, 0], None, PointLight((0, 1, 0)))
    with pytest.raises(ValueError, match="light_size: expected one of"):
        look(grid, [0, 0, 0], None, light, k=8, light_size=1)
    for name, value in (
        ("k", 0.0),
        ("step", 0.0),
        ("step", 2.0),
        ("max_steps", 0),
        ("offset", -1.0),
        ("offset", 1e300),
        ("method", "best"),
    ):
        with pytest.raises(ValueError, match=name):
            look(grid, [0, 0, 0], None, light, **{name: value})
    with pytest.raises(ValueError, match="field: expected distances of shape"):
        look(lambda p: p, [[0, 0, 0]], None, light)
    with pytest.raises(ValueError, match="bounds: expected where a source"):
        SHADOW.distance_grid(ball)
    with pytest.raises(ValueError, match="bounds"):
        SHADOW.distance_grid(ball, [(1, 1, 1), (0, 0, 0)])
    with pytest.raises(ValueError, match="resolution"):
        SHADOW.distance_grid(ball, box, resolution=2000)
    for wrong in ([1], 1.0, None):
        with pytest.raises(TypeError, match="sources"):
            SHADOW.distance_grid(wrong)
    with pytest.raises(ValueError, match="distances: expected shape"):
        SHADOW.DistanceGrid(np.zeros((2, 2)), (0, 0, 0), 1.0)
    with pytest.raises(ValueError, match="cell"):
        SHADOW.DistanceGrid(np.zeros((2, 2, 2)), (0, 0, 0), 0.0)
    with pytest.raises(ValueError, match="distances: expected finite"):
        SHADOW.DistanceGrid(np.full((2, 2, 2), np.nan), (0, 0, 0), 1.0)
