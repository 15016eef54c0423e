"""Rough mirrors: Mitsuba's values, furnace, reciprocity, and a density that is the samples' own."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import shadelab as sl
from scipy import stats

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)

ALPHAS = [0.01, 0.1, 0.5, 1.0]


def test_separable_masking_agrees_with_mitsuba():
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    for alpha in [0.001, *ALPHAS]:
        bsdf = mi.load_dict({"type": "roughconductor", "material": "none", "alpha": alpha, "distribution": "ggx"})
        wo = common.directions(100, 1, np.float32, 0.05)
        # Half of the pairs near the mirror direction, where the lobe is.
        wi = common.directions(100, 2, np.float32, 0.05)
        u = sl.sampling.Generator(5).uniform(np.arange(50)[:, None], 0, [0, 1], np.float32)
        wi[:50] = sl.brdf.ggx_sample(wo[:50], u, alpha)
        got = sl.brdf.ggx(wi, wo, alpha, masking="separable")[:, 0] * wi[:, 2]
        pdf = sl.brdf.ggx_pdf(wi, wo, alpha)
        si, context = mi.SurfaceInteraction3f(), mi.BSDFContext()
        for i in range(len(wo)):
            if wi[i, 2] < 0.01:
                continue
            si.wi = wo[i]
            # Mitsuba's half vector is normalised in single precision: 2e-7 of slope over alpha, doubled by the lobe.
            tolerance = 1e-5 + 2e-6 / alpha
            assert np.isclose(got[i], bsdf.eval(context, si, wi[i])[0], rtol=tolerance)
            assert np.isclose(pdf[i], bsdf.pdf(context, si, wi[i]), rtol=tolerance)


@pytest.mark.parametrize("alpha", ALPHAS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_brdf_is_reciprocal(alpha, dtype):
    wi, wo = common.directions(1000, 3, dtype), common.directions(1000, 4, dtype)
    for masking in ("height_correlated", "separable"):
        a, b = sl.brdf.ggx(wi, wo, alpha, masking=masking), sl.brdf.ggx(wo, wi, alpha, masking=masking)
        assert a.dtype == dtype and np.allclose(a, b, rtol=4 * np.finfo(dtype).eps)


@pytest.mark.parametrize("alpha", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("cosine", [1.0, 0.5, 0.1])
def test_the_density_integrates_to_one_over_the_sphere(alpha, cosine):
    wi = common.sphere()
    total = sl.brdf.ggx_pdf(wi, common.at(cosine), alpha).mean() * 4 * np.pi
    # The grid's own error at a lobe 0.1 wide.
    assert total == pytest.approx(1, abs=2e-4)


@pytest.mark.parametrize("alpha", [0.05, 0.3, 1.0])
@pytest.mark.parametrize("cosine", [0.95, 0.4, 0.1])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_samples_follow_the_density(alpha, cosine, dtype):
    n = 1 << 15
    wo = common.at(cosine).astype(dtype)
    u = sl.sampling.Generator(1).uniform(np.arange(n)[:, None], 0, [0, 1], dtype)
    wi = sl.brdf.ggx_sample(wo, u, alpha)
    assert np.allclose((wi.astype(float) ** 2).sum(-1), 1, atol=20 * np.finfo(dtype).eps)
    # Cells in the plane of the half vector's slopes, where the lobe has the same size everywhere.
    edges = np.tan(np.linspace(-1.3, 1.3, 13)) * alpha * 0.7

    def cells(w):
        h = w + common.at(cosine)
        return np.stack([h[..., 0] / h[..., 2], h[..., 1] / h[..., 2]], -1)

    slopes = cells(wi.astype(np.float64))
    observed = np.histogram2d(slopes[:, 0], slopes[:, 1], (edges, edges))[0].ravel()
    # Expected: midpoint rule over each cell; the density of slopes is that of wi over dω_h/dω_i and cos³.
    k = 16
    fine = (edges[:-1, None] + np.diff(edges)[:, None] * (np.arange(k) + 0.5) / k).ravel()
    weight = np.repeat(np.diff(edges) / k, k)
    x, y = np.meshgrid(fine, fine, indexing="ij")
    h = np.stack([x, y, np.ones_like(x)], -1)
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    cos_half = h @ common.at(cosine)
    w = 2 * cos_half[..., None] * h - common.at(cosine)
    density = sl.brdf.ggx_pdf(w, common.at(cosine), alpha) * 4 * np.abs(cos_half) * h[..., 2] ** 3
    density[cos_half <= 0] = 0
    expected = (density * np.outer(weight, weight)).reshape(12, k, 12, k).sum((1, 3)).ravel() * n
    observed, expected = np.append(observed, n - observed.sum()), np.append(expected, n - expected.sum())
    keep = expected > 10
    observed = np.append(observed[keep], observed[~keep].sum())
    expected = np.append(expected[keep], expected[~keep].sum())
    # A term of nearly nothing has no χ² of its own.
    terms = expected > 1
    statistic = ((observed - expected)[terms] ** 2 / expected[terms]).sum()
    assert stats.chi2.sf(statistic, terms.sum() - 1) > 1e-6


@pytest.mark.parametrize("alpha", ALPHAS)
def test_no_sample_weighs_more_than_one(alpha):
    wo = common.directions(20000, 6, lowest=1e-6)
    wi = sl.brdf.ggx_sample(wo, sl.sampling.sobol(20000, 2), alpha)
    weight = sl.brdf.ggx(wi, wo, alpha)[:, 0] * wi[:, 2] / sl.brdf.ggx_pdf(wi, wo, alpha)
    assert np.isfinite(weight).all() and weight.min() >= 0 and weight.max() <= 1 + 1e-12


def test_furnace_loses_what_is_known():
    """Cosine-averaged losses of single bounces at roughness 0.25, 0.5, 0.75, 1, in per cent."""
    n = 1 << 16
    u = sl.sampling.sobol(n, 4, seed=2)
    wo = sl.sampling.square_to_cosine_hemisphere(u[:, :2])
    for roughness, loss in [(0.25, 1.28), (0.5, 11.77), (0.75, 34.4), (1.0, 59.1)]:
        alpha = roughness**2
        wi = sl.brdf.ggx_sample(wo, u[:, 2:], alpha)
        weight = sl.brdf.ggx(wi, wo, alpha)[:, 0] * wi[:, 2] / sl.brdf.ggx_pdf(wi, wo, alpha)
        # The known values are given to three digits.
        assert 100 * (1 - weight.mean()) == pytest.approx(loss, abs=0.06)


def test_domain_is_checked():
    up = [0.0, 0.0, 1.0]
    with pytest.raises(ValueError, match=r"alpha: expected a number in \(0, 1\], got 0"):
        sl.brdf.ggx(up, up, 0.0)
    got = sl.brdf.ggx([up] * 3, up, np.array([0.5, -1.0, np.nan]))
    assert np.array_equal(np.isnan(got[:, 0]), [False, True, True])
    assert np.isnan(sl.brdf.ggx_sample([0.6, 0.0, -0.8], [0.5, 0.5], 0.3)).all()
