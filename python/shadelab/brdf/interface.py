"""Interfaces: reflected and refracted directions, Fresnel's reflectances; Lambert's diffuser."""

from __future__ import annotations

from typing import Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import brdf as _kernels
from ._gather import lanewise

__all__ = [
    "Fresnel",
    "Refracted",
    "fresnel",
    "fresnel_average",
    "fresnel_schlick",
    "half_lambert",
    "lambert",
    "reflect",
    "refract",
]


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
    metals coarser past 60°. About 2 ns a float32 element on one thread (AVX2).

    References
    ----------
    C. Schlick, *An inexpensive BRDF model for physically-based rendering*, 1994.

    Examples
    --------
    >>> fresnel_schlick([1.0, 0.5, 0.0], 0.04)
    array([0.04, 0.07, 1.  ])
    """
    return lanewise(_kernels.fresnel_schlick, {}, {"cos_theta": cos_theta, "f0": f0, "f90": f90}, result=0)


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
    Within 1 ulp. About 5 ns a float32 element on one thread (AVX2). Draw with
    `shadelab.sampling.square_to_cosine_hemisphere`.

    References
    ----------
    J. H. Lambert, *Photometria*, 1760.

    Examples
    --------
    >>> lambert([0, 0.6, 0.8], [0, 0, 1], [1.0, 0.5, 0.0]).round(4)
    array([0.3183, 0.1592, 0.    ])
    """
    return lanewise(_kernels.lambert, {"wi": (wi, 3), "wo": (wo, 3), "albedo": (albedo, 3)}, {})


def half_lambert(wi: ArrayLike, albedo: ArrayLike = 1.0, *, exponent: ArrayLike = 2.0) -> Floats:
    """Shading that reaches round the terminator: (cos θ / 2 + 1/2)ⁿ, in place of the cosine.

    Parameters
    ----------
    wi : array_like, shape (..., 3)
        Unit directions to the light, z the normal.
    albedo : array_like
        A factor.
    exponent : array_like
        2 as in its first use; 1 is plain wrapping.

    Returns
    -------
    ndarray, shape (...)
        What takes the place of albedo times the cosine: one towards the normal, zero only against it.

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit.

    Notes
    -----
    A look, no reflection model: it lights what faces away, and gives back more than came.

    References
    ----------
    J. Mitchell, G. McTaggart, C. Green, *Shading in Valve's Source engine*, 2006.

    Examples
    --------
    >>> half_lambert([[0, 0, 1], [1, 0, 0], [0, 0, -1]])
    array([1.  , 0.25, 0.  ])
    """
    dtype = _arrays.result_dtype(wi=wi)
    cosine = _arrays.vectors("wi", wi, 3, dtype)[..., 2]
    numbers = {"cosine of wi": (cosine, 0), "albedo": (_arrays.floats("albedo", albedo, dtype), 0)}
    _arrays.broadcast(numbers | {"exponent": (_arrays.floats("exponent", exponent, dtype), 0)})
    wrapped = np.clip(cosine * dtype.type(0.5) + dtype.type(0.5), 0, None)
    with np.errstate(all="ignore"):
        power = wrapped ** _arrays.floats("exponent", exponent, dtype)
        return np.asarray(power * _arrays.floats("albedo", albedo, dtype))


def reflect(w: ArrayLike, normal: ArrayLike) -> Floats:
    """Mirror directions about normals: 2 (w·n) n − w.

    Parameters
    ----------
    w : array_like, shape (..., 3)
        Directions that leave the surface.
    normal : array_like, shape (..., 3)
        Unit normals, on either side.

    Returns
    -------
    ndarray, shape (..., 3)
        As long as `w`.

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit.

    Notes
    -----
    Shading languages take the direction that arrives, −w, and give the same.

    Examples
    --------
    >>> reflect([0.6, 0.8, 0], [0, 1, 0])
    array([-0.6,  0.8,  0. ])
    """
    return _arrays.elementwise(_kernels.reflect, {"w": (w, 3), "normal": (normal, 3)}, [3])[0]


class Refracted(NamedTuple):
    """Directions across a surface."""

    direction: Floats
    """Unit if `w` was, shape (..., 3); NaN where all is reflected."""
    total: NDArray[np.bool_]
    """Where all is reflected."""


def refract(w: ArrayLike, normal: ArrayLike, eta: ArrayLike) -> Refracted:
    """Bend directions by Snell's law.

    Parameters
    ----------
    w : array_like, shape (..., 3)
        Unit directions that leave the surface: light comes along −w.
    normal : array_like, shape (..., 3)
        Unit normals, on either side.
    eta : array_like
        Index of refraction beyond the surface over that on the side of `w`; above 0.

    Returns
    -------
    Refracted
        Where the light goes, and where all is reflected instead.

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit.

    Notes
    -----
    Right to a few units of the last place for unit vectors, at η = 1 ± 1e-7 as well: no difference of nearly equal
    numbers is taken. Shading languages take the inverse of `eta`.

    Examples
    --------
    >>> bent = refract([0.6, 0.8, 0], [0, 1, 0], [1.5, 0.5])
    >>> bent.direction.round(4), bent.total
    (array([[-0.4   , -0.9165, -0.    ],
           [    nan,     nan,     nan]]), array([False,  True]))
    """
    given: dict[str, tuple[ArrayLike, int]] = {"w": (w, 3), "normal": (normal, 3)}
    return Refracted(*_arrays.elementwise(_kernels.refract, given, [3, (0, np.bool_)], knobs={"eta": eta}))


