"""Rectangles that show pictures: as many small rectangles, their draws, and what transformed cosines see of them."""

import dataclasses

import numpy as np
import pytest
import shadelab as sl
from scipy import stats
from shadelab.light import RectLight, light_pdf, light_sample

PLACE = {"center": (0.2, 1.5, -0.3), "edge_u": (1.2, 0, 0), "edge_v": (0, 0.3, 0.8)}


def picture(height, width, seed=0, dtype=np.float64):
    """Texels of which a few are bright, some black."""
    rng = np.random.default_rng(seed)
    texels = rng.random((height, width, 3)) ** 4
    texels[rng.random((height, width)) < 0.2] = 0
    return texels.astype(dtype)


def mosaic(light):
    """The same light as one small rectangle for each texel."""
    texture, found = light.texture, []
    height, width = texture.shape[:2]
    u, v = np.array(light.edge_u), np.array(light.edge_v)
    for i in range(height):
        for j in range(width):
            center = np.array(light.center) + u * ((j + 0.5) / width - 0.5) + v * (0.5 - (i + 0.5) / height)
            radiance = tuple((np.array(light.radiance) * texture[i, j]).tolist())
            found.append(
                RectLight(tuple(center), tuple(u / width), tuple(v / height), radiance, two_sided=light.two_sided)
            )
    return found


def receivers(n, seed=3):
    rng = np.random.default_rng(seed)
    points = np.stack([rng.uniform(-1, 1, n), rng.uniform(-0.2, 0.4, n), rng.uniform(-1, 1, n)], -1)
    normals = np.stack([rng.normal(0, 0.5, n), np.ones(n), rng.normal(0, 0.5, n)], -1)
    wo = np.stack([rng.normal(0, 0.7, n), np.ones(n), rng.normal(0, 0.7, n)], -1)
    return points, *(v / np.linalg.norm(v, axis=-1, keepdims=True) for v in (normals, wo))


@pytest.mark.parametrize("two_sided", [False, True])
def test_irradiance_is_that_of_a_rectangle_for_each_texel(two_sided):
    light = RectLight(**PLACE, radiance=(3, 2, 1), two_sided=two_sided, texture=picture(5, 7))
    points, normals, _ = receivers(60)
    points[::2, 1] += 2.5
    normals[::2] *= -1
    parts = sum(sl.light.irradiance(x, points, normals) for x in mosaic(light))
    got = sl.light.irradiance(light, points, normals)
    np.testing.assert_allclose(got, parts, rtol=1e-12, atol=1e-14)
    assert (got[::2] > 0).any() == two_sided
    np.testing.assert_allclose(
        sl.light.irradiance(light, points.astype(np.float32), normals.astype(np.float32)), parts, rtol=2e-4, atol=1e-5
    )
    np.testing.assert_allclose(sl.light.flux(light), sum(sl.light.flux(x) for x in mosaic(light)))
    np.testing.assert_allclose(sl.light.flux(sl.light.with_flux(light, 100.0)), 100)


