"""Light of many wavelengths: exact at each, parted by prisms as Snell says; grey scenes are those of three channels."""

import numpy as np
import pytest
import shadelab as sl
from shadelab import brdf, mesh, scene
from shadelab.environment import Environment
from shadelab.pathtrace import PixelFilter, Spectrum, path_trace, spectral

SIZE = (12, 9)


def room(reflectance, emission, extra=()):
    """A closed box whose walls reflect and emit alike: radiance is emission · (1 + ρ + ρ² …)."""
    paint = scene.Material((reflectance,) * 3, roughness=1.0, specular=0.0, emission=(emission,) * 3)
    return scene.Scene(
        [scene.Instance(mesh.box((4, 4, 4)), materials=paint), *extra], (), scene.Camera((0, 0, 1), (0, 0, 0))
    )


def reflectance(w):
    return 0.5 + 0.45 * np.sin(w / 40)


def test_each_wavelength_is_reflected_by_its_own():
    w = np.linspace(400, 700, 10)
    depth = 5
    got = spectral(lambda x: room(reflectance(x), x / 500), SIZE, 256, depth, wavelengths=w)
    rho = reflectance(w)
    exact = w / 500 * (1 - rho ** (depth + 1)) / (1 - rho)
    mean, spread = got.radiance.mean((0, 1)), np.sqrt(got.variance.mean((0, 1)) / np.prod(SIZE))
    assert got.radiance.shape == (9, 12, 10) and np.array_equal(got.wavelengths, w)
    assert (got.samples == 256).all()
    np.testing.assert_array_less(np.abs(mean - exact), 5 * spread + 1e-5)
    # Channels of means would not do: of the spectrum's mean reflectance another radiance comes.
    bands = rho.mean()
    assert abs(exact.mean() / ((w / 500).mean() * (1 - bands ** (depth + 1)) / (1 - bands)) - 1) > 0.2


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_grey_scene_is_the_picture_of_three_channels(dtype):
    lamp = sl.light.RectLight((0, 1.9, 0), (1, 0, 0), (0, 0, 1), (3, 3, 3))
    thing = scene.Instance(mesh.icosphere(2, 0.7), materials=scene.Material((0.6,) * 3, roughness=0.4, metallic=0.5))
    world = room(0.5, 0.1, [thing])
    world = scene.Scene(world.instances, (lamp,), world.camera)
    got = spectral(lambda _: world, SIZE, 8, wavelengths=6, dtype=dtype, seed=3)
    # Two pictures, each of three wavelengths, of one sequence.
    halves = [path_trace(world, SIZE, 8, seed=3, start=s, dtype=dtype).radiance for s in (0, 24)]
    assert got.radiance.dtype == got.rgb().dtype == dtype
    for k, half in enumerate(halves):
        for i in (k, k + 2, k + 4):
            assert np.array_equal(got.radiance[..., i], half[..., 0])
    weighed = got.rgb(white=np.ones(6))
    low, high = np.minimum(*halves)[..., 0], np.maximum(*halves)[..., 0]
    # Between both but for what matching functions weigh negatively.
    assert (np.abs(weighed.mean(-1) - (low + high) / 2) < 0.6 * (high - low) + 1e-5).all()


# A prism of 60° about z, whose left face is met by rays in the plane of x and y.
HALF = np.radians(30)


def index(w):
    """Cauchy's formula, of dense flint."""
    return 1.6 + 14000 / w**2


def prism():
    """Flat: no face shares its vertices."""
    corners = np.array([[-1, 0], [1, 0], [0, np.sqrt(3)]])
    points = np.concatenate([np.c_[corners, np.full(3, z)] for z in (2.0, -2.0)])
    sides = [f for i, j in ((0, 1), (1, 2), (2, 0)) for f in ([j + 3, j, i], [i + 3, j + 3, i])]
    faces = np.array([[0, 1, 2], [3, 5, 4], *sides])
    return mesh.Mesh(points[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3))


