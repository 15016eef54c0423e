"""Direct light: exact at an analytic edge, equal to closed forms without obstacles, with an error that is its own."""

import numpy as np
import pytest
import shadelab as sl
from shadelab import scene
from shadelab.light import DirectionalLight, PointLight, RectLight, SphereLight

UP = np.array([0.0, 1, 0])
NOWHERE = sl.accel.BVH([[0.0, 90, 0], [1e-3, 90, 0], [0, 90, 1e-3]], [[0, 1, 2]])
LAMP = RectLight((0, 2, 0), (1, 0, 0), (0, 0, 1), (3, 2, 1))


def half_plane(height, edge, dtype=np.float64):
    """A screen over all x < edge."""
    corners = np.array([[-100, height, -100], [edge, height, -100], [edge, height, 100], [-100, height, 100]], dtype)
    return sl.accel.BVH(corners, [[0, 1, 2], [0, 2, 3]])


def behind_half_plane(x, height, edge):
    """Irradiance from what is seen of LAMP past the edge, in closed form."""
    out = []
    for px in x:
        # The line through the edge meets the lamp's plane here; what lies beyond is seen.
        cut = np.clip(px + (edge - px) * 2 / height, -0.5, 0.5)
        corners = LAMP.corners
        corners[:, 0] = np.maximum(corners[:, 0], cut)
        out.append(sl.light.polygon_irradiance(corners, [px, 0, 0], UP))
    return np.array(out)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_penumbra_of_a_half_plane_is_exact(dtype):
    x = np.linspace(-1.2, 1.2, 97)
    points = np.stack([x, 0 * x, 0 * x], -1)
    bvh = half_plane(1.0, 0.1, dtype)
    errors = []
    for samples in (64, 1024):
        got = sl.pathtrace.direct_light(
            bvh, LAMP, points, UP, [1.0] * 3, specular=0.0, wo=UP, samples=samples, offset=1e-6
        )
        assert got.radiance.dtype == dtype
        exact = behind_half_plane(x, 1.0, 0.1)[:, None] * LAMP.radiance / np.pi
        penumbra = (exact[:, 0] > 1e-6) & (exact[:, 0] < 0.99 * exact[:, 0].max())
        assert np.abs(got.radiance - exact)[exact[:, 0] == 0].max() == 0
        errors.append(np.sqrt(((got.radiance - exact)[penumbra, 0] ** 2).mean()) / exact[:, 0].max())
        # The stated error is an upper bound of the true one here.
        assert errors[-1] < np.sqrt(got.variance[penumbra, 0].mean()) / exact[:, 0].max()
    # An edge: samples^(-3/4), a factor of 8 over 16 times the samples; independent samples would give 4.
    assert errors[1] < 1.5e-3 and errors[0] / errors[1] > 5.5


@pytest.mark.parametrize("roughness", [0.1, 0.4, 0.9])
def test_without_obstacles_it_is_unshadowed(roughness):
    rng = np.random.default_rng(1)
    points = rng.uniform(-1, 1, (60, 3)) * [1, 0.2, 1]
    normals = rng.normal(size=(60, 3)) * 0.3 + UP
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    # None before another, which would shade it.
    lights = [LAMP, PointLight((1, 2, 1), (2, 2, 2)), DirectionalLight((1, -0.4, 0.3))]
    material = ([0.8, 0.5, 0.2], 0.5, roughness)
    eye = (0.5, 1.0, 3.0)
    got = sl.pathtrace.direct_light(NOWHERE, lights, points, normals, *material, eye=eye, samples=2048)
    wanted = sl.light.unshadowed(lights, points, normals, *material, eye=eye, samples=8192, seed=9)
    assert np.array_equal(got.radiance == 0, wanted == 0)
    # The references' own errors: those stated, which are upper bounds, and the other's at four times the samples.
    assert (np.abs(got.radiance - wanted) < 5 * np.sqrt(got.variance) + 1e-6).all()
    assert np.abs(got.radiance - wanted).max() < 0.02 * wanted.max()


def test_mirrors_see_the_light_past_the_edge():
    # Two strategies, one answer: narrow mirrors under a screen, against a dense average over the light.
    x = np.linspace(-0.6, 0.6, 25)
    points = np.stack([x, 0 * x, 0 * x], -1)
    wo = np.array([0.0, 1, 0])
    bvh = half_plane(1.0, 0.0)
    got = sl.pathtrace.direct_light(bvh, LAMP, points, UP, [1.0] * 3, 1.0, 0.4, wo=wo, samples=4096)
    u = sl.sampling.sobol(1 << 14, 2)
    wi, distance, pdf = sl.light.light_sample(LAMP, points[:, None], u)
    clear = ~bvh.any_hit(points[:, None] + 1e-6 * UP, wi, t_max=distance)
    to_local = [0, 2, 1]
    f = sl.brdf.metallic_roughness(wi[..., to_local], wo[to_local], [1.0] * 3, 1.0, 0.4)
    dense = (f[..., 0] * clear * wi[..., 1] / pdf).mean(1) * LAMP.radiance[0]
    assert np.allclose(got.radiance[:, 0], dense, rtol=5e-3, atol=2e-3 * dense.max())


