"""The artist's model: the source's listing, draws, glass."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from shadelab import brdf

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)

PAINT = {"roughness": 0.4, "specular": 0.6, "specular_tint": 0.3, "anisotropic": 0.5, "sheen": 0.4}
PAINT |= {"clearcoat": 0.8, "clearcoat_gloss": 0.3, "metallic": 0.3, "subsurface": 0.4}
COLOR = (0.8, 0.4, 0.2)


def listing(wi, wo, color, metallic, subsurface, specular, roughness, specular_tint, anisotropic, sheen, sheen_tint,
            clearcoat, clearcoat_gloss):  # fmt: skip
    """The formulas of the notes of 2012, one direction at a time."""
    mix = lambda a, b, t: a * (1 - t) + b * t  # noqa: E731
    weight = lambda c: (1 - c) ** 5  # noqa: E731
    h = (wi + wo) / np.linalg.norm(wi + wo)
    nl, nv, nh, lh = wi[2], wo[2], h[2], wi @ h
    color = np.array(color)
    tint = color / (color @ [0.3, 0.6, 0.1])
    spec0 = mix(specular * 0.08 * mix(1, tint, specular_tint), color, metallic)
    fd90 = 0.5 + 2 * lh * lh * roughness
    fd = mix(1, fd90, weight(nl)) * mix(1, fd90, weight(nv))
    fss90 = lh * lh * roughness
    fss = mix(1, fss90, weight(nl)) * mix(1, fss90, weight(nv))
    ss = 1.25 * (fss * (1 / (nl + nv) - 0.5) + 0.5)
    aspect = np.sqrt(1 - anisotropic * 0.9)
    ax, ay = max(0.001, roughness**2 / aspect), max(0.001, roughness**2 * aspect)
    ds = 1 / (np.pi * ax * ay * ((h[0] / ax) ** 2 + (h[1] / ay) ** 2 + nh * nh) ** 2)
    fs = mix(spec0, 1, weight(lh))
    smith = lambda w: 1 / (w[2] + np.sqrt((w[0] * ax) ** 2 + (w[1] * ay) ** 2 + w[2] ** 2))  # noqa: E731
    gs = smith(wi) * smith(wo)
    a2 = mix(0.1, 0.001, clearcoat_gloss) ** 2
    dr = (a2 - 1) / (np.pi * np.log(a2) * (1 + (a2 - 1) * nh * nh))
    b = 0.25**2
    coat = lambda c: 1 / (c + np.sqrt(b + c * c - b * c * c))  # noqa: E731
    sheen_part = weight(lh) * sheen * mix(1, tint, sheen_tint)
    body = (mix(fd, ss, subsurface) / np.pi * color + sheen_part) * (1 - metallic)
    return body + gs * fs * ds + 0.25 * clearcoat * coat(nl) * coat(nv) * mix(0.04, 1, weight(lh)) * dr


def test_the_form_of_2012_is_as_listed():
    wi, wo = common.directions(200, 1), common.directions(200, 2)
    got = brdf.Principled(COLOR, sheen_tint=0.7, **PAINT).eval(wi, wo)
    expected = [listing(i, o, COLOR, sheen_tint=0.7, **PAINT) for i, o in zip(wi, wo, strict=True)]
    np.testing.assert_allclose(got, expected, rtol=1e-10)


@pytest.mark.parametrize("form", ["2012", "2015"])
def test_reciprocity(form):
    wi, wo = common.directions(500, 3), common.directions(500, 4)
    model = brdf.Principled(COLOR, form=form, **PAINT)
    np.testing.assert_allclose(model.eval(wi, wo), model.eval(wo, wi), rtol=1e-11)


@pytest.mark.parametrize("options", [{}, PAINT, {"metallic": 1.0}, {"form": "2015"} | PAINT])
@pytest.mark.parametrize("cosine", [0.9, 0.35])
def test_draws_follow_the_density(options, cosine):
    # A wide coat, since the cells do not resolve a narrow one.
    model = brdf.Principled(COLOR, **options | {"clearcoat_gloss": 0.0})
    assert common.samples_follow(model, common.at(cosine, 0.4), 1 << 15) > 1e-4


@pytest.mark.parametrize("cosine", [0.9, 0.4, -0.8])
def test_draws_of_glass_follow_the_density(cosine):
    model = brdf.Principled(COLOR, roughness=0.6, spec_trans=0.7, form="2015")
    assert common.samples_follow(model, common.at(cosine, 0.4), 1 << 15) > 1e-4


def test_all_glass_is_rough_glass_with_a_tint():
    wi, wo = common.both_sides(500, 5), common.both_sides(500, 7)
    cross = wi[:, 2] * wo[:, 2] < 0
    model = brdf.Principled(COLOR, roughness=0.5, spec_trans=1.0, form="2015")
    glass = brdf.RoughDielectric(0.25, tint=tuple(np.sqrt(COLOR)))
    np.testing.assert_allclose(model.eval(wi, wo)[cross], glass.eval(wi, wo)[cross], rtol=1e-12)
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    np.testing.assert_allclose(model.eval(wi, wo)[above], glass.eval(wi, wo)[above], rtol=1e-9)


ALIKE = {
    "plain": {},
    "smooth": {"roughness": 0.2, "eta": 1.33},
    "metal": {"metallic": 1.0},
    "mixed": {"metallic": 0.5},
    "anisotropic": {"anisotropic": 0.6},
    "sheen": {"sheen": 0.6, "sheen_tint": 0.0},
}


def mitsubas(wi, wo, **parameters):
    """Its value without the cosine, and its density."""
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    color = {"type": "rgb", "value": list(COLOR)}
    model = mi.load_dict({"type": "principled", "base_color": color, **parameters})
    context, values, densities = mi.BSDFContext(), [], []
    for i, o in zip(wi.tolist(), wo.tolist(), strict=True):
        si = mi.SurfaceInteraction3f()
        si.wi, light = mi.Vector3f(o), mi.Vector3f(i)
        values.append(list(model.eval(context, si, light)))
        densities.append(model.pdf(context, si, light))
    return np.array(values) / wi[:, 2:], np.array(densities)


@pytest.mark.parametrize("name", ALIKE)
def test_the_form_of_2015_is_mitsubas(name):
    """Theirs computes in float32: 3e-6 seen. Densities agree where there is one lobe; shares of lobes are free."""
    parameters = {"roughness": 0.4, "eta": 1.5} | ALIKE[name]
    wi, wo = common.directions(200, 11), common.directions(200, 12)
    value, density = mitsubas(wi, wo, **parameters)
    model = brdf.Principled(COLOR, form="2015", **parameters)
    np.testing.assert_allclose(value, model.eval(wi, wo), rtol=1e-5)
    if name == "metal":
        np.testing.assert_allclose(density, model.pdf(wi, wo), rtol=1e-5)


def test_mitsubas_coat_lacks_the_cosines():
    """Where definitions part: its coat has the masking G in place of the source's G / (cos θi cos θo), and 4 for 1."""
    wi, wo = common.directions(200, 13), common.directions(200, 14)
    coat = {"clearcoat": 1.0, "clearcoat_gloss": 0.0}
    bare = {"roughness": 0.4, "eta": 1.5}
    theirs = mitsubas(wi, wo, **bare, **coat)[0] - mitsubas(wi, wo, **bare)[0]
    ours = brdf.Principled(COLOR, form="2015", **bare, **coat).eval(wi, wo)
    ours = ours - brdf.Principled(COLOR, form="2015", **bare).eval(wi, wo)
    # Differences of float32 values of about one.
    np.testing.assert_allclose(theirs, ours * (4 * wi[:, 2:] * wo[:, 2:]), rtol=1e-3, atol=2e-6)