def test_an_even_picture_is_the_plain_rectangle():
    plain = RectLight(**PLACE, radiance=(3, 2, 1))
    for light in (dataclasses.replace(plain, texture=np.ones((6, 9, 3))), dataclasses.replace(plain, texture=[[1.0]])):
        points, normals, wo = receivers(200)
        np.testing.assert_allclose(
            sl.light.irradiance(light, points, normals), sl.light.irradiance(plain, points, normals), rtol=1e-12
        )
        for material in (sl.brdf.MetallicRoughness(roughness=0.3), sl.brdf.Diffuse((0.5, 0.6, 0.7))):
            for method in ("ltc", "point", "representative_point"):
                one, other = (
                    sl.renderer.shade(points, normals, material, x, wo=wo, method=method) for x in (light, plain)
                )
                # One point that stands for the light is for even ones: pictures take samples.
                loose = 1e-6 if method != "representative_point" else 0.5
                np.testing.assert_allclose(one.sum(0), other.sum(0), rtol=loose)
        np.testing.assert_allclose(
            sl.light.ltc(light, points, normals, wo, 0.2), sl.light.ltc(plain, points, normals, wo, 0.2), rtol=1e-6
        )


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("method", ["area", "solid_angle"])
def test_draws_follow_the_picture(dtype, method):
    light = RectLight(**PLACE, texture=picture(4, 6))
    point = np.array([0.1, 0.0, 0.2], dtype)
    u = sl.sampling.sobol(1 << 14, 2, seed=2).astype(dtype)
    draws = light_sample(light, point, u, method=method)
    seen = draws.pdf > 0
    hit = point + draws.wi * draws.distance[:, None]
    # Where on the picture, from the left and the top.
    to = hit[seen].astype(np.float64) - light.center
    x = 0.5 + to @ np.array(light.edge_u) / np.dot(light.edge_u, light.edge_u)
    y = 0.5 - to @ np.array(light.edge_v) / np.dot(light.edge_v, light.edge_v)
    assert min(x.min(), y.min()) > -1e-5 and max(x.max(), y.max()) < 1 + 1e-5
    if method == "area":
        count = np.histogram2d(y, x, bins=(4, 6), range=((0, 1), (0, 1)))[0]
        weight = light.texture @ [0.2126, 0.7152, 0.0722]
        assert (count[weight == 0] <= 2).all()
        expected = weight / weight.sum() * count.sum()
        # A sequence is more even than chance: far below what a test of chance allows.
        assert stats.chi2.sf(((count - expected)[weight > 0] ** 2 / expected[weight > 0]).sum(), 20) > 0.01
    # The density is the one that is reported for a direction, and integrates to one.
    again = light_pdf(light, point, draws.wi, method=method)
    close = np.isclose(again, draws.pdf, rtol=2e-3 if dtype == np.float32 else 1e-9)
    # At a border between texels rounding may fall to either side.
    assert close[seen].mean() > 0.999
    even = light_sample(dataclasses.replace(light, texture=None), point, u)
    total = (light_pdf(light, point, even.wi, method=method) / even.pdf).mean()
    assert total == pytest.approx(1, abs=2e-2)


def test_sampling_converges_to_the_sum_over_texels():
    light = RectLight(**PLACE, radiance=(3, 2, 1), texture=picture(4, 5))
    points, normals, wo = receivers(24)
    for material in (sl.brdf.MetallicRoughness(roughness=0.5), sl.brdf.OrenNayar(0.5), sl.brdf.RoughConductor(0.3)):
        got = sl.renderer.shade(points, normals, material, light, wo=wo, samples=4096)
        parts = sl.renderer.shade(points, normals, material, mosaic(light), wo=wo, samples=1024)
        assert np.sqrt(np.mean((got - parts) ** 2)) < 4e-3 * parts.mean()


def test_paths_see_the_picture_upright():
    """A camera before the light sees row 0 at the top and column 0 at the left, texel by texel."""
    texture = picture(3, 4, 5)
    light = RectLight((0, 0, 0), (4, 0, 0), (0, 3, 0), (2, 2, 2), texture=texture)
    far = sl.scene.Instance(sl.mesh.box((0.1, 0.1, 0.1)), sl.transform.translate([0, 0, -50.0]))
    camera = sl.scene.Camera((0, 0, 10.0), (0, 0, 0), fov_y=2 * np.arctan(1.5 / 10))
    traced = sl.pathtrace.path_trace(sl.scene.Scene(far, light, camera), (4, 3), 16, max_depth=1)
    np.testing.assert_allclose(traced.radiance, 2 * texture, rtol=1e-5)


