"""Directions about the normal: unit, in proportion to the cosine, and inverted."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats

METHODS = ["concentric", "polar"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_directions_follow_the_cosine(method, dtype):
    u = sl.sampling.Generator(1).uniform(np.arange(1 << 16)[:, None], 0, [0, 1], dtype)
    d = sl.sampling.square_to_cosine_hemisphere(u, method)
    assert d.dtype == dtype and (d[:, 2] >= 0).all()
    assert np.allclose((d.astype(np.float64) ** 2).sum(-1), 1, rtol=0, atol=6 * np.finfo(dtype).eps)
    # Bands in which the integral of cos θ is the same, times sectors. Chance of failing 1e-6.
    counts, *_ = np.histogram2d(d[:, 2] ** 2, np.arctan2(d[:, 1], d[:, 0]), (16, 32), [(0, 1.0001), (-np.pi, np.pi)])
    assert counts.sum() == len(d)
    assert stats.chisquare(counts.ravel()).pvalue > 1e-6


def test_density_integrates_to_one():
    z = (np.arange(1000) + 0.5) / 1000
    d = np.stack([np.sqrt(1 - z * z), 0 * z, z], -1)
    assert 2 * np.pi * sl.sampling.square_to_cosine_hemisphere_pdf(d).mean() == pytest.approx(1, abs=1e-12)
    assert sl.sampling.square_to_cosine_hemisphere_pdf([0.6, 0.0, -0.8]) == 0


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_inverse_returns_to_the_square(method, dtype):
    u = np.random.default_rng(3).uniform(0.01, 0.99, (10000, 2)).astype(dtype)
    d = sl.sampling.square_to_cosine_hemisphere(u, method)
    back = sl.sampling.cosine_hemisphere_to_square(d, method)
    scale = np.hypot(d[:, 0], d[:, 1])[:, None] if method == "polar" else 1
    assert (np.abs(back - u) * scale).max() < 4 * np.finfo(dtype).eps


def test_points_beyond_the_square_are_nan_alone():
    got = sl.sampling.square_to_cosine_hemisphere([[2.0, 0.5], [-1.0, 0.5], [0.5, np.nan], [0.5, 0.25]])
    assert np.isnan(got[:3]).all() and np.isfinite(got[3]).all()


def test_mitsuba_maps_alike():
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    for u in np.random.default_rng(2).random((50, 2)):
        d = np.array(mitsuba.warp.square_to_cosine_hemisphere(u))
        assert np.allclose(sl.sampling.square_to_cosine_hemisphere(u, "concentric"), d, atol=1e-6)
        assert np.isclose(
            sl.sampling.square_to_cosine_hemisphere_pdf(d), mitsuba.warp.square_to_cosine_hemisphere_pdf(d), rtol=1e-5
        )
