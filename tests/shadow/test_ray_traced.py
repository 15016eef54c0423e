"""Ray-traced shadows: the analytic share of a rectangle behind a half-plane, by area and by irradiance."""

import numpy as np
import pytest
import shadelab as sl

UP = [0, 1, 0]


def edge_scene(scenes, dtype):
    """A half-plane x < 0 half way between the ground and a square light of side 0.8 at height 4."""
    mesh = scenes.join(scenes.quad(0.0, (-4, 4), (-4, 4), dtype), scenes.quad(2.0, (-9, 0), (-9, 9), dtype))
    return sl.accel.BVH(*mesh), scenes.rect_light(side=0.8)


def irradiance(points, normal, x, z):
    """Of parts of the light at (x, z), up to a factor: both cosines over the squared distance."""
    d = np.stack(np.broadcast_arrays(x - points[:, 0, None, None], 4.0, z - points[:, 2, None, None]), -1)
    return (d @ normal) * 4.0 / (d * d).sum(-1) ** 2


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_share_of_the_light_by_area(scenes, dtype):
    bvh, light = edge_scene(scenes, dtype)
    x = np.linspace(-0.6, 0.6, 241).astype(dtype)
    # Off the ground, since without normals rays start from the point itself.
    points = np.stack([x, 0 * x + dtype(1e-3), 0.2 + 0 * x], -1)
    lit = sl.shadow.ray_traced(bvh, points, None, light, 1024)
    assert lit.dtype == dtype
    # The shadow's edge on the light is at -x (heights in the ratio 1 : 1 to 1e-3); Sobol' points know it to 1 / 256.
    assert np.abs(lit - np.clip(0.5 + x / 0.8, 0, 1)).max() < 1 / 128


def test_share_of_the_light_by_irradiance(scenes):
    bvh, light = edge_scene(scenes, np.float64)
    x = np.linspace(-0.35, 0.35, 21)
    points, normal = np.stack([x, 0 * x, 0 * x], -1), np.array([0.8, 0.6, 0.0])
    lit = sl.shadow.ray_traced(bvh, points, normal, light, 4096)
    # Quadrature over the light; what is seen of it lies right of -x.
    grid = (np.arange(400) + 0.5) / 400 * 0.8 - 0.4
    sent = irradiance(points, normal, grid[None, :, None], grid[None, None, :])
    seen = grid[None, :, None] > -points[:, 0, None, None]
    exact = (sent * seen).sum((1, 2)) / sent.sum((1, 2))
    assert np.abs(lit - exact).max() < 1 / 200
    # Which differs from the share by area by more than that, or this test would prove nothing.
    by_area = sl.shadow.ray_traced(bvh, points + np.array([0, 1e-6, 0]), None, light, 4096)
    assert np.abs(by_area - exact).max() > 1 / 50


def test_error_falls_faster_than_noise(scenes):
    bvh, light = edge_scene(scenes, np.float64)
    # A share that no number of samples meets by luck.
    points = np.tile([0.0937, 1e-6, 0.0], (2000, 1))
    exact = 0.5 + 0.0937 / 0.8
    errors = [(sl.shadow.ray_traced(bvh, points, None, light, n) - exact).std() for n in (4, 64)]
    # Independent samples would gain 4; stratified ones gain 16^(3/4) = 8.
    assert errors[0] / errors[1] > 6
    mean = sl.shadow.ray_traced(bvh, points, None, light, 4).mean()
    assert mean == pytest.approx(exact, abs=4 * errors[0] / np.sqrt(2000))


def test_lit_where_nothing_blocks_and_dark_where_all_is_blocked(scenes):
    bvh, light = edge_scene(scenes, np.float32)
    for normals in (None, UP):
        lit = sl.shadow.ray_traced(bvh, [[2.0, 1e-3, 0], [-2, 1e-3, 0]], normals, light, 5)
        assert lit.tolist() == [1, 0]