def refracted(d, n, eta):
    """A unit direction through a surface whose unit normal is against it, to a medium of an index eta times as high."""
    cos = -(d @ n)
    cos2 = 1 - (1 - cos**2) / eta**2
    return d / eta + n * (cos / eta - np.sqrt(cos2)), cos, np.sqrt(cos2)


def transmittance(cos, cos2, eta):
    parallel, across = (eta * cos - cos2) / (eta * cos + cos2), (cos - eta * cos2) / (cos + eta * cos2)
    return 1 - (parallel**2 + across**2) / 2


def test_a_prism_parts_the_wavelengths_as_snell_says():
    """A slit seen through a prism at each wavelength, against the deviation and Fresnel's losses in closed form."""
    body, top = prism(), np.array([0, np.sqrt(3), 0])
    normal_left = np.array([-np.cos(HALF), np.sin(HALF), 0])
    normal_right = np.array([np.cos(HALF), np.sin(HALF), 0])
    w = np.array([420.0, 480, 550, 620, 700])
    toward = np.array([np.cos(0.85 - np.pi / 6), np.sin(0.85 - np.pi / 6), 0])
    middle = np.array([-0.5, np.sqrt(3) / 2, 0])
    eye = middle - 3 * toward
    out = {}
    for x in w:
        inside, c1, c2 = refracted(toward, normal_left, index(x))
        t = (top - middle) @ normal_right / (inside @ normal_right)
        leaves = middle + t * inside
        outside, c3, c4 = refracted(inside, -normal_right, 1 / index(x))
        out[x] = leaves, outside, transmittance(c1, c2, index(x)) * transmittance(c3, c4, 1 / index(x))
    # A slit so far away that it is met by the wavelength in the middle alone.
    leaves, outside, share = out[550.0]
    centre = leaves + 30 * outside
    across = np.array([-outside[1], outside[0], 0])
    near = {x: (d + 0 * a)[:2] for x, (a, d, _) in out.items()}
    apart = [np.arccos(np.clip(near[x] @ outside[:2], -1, 1)) for x in w]
    assert apart[0] > 0.03 and apart[-1] > 0.01 and np.all(np.diff([np.arctan2(*near[x][::-1]) for x in w]) > 0)
    corners = np.array(
        [centre + i * across + j * np.array([0, 0, 3.0]) for i, j in ((-0.1, -1), (0.1, -1), (0.1, 1), (-0.1, 1))]
    )
    slit = mesh.Mesh(corners, [[0, 1, 2], [0, 2, 3]])
    camera = scene.Camera(tuple(eye), tuple(middle), up=(0, 0, 1), fov_y=1e-4)
    glow = scene.Material((0, 0, 0), emission=(1, 1, 1))

    def at(x, behind=slit):
        glass = brdf.Dielectric(index(x))
        return scene.Scene([scene.Instance(body, materials=glass), scene.Instance(behind, materials=glow)], (), camera)

    options = {"max_depth": 2, "filter": PixelFilter("box", 0.0), "dtype": np.float64, "roulette": 9}
    got = spectral(at, (4, 4), 1024, wavelengths=w, **options)
    mean, spread = got.radiance.mean((0, 1)), np.sqrt(got.variance.mean((0, 1)) / 16)
    assert abs(mean[2] - share) < 5 * spread[2] and share > 0.6
    assert np.array_equal(mean > 0, [False, False, True, False, False])
    # A wide slit shows all of them, each less its own reflections.
    wide = mesh.Mesh((corners - centre) * 60 + centre, slit.faces)
    got = spectral(lambda x: at(x, wide), (4, 4), 1024, wavelengths=w, seed=1, **options)
    mean, spread = got.radiance.mean((0, 1)), np.sqrt(got.variance.mean((0, 1)) / 16)
    np.testing.assert_array_less(np.abs(mean - [out[x][2] for x in w]), 5 * spread)


