"""Facets: their normals, how they hide each other, and the light that they throw at each other."""

from __future__ import annotations

from typing import Literal, NamedTuple, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import brdf as _kernels
from ._numbers import LEAST, MOST

__all__ = [
    "AlbedoTable",
    "KullaConty",
    "albedo_table",
    "kulla_conty",
    "masking_shadowing",
    "ndf",
]

Shape: TypeAlias = Literal["ggx", "beckmann"]
Form: TypeAlias = Literal["height_correlated", "separable", "schlick", "v_cavity"]
SHAPES = ("ggx", "beckmann")
FORMS = ("height_correlated", "separable", "schlick", "v_cavity")


def ndf(
    normals: ArrayLike,
    alpha: ArrayLike,
    distribution: Literal["ggx", "beckmann", "gtr"] = "ggx",
    *,
    alpha_y: ArrayLike | None = None,
    gamma: ArrayLike = 2.0,
) -> Floats:
    """The distribution D of the normals of microscopic facets.

    Parameters
    ----------
    normals : array_like, shape (..., 3)
        Unit normals of facets (half vectors), z the normal of the surface.
    alpha : array_like
        Width (along x), in (0, 1].
    distribution : {"ggx", "beckmann", "gtr"}
        GTR is the family ``(alpha² cos² + sin²) ** -gamma``: GGX at 2, Berry's at 1.
    alpha_y : array_like, optional
        Width along y where it differs (not for GTR).
    gamma : array_like
        Exponent of GTR.

    Returns
    -------
    ndarray, shape (...)
        Density per solid angle, in sr⁻¹, of area of facets over area of surface: the integral of D times the cosine
        over the hemisphere is one. Zero at and below the horizon; NaN where alpha is out of (0, 1].

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit, a distribution is unknown, or GTR is asked for two widths.

    Notes
    -----
    GTR comes near Beckmann's distribution for large `gamma` only where alpha is small. GGX holds to a few units of the
    last place for alpha down to 1e-9 in float32.

    References
    ----------
    B. Walter and others, *Microfacet models for refraction through rough surfaces*, 2007; B. Burley, *Physically based
    shading at Disney*, 2012.

    Examples
    --------
    >>> ndf([0, 0, 1], [0.5, 1.0]).round(4)
    array([1.2732, 0.3183])
    """
    _arrays.choice("distribution", distribution, ("ggx", "beckmann", "gtr"))
    if distribution == "gtr" and alpha_y is not None:
        raise ValueError("alpha_y: GTR has one width")
    given: dict[str, tuple[ArrayLike, int]] = {"normals": (normals, 3)}
    knobs = {"alpha": alpha, "alpha_y": alpha if alpha_y is None else alpha_y, "gamma": gamma}
    return _arrays.elementwise(_kernels.ndf, given, [0], distribution, knobs=knobs)[0]


def masking_shadowing(
    wi: ArrayLike,
    wo: ArrayLike,
    alpha: ArrayLike,
    distribution: Shape = "ggx",
    masking: Form = "height_correlated",
    *,
    alpha_y: ArrayLike | None = None,
) -> Floats:
    """The share G of facets that both directions see.

    Parameters
    ----------
    wi, wo : array_like, shape (..., 3)
        Unit directions to the light and to the eye, z the normal.
    alpha : array_like
        Width (along x), in (0, 1].
    distribution : {"ggx", "beckmann"}
    masking : {"height_correlated", "separable", "schlick", "v_cavity"}
        Smith's for both together, or the product of one for each; Schlick's rational form of that; grooves.
    alpha_y : array_like, optional
        Width along y where it differs.

    Returns
    -------
    ndarray, shape (...)
        In [0, 1]; zero unless both are above the horizon; NaN where alpha is out of (0, 1].

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit or a name is unknown.

    Notes
    -----
    Beckmann's is Walter's rational form, within 0.35 % of the exact one. Schlick's takes k = alpha / 2. Grooves do not
    know alpha. Smith's forms follow from the distribution; the height-correlated one is the larger, most where both
    directions graze.

    References
    ----------
    E. Heitz, *Understanding the masking-shadowing function in microfacet-based BRDFs*, 2014.

    Examples
    --------
    >>> masking_shadowing([[0.8, 0, 0.6]], [[-0.8, 0, 0.6]], 0.5, masking="separable").round(4)
    array([0.8251])
    """
    _arrays.choice("distribution", distribution, SHAPES)
    _arrays.choice("masking", masking, FORMS)
    given: dict[str, tuple[ArrayLike, int]] = {"wi": (wi, 3), "wo": (wo, 3)}
    knobs = {"alpha": alpha, "alpha_y": alpha if alpha_y is None else alpha_y}
    return _arrays.elementwise(_kernels.masking_shadowing, given, [0], distribution, masking, knobs=knobs)[0]


class KullaConty(NamedTuple):
    """The light of further bounces, and what it is made of."""

    value: Floats
    """The added lobe in sr⁻¹: `shape` times `color`."""
    shape: Floats
    """(1 − E(θi)) (1 − E(θo)) / (π (1 − E_avg))."""
    color: Floats
    """The factor of the reflectance."""
    albedo_i: Floats
    """E(θi): what one bounce gives back of light along `wi`."""
    albedo_o: Floats
    """E(θo)."""
    average: Floats
    """E_avg, over the hemisphere."""