@pytest.mark.parametrize("kind", ["point", "sun"])
def test_lights_without_extent_agree_with_a_fine_map(scenes, kind):
    mesh = scenes.join(scenes.quad(0.0, (-2, 2), (-2, 2)), scenes.quad(1.0, (-0.5, 0.5), (-0.5, 0.5)))
    light = scenes.lights()[kind]
    points = (np.random.default_rng(1).uniform(-2, 2, (5000, 3)) * [1, 0, 1]).astype(np.float32)
    rays = sl.shadow.ray_traced(sl.accel.BVH(*mesh), points, UP, light)
    mapped = sl.shadow.hard(sl.shadow.shadow_map(*mesh, light, 4096), points, UP)
    # They differ within half a texel of the outline alone: 4 · 1.3 · 0.001 of 16.
    assert (rays != mapped).mean() < 2e-3
    assert 0 < (rays == 0).mean() < 0.2


def test_the_face_under_the_receiver_hides_nothing(scenes):
    ground, faces = scenes.quad(0.0, (-2, 2), (-2, 2))
    bvh = sl.accel.BVH(ground, faces)
    # Below the surface by rounding.
    points = np.array([[0.5, -1e-7, 0.2]], np.float32)
    light = scenes.rect_light()
    assert sl.shadow.ray_traced(bvh, points, None, light) == 0
    face = bvh.closest_hit([[0.5, 1, 0.2]], [0, -1, 0]).face
    assert sl.shadow.ray_traced(bvh, points, None, light, ignore_face=face) == 1
    assert sl.shadow.ray_traced(bvh, points, UP, light) == 1


def test_nan_stays_where_it_is_and_below_the_horizon_is_one(scenes):
    bvh, light = edge_scene(scenes, np.float32)
    points = np.array([[-2.0, 0, 0]] * 4, np.float32)
    normals = np.array([UP] * 4, np.float32)
    points[1, 0], normals[2, 1] = np.nan, np.nan
    normals[3] = [0, -1, 0]
    lit = sl.shadow.ray_traced(bvh, points, normals, light)
    assert lit[0] == 0 and np.isnan(lit[1:3]).all() and lit[3] == 1


def test_the_same_seed_gives_the_same_bits(scenes):
    bvh, light = edge_scene(scenes, np.float32)
    points = (np.random.default_rng(1).uniform(-1, 1, (20_000, 3)) * [1, 0, 1]).astype(np.float32)
    before, results = sl.threads(), []
    try:
        for n in (1, 3):
            sl.set_threads(n)
            for level in sl.simd_levels():
                with sl.simd(level):
                    results.append(sl.shadow.ray_traced(bvh, points, UP, light, 8, seed=3))
    finally:
        sl.set_threads(before)
    assert all(np.array_equal(results[0], r) for r in results)
    assert not np.array_equal(results[0], sl.shadow.ray_traced(bvh, points, UP, light, 8, seed=4))


def test_errors_name_the_argument(scenes):
    bvh, light = edge_scene(scenes, np.float32)
    with pytest.raises(TypeError, match="bvh: expected a BVH"):
        sl.shadow.ray_traced(None, [0, 0, 0], None, light)
    with pytest.raises(ValueError, match="samples"):
        sl.shadow.ray_traced(bvh, [0, 0, 0], None, light, 0)
    with pytest.raises(TypeError, match="light: expected"):
        sl.shadow.ray_traced(bvh, [0, 0, 0], None, None)
    with pytest.raises(ValueError, match="ignore_face"):
        sl.shadow.ray_traced(bvh, [[0, 0, 0]], None, light, ignore_face=[1, 2])


@pytest.mark.parametrize("face", [-2, 2, 2**32])
def test_ignored_faces_are_faces(scenes, face):
    p, f = scenes.quad(0.0, (-1, 1), (-1, 1))
    bvh = sl.accel.BVH(p, f)
    with pytest.raises(ValueError, match="ignore_face: expected -1 or a face below 2"):
        sl.shadow.ray_traced(bvh, [0.0, -1, 0], None, scenes.rect_light(), ignore_face=face)


