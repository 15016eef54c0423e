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
