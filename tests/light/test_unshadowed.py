"""Unshadowed radiance: closed forms against dense averages, and the same at every SIMD level."""

import numpy as np
import pytest
import shadelab as sl

LIGHTS = [
    sl.light.PointLight((1, 2, 0), (3, 2, 1)),
    sl.light.DirectionalLight((0.3, -1, 0.2), (1, 2, 3)),
    sl.light.RectLight((-0.5, 1.5, 0.2), (1, 0.3, 0), (0, 0, 0.8), (4, 5, 6)),
]
EYE = np.array([1.0, 1.0, 2.0])


def receivers(n, dtype=np.float64):
    rng = np.random.default_rng(4)
    points = rng.uniform(-1, 0.5, (n, 3))
    normals = rng.normal(size=(n, 3)) * 0.4 + [0, 1, 0]
    return points.astype(dtype), (normals / np.linalg.norm(normals, axis=-1, keepdims=True)).astype(dtype)


def frame(normal):
    x = np.cross([0.0, 0, 1], normal)
    x /= np.linalg.norm(x, axis=-1, keepdims=True)
    return np.stack([x, np.cross(normal, x), normal], -2)


def dense(light, points, normals, material, n=1 << 12):
    """The average over many points of the light, in NumPy over the public functions."""
    wi, _, pdf = sl.light.light_sample(light, points[:, None], sl.sampling.sobol(n, 2))
    local = frame(normals)
    wo = EYE - points
    wo = np.einsum("nij,nj->ni", local, wo / np.linalg.norm(wo, axis=-1, keepdims=True))
    wi = np.einsum("nij,nkj->nki", local, wi)
    f = sl.brdf.metallic_roughness(wi, wo[:, None], *material)
    carried = np.where(pdf > 0, np.maximum(wi[..., 2], 0) / np.where(pdf > 0, pdf, 1), 0)
    return (f * carried[..., None]).mean(1) * light.radiance


@pytest.mark.parametrize("specular", [0.0, 1.0])
def test_the_diffuse_part_is_exact_with_its_fresnel_factor(specular):
    points, normals = receivers(40)
    color, n = np.array([0.8, 0.5, 0.1]), 1 << 12
    got = sl.light.unshadowed(LIGHTS[2], points, normals, color, 0.0, 1.0, specular, eye=EYE, samples=0)
    both = dense(LIGHTS[2], points, normals, (color, 0.0, 1.0, specular), n)
    # The mirrors' part does not depend on the colour.
    black = dense(LIGHTS[2], points, normals, (color * 0, 0.0, 1.0, specular), n)
    # Scrambled points at n = 2^12.
    assert np.allclose(got, both - black, rtol=3e-3, atol=1e-4)


@pytest.mark.parametrize("roughness", [0.3, 0.6, 1.0])
@pytest.mark.parametrize("metallic", [0.0, 1.0])
def test_the_mirrors_part_is_the_average_over_the_light(roughness, metallic):
    points, normals = receivers(40)
    material = (np.array([0.8, 0.5, 0.1]), metallic, roughness)
    got = sl.light.unshadowed(LIGHTS[2], points, normals, *material, eye=EYE, samples=1024)
    assert np.allclose(got, dense(LIGHTS[2], points, normals, material), rtol=5e-3, atol=2e-3)


def test_samples_are_unbiased_and_their_error_is_as_stated():
    points, normals = receivers(500)
    material = ([1.0, 1.0, 1.0], 1.0, 0.5)
    exact = sl.light.unshadowed(LIGHTS[2], points, normals, *material, eye=EYE, samples=4096)[:, 0]
    lit = exact > 0.05 * exact.max()
    for samples, error in ((16, 0.08), (64, 0.03)):
        got = sl.light.unshadowed(LIGHTS[2], points, normals, *material, eye=EYE, samples=samples, seed=1)[:, 0]
        relative = (got[lit] / exact[lit]) - 1
        assert np.sqrt((relative**2).mean()) < error
        assert abs(relative.mean()) < 4 * relative.std() / np.sqrt(lit.sum())