SAMPLERS = ["sobol", "independent", "stratified", "latin_hypercube", "multi_jittered", "r2", "halton"]


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_every_sampler_tends_to_the_exact_fraction(scenes, sampler):
    bvh, light = edge_scene(scenes, np.float64)
    rng = np.random.default_rng(4)
    points = np.stack([rng.uniform(-0.3, 0.3, 1500), np.full(1500, 1e-6), rng.uniform(-0.2, 0.2, 1500)], -1)
    # An edge askew to the light's sides, as most are: a second half-plane, turned.
    exact = sl.shadow.half_plane(points, None, light, [[0, 2, 0], [0, 0, 1], [-1, 0, 0]])
    rms = []
    for n in (4, 16, 64, 256):
        off = sl.shadow.ray_traced(bvh, points, None, light, n, sampler=sampler) - exact
        rms.append(np.sqrt(np.mean(off**2)))
        # Unbiased: the mean over receivers is off by chance alone.
        assert abs(off.mean()) < 4 * off.std() / np.sqrt(len(off))
    rate = np.polyfit(np.log([4, 16, 64, 256]), np.log(rms), 1)[0]
    # Independent points: -1/2; the others stratify, and gain from it where the edge lies along a side of the light.
    assert rate == pytest.approx(-0.5, abs=0.06) if sampler == "independent" else rate < -0.7
    assert np.array_equal(*(sl.shadow.ray_traced(bvh, points[:9], UP, light, 8, sampler=sampler) for _ in range(2)))


def test_offsets_shift_one_set_for_all(scenes):
    bvh, light = edge_scene(scenes, np.float64)
    points = np.stack([np.linspace(-0.3, 0.3, 64), np.full(64, 1e-6), np.zeros(64)], -1)
    shifts = np.random.default_rng(1).random((64, 2))
    lit = [sl.shadow.ray_traced(bvh, points, None, light, 16, sampler="r2", offsets=s) for s in (shifts, shifts + 3)]
    np.testing.assert_allclose(*lit, atol=1e-12)
    # One place, two shifts: another answer; one shift: the same answer everywhere.
    same = np.tile(points[40], (64, 1))
    assert np.ptp(sl.shadow.ray_traced(bvh, same, None, light, 4, offsets=shifts)) > 0
    assert np.ptp(sl.shadow.ray_traced(bvh, same, None, light, 4, offsets=shifts[0])) == 0


def test_blue_noise_shifts_spread_the_error(scenes):
    """What is left after a blur of 3 × 3 pixels is less than with offsets at random."""
    bvh, light = edge_scene(scenes, np.float64)
    x, z = np.meshgrid(np.linspace(-0.2, 0.2, 64), np.linspace(-0.2, 0.2, 64))
    points = np.stack([x, 0 * x + 1e-6, z], -1)
    exact = sl.shadow.half_plane(points, None, light, [[0, 2, 0], [0, 0, 1], [-1, 0, 0]])
    left = {}
    for name, tiles in (
        ("blue", [sl.sampling.blue_noise_mask(64, seed=s) for s in (1, 2)]),
        ("white", np.random.default_rng(2).random((2, 64, 64))),
    ):
        off = sl.shadow.ray_traced(bvh, points, None, light, 1, offsets=np.stack(list(tiles), -1)) - exact
        blurred = sum(np.roll(off, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)) / 9
        left[name] = blurred[2:-2, 2:-2].std()
    assert left["blue"] < 0.7 * left["white"]


def test_samplers_and_offsets_are_checked(scenes):
    bvh, light = edge_scene(scenes, np.float32)
    with pytest.raises(ValueError, match="sampler: expected one of"):
        sl.shadow.ray_traced(bvh, [0, 0, 0], None, light, sampler="best")
    with pytest.raises(ValueError, match="offsets: expected shape"):
        sl.shadow.ray_traced(bvh, [[0, 0, 0]], None, light, offsets=np.zeros((3, 2)))
    with pytest.raises(ValueError, match="offsets: expected finite"):
        sl.shadow.ray_traced(bvh, [[0, 0, 0]], None, light, offsets=[np.nan, 0])
