"""Deferred shading: every material under every light, against the models' own values and the path tracer's kernels."""

import numpy as np
import pytest
import shadelab as sl
from shadelab.light import AmbientLight, RectLight

from .things import AREAS, LIGHTS, MATERIALS, PUNCTUAL


def receivers(n=40, seed=3, dtype=np.float64):
    """Points of a bumpy floor, normals, directions to the eye above them."""
    rng = np.random.default_rng(seed)
    points = np.stack([rng.uniform(-1, 1, n), rng.uniform(0, 0.1, n), rng.uniform(-1, 1, n)], -1)
    normals = np.stack([rng.normal(0, 0.2, n), np.ones(n), rng.normal(0, 0.2, n)], -1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    wo = np.stack([rng.normal(0, 0.6, n), np.ones(n), rng.normal(0, 0.6, n)], -1)
    wo /= np.linalg.norm(wo, axis=-1, keepdims=True)
    return points.astype(dtype), normals.astype(dtype), wo.astype(dtype)


@pytest.mark.parametrize("material", MATERIALS.values(), ids=MATERIALS)
@pytest.mark.parametrize("name", PUNCTUAL)
def test_beams_are_the_models_own_values(material, name):
    points, normals, wo = receivers()
    light = PUNCTUAL[name]
    to_local = np.swapaxes(sl.transform.orthonormal_basis(normals), -1, -2)
    if name == "directional":
        wi = np.broadcast_to(-np.array(light.direction) / np.linalg.norm(light.direction), points.shape)
    else:
        wi = np.array(light.position) - points
        wi /= np.linalg.norm(wi, axis=-1, keepdims=True)
    facing = sl.light.irradiance(light, points, wi)
    local = [np.einsum("nij,nj->ni", to_local, w) for w in (wi, wo)]
    seen = (local[0][:, 2] > 0) & (local[1][:, 2] > 0)
    expected = np.where(seen[:, None], material.eval(*local) * facing * local[0][:, 2:], 0)
    got = sl.renderer.shade(points, normals, material, light, wo=wo)
    # Directions are rounded once more on the way; narrow lobes see that.
    assert np.allclose(got, expected, rtol=1e-9, atol=1e-12)
    single = sl.renderer.shade(*(x.astype(np.float32) for x in (points, normals)), material, light, wo=wo)
    assert single.dtype == np.float32
    assert np.allclose(single, expected, rtol=2e-4, atol=1e-5 * max(expected.max(), 1e-30))


@pytest.mark.parametrize("material", MATERIALS.values(), ids=MATERIALS)
@pytest.mark.parametrize("light", AREAS.values(), ids=AREAS)
def test_areas_converge_to_the_integral_of_the_model(material, light):
    points, normals, wo = receivers(6)
    to_local = np.swapaxes(sl.transform.orthonormal_basis(normals), -1, -2)
    many = 1 << 12
    got = sl.renderer.shade(points, normals, material, light, wo=wo, samples=many)
    expected = np.zeros_like(got)
    for i in range(len(points)):
        # By draws of the model alone, which find what is specular as well; and by the light's own where it is not.
        # Rough glass reflects a few draws of a hundred to all sides.
        u = sl.sampling.sobol(1 << (19 if material is MATERIALS["compensated glass"] else 15), 3, seed=i)
        local = to_local[i] @ wo[i]
        draws = material.sample(np.broadcast_to(local, u.shape), u)
        world = np.nan_to_num(draws.wi) @ to_local[i]
        hit = sl.light.light_pdf(light, points[i], world) > 0
        above = np.einsum("ij,j->i", world, normals[i]) * local[2] > 0
        above = above | (draws.wi[:, 2] < 0)
        brought = np.where((hit & above & (draws.pdf > 0))[:, None], np.nan_to_num(draws.weight), 0)
        expected[i] = brought.mean(0) * np.array(light.radiance)
    # The reference's own noise: lights fill a few per cent of a lobe.
    share = 0.01 if isinstance(light, AmbientLight) else 0.06
    assert np.abs(got - expected).max() <= share * expected.max()


def test_methods_agree_where_they_should():
    points, normals, wo = receivers()
    shade = sl.renderer.shade
    rect, matte = AREAS["rect"], MATERIALS["diffuse"]
    # A diffuser is in closed form whatever the method.
    closed = [shade(points, normals, matte, rect, wo=wo, method=m) for m in ("sampling", "ltc", "representative_point")]
    assert np.array_equal(closed[0], closed[1]) and np.array_equal(closed[0], closed[2])
    # A light far away is a point; its size over its distance, squared, is the error.
    far = RectLight((0, 50, 0), (1, 0, 0), (0, 0, 1), (900, 900, 900))
    glossy = MATERIALS["metallic roughness"]
    exact = shade(points, normals, glossy, far, wo=wo, samples=1024)
    assert np.allclose(shade(points, normals, glossy, far, wo=wo, method="point"), exact, rtol=2e-3)
    # Transformed cosines fit the lobe to some per cent of its peak.
    near = shade(points, normals, glossy, rect, wo=wo, samples=4096)
    ltc = shade(points, normals, glossy, rect, wo=wo, method="ltc")
    assert np.sqrt(np.mean((ltc - near) ** 2)) < 0.02 * near.mean()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_eight_at_once_are_one_by_one(dtype):
    points, normals, wo = receivers(203, dtype=dtype)
    rng = np.random.default_rng(0)
    materials = [MATERIALS[k] for k in ("metallic roughness", "diffuse", "specular glossiness", "phong")]
    several = [PUNCTUAL["point"], PUNCTUAL["directional"], PUNCTUAL["spot"], AREAS["rect"]]
    extra = {
        "colors": rng.random((203, 3)).astype(dtype),
        "geometric_normals": np.broadcast_to(np.array([0, 1, 0], dtype), points.shape),
    }
    fractions = [rng.random(203).astype(dtype), None, None, rng.random(203).astype(dtype)]
    for count in (1, 3, 4):
        # What is sampled is so by its place: the fourth material meets no area light.
        lights, lit = (several[:3], fractions[:3]) if count == 4 else (several, fractions)
        ids = rng.integers(-1, count, 203)
        for more in ({}, extra):
            together = sl.renderer.shade(
                points, normals, materials, lights, wo=wo, material_ids=ids, lit=lit, method="ltc", **more
            )
            for i in range(203):
                own = {k: v[i] for k, v in more.items()}
                alone = sl.renderer.shade(
                    points[i], normals[i], materials, lights, wo=wo[i], material_ids=ids[i],
                    lit=[x if x is None else x[i] for x in lit], method="ltc", **own,
                )  # fmt: skip
                # Directions are rounded in another order.
                assert np.allclose(together[i], alone, rtol=200 * np.finfo(dtype).eps, atol=1e-6 * np.finfo(dtype).eps)
            assert (together[ids < 0] == 0).all()


def test_the_same_bits_whatever_threads_and_level():
    points, normals, wo = (np.tile(x, (60, 1)) for x in receivers(400, dtype=np.float32))
    materials = list(MATERIALS.values())
    ids = np.arange(len(points)) % len(materials)
    lights = list(LIGHTS.values())
    before, found = sl.threads(), []
    try:
        for n in (1, 3):
            sl.set_threads(n)
            for level in sl.simd_levels():
                with sl.simd(level):
                    found.append(
                        sl.renderer.shade(points, normals, materials, lights, wo=wo, material_ids=ids, samples=2)
                    )
    finally:
        sl.set_threads(before)
    assert all(np.array_equal(found[0], x, equal_nan=True) for x in found[1:])


def test_nan_stays_where_it_is():
    points, normals, wo = receivers(24)
    for array in (points, normals, wo):
        whole = sl.renderer.shade(points, normals, list(MATERIALS.values())[:1], list(LIGHTS.values()), wo=wo)
        kept, array[7, 1] = array[7, 1], np.nan
        got = sl.renderer.shade(points, normals, list(MATERIALS.values())[:1], list(LIGHTS.values()), wo=wo)
        array[7, 1] = kept
        assert np.isnan(got[7]).all()
        assert np.array_equal(np.delete(got, 7, 0), np.delete(whole, 7, 0))


def test_what_does_not_fit_is_named():
    points, normals, wo = receivers(5)
    shade, light, matte = sl.renderer.shade, PUNCTUAL["point"], MATERIALS["diffuse"]
    with pytest.raises(ValueError, match="wo: expected either wo or eye"):
        shade(points, normals, matte, light)
    with pytest.raises(TypeError, match="materials: expected"):
        shade(points, normals, "wood", light, wo=wo)
    with pytest.raises(TypeError, match="lights: expected"):
        shade(points, normals, matte, "sun", wo=wo)
    with pytest.raises(ValueError, match="material_ids: index 1 is out of range"):
        shade(points, normals, matte, light, wo=wo, material_ids=np.ones(5, int))
    with pytest.raises(ValueError, match="lit: expected one for each of 1 lights, got 2"):
        shade(points, normals, matte, light, wo=wo, lit=[None, None])
    with pytest.raises(ValueError, match="lit: expected shape"):
        shade(points, normals, matte, light, wo=wo, lit=[np.ones(4)])
    with pytest.raises(ValueError, match="method"):
        shade(points, normals, matte, light, wo=wo, method="magic")
    with pytest.raises(ValueError, match="samples: expected one, or one for each of 1 materials"):
        shade(points, normals, matte, light, wo=wo, samples=[1, 2])
    with pytest.raises(ValueError, match="eye"):
        shade(points, normals, matte, light, eye=wo)
    with pytest.raises(TypeError, match="environment"):
        shade(points, normals, matte, [], wo=wo, environment="sky")
    assert shade(points[:0], normals[:0], matte, light, wo=wo[:0]).shape == (0, 3)


def test_a_panorama_is_the_ambient_light_that_it_holds():
    points, normals, wo = receivers(30)
    even = sl.environment.Environment(np.full((8, 16, 3), 0.7))
    for material in (MATERIALS["metallic roughness"], MATERIALS["plastic"]):
        got = sl.renderer.shade(points, normals, material, [], wo=wo, environment=even, samples=1024)
        exact = sl.renderer.shade(points, normals, material, AmbientLight((0.7, 0.7, 0.7)), wo=wo, samples=1024)
        assert np.allclose(got, exact, rtol=0.02)


@pytest.mark.parametrize("light", [PUNCTUAL["point"], AREAS["rect"]], ids=["point", "rectangle"])
def test_shares_beyond_their_range_are_nan_where_they_are(light):
    points, normals, wo = receivers(24)
    matte, ones = MATERIALS["metallic roughness"], np.ones(24)

    def shaded(**given):
        return sl.renderer.shade(points, normals, matte, light, wo=wo, **given)

    whole = shaded(colors=np.ones((24, 3)), geometric_normals=normals, lit=[ones])
    for bad in (-0.1, 1.1, np.nan, np.inf):
        lit, colors = ones.copy(), np.ones((24, 3))
        lit[5], colors[6, 1] = bad, bad
        got = shaded(colors=colors, geometric_normals=normals, lit=[lit])
        assert np.isnan(got[5]).all() and np.isnan(got[6]).any()
        assert np.array_equal(np.delete(got, [5, 6], 0), np.delete(whole, [5, 6], 0))
    # Roundings are no reason.
    near = shaded(colors=np.full((24, 3), 1 + 1e-6), geometric_normals=normals, lit=[ones + 1e-6])
    assert np.array_equal(near, whole)


@pytest.mark.parametrize("bad", [0.0, np.nan])
@pytest.mark.parametrize("light", [PUNCTUAL["point"], AREAS["rect"]], ids=["point", "rectangle"])
def test_a_face_without_a_normal_is_nan(light, bad):
    points, normals, wo = receivers(24)
    faces = normals.copy()
    faces[3] = bad
    got = sl.renderer.shade(points, normals, MATERIALS["diffuse"], light, wo=wo, geometric_normals=faces)
    whole = sl.renderer.shade(points, normals, MATERIALS["diffuse"], light, wo=wo, geometric_normals=normals)
    assert np.isnan(got[3]).all() and np.array_equal(np.delete(got, 3, 0), np.delete(whole, 3, 0))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_point_light_at_hand_is_finite(dtype):
    points, normals, wo = receivers(24, dtype=dtype)
    for away in (0.0, 1e-310, 1e-170, 1e-30, 1e-20, 1e-10, 1e-3):
        light = sl.light.PointLight((float(points[2, 0]), float(points[2, 1]) + away, float(points[2, 2])), (9, 9, 9))
        near = sl.light.PointLight((0, away, 0), (9, 9, 9))
        got = sl.renderer.shade(points, normals, MATERIALS["diffuse"], light, wo=wo)
        assert np.isfinite(got).all()
        for n in (1, 9):
            at = np.zeros((n, 3), dtype)
            up = np.broadcast_to(np.asarray([0, 1, 0], dtype), at.shape)
            assert np.isfinite(sl.renderer.shade(at, up, MATERIALS["diffuse"], near, wo=up)).all()
            assert np.isfinite(sl.light.irradiance(near, at, up)).all()
