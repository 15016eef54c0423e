"""Directions and quadratures that the tests of `brdf` share."""

import numpy as np


def directions(n, seed, dtype=np.float64, lowest=1e-3):
    """Unit directions above the horizon."""
    rng = np.random.default_rng(seed)
    z, phi = rng.uniform(lowest, 1, n), rng.uniform(0, 2 * np.pi, n)
    s = np.sqrt(1 - z * z)
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], -1).astype(dtype)


def at(cos_theta, phi=0.0):
    s = np.sqrt(1 - cos_theta**2)
    return np.array([s * np.cos(phi), s * np.sin(phi), cos_theta])


def sphere(n=1 << 20):
    """Points of an even grid over the whole sphere, in the middle of cells of solid angle 4π/n."""
    i = np.arange(n) + 0.5
    z, phi = 1 - 2 * i / n, np.pi * (1 + 5**0.5) * i
    s = np.sqrt(1 - z * z)
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], -1)


def both_sides(n, seed, dtype=np.float64):
    """Unit directions above and below the horizon."""
    w = directions(n, seed, np.float64, 0.02)
    w[:, 2] *= np.where(np.random.default_rng(seed + 1).random(n) < 0.5, -1, 1)
    return w.astype(dtype)


def mitsuba_bsdf(description, wi, wo):
    """Value times cosine, and density, of Mitsuba's BSDF; `wo` is the eye's, which Mitsuba calls wi."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    bsdf = mi.load_dict(description)
    si, context = mi.SurfaceInteraction3f(), mi.BSDFContext()
    values, densities = [], []
    for light, eye in zip(wi.tolist(), wo.tolist(), strict=True):
        si.wi = eye
        values.append(list(bsdf.eval(context, si, light)))
        densities.append(bsdf.pdf(context, si, light))
    return np.array(values), np.array(densities)


def agrees_with_mitsuba(model, description, wi, wo, rtol=1e-5, density_rtol=None):
    """Value and density of a model, in double, against Mitsuba's single precision."""
    value, density = mitsuba_bsdf(description, wi, wo)
    own = model.eval(wi, wo) * np.abs(wi[:, 2:])
    # Below a millionth of the largest, Mitsuba's own rounding of differences shows.
    np.testing.assert_allclose(own, value, rtol=rtol, atol=1e-7 * np.abs(value).max())
    np.testing.assert_allclose(model.pdf(wi, wo), density, rtol=density_rtol or rtol, atol=1e-7 * density.max())


def total(function, n=1 << 20):
    """The integral over the sphere of a function of directions."""
    return function(sphere(n)).mean(0) * 4 * np.pi


def samples_follow(model, wo, n=1 << 16, seed=1, dtype=np.float64):
    """The p-value of Pearson's test of draws against the density, over cells of cosine and azimuth."""
    import shadelab as sl
    from scipy import stats

    u = sl.sampling.Generator(seed).uniform(np.arange(n)[:, None], 0, [0, 1, 2], dtype)
    draws = model.sample(np.asarray(wo, dtype), u)
    # Draws that bring nothing are no draws of the density.
    wi = draws.wi[(draws.pdf > 0) & ~draws.specular].astype(np.float64)
    # Near the poles a step of the cosine is a large angle: many of them.
    rows, columns, kz, k = 16, 24, 128, 12
    z = np.linspace(-1, 1, rows + 1)
    phi = np.linspace(-np.pi, np.pi, columns + 1)
    observed = np.histogram2d(wi[:, 2], np.arctan2(wi[:, 1], wi[:, 0]), (z, phi))[0].ravel()
    zs = -1 + (np.arange(rows * kz) + 0.5) * 2 / (rows * kz)
    ps = -np.pi + (np.arange(columns * k) + 0.5) * 2 * np.pi / (columns * k)
    zz, pp = np.meshgrid(zs, ps, indexing="ij")
    s = np.sqrt(1 - zz * zz)
    w = np.stack([s * np.cos(pp), s * np.sin(pp), zz], -1)
    density = model.pdf(w, np.asarray(wo, np.float64)).reshape(rows, kz, columns, k).sum((1, 3)).ravel()
    expected = density * (4 * np.pi / (rows * kz * columns * k)) * n
    observed, expected = np.append(observed, n - len(wi)), np.append(expected, n - expected.sum())
    many = expected > 8
    observed = np.append(observed[many], observed[~many].sum())
    expected = np.append(expected[many], max(expected[~many].sum(), 1e-9))
    terms = expected > 4
    statistic = ((observed - expected)[terms] ** 2 / expected[terms]).sum()
    return stats.chi2.sf(statistic, terms.sum() - 1)


def lost_flux(model, side=1, n=4096, dtype=np.float64, seed=1):
    """The part of the power that comes evenly from one side which does not come back, reflected or passed."""
    import shadelab as sl

    x, weight = np.polynomial.legendre.leggauss(24)
    cosine = (x + 1) / 2
    wo = np.stack([np.sqrt(1 - cosine**2), 0 * cosine, side * cosine], -1).astype(dtype)
    u = np.minimum(sl.sampling.sobol(n, 3, seed=seed), 1 - 1e-7).astype(dtype)
    draws = model.sample(wo[:, None], u)
    # Power rather than radiance.
    back = np.where(draws.weight[..., 0] == 0, 0, draws.weight[..., 0].astype(float) * draws.eta.astype(float) ** 2)
    return 1 - (back.mean(1) * weight * cosine).sum()