def test_three_wavelengths_go_together_where_colours_alone_differ(monkeypatch):
    traced = []
    original = sl.pathtrace.spectra.path_trace
    monkeypatch.setattr(sl.pathtrace.spectra, "path_trace", lambda *a, **k: traced.append(a[0]) or original(*a, **k))
    lamp = sl.light.SphereLight((0, 3, 0), 0.5)

    def painted(w):
        things = [
            scene.Instance(mesh.box(), materials=brdf.Diffuse((w / 1000,) * 3)),
            scene.Instance(mesh.plane((9, 9))),
        ]
        lights = (sl.light.SphereLight(lamp.center, lamp.radius, (w / 100,) * 3),)
        return scene.Scene(things, lights, scene.Camera((0, 2, 5), (0, 0, 0)), background=(w / 900,) * 3)

    w = np.arange(400, 700, 50.0)
    together = spectral(painted, (8, 6), 256, wavelengths=w, seed=1)
    assert len(traced) == 2
    assert traced[0].instances[0].materials[0].albedo == (0.4, 0.5, 0.6)
    apart = [path_trace(painted(x), (8, 6), 256, seed=k) for k, x in enumerate(w)]
    for i, one in enumerate(apart):
        spread = np.sqrt(together.variance[..., i] + one.variance[..., 0])
        assert np.abs(together.radiance[..., i] - one.radiance[..., 0]).mean() < 2 * spread.mean() + 1e-6
    # What differs in more goes by itself.
    for other in (
        lambda w: scene.Scene(mesh.box((w / 500, 1, 1)), (), scene.Camera((0, 2, 5), (0, 0, 0))),
        lambda w: scene.Scene(mesh.box(), (), scene.Camera((0, 2, w / 100), (0, 0, 0))),
        lambda w: scene.Scene(scene.Instance(mesh.box(), materials=scene.Material(roughness=w / 1000))),
        lambda w: scene.Scene(mesh.box(), environment=Environment(np.full((4, 8, 3), w))),
        lambda w: scene.Scene(mesh.box(), sl.light.PointLight((w, 9, 9))),
        lambda w: scene.Scene([mesh.box()] * (1 + (w > 450)), (), scene.Camera((0, 2, 5), (0, 0, 0))),
    ):
        traced.clear()
        spectral(other, (2, 2), 1, wavelengths=[400.0, 500.0, 600.0])
        assert len(traced) == 3


def test_colours_are_those_of_the_eye():
    colour = pytest.importorskip("colour")
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    w = np.arange(390.0, 721)
    values = np.asarray(cmfs.values)[(cmfs.wavelengths >= 390) & (cmfs.wavelengths <= 720)]
    one = np.ones((1, 1, len(w)))
    got = Spectrum(w, one, 0 * one, one.astype(np.int32))
    # Even light: X, Y and Z alike, to the fit's error.
    np.testing.assert_allclose(got.xyz()[0, 0], values.sum(0) / values[:, 1].sum(), atol=3e-3)
    np.testing.assert_allclose(
        got.rgb()[0, 0],
        colour.XYZ_to_sRGB(
            got.xyz()[0, 0],
            apply_cctf_encoding=False,
            illuminant=colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D65"],
        ),
        atol=2e-3,
    )
    np.testing.assert_allclose(got.rgb(white=1.0), 1, rtol=1e-6)
    # A spectrum of daylight is white.
    day = colour.SDS_ILLUMINANTS["D65"].copy().align(colour.SpectralShape(390, 720, 1)).values / 100
    lit = got._replace(radiance=day[None, None])
    np.testing.assert_allclose(lit.rgb()[0, 0] / lit.xyz()[0, 0, 1], 1, atol=0.02)
    # A single wavelength's colour, spread over its part.
    line = got._replace(radiance=np.eye(len(w))[None, 150:151])
    np.testing.assert_allclose(line.xyz()[0, 0] * values[:, 1].sum(), values[150], atol=0.02)


