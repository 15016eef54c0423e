"""Densities as functions: inverted, rejected from, and owed by parametrisations."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats


@pytest.mark.parametrize(
    "law", [stats.norm, stats.expon, stats.beta(2, 5), stats.beta(0.7, 3), stats.t(5)], ids=lambda d: str(d)[:20]
)
def test_scipy_inverts_alike(law):
    u = np.linspace(0.001, 0.999, 301)
    low, high = (float(x) for x in law.ppf([1e-4, 1 - 1e-4]))
    inner = law.cdf(low) + u * (law.cdf(high) - law.cdf(low))
    exact = law.ppf(inner)
    by_cdf = sl.sampling.inverse_transform(u, low=low, high=high, cdf=law.cdf)
    # The cdf's own rounding, over the density.
    assert (np.abs(by_cdf - exact) < 1e-14 + 4e-16 / law.pdf(exact) + 1e-13 * np.abs(exact)).all()
    by_pdf = sl.sampling.inverse_transform(u, low=low, high=high, pdf=lambda x: 7 * law.pdf(x))
    tolerance = 1e-3 if "0.7" in str(getattr(law, "args", "")) else 1e-9
    assert np.allclose(by_pdf, exact, atol=tolerance)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_ends_and_gaps(dtype):
    u = np.array([0, 0.25, 0.5, 0.75, 1, np.nan, 2], dtype)
    got = sl.sampling.inverse_transform(u, low=0, high=4, pdf=lambda x: ((x < 1) | (x > 3)) * 1.0)
    assert got.dtype == dtype
    assert np.allclose(got[[0, 1, 3, 4]], [0, 0.5, 3.5, 4], atol=1e-6)
    assert 1 - 1e-6 <= got[2] <= 3 + 1e-6 and np.isnan(got[5:]).all()


def test_densities_that_are_none_are_refused():
    with pytest.raises(ValueError, match="cdf, pdf: expected one of both, got neither"):
        sl.sampling.inverse_transform(0.5, low=0, high=1)
    with pytest.raises(ValueError, match="pdf: expected densities of at least 0"):
        sl.sampling.inverse_transform(0.5, low=0, high=1, pdf=lambda x: x - 0.5)
    with pytest.raises(ValueError, match="pdf: expected a density whose integral"):
        sl.sampling.inverse_transform(0.5, low=0, high=1, pdf=lambda x: 0 * x)
    with pytest.raises(ValueError, match="cdf: expected finite values that rise"):
        sl.sampling.inverse_transform(0.5, low=0, high=1, cdf=lambda x: -x)


def test_rejection_gives_the_density_and_measures_its_acceptance():
    found = sl.sampling.rejection_sample(lambda x: 30 * (x[:, 0] * (1 - x[:, 0])) ** 2, 20000, bound=2, seed=1)
    assert found.samples.shape == (20000, 1)
    assert stats.kstest(found.samples[:, 0], stats.beta(3, 3).cdf).pvalue > 1e-5
    # Binomial: half are kept, of some 40,000; four sigma.
    assert found.acceptance == pytest.approx(0.5, abs=4 * np.sqrt(0.25 / found.tried))
    assert found.largest_ratio == pytest.approx(30 / 16 / 2, rel=1e-4)


def test_rejection_from_a_proposal():
    found = sl.sampling.rejection_sample(
        lambda x: np.exp(-x[:, 0]) * np.cos(x[:, 0]) ** 2,
        20000,
        bound=1,
        proposal=(lambda u: -np.log1p(-u[:, 0]), lambda x: np.exp(-x[:, 0])),
        seed=2,
    )
    mass = 3 / 5  # of exp(-x) cos²x
    assert found.acceptance == pytest.approx(mass, abs=4 * np.sqrt(0.24 / found.tried))
    x = np.linspace(0, 20, 2001)
    cdf = np.concatenate([[0], np.cumsum(np.exp(-x) * np.cos(x) ** 2)[:-1] + 0]) * 0.01 / mass
    assert stats.kstest(found.samples[:, 0], lambda t: np.interp(t, x, cdf)).statistic < 0.02


def test_a_bound_below_the_density_is_refused():
    with pytest.raises(ValueError, match=r"bound: expected at least the density"):
        sl.sampling.rejection_sample(lambda x: 2 * x[:, 0], 1000, bound=1.5)
    with pytest.raises(ValueError, match="max_tries: "):
        sl.sampling.rejection_sample(lambda x: 0 * x[:, 0], 10, bound=1, max_tries=5000)
    with pytest.raises(ValueError, match="density: expected numbers of at least 0"):
        sl.sampling.rejection_sample(lambda x: x[:, 0] - 0.5, 10, bound=1)


WARPS = {
    "disk": (sl.sampling.square_to_disk, sl.sampling.square_to_disk_pdf),
    "triangle": (sl.sampling.square_to_triangle, sl.sampling.square_to_triangle_pdf),
    "sphere": (sl.sampling.square_to_sphere, sl.sampling.square_to_sphere_pdf),
    "hemisphere": (sl.sampling.square_to_hemisphere, sl.sampling.square_to_hemisphere_pdf),
    "cosine": (sl.sampling.square_to_cosine_hemisphere, sl.sampling.square_to_cosine_hemisphere_pdf),
    "cone": (lambda u: sl.sampling.square_to_cone(u, 0.7), lambda d: sl.sampling.square_to_cone_pdf(d, 0.7)),
    "triangle of directions": (
        lambda u: sl.sampling.square_to_spherical_triangle(u, [1, 0, 0.2], [0, 1, 0.1], [0.3, 0.1, 1]),
        lambda d: sl.sampling.square_to_spherical_triangle_pdf(d, [1, 0, 0.2], [0, 1, 0.1], [0.3, 0.1, 1]),
    ),
    "rectangle of directions": (
        lambda u: sl.sampling.square_to_spherical_rectangle(u, [0.4, 1, 0.6], [2, 0, 0], [0, 1.5, 0]),
        lambda d: sl.sampling.square_to_spherical_rectangle_pdf(d, [0.4, 1, 0.6], [2, 0, 0], [0, 1.5, 0]),
    ),
}


@pytest.mark.parametrize("name", WARPS)
def test_every_warp_has_the_density_that_its_derivatives_say(name):
    warp, pdf = WARPS[name]
    u = np.random.default_rng(1).uniform(0.02, 0.98, (300, 2))
    # Away from the folds of the square: its diagonals and its middle.
    u = u[(np.abs(u[:, 0] - u[:, 1]) > 0.02) & (np.abs(u.sum(1) - 1) > 0.02) & (np.abs(u - 0.5) > 0.02).all(1)]
    found = sl.sampling.manifold_density(warp, u)
    assert np.allclose(found.density, pdf(found.points), rtol=1e-7)


def test_curves_volumes_and_given_derivatives():
    t = np.linspace(0.1, 3, 7)[:, None]
    helix = lambda t: np.stack([np.cos(t[:, 0]), np.sin(t[:, 0]), 2 * t[:, 0]], -1)  # noqa: E731
    assert np.allclose(sl.sampling.manifold_density(helix, t).stretch, np.sqrt(5), rtol=1e-10)
    slope = lambda t: np.stack([-np.sin(t[:, 0]), np.cos(t[:, 0]), 2 + 0 * t[:, 0]], -1)[..., None]  # noqa: E731
    assert np.allclose(sl.sampling.manifold_density(helix, t, 3.0, jacobian=slope).density, 3 / np.sqrt(5), rtol=1e-14)
    sheet = lambda u: u @ np.array([[2.0, 0, 0, 1], [0, 3, 0, 0], [1, 0, 1, 0]])  # noqa: E731
    u = np.random.default_rng(2).random((5, 3))
    j = np.array([[2.0, 0, 0, 1], [0, 3, 0, 0], [1, 0, 1, 0]]).T
    assert np.allclose(sl.sampling.manifold_density(sheet, u).stretch, np.sqrt(np.linalg.det(j.T @ j)), rtol=1e-9)


def test_poles_are_infinitely_dense_and_nan_stays_alone():
    polar = lambda a: np.stack(  # noqa: E731
        [np.sin(a[:, 0]) * np.cos(a[:, 1]), np.sin(a[:, 0]) * np.sin(a[:, 1]), np.cos(a[:, 0])], -1
    )
    found = sl.sampling.manifold_density(polar, [[0.0, 0.3], [0.5, 0.3], [np.nan, 0]])
    assert found.stretch[0] < 1e-11 and found.stretch[1] == pytest.approx(np.sin(0.5), rel=1e-9)
    assert np.isnan(found.density[2])
    with pytest.raises(ValueError, match="mapping: expected points of at least 2"):
        sl.sampling.manifold_density(lambda u: u[:, :1], [[0.1, 0.2]])
