"""What models give back: by direction, on the average, and of any light."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from ._model import Model

__all__ = ["directional_albedo", "reflected_radiance", "white_furnace"]

# Draws at a time: some 100 MB of them.
BATCH = 1 << 20


def reflected_radiance(
    model: Model,
    wo: ArrayLike,
    radiance: Callable[[Floats], ArrayLike],
    samples: int = 4096,
    *,
    seed: int = 0,
) -> Floats:
    """The radiance that a surface sends to the eye: the integral of value, radiance and cosine over directions.

    Parameters
    ----------
    model : Model
        Of lone numbers.
    wo : array_like, shape (..., 3)
        Unit directions to the eye.
    radiance : callable
        Takes directions (n, 3), gives radiance (n,), (n, 3) or one number.
    samples : int
        Draws of the model for each direction.
    seed : int
        Of the scramble of their Sobol' points.

    Returns
    -------
    ndarray, shape (..., 3)
        An estimate whose error falls faster than 1/√samples where the radiance is smooth.

    Raises
    ------
    TypeError, ValueError
        If an argument does not fit.

    References
    ----------
    J. T. Kajiya, *The rendering equation*, 1986.

    Examples
    --------
    >>> from shadelab import brdf
    >>> reflected_radiance(brdf.Diffuse(0.5), [0, 0, 1], lambda w: w[:, 2], 1024).round(3)
    array([0.333, 0.333, 0.333])
    """
    if not isinstance(model, Model):
        raise TypeError(f"model: expected a Model, got {type(model).__name__}")
    if not callable(radiance):
        raise TypeError(f"radiance: expected a callable, got {type(radiance).__name__}")
    samples = _arrays.count("samples", samples, 1, 1 << 22)
    wo = _arrays.vectors("wo", wo)
    flat = wo.reshape(-1, 3)
    # Here, since scenes of models need no sequences: a tenth of a first picture's imports.
    from .. import sampling

    u = sampling.sobol(samples, 3, seed=seed).astype(flat.dtype)
    # Rounding to single may reach one.
    u = np.minimum(u, np.nextafter(flat.dtype.type(1), flat.dtype.type(0)))
    out = np.empty((len(flat), 3), flat.dtype)
    step = max(1, BATCH // samples)
    for at in range(0, len(flat), step):
        some = flat[at : at + step]
        draws = model.sample(np.repeat(some, samples, 0), np.tile(u, (len(some), 1)))
        light = np.asarray(radiance(draws.wi))
        light = light[:, None] if light.ndim == 1 else light
        brought = np.where(draws.weight == 0, 0, draws.weight * light)
        out[at : at + step] = brought.reshape(len(some), samples, 3).mean(1, dtype=np.float64)
    return out.reshape(wo.shape)


def directional_albedo(model: Model, wo: ArrayLike, samples: int = 4096, *, seed: int = 0) -> Floats:
    """The part of light along a direction that a model gives back to the whole hemisphere, or to the sphere.

    Parameters
    ----------
    model : Model
        Of lone numbers.
    wo : array_like, shape (..., 3)
        Unit directions.
    samples : int
        Draws for each direction.
    seed : int
        Of the scramble of their Sobol' points.

    Returns
    -------
    ndarray, shape (..., 3)
        Of reciprocal models at most one. Of models that transmit it counts radiance: what crosses is divided by the
        square of the index that it meets.

    Raises
    ------
    TypeError, ValueError
        If an argument does not fit.

    Examples
    --------
    >>> from shadelab import brdf
    >>> directional_albedo(brdf.RoughConductor(1.0, 1e-9, 1e9), [0, 0, 1]).round(2)
    array([0.31, 0.31, 0.31])
    """
    return reflected_radiance(model, wo, lambda w: 1.0, samples, seed=seed)


def white_furnace(model: Model, directions: int = 64, samples: int = 4096, *, seed: int = 0) -> Floats:
    """The light that a model loses in a furnace: one less its albedo, averaged by the cosine.

    Parameters
    ----------
    model : Model
        Opaque, of lone numbers.
    directions : int
        Cosines at which the albedo is taken (Gauss and Legendre's).
    samples : int
        Draws for each.
    seed : int
        Of the scramble of their Sobol' points.

    Returns
    -------
    ndarray, shape (3,)
        Zero if all comes back; negative if more.

    Raises
    ------
    TypeError, ValueError
        If an argument does not fit.

    Notes
    -----
    Anisotropic models are taken along x alone.

    Examples
    --------
    >>> from shadelab import brdf
    >>> white_furnace(brdf.RoughConductor(0.25, 1e-9, 1e9)).round(2)
    array([0.12, 0.12, 0.12])
    """
    directions = _arrays.count("directions", directions, 1, 4096)
    x, weight = np.polynomial.legendre.leggauss(directions)
    cosine = (x + 1) / 2
    wo = np.stack([np.sqrt(1 - cosine * cosine), np.zeros_like(cosine), cosine], -1)
    albedo = directional_albedo(model, wo, samples, seed=seed)
    return np.asarray(1 - (albedo * (weight * cosine)[:, None]).sum(0))