def sphere(n=600):
    z, phi = 1 - 2 * (np.arange(n) + 0.5) / n, 2 * np.pi * (np.arange(n) + 0.5) / n
    r = np.sqrt(1 - z * z)[:, None]
    return np.stack(np.broadcast_arrays(r * np.cos(phi), r * np.sin(phi), z[:, None]), -1).reshape(
        -1, 3
    ), 4 * np.pi / n**2


@pytest.mark.parametrize(
    ("options", "cosine"),
    [
        (dict(roughness=0.6, spec_trans=1.0, clearcoat=1.0, clearcoat_gloss=0.0), 0.1),
        (dict(roughness=0.6, spec_trans=0.5, clearcoat=0.5, clearcoat_gloss=0.1, metallic=0.3), 0.1),
        (dict(roughness=0.6, spec_trans=1.0, eta=0.7), 0.4),
        (dict(roughness=0.6, spec_trans=1.0, eta=0.7), 0.1),
    ],
)
def test_draws_bring_all_that_passes(options, cosine):
    """Below the horizon, where a coat sends draws that are no light, and where a flat interface is dark."""
    model = brdf.Principled((0.8, 0.8, 0.8), form="2015", **options)
    wo = np.array([np.sqrt(1 - cosine**2), 0, cosine])
    wi, weight = sphere()
    below = wi[:, 2] < 0
    exact = (model.eval(wi[below], wo)[:, 0] * -wi[below, 2]).sum() * weight
    u = np.random.default_rng(1).random((1 << 17, 3))
    draws = model.sample(np.broadcast_to(wo, (len(u), 3)), u)
    brought = np.where(draws.wi[:, 2] < 0, draws.weight[:, 0], 0)
    assert brought.mean() == pytest.approx(exact, abs=5 * brought.std() / np.sqrt(len(u)) + 0.002)