@overload
def kulla_conty(
    wi: ArrayLike,
    wo: ArrayLike,
    alpha: ArrayLike,
    fresnel: ArrayLike = ...,
    *,
    color: Literal["bounces", "as_published"] = ...,
    distribution: Shape = ...,
    masking: Form = ...,
    full_output: Literal[False] = ...,
) -> Floats: ...
@overload
def kulla_conty(
    wi: ArrayLike,
    wo: ArrayLike,
    alpha: ArrayLike,
    fresnel: ArrayLike = ...,
    *,
    color: Literal["bounces", "as_published"] = ...,
    distribution: Shape = ...,
    masking: Form = ...,
    full_output: Literal[True],
) -> KullaConty: ...
def kulla_conty(
    wi: ArrayLike,
    wo: ArrayLike,
    alpha: ArrayLike,
    fresnel: ArrayLike = 1.0,
    *,
    color: Literal["bounces", "as_published"] = "bounces",
    distribution: Shape = "ggx",
    masking: Form = "height_correlated",
    full_output: bool = False,
) -> Floats | KullaConty:
    """The lobe that gives back the light which microscopic mirrors throw at each other.

    Parameters
    ----------
    wi, wo : array_like, shape (..., 3)
        Unit directions to the light and to the eye, z the normal.
    alpha : array_like
        Width of the distribution, in (0, 1].
    fresnel : array_like
        The average reflectance (see `fresnel_average`), in [0, 1].
    color : {"bounces", "as_published"}
        ``F² E / (1 − F (1 − E))``, the light that has met two mirrors or more; or ``F E / (1 − F (1 − E))`` as the
        slides first had it, a bounce of colour too few. Both are one at F = 1.
    distribution : {"ggx", "beckmann"}
    masking : {"height_correlated", "separable", "schlick", "v_cavity"}
        Of the single bounce, whose loss this makes good.
    full_output : bool
        Give `KullaConty`: shape, colour and albedos as well.

    Returns
    -------
    ndarray, shape (...), or KullaConty
        In sr⁻¹, to be added to the single bounce; zero unless both directions are above the horizon.

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit or a name is unknown.

    Notes
    -----
    The albedo of one bounce is interpolated in a table of 32 × 32 that the first call makes (`albedo_table`, about 0.1
    s). With it a perfect mirror (F = 1) gives back all light within 0.2 % on the average.

    References
    ----------
    C. Kulla, A. Conty, *Revisiting physically based shading at Imageworks*, 2017; S. Hill, *A multi-faceted
    exploration*, 2018.

    Examples
    --------
    >>> kulla_conty([0, 0, 1], [0, 0, 1], [1.0]).round(2)
    array([0.26])
    """
    _arrays.choice("color", color, ("bounces", "as_published"))
    _arrays.choice("distribution", distribution, SHAPES)
    _arrays.choice("masking", masking, FORMS)
    found = _arrays.elementwise(
        _kernels.kulla_conty,
        {"wi": (wi, 3), "wo": (wo, 3)},
        [0] * 5,
        distribution,
        masking,
        color == "as_published",
        knobs={"alpha": alpha, "fresnel": fresnel},
    )
    shape, albedo_i, albedo_o, average, factor = found
    result = KullaConty(shape * factor, shape, factor, albedo_i, albedo_o, average)
    return result if _arrays.flag("full_output", full_output) else result.value


class AlbedoTable(NamedTuple):
    """What one bounce gives back of light, of perfect mirrors or of rough glass."""

    albedo: Floats
    """(32, 32): rows by alpha, columns by the cosine."""
    average: Floats
    """(32,) over the hemisphere, by alpha."""
    knots: Floats
    """(32,) the alphas of rows and the cosines of columns."""


def albedo_table(
    distribution: Shape = "ggx", masking: Form = "height_correlated", *, eta: float | None = None
) -> AlbedoTable:
    """What one bounce gives back, by width and cosine: the table behind energy compensation.

    Parameters
    ----------
    distribution : {"ggx", "beckmann"}
    masking : {"height_correlated", "separable", "schlick", "v_cavity"}
        Of reflection; what is refracted takes Smith's separable form, or the product of what two V-cavities show.
    eta : float, optional
        Of rough glass, light reflected and passed together: index across the interface over that on the side of the
        light, in [1e-9, 1e9]. None is the perfect mirror of `kulla_conty`.

    Returns
    -------
    AlbedoTable
        In double.

    Raises
    ------
    TypeError, ValueError
        If a name is unknown, or `eta` out of its domain.

    Notes
    -----
    Made by quadrature over drawn normals, once a program: the mirror's in about 0.1 s, of glass the two slabs about an
    index when it is first asked for. Between the 64 slabs on either side of η = 1 tables are
    interpolated: averages are within 0.0015, of alpha from 1e-4 on.

    Examples
    --------
    >>> round(float(1 - albedo_table().average[-1]), 2)
    0.59
    >>> [round(float(1 - albedo_table(masking="separable", eta=n).average[-1]), 2) for n in (1.5, 1 / 1.5)]
    [0.25, 0.56]
    """
    _arrays.choice("distribution", distribution, SHAPES)
    _arrays.choice("masking", masking, FORMS)
    eta = None if eta is None else _arrays.number("eta", eta, LEAST, MOST)
    return AlbedoTable(*(np.asarray(part) for part in _kernels.albedo_table(distribution, masking, eta)))
