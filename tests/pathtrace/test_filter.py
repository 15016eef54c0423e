"""Pixel filters: densities against their formulas, samples against densities, moments, pictures."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import integrate, stats
from shadelab.pathtrace import PixelFilter

FILTERS = [
    PixelFilter("box"),
    PixelFilter("box", 1.5),
    PixelFilter("tent"),
    PixelFilter("gaussian"),
    PixelFilter("gaussian", 1.5, 1.0),
    PixelFilter("blackman_harris"),
    PixelFilter("blackman_harris", 2.0),
]


def formula(f, x):
    """The textbook's filter, not scaled."""
    x = np.asarray(x, float)
    inside = np.abs(x) <= f.radius
    if f.name == "box":
        return inside * 1.0
    if f.name == "tent":
        return inside * (1 - np.abs(x) / f.radius)
    if f.name == "gaussian":
        return inside * (np.exp(-((x / f.deviation) ** 2) / 2) - np.exp(-((f.radius / f.deviation) ** 2) / 2))
    from scipy.signal.windows import blackmanharris

    n = 200_001
    return np.interp(x, np.linspace(-f.radius, f.radius, n), blackmanharris(n), 0, 0)


@pytest.mark.parametrize("f", FILTERS, ids=str)
def test_the_density_is_the_formula_scaled_to_one(f):
    x = np.linspace(-f.radius * 1.2, f.radius * 1.2, 4001)
    total = integrate.quad(lambda t: float(formula(f, t)), -f.radius, f.radius, limit=200)[0]
    # Linear pieces of 1/128 of the radius: off by h² f'' / 8.
    assert np.abs(f.density(x) - formula(f, x) / total).max() <= 4e-4 * f.density(0.0)
    grid = np.linspace(-f.radius, f.radius, 128 * 2 + 1)
    assert integrate.trapezoid(f.density(grid), grid) == pytest.approx(1, abs=1e-4)


@pytest.mark.parametrize("f", FILTERS, ids=str)
def test_samples_follow_the_density(f):
    """Chi-square over 64 even cells of the offset, 400,000 stratified-free numbers, at a level of 1e-4 a filter."""
    x = f.sample(np.random.default_rng(5).random(400_000))
    edges = np.linspace(-f.radius, f.radius, 65)
    counts = np.histogram(x, edges)[0]
    assert counts.sum() == len(x)
    expected = np.array(
        [integrate.quad(lambda t: float(f.density(t)), a, b, limit=100)[0] for a, b in itertools.pairwise(edges)]
    )
    few = expected * len(x) < 5
    counts = np.append(counts[~few], counts[few].sum())
    expected = np.append(expected[~few], expected[few].sum()) * len(x)
    keep = expected > 0
    assert stats.chisquare(counts[keep], expected[keep] * counts.sum() / expected[keep].sum()).pvalue > 1e-4


@pytest.mark.parametrize("f", FILTERS, ids=str)
def test_moments_are_the_formulas(f):
    u = (np.arange(1 << 16) + 0.5) / (1 << 16)
    x = f.sample(u)
    total = integrate.quad(lambda t: float(formula(f, t)), -f.radius, f.radius, limit=200)[0]
    second = integrate.quad(lambda t: t * t * float(formula(f, t)), -f.radius, f.radius, limit=200)[0] / total
    assert abs(x.mean()) < 1e-12
    # The inverse distribution by the midpoint rule, and the linear pieces.
    assert (x**2).mean() == pytest.approx(second, rel=3e-4)


@pytest.mark.parametrize("f", FILTERS, ids=str)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_samples_rise_mirror_and_stay_within(f, dtype):
    u = np.linspace(0, 1, 2049, dtype=dtype)
    x = f.sample(u)
    assert x.dtype == dtype and (np.diff(x) > 0).all()
    assert x[0] == -f.radius and x[-1] == f.radius and x[1024] == 0
    assert np.array_equal(x, -x[::-1])
    last = f.sample(np.nextafter(dtype(1), dtype(0)))
    assert np.isfinite(last) and abs(last) <= f.radius


@settings(max_examples=30, deadline=None)
@given(st.sampled_from(["box", "tent", "gaussian", "blackman_harris"]), st.floats(0, 1e6), st.floats(0, 1))
def test_any_radius_gives_offsets_within_it(name, radius, u):
    x = PixelFilter(name, radius).sample(u)
    assert abs(x) <= radius


def test_a_filter_agrees_with_its_inverse():
    for f in FILTERS:
        u = np.linspace(0.001, 0.999, 97)
        x = f.sample(u)
        # By the trapezoid rule, finer than the linear pieces.
        grid = np.linspace(-f.radius, f.radius, 128 * 80 + 1)
        cumulative = integrate.cumulative_trapezoid(f.density(grid), grid, initial=0)
        assert np.allclose(np.interp(x, grid, cumulative), u, atol=1e-5)


def test_extremes():
    point = PixelFilter("tent", 0.0)
    assert (point.sample([0.0, 0.3, 1.0]) == 0).all()
    assert point.density([0.0, 1.0]).tolist() == [np.inf, 0.0]
    tiny = PixelFilter("gaussian", 1e-6)
    assert np.abs(tiny.sample(np.linspace(0, 1, 33))).max() == 1e-6
    assert np.isnan(PixelFilter().sample([np.nan, -0.1, 1.1])).all()
    assert np.isnan(PixelFilter("gaussian").density(np.nan))
    wide = PixelFilter("gaussian", 1.0, 100.0)
    assert np.isfinite(wide.sample(np.linspace(0, 1, 33))).all()


def test_wrong_calls_name_the_argument():
    with pytest.raises(ValueError, match="name: expected one of"):
        PixelFilter("mitchell")
    with pytest.raises(ValueError, match="radius: expected a number"):
        PixelFilter("box", -1)
    with pytest.raises(ValueError, match="deviation: expected None"):
        PixelFilter("box", 1, 1)
    with pytest.raises(ValueError, match="deviation: expected a number"):
        PixelFilter("gaussian", 1, 1e-3)