def test_paths_gather_what_closed_forms_say():
    texture = picture(6, 6, 2)
    light = RectLight((0, 1.0, 0), (1, 0, 0), (0, 0, 1), (5, 5, 5), texture=texture)
    floor = sl.scene.Instance(sl.mesh.plane(20.0), None, sl.brdf.Diffuse(1.0))
    camera = sl.scene.Camera((0.3, 0.6, 3.0), (0, 0, 0.1), fov_y=0.35)
    scene = sl.scene.Scene(floor, light, camera)
    sharp = sl.pathtrace.PixelFilter("box", 1e-3)
    for strategy in ("mis", "light", "bsdf"):
        traced = sl.pathtrace.path_trace(scene, (8, 5), 1024, max_depth=1, strategy=strategy, filter=sharp)
        points = sl.render(scene, size=(8, 5)).position.astype(np.float64)
        exact = sl.light.irradiance(light, points, np.array([0.0, 1, 0])) / np.pi
        apart = traced.radiance - exact
        if strategy != "bsdf":
            # Even draws of the hemisphere miss a light of so few degrees in some pixels altogether.
            assert (np.abs(apart) < 6 * np.sqrt(traced.variance) + 1e-4 * exact.max()).all()
        assert (np.abs(apart.mean((0, 1))) < 4 * np.sqrt(traced.variance.sum((0, 1))) / 40 + 1e-5).all()


def _converged(light, material, points, normals, wo):
    return np.mean(
        [sl.renderer.shade(points, normals, material, light, wo=wo, samples=4096, seed=s) for s in (1, 2)], 0
    )


# Of the mean: what the docstring of `RectLight` says.
@pytest.mark.parametrize("roughness", [0.05, 0.25, 0.5, 1.0])
def test_transformed_cosines_see_the_prefiltered_picture(roughness):
    """As well as they see a plain rectangle, and far better than by the picture's mean."""
    points, normals, wo = receivers(200)
    smooth = sl.image.gaussian_filter(picture(32, 32), 2.0)
    light = RectLight(**PLACE, radiance=(3, 3, 3), texture=smooth)
    plain = dataclasses.replace(light, texture=None)
    mean = np.divide(light.mean_radiance, plain.radiance)

    def off(material, method="ltc"):
        exact, even = (_converged(x, material, points, normals, wo) for x in (light, plain))
        got, flat = (sl.renderer.shade(points, normals, material, x, wo=wo, method=method) for x in (light, plain))
        return [
            np.sqrt(np.mean((a - b) ** 2)) / b.mean() for a, b in ((got, exact), (flat * mean, exact), (flat, even))
        ]

    shown, by_mean, own = off(sl.brdf.MetallicRoughness((1, 1, 1), 1.0, roughness))
    assert shown < own + 0.01 and shown < by_mean
    assert roughness > 0.3 or shown < 0.2 * by_mean
    shown, by_mean, own = off(sl.brdf.Diffuse((0.7, 0.7, 0.7)))
    assert shown < 0.004 and shown < 0.1 * by_mean


def test_what_is_seen_is_a_mean_of_the_picture():
    """Never beyond its darkest and brightest, however far, near, grazing or large the light is."""
    rng = np.random.default_rng(8)
    texture = np.clip(rng.random((17, 5, 3)), 0.25, 0.75)
    points, normals, wo = receivers(400, 4)
    for edge in (1e-3, 1.0, 1e3, 1e6):
        light = RectLight((0, 1.5, 0), (edge, 0, 0), (0, 0.3 * edge, 0.8 * edge), texture=texture)
        plain = dataclasses.replace(light, texture=None)
        for alpha in (1e-4, 0.04, 0.5, 1.0):
            got, even = (sl.light.ltc(x, points, normals, wo, alpha) for x in (light, plain))
            lit = even[..., 0] > 1e-12
            ratio = got[lit] / even[lit]
            assert np.isfinite(got).all() and ratio.min() > 0.25 - 1e-5 and ratio.max() < 0.75 + 1e-5


def test_a_mirror_shows_the_texel_that_it_meets():
    texture = picture(8, 8, 3)
    light = RectLight((0, 2, 0), (2, 0, 0), (0, 0, 2), texture=texture)
    points, up = np.zeros((64, 3)), np.array([0.0, 1, 0])
    # Towards the middle of each texel.
    i, j = np.divmod(np.arange(64), 8)
    at = np.array(light.center) + np.stack([(j + 0.5) / 4 - 1, 0 * i, 1 - (i + 0.5) / 4], -1)
    wi = at / np.linalg.norm(at, axis=-1, keepdims=True)
    wo = wi * [-1, 1, -1]
    got = sl.light.ltc(light, points, up, wo, 1e-4)
    np.testing.assert_allclose(got, texture[i, j], atol=2e-3)