def test_seeds_are_independent_and_halves_measure_the_error():
    x = np.linspace(-0.5, 0.6, 400)
    points = np.stack([x, 0 * x, 0.1 + 0 * x], -1)
    bvh = half_plane(1.0, 0.1)
    run = lambda seed, samples: sl.pathtrace.direct_light(  # noqa: E731
        bvh, LAMP, points, UP, [1.0] * 3, specular=0.0, wo=UP, samples=samples, seed=seed
    ).radiance[:, 0]
    a, b, exact = run(1, 64), run(2, 64), run(3, 1 << 14)
    measured, true = np.mean((a - b) ** 2) / 2, np.mean((a - exact) ** 2)
    # 400 receivers: a relative spread of a mean square of about 10 %.
    assert measured == pytest.approx(true, rel=0.4)
    assert abs(np.corrcoef(a - exact, b - exact)[0, 1]) < 0.25


def test_going_on_extends_the_same_sequence():
    points, bvh = np.array([[0.05, 0, 0], [0.3, 0, 0.2]]), half_plane(1.0, 0.1)
    keywords = {"specular": 0.0, "wo": UP, "seed": 3}
    whole = sl.pathtrace.direct_light(bvh, LAMP, points, UP, [1.0] * 3, samples=256, **keywords)
    parts = [
        sl.pathtrace.direct_light(bvh, LAMP, points, UP, [1.0] * 3, samples=n, start=s, **keywords)
        for n, s in ((64, 0), (192, 64))
    ]
    merged = parts[0].merge(parts[1])
    assert merged.samples == 256
    assert np.allclose(merged.radiance, whole.radiance, rtol=1e-12)
    assert np.allclose(merged.variance, whole.variance, rtol=1e-9)


def test_punctual_lights_cast_hard_shadows():
    bvh = half_plane(1.0, 0.0)
    points = np.array([[-0.5, 0, 0], [0.5, 0, 0]])
    for light in (PointLight((0, 2, 0)), DirectionalLight((0, -1, 0))):
        got = sl.pathtrace.direct_light(bvh, light, points, UP, [1.0] * 3, specular=0.0, wo=UP)
        assert got.radiance[0].max() == 0 and got.variance.max() == 0
        assert np.allclose(got.radiance[1], sl.light.irradiance(light, points[1], UP) / np.pi)
    # A point light under the screen is not shadowed by what is behind it.
    below = PointLight((0, 0.5, 0))
    assert sl.pathtrace.direct_light(bvh, below, points, UP, [1.0] * 3, wo=UP).radiance.min() > 0


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_threads_and_levels_change_no_bit(dtype):
    ball = sl.mesh.icosphere(3, 0.5)
    bvh = sl.accel.BVH(ball.positions.astype(dtype), ball.faces)
    points = np.random.default_rng(2).uniform(-1, 1, (500, 3)) * [1, 0, 1] - 0.6 * UP
    results, before = [], sl.threads()
    for level in sl.simd_levels():
        for threads in (1, 3):
            with sl.simd(level):
                sl.set_threads(threads)
                results.append(sl.pathtrace.direct_light(bvh, LAMP, points, UP, [0.5] * 3, eye=(0, 1, 3), samples=32))
    sl.set_threads(before)
    assert all(np.array_equal(r.radiance, results[0].radiance) for r in results)


def test_lit_ground_under_its_own_mesh_has_no_acne():
    # A fine floor that receives and blocks: every shadow ray starts on it. Also far from the origin.
    for scale, shift in ((1.0, 0.0), (1e6, 0.0), (1e-6, 0.0), (1.0, 1e3)):
        n = 33
        x, z = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n))
        y = 0.05 * np.sin(3 * x) * np.cos(2 * z)
        positions = (np.stack([x, y, z], -1).reshape(-1, 3) * scale + shift).astype(np.float32)
        i = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
        faces = np.concatenate([np.stack([i, i + n, i + 1], -1), np.stack([i + 1, i + n, i + n + 1], -1)])
        bvh = sl.accel.BVH(positions, faces)
        middle = positions[faces].mean(1)
        normals = np.cross(
            positions[faces][:, 1] - positions[faces][:, 0], positions[faces][:, 2] - positions[faces][:, 0]
        )
        normals = normals.astype(float)
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
        lamp = RectLight((shift, 2 * scale + shift, shift), (scale, 0, 0), (0, 0, scale))
        got = sl.pathtrace.direct_light(bvh, lamp, middle, normals, [1.0] * 3, specular=0.0, wo=normals, samples=64)
        free = sl.light.unshadowed(lamp, middle, normals, [1.0] * 3, specular=0.0, wo=normals)
        # The waves are too flat to shade each other under this lamp.
        assert np.allclose(got.radiance, free, rtol=0.05)