def test_wavelengths_are_strata_shifted_by_chance():
    world = scene.Scene(mesh.box(), (), scene.Camera((0, 0, 9), (0, 0, 0)))
    first, other = (spectral(lambda _: world, (1, 1), 1, wavelengths=10, low=400, high=700, seed=s) for s in (1, 2))
    assert np.allclose(np.diff(first.wavelengths), 30) and 400 <= first.wavelengths[0] < 430
    assert not np.array_equal(first.wavelengths, other.wavelengths)
    calls = []
    spectral(lambda _: world, (1, 1), 1, wavelengths=4, progress=lambda *a: calls.append(a))
    assert calls[-1] == (4, 4)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"wavelengths": 0}, "wavelengths: expected an integer of at least 1|wavelengths: expected an integer from 1"),
        ({"wavelengths": [500.0, 400.0]}, "wavelengths: expected"),
        ({"wavelengths": []}, "wavelengths: expected"),
        ({"wavelengths": [np.nan]}, "wavelengths: expected"),
        ({"low": 700, "high": 400}, "low: expected"),
        ({"scene": 3}, "scene: expected a callable"),
        ({"scene": lambda w: w}, "scene: expected a Scene at"),
        ({"bvh": None}, "bvh: expected none"),
        ({"samples": 0}, "samples: expected"),
        ({"start": 2**32 - 2}, "start: expected"),
    ],
)
def test_what_cannot_be_is_named(given, message):
    world = scene.Scene(mesh.box(), (), scene.Camera((0, 0, 9), (0, 0, 0)))
    options = {"scene": lambda _: world, "size": (2, 2), "samples": 1, "wavelengths": 3, **given}
    with pytest.raises((TypeError, ValueError), match=message):
        spectral(options.pop("scene"), **options)
    if not given.get("start"):
        got = spectral(lambda _: world, (2, 2), 1, wavelengths=3)
        with pytest.raises(ValueError, match="white: expected"):
            got.rgb(white=[1.0, 2.0])


@pytest.mark.parametrize(
    "model",
    [
        lambda x: brdf.SpecularGlossiness((0.5,) * 3, (0.9 * x,) * 3, 0.4),
        lambda x: brdf.Principled((x,) * 3, specular_tint=1, specular=1, roughness=0.2),
    ],
    ids=["specular-glossiness", "principled"],
)
def test_models_that_mix_their_channels_are_traced_by_themselves(model):
    """What a wavelength gives does not depend on which others are asked for."""

    def ball(w):
        thing = scene.Instance(mesh.icosphere(2), materials=model((w - 400) / 300))
        return scene.Scene(thing, (), scene.Camera((0, 0, 4), (0, 0, 0)), background=(1, 1, 1))

    several = spectral(ball, (4, 4), 64, wavelengths=[450.0, 550.0, 650.0])
    for k, w in enumerate((450.0, 550.0, 650.0)):
        alone = path_trace(ball(w), (4, 4), 256)
        spread = np.sqrt(several.variance[..., k].sum() + alone.variance[..., 0].sum())
        assert abs(several.radiance[..., k].sum() - alone.radiance[..., 0].sum()) < 4 * spread


def test_a_hierarchy_serves_all_wavelengths(monkeypatch):
    built = []

    def counted(*given):
        built.append(1)
        return sl.accel.BVH(*given)

    monkeypatch.setattr(sl.pathtrace.spectra, "BVH", counted)
    glass = mesh.icosphere(1)

    def ball(w):
        thing = scene.Instance(glass, materials=brdf.Dielectric(1.4 + 0.1 * (w - 400) / 300))
        return scene.Scene(thing, (), scene.Camera((0, 0, 4), (0, 0, 0)), background=(1, 1, 1))

    spectral(ball, (4, 4), 4, wavelengths=6)
    assert len(built) == 1