def test_pictures_that_no_light_can_show_are_refused():
    def made(texture, **more):
        return RectLight(**PLACE, texture=texture, **more)

    with pytest.raises(TypeError, match="texture"):
        made(np.ones((2, 2, 3), np.uint8))
    for bad in (np.full((2, 2, 3), -1.0), np.full((2, 2), np.nan), np.full((2, 2), np.inf), np.ones((2, 2, 4)),
                np.ones((0, 2, 3)), np.ones((1, 2049)), np.ones(3)):  # fmt: skip
        with pytest.raises(ValueError, match="texture"):
            made(bad)
    with pytest.raises(ValueError, match="texture"):
        made(np.full((1, 1), 1e20), radiance=(1e20, 0, 0))
    black = made(np.zeros((3, 3)))
    points, normals, wo = receivers(5)
    assert not sl.light.irradiance(black, points, normals).any()
    assert not sl.renderer.shade(points, normals, sl.brdf.MetallicRoughness(), black, wo=wo).any()
    one, other = made(picture(2, 2)), made(picture(2, 2, 1))
    assert one != other and one == made(picture(2, 2)) and len({one, other}) == 2
    assert not one.texture.flags.writeable


def test_without_samples_the_diffuse_part_is_left():
    plain = sl.light.RectLight((0, 2, 0), (1, 0, 0), (0, 0, 1), (4, 4, 4))
    shown = sl.light.RectLight((0, 2, 0), (1, 0, 0), (0, 0, 1), (4, 4, 4), texture=np.ones((2, 2)))
    given = ([0.3, 0, 0], [0.0, 1, 0], [0.5] * 3)
    expected, found = (sl.light.unshadowed(light, *given, wo=[0.0, 1, 0], samples=0) for light in (plain, shown))
    assert expected.min() > 0.1
    assert np.abs(found / expected - 1).max() < 1e-5


def covered(n, within, sub=4):
    """How much of each of n × n texels lies within a shape of the square [−1, 1]², row 0 at the top."""
    e = (np.arange(n * sub) + 0.5) / (n * sub) * 2 - 1
    inside = within(e[None, :], -e[:, None]).astype(float)
    return inside.reshape(n, sub, n, sub).mean((1, 3))


@pytest.mark.parametrize("shape", ["disk", "triangle"])
def test_a_picture_may_be_of_any_shape(shape):
    """Disks and polygons as rectangles that are black around them."""
    if shape == "disk":
        plain = sl.light.DiskLight((0, 1.2, 0), (0, -1, 0), 0.8, (3, 3, 3))
        texture = covered(128, lambda x, y: x * x + y * y < 1)
    else:
        # edge_u is x, edge_v is z, which points up on the picture.
        plain = sl.light.PolygonLight([(-0.8, 1.2, -0.8), (0.8, 1.2, -0.8), (-0.8, 1.2, 0.8)], (3, 3, 3))
        texture = covered(128, lambda x, y: (x + y < 1e-9) / 2 + (x + y < -1e-9) / 2)
    light = RectLight((0, 1.2, 0), (1.6, 0, 0), (0, 0, 1.6), (3, 3, 3), texture=texture)
    assert np.dot(plain.normal, light.normal) == pytest.approx(1)
    points, normals, wo = receivers(300, 7)
    exact = sl.light.irradiance(plain, points, normals)
    apart = sl.light.irradiance(light, points, normals) - exact
    assert np.abs(apart).max() < 2e-4 * exact.mean() and np.sqrt(np.mean(apart**2)) < 5e-5 * exact.mean()
    for roughness, most in ((0.1, 0.04), (0.25, 0.04), (0.5, 0.03), (1.0, 0.02)):
        shown, even = (sl.light.ltc(x, points, normals, wo, roughness**2) for x in (light, plain))
        assert np.sqrt(np.mean((shown - even) ** 2)) < most * even.mean()