@pytest.mark.parametrize("metallic", [0.0, 0.5])
def test_glass_of_no_index_passes_its_share(metallic):
    model = brdf.Principled((0.2,) * 3, roughness=0.6, metallic=metallic, spec_trans=0.5, eta=1.0, form="2015")
    wo = np.array([np.sqrt(1 - 0.81), 0, 0.9])
    u = np.random.default_rng(1).random((1 << 16, 3))
    draws = model.sample(np.broadcast_to(wo, (len(u), 3)), u)
    passed = np.where(draws.specular, draws.weight[:, 0], 0)
    right = np.sqrt(0.2) * 0.5 * (1 - metallic)
    assert passed.mean() == pytest.approx(right, rel=0.02)


@pytest.mark.parametrize("form", ["2012", "2015"])
def test_what_it_loses_and_invents_is_what_is_said(form):
    """As published, it is not conservative: metal loses its further bounces, white paint gives back too much."""
    for roughness, lost in ((0.25, 0.013), (0.5, 0.12), (0.75, 0.36), (1.0, 0.62)):
        metal = brdf.Principled((1, 1, 1), metallic=1.0, roughness=roughness, form=form)
        assert brdf.white_furnace(metal, 16, 1024) == pytest.approx(lost, abs=0.005)
        paint = brdf.Principled((1, 1, 1), roughness=roughness, form=form)
        assert (np.abs(brdf.white_furnace(paint, 16, 1024) + 0.065) < 0.025).all()
    coated = brdf.Principled((1, 1, 1), roughness=1.0, sheen=1.0, clearcoat=1.0, form=form)
    assert brdf.white_furnace(coated, 16, 1024) == pytest.approx(-0.11, abs=0.005)
    rough = brdf.Principled((1, 1, 1), roughness=1.0, form=form)
    assert brdf.directional_albedo(rough, common.at(0.05), 4096) == pytest.approx(1.5, abs=0.02)


FORMS = ["kulla_conty", "kulla_conty_as_published", "scaled"]


@pytest.mark.parametrize("compensation", FORMS)
@pytest.mark.parametrize("form", ["2012", "2015"])
@pytest.mark.parametrize("roughness", [0.1, 0.25, 0.5, 0.75, 1.0])
def test_white_metal_gives_all_back_with_compensation(roughness, form, compensation):
    model = brdf.Principled(1.0, metallic=1.0, roughness=roughness, form=form, compensation=compensation)
    assert abs(brdf.white_furnace(model)).max() < 0.002


@pytest.mark.parametrize("compensation", FORMS)
@pytest.mark.parametrize("eta", [1.1, 1.5, 2.5])
@pytest.mark.parametrize("roughness", [0.25, 0.5, 0.75, 1.0])
def test_glass_gives_all_back_with_compensation(roughness, eta, compensation):
    model = brdf.Principled(1.0, roughness=roughness, eta=eta, spec_trans=1.0, form="2015", compensation=compensation)
    for side in (1, -1):
        assert abs(common.lost_flux(model, side, 1 << 13)) < 0.002