def test_several_lights_add_up_and_tables_are_looked_up():
    points, normals = receivers(60)
    table = {"base_color": np.eye(3) * 0.5 + 0.2, "metallic": [0.0, 0.5, 1.0], "roughness": [0.3, 0.6, 0.9]}
    ids = np.arange(60) % 4 - 1
    wo = (EYE - points) / np.linalg.norm(EYE - points, axis=-1, keepdims=True)
    together = sl.light.unshadowed(LIGHTS[:2], points, normals, **table, wo=wo, material_ids=ids)
    rows = {k: np.asarray(v)[ids] for k, v in table.items()}
    each = sum(sl.light.unshadowed(light, points, normals, **rows, eye=EYE) for light in LIGHTS[:2])
    assert np.allclose(together[ids >= 0], each[ids >= 0], rtol=1e-12)
    assert np.array_equal(together[ids < 0], np.zeros((15, 3)))


def test_punctual_lights_are_brdf_times_irradiance():
    points, normals = receivers(50)
    for light, to in ((LIGHTS[0], np.array([1, 2, 0]) - points), (LIGHTS[1], np.array([-0.3, 1, -0.2]) + 0 * points)):
        wi, wo = (w / np.linalg.norm(w, axis=-1, keepdims=True) for w in (to, EYE - points))
        local = [np.einsum("nij,nj->ni", frame(normals), w) for w in (wi, wo)]
        f = sl.brdf.metallic_roughness(*local, [0.8, 0.4, 0.2], 0.3, 0.4)
        expected = f * sl.light.irradiance(light, points, normals)
        got = sl.light.unshadowed(light, points, normals, [0.8, 0.4, 0.2], 0.3, 0.4, eye=EYE)
        assert np.allclose(got, expected, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_levels_and_threads_give_the_same_bits(dtype):
    points, normals = receivers(3000, dtype)
    results, before = [], sl.threads()
    for level in sl.simd_levels():
        for threads in (1, 3):
            with sl.simd(level):
                sl.set_threads(threads)
                results.append(sl.light.unshadowed(LIGHTS, points, normals, [0.5, 0.4, 0.3], eye=EYE))
    sl.set_threads(before)
    assert results[0].dtype == dtype and all(np.array_equal(r, results[0]) for r in results)


def test_wrong_calls_name_the_argument():
    points, normals = receivers(4)
    with pytest.raises(ValueError, match="wo: expected either wo or eye, got neither"):
        sl.light.unshadowed(LIGHTS, points, normals, [0.5] * 3)
    with pytest.raises(ValueError, match=r"material_ids: index 3 is out of range \[-1, 2\)"):
        sl.light.unshadowed(LIGHTS, points, normals, [[0.5] * 3] * 2, eye=EYE, material_ids=[0, 1, 3, 0])
    with pytest.raises(TypeError, match="lights: expected a light or lights"):
        sl.light.unshadowed(["sun"], points, normals, [0.5] * 3, eye=EYE)
    nan = points.copy()
    nan[1] = np.nan
    got = sl.light.unshadowed(LIGHTS, nan, normals, [0.5] * 3, eye=EYE)
    assert np.isnan(got[1]).all() and np.isfinite(got[[0, 2, 3]]).all()


def test_ids_far_below_zero_are_no_surface():
    up = [0.0, 1.0, 0.0]
    colors = [[1.0, 0, 0], [0, 1, 0]]
    for low in (-(2**32), -(2**63), -1):
        ids = np.array([low, 1])
        got = sl.light.unshadowed(
            sl.light.PointLight((0, 2, 0)), [[0.0, 0, 0]] * 2, up, colors, wo=up, material_ids=ids
        )
        assert (got[0] == 0).all() and (got[1] > 0).all()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_disks_are_polygons_of_many_corners_also_next_to_their_rim(dtype):
    """Diffuse light of both with its Fresnel factor. Mirrors, which take the disk for a polygon, are left out."""
    angle = np.arange(2048) * 2 * np.pi / 2048
    # Equal areas; by the rim the corners are up to 1e-6 away from the circle.
    r = np.sqrt(2 * np.pi / (2048 * np.sin(angle[1])))
    disk = sl.light.DiskLight((0, 1, 0), (0, -1, 0), 1.0)
    polygon = sl.light.PolygonLight(np.stack([r * np.cos(angle), np.ones(2048), r * np.sin(angle)], -1))
    rng = np.random.default_rng(6)
    for gap in (1e-3, 1e-2, 0.1, 1.0):
        away, turn = 1 + gap * rng.normal(size=300), rng.uniform(0, 2 * np.pi, 300)
        height = 1 - gap * rng.uniform(0.2, 2, 300)
        points = np.stack([away * np.cos(turn), height, away * np.sin(turn)], -1).astype(dtype)
        normals = rng.normal(size=(300, 3))
        normals = (normals / np.linalg.norm(normals, axis=-1, keepdims=True)).astype(dtype)
        a, b = (
            sl.light.unshadowed(x, points, normals, (0.8,) * 3, 0.0, 1.0, wo=normals, samples=0)
            for x in (disk, polygon)
        )
        assert 0 <= a.min() and a.max() < 0.8
        np.testing.assert_allclose(a, b, atol=4e-7 / gap + 1e-5, rtol=0)


LYING = [
    sl.light.RectLight((0, 0.5, 0), (1, 0, 0), (0, 0, 1), two_sided=True),
    sl.light.RectLight((0, 0.5, 0), (1, 0, 0), (0, 0, 1)),
    sl.light.PolygonLight([(-1, 0.5, -1), (1, 0.5, -1), (0.9, 0.5, 1), (-1, 0.5, 1)], two_sided=True),
    sl.light.DiskLight((0, 0.5, 0), (0, -1, 0), 0.9, two_sided=True),
]


@pytest.mark.parametrize("light", LYING)
@pytest.mark.parametrize("height", [0, 1e-16, -1e-16, 1e-15, 1e-14, -1e-13, 1e-9])
@pytest.mark.parametrize("method", ["ltc", "representative_point"])
def test_receivers_on_the_light_get_what_light_there_is(light, height, method):
    """In its plane, where rounding decides on the side, and a hair off it, at any tilt."""
    rng = np.random.default_rng(7)
    points, normals, wo = rng.uniform(-0.5, 0.5, (2000, 3)), rng.normal(size=(2000, 3)), rng.normal(size=(2000, 3))
    points[:, 1] = 0.5 + height
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    wo /= np.linalg.norm(wo, axis=-1, keepdims=True)
    wo[(wo * normals).sum(-1) < 0] *= -1
    got = sl.light.unshadowed(light, points, normals, (0.8,) * 3, 0.0, 0.5, wo=wo, method=method)
    # Albedo 0.8, and mirrors of 4 % along the normal and all at grazing.
    assert got.min() >= 0 and got.max() < 1.9
    if height == 0:
        # Of sampled mirrors rounding leaves something.
        assert got.max() < 1e-9
    base = sl.light.ltc(light, points, normals, wo, 0.5, full_output=True).base if method == "ltc" else np.zeros(1)
    assert 0 <= base.min() and base.max() <= 1 + 1e-3


@pytest.mark.parametrize("light", [*LIGHTS, sl.light.SpotLight((0, 1, 0), (0, 1, 0))])
@pytest.mark.parametrize("which", [0, 1, 2])
def test_receivers_that_are_no_numbers_give_none(light, which):
    given = [np.array(v, float) for v in ((0, 0, 0), (0, 1, 0), (0, 1, 0))]
    given[which] = np.array([np.nan, 0, 0])
    got = sl.light.unshadowed(light, given[0], given[1], (0.8,) * 3, wo=given[2])
    assert np.isnan(got).all()