class Fresnel(NamedTuple):
    """Reflectances of an interface."""

    unpolarized: Floats
    s: Floats
    """Of light that swings across the plane of incidence."""
    p: Floats
    """Of light that swings in it."""
    cos_t: Floats
    """Cosine of the refracted ray: 0 where all is reflected, and for metals."""


@overload
def fresnel(
    cos_theta: ArrayLike, eta: ArrayLike = ..., k: ArrayLike | None = ..., *, full_output: Literal[False] = ...
) -> Floats: ...
@overload
def fresnel(
    cos_theta: ArrayLike, eta: ArrayLike = ..., k: ArrayLike | None = ..., *, full_output: Literal[True]
) -> Fresnel: ...
def fresnel(
    cos_theta: ArrayLike, eta: ArrayLike = 1.5, k: ArrayLike | None = None, *, full_output: bool = False
) -> Floats | Fresnel:
    """Reflectance of a smooth interface by Fresnel's equations.

    Parameters
    ----------
    cos_theta : array_like
        Cosine between a direction and the normal, in [0, 1].
    eta : array_like
        Index of refraction of the body that light meets over that of the one it is in; above 0.
    k : array_like, optional
        Extinction of a metal, whose index is η + ik; None is a clear body.
    full_output : bool
        Give `Fresnel`: both polarisations, and the cosine of the refracted ray.

    Returns
    -------
    ndarray, or Fresnel
        Of unpolarised light; NaN where `cos_theta` is not in [0, 1], `eta` not in (0, 1e9], or `k` not in [0, 1e9].

    Raises
    ------
    TypeError, ValueError
        If shapes do not broadcast, or a lone number is NaN.

    Notes
    -----
    Clear bodies keep their digits at η = 1 ± 1e-7 and at the critical angle: within 16 units of the last place of the
    larger polarisation. At η = 1 nothing is reflected.

    References
    ----------
    M. Born, E. Wolf, *Principles of Optics*, 1999, sections 1.5 and 14.2.

    Examples
    --------
    >>> fresnel([1.0, 0.5, 0.0]).round(4)
    array([0.04  , 0.0892, 1.    ])
    >>> fresnel([1.0], 0.2, 3.9).round(4)
    array([0.952])
    """
    if k is None:
        given: dict[str, tuple[ArrayLike, int]] = {"cos_theta": (cos_theta, 0)}
        s, p, cos_t = _arrays.elementwise(_kernels.fresnel_dielectric, given, [0, 0, 0], knobs={"eta": eta})
    else:
        given = {"cos_theta": (cos_theta, 0)}
        s, p = _arrays.elementwise(_kernels.fresnel_conductor, given, [0, 0], knobs={"eta": eta, "k": k})
        cos_t = np.zeros_like(s)
    average = np.asarray((s + p) * s.dtype.type(0.5))
    return Fresnel(average, s, p, cos_t) if _arrays.flag("full_output", full_output) else average


def fresnel_average(
    eta: ArrayLike | None = None,
    k: ArrayLike | None = None,
    *,
    f0: ArrayLike | None = None,
    f90: ArrayLike = 1.0,
) -> Floats:
    """The part of diffuse light that an interface reflects: twice the integral of F(c) c over [0, 1].

    Parameters
    ----------
    eta : array_like, optional
        Index of refraction of the body that light meets over that of the one it is in; above 0.
    k : array_like, optional
        Extinction of a metal, whose index is η + ik.
    f0, f90 : array_like
        In place of `eta`: Schlick's polynomial of these.

    Returns
    -------
    ndarray
        In closed form for clear bodies and for Schlick's polynomial, where it is (20 f0 + f90) / 21; by quadrature for
        metals.

    Raises
    ------
    TypeError, ValueError
        If both or neither of `eta` and `f0` are given, or shapes do not broadcast.

    Notes
    -----
    Computed in double. Within 1e-9 of clear bodies, and within 1e-7 of metals.

    References
    ----------
    W. G. Egan, T. Hilgeman, J. Reichman, *Determination of absorption and scattering coefficients for nonhomogeneous
    media*, 1973.

    Examples
    --------
    >>> fresnel_average([1.5, 1 / 1.5]).round(4), fresnel_average(f0=[0.04]).round(4)
    (array([0.0918, 0.5963]), array([0.0857]))
    """
    if (eta is None) == (f0 is None):
        raise ValueError("eta: expected either an index or f0")
    if f0 is not None:
        low, high = _arrays.floats("f0", f0), _arrays.floats("f90", f90)
        return np.asarray((20 * low + high) / 21, low.dtype)
    assert eta is not None
    if k is None:
        return _arrays.elementwise(_kernels.fresnel_average_dielectric, {"eta": (eta, 0)}, [0])[0]
    return _arrays.elementwise(_kernels.fresnel_average_conductor, {"eta": (eta, 0), "k": (k, 0)}, [0])[0]