def test_compensated_glass_is_that_of_rough_glass():
    wi, wo = common.both_sides(500, 5), common.both_sides(500, 7)
    model = brdf.Principled(1.0, roughness=0.8, spec_trans=1.0, form="2015", compensation="kulla_conty")
    glass = brdf.RoughDielectric(0.64, compensation="kulla_conty")
    np.testing.assert_allclose(model.eval(wi, wo), glass.eval(wi, wo), rtol=1e-9)


@pytest.mark.parametrize("compensation", ["kulla_conty", "kulla_conty_as_published"])
def test_compensation_keeps_reciprocity(compensation):
    eta = 1.4
    wi, wo = common.both_sides(500, 3), common.both_sides(500, 4)
    model = brdf.Principled(COLOR, spec_trans=0.4, eta=eta, form="2015", compensation=compensation, **PAINT)

    def squared(w):
        return np.where(w[:, 2:] > 0, 1, eta * eta)

    there, back = model.eval(wi, wo) * squared(wi), model.eval(wo, wi) * squared(wo)
    np.testing.assert_allclose(there, back, rtol=1e-9, atol=1e-13)


@pytest.mark.parametrize("compensation", ["kulla_conty", "scaled"])
@pytest.mark.parametrize("options", [{}, {"metallic": 1.0}, {"form": "2015", "spec_trans": 0.6}])
@pytest.mark.parametrize("cosine", [0.9, 0.35, -0.7])
def test_compensated_draws_follow_the_density(options, cosine, compensation):
    if cosine < 0 and "spec_trans" not in options:
        return
    model = brdf.Principled(COLOR, roughness=0.9, sheen=0.3, compensation=compensation, **options)
    assert common.samples_follow(model, common.at(cosine, 0.4), 1 << 15) > 1e-4


@pytest.mark.parametrize("form", ["2012", "2015"])
def test_of_paint_compensation_adds_little(form):
    """Dielectric mirrors lose the square of what they reflect: less than 0.3 % of the light."""
    for roughness in (0.25, 1.0):
        options = {"roughness": roughness, "specular": 1.0, "form": form}
        plain, given = (brdf.Principled(0.5, compensation=c, **options) for c in ("none", "kulla_conty"))
        wi, wo = common.directions(300, 1), common.directions(300, 2)
        assert (given.eval(wi, wo) >= plain.eval(wi, wo)).all()
        assert 0 <= (brdf.white_furnace(plain) - brdf.white_furnace(given)).max() < 0.005


@pytest.mark.parametrize(
    ("anisotropic", "roughness", "left"), [(0.5, 0.5, 0.005), (0.5, 0.75, 0.005), (1.0, 0.75, 0.07), (0.5, 1.0, 0.035)]
)
def test_of_two_widths_some_loss_is_left(anisotropic, roughness, left):
    """As the docstring says, on the average over azimuths: most where a width is above one."""
    x, weight = np.polynomial.legendre.leggauss(16)
    cosine, turn = ((x + 1) / 2)[:, None], (np.arange(8) + 0.5) * np.pi / 16
    s = np.sqrt(1 - cosine**2)
    wo = np.stack(np.broadcast_arrays(s * np.cos(turn), s * np.sin(turn), cosine), -1)
    model = brdf.Principled(1.0, metallic=1.0, roughness=roughness, anisotropic=anisotropic, compensation="kulla_conty")
    albedo = brdf.directional_albedo(model, wo, 2048)[..., 0].mean(1)
    assert -0.001 < 1 - (albedo * weight * cosine[:, 0]).sum() < left


def test_mirrors_draws_through_glass_say_that_they_cross():
    wo = common.at(0.3)
    u = np.random.default_rng(3).random((1 << 14, 3))
    draws = brdf.Principled(1.0, roughness=1.0, spec_trans=1.0, form="2015").sample(wo, u)
    some = draws.pdf > 0
    assert np.array_equal(draws.eta[some] != 1, draws.wi[some, 2] < 0)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_no_density_is_negative_against_the_beam(dtype):
    """There rounding alone decides on the half vector."""
    model = brdf.Principled(clearcoat=1.0, clearcoat_gloss=1.0)
    wo = common.directions(100_000, 9, dtype)
    wi = (-wo + np.random.default_rng(9).normal(size=wo.shape) * np.finfo(dtype).eps).astype(dtype)
    density = model.pdf(wi, wo)
    assert np.isfinite(density).all() and density.min() >= 0
