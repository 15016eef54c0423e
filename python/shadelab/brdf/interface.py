"""Interfaces: Fresnel's reflectances, and Lambert's diffuser."""

from __future__ import annotations

from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import brdf as _kernels
from ._gather import _gather

__all__ = ["fresnel_schlick", "lambert"]


def fresnel_schlick(cos_theta: ArrayLike, f0: ArrayLike = 0.04, f90: ArrayLike = 1.0) -> Floats:
    """Fresnel reflectance by Schlick's polynomial f0 + (f90 − f0)(1 − cos θ)⁵.

    Parameters
    ----------
    cos_theta : array_like
        Cosine between a direction and the normal (of the mirror: wo·h), in [0, 1].
    f0, f90 : array_like
        Reflectance at normal incidence and at grazing; all three broadcast.

    Returns
    -------
    ndarray
        NaN where `cos_theta` is not in [0, 1].

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, shapes do not broadcast, or a lone number is out of [0, 1].

    Notes
    -----
    Within 2 ulp of the polynomial. Of Fresnel's equations for glass (η = 1.5, f0 = 0.04) it is within 0.04, of
    metals coarser past 60°. About 1 ns an element and thread.

    References
    ----------
    C. Schlick, *An inexpensive BRDF model for physically-based rendering*, 1994.

    Examples
    --------
    >>> fresnel_schlick([1.0, 0.5, 0.0], 0.04)
    array([0.04, 0.07, 1.  ])
    """
    shape, flat, dtype = _gather({}, {"cos_theta": cos_theta, "f0": f0, "f90": f90})
    out = _arrays.output("out", None, flat[0].shape, dtype)
    _kernels.fresnel_schlick(*flat, out)
    return out.reshape(shape)


def lambert(wi: ArrayLike, wo: ArrayLike, albedo: ArrayLike) -> Floats:
    """The perfect diffuser: albedo / π in every direction.

    Parameters
    ----------
    wi, wo : array_like, shape (..., 3)
        Unit directions to the light and to the eye, z the normal.
    albedo : array_like, shape (..., 3)
        The fraction of light given back, in [0, 1], per channel.

    Returns
    -------
    ndarray, shape (..., 3)
        BRDF in sr⁻¹; zero unless both directions are above the horizon, NaN where the albedo is out of [0, 1].

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, or not of three components, or leading axes do not broadcast.

    Notes
    -----
    Within 1 ulp. About 2 ns an element and thread. Draw with `shadelab.sampling.square_to_cosine_hemisphere`.

    References
    ----------
    J. H. Lambert, *Photometria*, 1760.

    Examples
    --------
    >>> lambert([0, 0.6, 0.8], [0, 0, 1], [1.0, 0.5, 0.0]).round(4)
    array([0.3183, 0.1592, 0.    ])
    """
    shape, flat, dtype = _gather({"wi": (wi, 3), "wo": (wo, 3), "albedo": (albedo, 3)}, {})
    out = _arrays.output("out", None, flat[0].shape, dtype)
    _kernels.lambert(*flat, out)
    return out.reshape(*shape, 3)
