"""Mirrored and refracted directions."""

import numpy as np
import pytest
from shadelab import brdf


def random_units(n, seed):
    w = np.random.default_rng(seed).normal(size=(n, 3))
    return w / np.linalg.norm(w, axis=-1, keepdims=True)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("eta", [1.5, 0.6, 1.0, 1 + 1e-7, 1 - 1e-7])
def test_snells_law(dtype, eta):
    w, n = random_units(1000, 1).astype(dtype), random_units(1000, 2).astype(dtype)
    bent = brdf.refract(w, n, eta)
    eps = np.finfo(dtype).eps
    assert bent.direction.dtype == dtype
    c = np.abs((w.astype(float) * n).sum(-1))
    # Where the angle itself is in doubt by its rounding, so is whether all is reflected.
    surely = np.abs(eta**2 - 1 + c * c) > 10 * eps
    assert np.array_equal(bent.total[surely], (eta**2 - 1 + c * c < 0)[surely])
    ok = ~bent.total
    t = bent.direction[ok].astype(float)
    np.testing.assert_allclose((t * t).sum(-1), 1, atol=30 * eps)
    np.testing.assert_allclose(np.cross(t, n[ok]) * eta, -np.cross(w[ok].astype(float), n[ok]), atol=10 * eps)
    assert (np.sign((t * n[ok]).sum(-1)) == -np.sign((w[ok] * n[ok]).sum(-1))).all()


def test_there_and_back():
    w, n = random_units(500, 3), random_units(500, 4)
    bent = brdf.refract(w, n, 1.4).direction
    np.testing.assert_allclose(brdf.refract(-bent, n, 1 / 1.4).direction, -w, atol=1e-12)


def test_mirrors_turn_the_part_across_the_normal():
    w, n = random_units(500, 5), random_units(500, 6)
    r = brdf.reflect(w, n)
    np.testing.assert_allclose((r * n).sum(-1), (w * n).sum(-1), atol=1e-15)
    np.testing.assert_allclose(brdf.reflect(r, n), w, atol=1e-15)


def test_an_index_out_of_domain_is_nan():
    bent = brdf.refract([0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [1.0, -1.0, np.nan])
    assert np.isnan(bent.direction[1:]).all() and np.isfinite(bent.direction[0]).all()