def test_rows_without_surface_are_black_and_nan_stays_in_its_row():
    points = np.array([[0.0, 0, 0], [0, 0, 0], [np.nan, 0, 0]])
    got = sl.pathtrace.direct_light(
        NOWHERE, LAMP, points, UP, [[0.5] * 3], [0.0], [0.5], [1.0], wo=UP, material_ids=[0, -1, 0]
    )
    assert np.isfinite(got.radiance[0]).all() and got.radiance[0].min() > 0
    assert np.array_equal(got.radiance[1], [0, 0, 0]) and np.isnan(got.radiance[2]).all()
    with pytest.raises(ValueError, match="samples: expected an integer from 1"):
        sl.pathtrace.direct_light(NOWHERE, LAMP, points, UP, [0.5] * 3, wo=UP, samples=0)


@pytest.mark.parametrize("roughness", [0.2, 1.0])
def test_a_light_stops_the_light_of_others_as_its_own_shape_would(roughness):
    """As in `path_trace`; from behind, lights are not there."""
    near = RectLight((0, 1, 0), (1, 0, 0), (0, 0, 1), (1, 1, 1))
    back = RectLight((0, 1, 0), (0, 0, 1), (1, 0, 0), (1, 1, 1))
    corners = np.array([[-0.5, 1, -0.5], [0.5, 1, -0.5], [0.5, 1, 0.5], [-0.5, 1, 0.5]])
    shape = sl.accel.BVH(corners, [[0, 1, 2], [0, 2, 3]])
    x = np.linspace(-1, 1, 21)
    points = np.stack([x, 0 * x, 0.3 * x], -1)
    material = ([0.6] * 3, 0.3, roughness)

    def lit(lights, bvh=NOWHERE, seed=0):
        return sl.pathtrace.direct_light(bvh, lights, points, UP, *material, eye=(0, 1, 2), samples=1024, seed=seed)

    for far in (RectLight((0, 2, 0), (2, 0, 0), (0, 0, 2), (5, 4, 3)), PointLight((0, 2, 0), (9, 9, 9))):
        alone, past, free = lit([near]), lit([far], shape, 1), lit([far], seed=2)
        together, behind = lit([near, far], seed=3), lit([back, far], seed=4)
        assert (past.radiance < 0.9 * free.radiance).any()
        wanted = alone.radiance + past.radiance
        spread = np.sqrt(together.variance + alone.variance + past.variance)
        assert (np.abs(together.radiance - wanted) < 5 * spread + 1e-9).all()
        spread = np.sqrt(behind.variance + free.variance)
        assert (np.abs(behind.radiance - free.radiance) < 5 * spread + 1e-9).all()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(
    "light",
    [RectLight((0, 3, 0), (1, 0, 0), (0, 0, 1), (9, 9, 9)), SphereLight((0, 3, 0), 0.5, (9, 9, 9))],
    ids=["rectangle", "sphere"],
)
def test_lights_in_one_place_do_not_put_each_other_out(light, dtype):
    """The first is seen; a smaller one behind it in the list gives nothing more."""
    points = np.array([[0.3, 0, 0.1], [2, 0, 1]], dtype)

    def lit(*lights):
        got = sl.pathtrace.direct_light(NOWHERE, lights, points, UP, [0.6] * 3, 0, 1, eye=(0, 1, 2), samples=512)
        return got.radiance[:, 0]

    # Each has samples of its own.
    np.testing.assert_allclose(lit(light, light), lit(light), rtol=0.01)
    floor = scene.Instance(sl.mesh.plane((6, 6)), None, scene.Material((0.6,) * 3, roughness=1, specular=0.0))
    for strategy in ("mis", "light", "bsdf"):
        one, two = (
            sl.pathtrace.path_trace(
                scene.Scene(floor, lights, scene.Camera((0, 1, 4), (0, 0, 0), fov_y=0.6)),
                (8, 8),
                256,
                1,
                strategy=strategy,
                dtype=dtype,
            )
            for lights in ((light,), (light, light))
        )
        spread = np.sqrt(one.variance.sum() + two.variance.sum())
        assert abs(one.radiance.sum() - two.radiance.sum()) < 5 * spread + 0.01 * one.radiance.sum()


def test_a_point_in_the_plane_of_an_area_light_shines_on():
    area = RectLight((0, 3, 0), (1, 0, 0), (0, 0, 1), (9, 9, 9))
    point = PointLight((0, 3, 0), (9, 9, 9))
    at = [[0.3, 0, 0.1]]

    def lit(*lights):
        return sl.pathtrace.direct_light(NOWHERE, lights, at, UP, [0.6] * 3, 0, 1, wo=UP, samples=256).radiance

    np.testing.assert_allclose(lit(area, point), lit(area) + lit(point), rtol=0.01)
