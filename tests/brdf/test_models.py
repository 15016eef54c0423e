"""What all models share: shapes, precision, domains, terms, the diffuser's known values."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from shadelab import brdf

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)

MODELS = [
    brdf.MetallicRoughness(),
    brdf.Diffuse(),
    brdf.OrenNayar(),
    brdf.Phong(),
    brdf.BlinnPhong(),
    brdf.Plastic(),
    brdf.RoughConductor(0.3),
    brdf.RoughConductor(0.3, compensation="kulla_conty"),
    brdf.RoughDielectric(0.3),
    brdf.SpecularGlossiness(),
    brdf.Principled(),
    brdf.Principled(spec_trans=0.5, form="2015"),
    brdf.RoughDielectric(0.6, compensation="kulla_conty"),
    brdf.RoughDielectric(0.6, 0.7, compensation="scaled"),
    brdf.Principled(metallic=0.3, roughness=0.8, compensation="kulla_conty"),
    brdf.Principled(metallic=0.3, roughness=0.8, spec_trans=0.5, form="2015", compensation="kulla_conty"),
    brdf.Principled(metallic=0.3, roughness=0.8, spec_trans=0.5, form="2015", compensation="scaled"),
]


@pytest.mark.parametrize("model", MODELS, ids=lambda m: type(m).__name__)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_single_precision_is_double_rounded(model, dtype):
    wi, wo = common.both_sides(300, 1, dtype), common.both_sides(300, 2, dtype)
    value, density = model.eval(wi, wo), model.pdf(wi, wo)
    assert value.dtype == density.dtype == dtype and value.shape == (300, 3) and density.shape == (300,)
    exact = model.eval(wi.astype(np.float64), wo.astype(np.float64))
    # The half vector of refraction is a difference: its rounding is magnified by 1 / (η - 1) / alpha.
    np.testing.assert_allclose(value, exact, rtol=200 * np.finfo(dtype).eps, atol=1e-6 * exact.max())
    assert (value >= 0).all() and (density >= 0).all()


@pytest.mark.parametrize("model", MODELS, ids=lambda m: type(m).__name__)
def test_weights_are_values_over_densities(model):
    wo = common.both_sides(500, 3)
    draws = model.sample(wo, np.random.default_rng(4).random((500, 3)))
    some = (draws.pdf > 0) & ~draws.specular
    assert some.sum() > 150
    wi, wo = draws.wi[some], wo[some]
    np.testing.assert_allclose(model.pdf(wi, wo), draws.pdf[some], rtol=1e-9)
    weight = model.eval(wi, wo) * np.abs(wi[:, 2:]) / draws.pdf[some, None]
    np.testing.assert_allclose(draws.weight[some], weight, rtol=1e-9)


@pytest.mark.parametrize("model", MODELS, ids=lambda m: type(m).__name__)
def test_nan_stays_where_it_is(model):
    wi, wo = common.directions(4, 5), common.directions(4, 6)
    good = model.eval(wi, wo)
    wi[2, 0] = np.nan
    wi[2, 2] = np.nan
    bad = model.eval(wi, wo)
    assert np.isnan(bad[2]).all() and np.array_equal(bad[[0, 1, 3]], good[[0, 1, 3]])


def test_empty_arrays_are_fine():
    none = np.empty((0, 3), np.float32)
    assert brdf.RoughConductor().eval(none, none).shape == (0, 3)
    assert brdf.Diffuse(np.empty((0, 3))).eval([0, 0, 1], [0, 0, 1]).shape == (0, 3)


@pytest.mark.parametrize(
    ("model", "name", "options"),
    [
        (brdf.RoughConductor, "alpha", {"distribution": "beckmann"}),
        (brdf.MetallicRoughness, "roughness", {"metallic": 0.3}),
        (brdf.SpecularGlossiness, "glossiness", {}),
    ],
)
def test_lanes_give_the_bits_of_the_scalar(model, name, options):
    """Parameters for all and one each go in lanes; rows that elements share by number go one by one."""
    wi, wo = common.directions(1001, 1, np.float32), common.directions(1001, 2, np.float32)
    wi[7], wo[9] = wi[7] * [1, 1, -1], np.nan
    one = model(**{name: np.full(1, 0.3, np.float32)}, **options)
    each = model(**{name: np.full(1001, 0.3, np.float32)}, **options)
    shared = model(**{name: np.array([0.3, 0.7], np.float32)}, **options)
    for call in ("eval", "pdf"):
        many = getattr(one, call)(wi, wo)
        np.testing.assert_array_equal(getattr(each, call)(wi, wo), many)
        np.testing.assert_array_equal(getattr(shared, call)(wi[:, None], wo[:, None])[:, 0], many)


@pytest.mark.parametrize("masking", ["separable", "height_correlated"])
@pytest.mark.parametrize("alpha", [1e-4, 0.01, 0.3, 1.0])
def test_one_metal_for_many_directions_is_the_model(alpha, masking):
    """In single precision it has its own arithmetic: 8e-7 seen, of several roots and quotients."""
    wi, wo = common.directions(5001, 1, np.float32), common.directions(5001, 2, np.float32)
    for metal in ({}, {"eta": (1.3, 2.9, 3.1), "k": (7.5, 3.1, 3.3)}, {"eta": 0.9, "k": 0.01}):
        model = brdf.RoughConductor(alpha, masking=masking, tint=(0.5, 1.0, 0.9), **metal)
        exact = model.eval(wi.astype(float), wo.astype(float))
        np.testing.assert_allclose(model.eval(wi, wo), exact, rtol=1.5e-6 if metal.get("k") != 0.01 else 1e-4)


@pytest.mark.parametrize("model", [m for m in MODELS if m._facets], ids=lambda m: type(m).__name__)
def test_terms_are_the_factors(model):
    wi, wo = common.directions(50, 7), common.directions(50, 8)
    terms = model.eval(wi, wo, full_output=True)
    product = terms.fresnel * (terms.distribution * terms.masking / (4 * wi[:, 2] * wo[:, 2]))[:, None]
    assert np.array_equal(terms.value, model.eval(wi, wo))
    if type(model) in (brdf.RoughConductor, brdf.RoughDielectric) and getattr(model, "compensation", "none") == "none":
        np.testing.assert_allclose(product, terms.value, rtol=1e-12)
    else:
        assert (product <= terms.value * (1 + 1e-9)).all()
    half = wi + wo
    np.testing.assert_allclose(terms.half, half / np.linalg.norm(half, axis=-1, keepdims=True), rtol=1e-12)


def test_one_direction_has_terms_without_axes():
    terms = brdf.RoughConductor(0.3).eval([0.0, 0.0, 1.0], [0.6, 0.0, 0.8], full_output=True)
    assert terms.half.shape == (3,) and terms.distribution.shape == () and terms.value.shape == (3,)


def test_models_without_facets_have_no_terms():
    with pytest.raises(ValueError, match="full_output: Diffuse is no model of facets"):
        brdf.Diffuse().eval([0, 0, 1], [0, 0, 1], full_output=True)


def test_parameters_are_checked():
    with pytest.raises(ValueError, match=r"alpha: expected a number in \[1e-09, 1\], got 0"):
        brdf.RoughConductor(0.0)
    with pytest.raises(ValueError, match="albedo: expected three numbers"):
        brdf.Diffuse((0.5, 0.5))
    with pytest.raises(ValueError, match="distribution: expected one of"):
        brdf.RoughConductor(distribution="phong")
    with pytest.raises(ValueError, match="parameters: shapes"):
        brdf.MetallicRoughness(metallic=np.zeros(2), roughness=np.zeros(3)).eval([0, 0, 1], [0, 0, 1])
    got = brdf.Diffuse(np.array([[0.5, 0.5, 0.5], [0.5, 1.5, 0.5]])).eval([0, 0, 1], [0, 0, 1])
    assert np.isfinite(got[0]).all() and np.isnan(got[1]).all()


def test_a_list_of_numbers_is_an_array():
    got = brdf.RoughConductor([0.1, 0.4]).eval([0, 0, 1], [0, 0, 1])
    np.testing.assert_array_equal(got, brdf.RoughConductor(np.array([0.1, 0.4])).eval([0, 0, 1], [0, 0, 1]))
    with pytest.raises(TypeError, match="alpha: expected real numbers"):
        brdf.RoughConductor(["a", "b"])


def test_half_lambert_wraps():
    assert np.array_equal(brdf.half_lambert([[0, 0, 1.0], [0, 0, -1.0]], 0.5), [0.5, 0])
    assert brdf.half_lambert(np.float32([[1, 0, 0]]), exponent=1.0).dtype == np.float32
    with pytest.raises(ValueError, match="albedo"):
        brdf.half_lambert(np.ones((3, 3)), np.ones(2))


def test_reflected_radiance_of_a_half_lit_sky():
    with pytest.raises(TypeError, match="radiance: expected a callable, got float"):
        brdf.reflected_radiance(brdf.Diffuse(), [0.0, 0, 1], 1.0)
    got = brdf.reflected_radiance(brdf.Diffuse((0.2, 0.4, 0.8)), [0.0, 0, 1], lambda w: w[:, 0] > 0, 1 << 14)
    np.testing.assert_allclose(got, [0.1, 0.2, 0.4], rtol=5e-3)


HUGE = {
    "Conductor": ({"eta": 1e9, "k": 1e9}, {"k": 1e160}, "k"),
    "RoughConductor": ({"eta": 1e-9, "k": 1e9}, {"eta": 1e300}, "eta"),
    "Dielectric": ({"eta": 1e9}, {"eta": 1e300}, "eta"),
    "RoughDielectric": ({"eta": 1e9}, {"eta": 1e-300}, "eta"),
    "Phong": ({"exponent": 1e9}, {"exponent": 1e300}, "exponent"),
    "BlinnPhong": ({"exponent": 1e9}, {"exponent": 1e300}, "exponent"),
    "Plastic": ({"eta": 1e9}, {"eta": 1e300}, "eta"),
    "Principled": ({"eta": 1e9, "spec_trans": 0.5, "form": "2015"}, {"eta": 1e300}, "eta"),
}


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("name", HUGE)
def test_huge_parameters_have_their_limit_or_are_refused(name, dtype):
    kind, (held, refused, argument) = getattr(brdf, name), HUGE[name]
    with pytest.raises(ValueError, match=f"{argument}: expected a number in"):
        kind(**refused)
    wo = common.directions(64, 5, dtype, 0.01)
    wi = np.concatenate([common.directions(32, 6, dtype, 0.01), wo[32:] * np.array([-1, -1, 1], dtype)])
    model = kind(**held)
    draws = model.sample(wo, np.random.default_rng(2).random((64, 3)).astype(dtype))
    for found in (model.eval(wi, wo), model.pdf(wi, wo), draws.weight, draws.pdf):
        assert np.isfinite(found).all() and (found >= 0).all()
    # An element of an array is no reason to refuse the others.
    value = refused[argument]
    core = (3,) if argument == "k" or kind is brdf.RoughConductor else ()
    several = np.broadcast_to(np.reshape([1.5, value], (2, *(1 for _ in core))), (2, *core)).astype(np.float64)
    drawn = kind(**{**held, argument: several}).sample(wo[:1].astype(np.float64), np.full((2, 3), 0.3))
    assert np.isfinite(drawn.weight[0]).all() and np.isnan(drawn.weight[1]).any()
