"""Reflection models: evaluation, sampling, density.

Directions are unit vectors that leave the surface, in the local frame whose z is the normal: `wi` to the light, `wo`
to the eye. Values are BRDFs in sr⁻¹, without the cosine; densities are per solid angle of `wi`.
"""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays
from ._arrays import Floats
from ._kernels import brdf as _kernels

__all__ = [
    "fresnel_schlick",
    "ggx",
    "ggx_pdf",
    "ggx_sample",
    "lambert",
    "metallic_roughness",
    "metallic_roughness_pdf",
    "metallic_roughness_sample",
]

Masking: TypeAlias = Literal["height_correlated", "separable"]


def _gather(
    vectors: dict[str, tuple[ArrayLike, int]], scalars: dict[str, ArrayLike], lows: tuple[str, ...] = ()
) -> tuple[tuple[int, ...], list[Floats], np.dtype[Any]]:
    """Vectors and numbers of one element each, broadcast together in their common precision.

    `scalars` are parameters of [0, 1] (above 0 for those named in `lows`): a lone number outside is refused, an
    element of an array outside is left to the kernel, which answers NaN there.
    """
    for name, value in scalars.items():
        if np.ndim(value) == 0 and not isinstance(value, np.ndarray):
            _arrays.number(name, value, 0.0, 1.0, above=0.0 if name in lows else None)
    arrays = {n: v for n, (v, _) in vectors.items()} | scalars
    dtype = _arrays.result_dtype(**{n: v for n, v in arrays.items() if np.ndim(v)})
    core = {n: (_arrays.vectors(n, v, k, dtype), 1) for n, (v, k) in vectors.items()}
    core |= {n: (_arrays.floats(n, v, dtype), 0) for n, v in scalars.items()}
    shape, flat = _arrays.broadcast(core)
    return shape, flat, dtype


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


def ggx(
    wi: ArrayLike,
    wo: ArrayLike,
    alpha: ArrayLike,
    f0: ArrayLike = (1.0, 1.0, 1.0),
    masking: Masking = "height_correlated",
) -> Floats:
    """Reflection at rough mirrors: GGX normals, Smith's masking, Schlick's Fresnel.

    Parameters
    ----------
    wi, wo : array_like, shape (..., 3)
        Unit directions to the light and to the eye, z the normal.
    alpha : array_like, shape (...)
        Width of the distribution, in (0, 1]; the square of an artist's roughness.
    f0 : array_like, shape (..., 3)
        Reflectance at normal incidence, in [0, 1]; at grazing it is one.
    masking : {"height_correlated", "separable"}
        Smith's function for both directions together, or the product of one for each, darker at grazing.

    Returns
    -------
    ndarray, shape (..., 3)
        BRDF in sr⁻¹; zero unless both directions are above the horizon, NaN where a parameter is out of its domain.

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit, or a lone number `alpha` is out of (0, 1].

    Notes
    -----
    Relative error below 12 rounding units for alpha ≥ 1e-9 in float32 (1e-70 in float64), down to grazing cosines of
    1e-7, of the formula at the given (rounded) directions. Light that bounces twice between the mirrors is lost: at
    alpha = 1 up to 69 %. About 4 ns an element and thread.

    References
    ----------
    B. Walter, S. R. Marschner, H. Li, K. E. Torrance, *Microfacet models for refraction through rough surfaces*, 2007.
    E. Heitz, *Understanding the masking-shadowing function in microfacet-based BRDFs*, 2014.

    Examples
    --------
    >>> ggx([0, 0, 1], [0, 0, 1], 0.5).round(4)
    array([0.3183, 0.3183, 0.3183])
    """
    _arrays.choice("masking", masking, ("height_correlated", "separable"))
    shape, (wi, wo, f0, alpha), dtype = _gather(
        {"wi": (wi, 3), "wo": (wo, 3), "f0": (f0, 3)}, {"alpha": alpha}, lows=("alpha",)
    )
    out = _arrays.output("out", None, wi.shape, dtype)
    _kernels.ggx(wi, wo, alpha, f0, masking, out)
    return out.reshape(*shape, 3)


def ggx_sample(wo: ArrayLike, u: ArrayLike, alpha: ArrayLike) -> Floats:
    """Directions mirrored at the GGX normals that are visible from `wo`.

    Parameters
    ----------
    wo : array_like, shape (..., 3)
        Unit directions to the eye, above the horizon.
    u : array_like, shape (..., 2)
        In [0, 1).
    alpha : array_like, shape (...)
        Width of the distribution, in (0, 1].

    Returns
    -------
    ndarray, shape (..., 3)
        Unit directions `wi`; some lie below the horizon, where `ggx` is zero. NaN where `wo` is below the horizon.

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit, or a lone number `alpha` is out of (0, 1].

    Notes
    -----
    `ggx` times the cosine over `ggx_pdf` is at most one. About 15 ns an element and thread.

    References
    ----------
    J. Dupuy, A. Benyoub, *Sampling visible GGX normals with spherical caps*, 2023.

    Examples
    --------
    >>> ggx_sample([0.0, 0.0, 1.0], [0.0, 0.0], 0.5)
    array([0., 0., 1.])
    """
    shape, (wo, u, alpha), dtype = _gather({"wo": (wo, 3), "u": (u, 2)}, {"alpha": alpha}, lows=("alpha",))
    out = _arrays.output("out", None, wo.shape, dtype)
    _kernels.ggx_sample(wo, u, alpha, out)
    return out.reshape(*shape, 3)


def ggx_pdf(wi: ArrayLike, wo: ArrayLike, alpha: ArrayLike) -> Floats:
    """The density of `ggx_sample` per solid angle.

    Parameters
    ----------
    wi, wo : array_like, shape (..., 3)
        Unit directions; `wi` may be below the horizon.
    alpha : array_like, shape (...)
        Width of the distribution, in (0, 1].

    Returns
    -------
    ndarray, shape (...)
        Integrates to one over the whole sphere of `wi`.

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit, or a lone number `alpha` is out of (0, 1].

    Notes
    -----
    As accurate as `ggx`. About 4 ns an element and thread.

    References
    ----------
    E. Heitz, *Sampling the GGX distribution of visible normals*, 2018.

    Examples
    --------
    >>> float(ggx_pdf([0, 0, 1], [0, 0, 1], 1.0).round(4))
    0.0796
    """
    shape, (wi, wo, alpha), dtype = _gather({"wi": (wi, 3), "wo": (wo, 3)}, {"alpha": alpha}, lows=("alpha",))
    out = _arrays.output("out", None, alpha.shape, dtype)
    _kernels.ggx_pdf(wi, wo, alpha, out)
    return out.reshape(shape)


def metallic_roughness(
    wi: ArrayLike,
    wo: ArrayLike,
    base_color: ArrayLike,
    metallic: ArrayLike = 0.0,
    roughness: ArrayLike = 0.5,
    specular: ArrayLike = 1.0,
) -> Floats:
    """The material of real-time rendering: a mix of metal and of a dielectric base.

    Parameters
    ----------
    wi, wo : array_like, shape (..., 3)
        Unit directions to the light and to the eye, z the normal.
    base_color : array_like, shape (..., 3)
        Albedo of the dielectric's diffuse part, reflectance of the metal at normal incidence; linear, in [0, 1].
    metallic : array_like, shape (...)
        The metal's share, in [0, 1].
    roughness : array_like, shape (...)
        The artist's roughness in [0, 1]; its square is the `alpha` of `ggx`, no less than 1e-4.
    specular : array_like, shape (...)
        Strength of the dielectric's mirrors, in [0, 1]; 0 leaves Lambert's diffuser.

    Returns
    -------
    ndarray, shape (..., 3)
        BRDF in sr⁻¹; zero unless both directions are above the horizon, NaN where a parameter is out of [0, 1].

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit, or a lone number is out of [0, 1].

    Notes
    -----
    ``(1 - metallic) * (diffuse + mirrors(0.04 * specular)) + metallic * mirrors(base_color)``, where mirrors are `ggx`
    and ``diffuse = base_color / π * (1 - F(cos θi)) * (1 - F(cos θo))``: reciprocal, and gives back at most what came
    (glTF's factor 1 − F(wo·h) gives back more at grazing). Relative error as of `ggx`. About 6 ns an element and
    thread.

    References
    ----------
    Khronos, *glTF 2.0 specification*, 2021, appendix B; KHR_materials_specular.
    P. Shirley, B. Smits, H. Hu, E. Lafortune, *A practitioners' assessment of light reflection models*, 1997.

    Examples
    --------
    >>> metallic_roughness([0, 0, 1], [0, 0, 1], [0.8, 0.4, 0.2], metallic=0.0, roughness=1.0).round(4)
    array([0.2379, 0.1205, 0.0619])
    """
    shape, flat, dtype = _gather(
        {"wi": (wi, 3), "wo": (wo, 3), "base_color": (base_color, 3)},
        {"metallic": metallic, "roughness": roughness, "specular": specular},
    )
    out = _arrays.output("out", None, flat[0].shape, dtype)
    _kernels.metallic_roughness("eval", *flat, out)
    return out.reshape(*shape, 3)


def metallic_roughness_sample(
    wo: ArrayLike,
    u: ArrayLike,
    base_color: ArrayLike,
    metallic: ArrayLike = 0.0,
    roughness: ArrayLike = 0.5,
    specular: ArrayLike = 1.0,
) -> Floats:
    """Directions for `metallic_roughness`, from its mirrors or from the cosine, as either is the brighter.

    Parameters
    ----------
    wo : array_like, shape (..., 3)
        Unit directions to the eye, above the horizon.
    u : array_like, shape (..., 3)
        In [0, 1): two for the direction, one to choose.
    base_color, metallic, roughness, specular : array_like
        As of `metallic_roughness`.

    Returns
    -------
    ndarray, shape (..., 3)
        Unit directions `wi`; some may lie below the horizon, where the BRDF is zero. NaN where `wo` is below the
        horizon or a parameter out of [0, 1].

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit, or a lone number is out of [0, 1].

    Notes
    -----
    About 15 ns an element and thread.

    References
    ----------
    J. Dupuy, A. Benyoub, *Sampling visible GGX normals with spherical caps*, 2023.

    Examples
    --------
    >>> metallic_roughness_sample([0.0, 0.0, 1.0], [0.5, 0.5, 0.9], [0.8, 0.8, 0.8])
    array([0., 0., 1.])
    """
    shape, flat, dtype = _gather(
        {"u": (u, 3), "wo": (wo, 3), "base_color": (base_color, 3)},
        {"metallic": metallic, "roughness": roughness, "specular": specular},
    )
    out = _arrays.output("out", None, flat[1].shape, dtype)
    _kernels.metallic_roughness("sample", *flat, out)
    return out.reshape(*shape, 3)


def metallic_roughness_pdf(
    wi: ArrayLike,
    wo: ArrayLike,
    base_color: ArrayLike,
    metallic: ArrayLike = 0.0,
    roughness: ArrayLike = 0.5,
    specular: ArrayLike = 1.0,
) -> Floats:
    """The density of `metallic_roughness_sample` per solid angle.

    Parameters
    ----------
    wi, wo : array_like, shape (..., 3)
        Unit directions; `wi` may be below the horizon.
    base_color, metallic, roughness, specular : array_like
        As of `metallic_roughness`.

    Returns
    -------
    ndarray, shape (...)
        Integrates to one over the whole sphere of `wi`; zero where `wo` is below the horizon, NaN where a parameter
        is out of [0, 1].

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit, or a lone number is out of [0, 1].

    Notes
    -----
    Relative error as of `ggx`. About 5 ns an element and thread.

    Examples
    --------
    >>> float(metallic_roughness_pdf([0, 0, 1], [0, 0, 1], [0.8, 0.8, 0.8], specular=0.0).round(4))
    0.3183
    """
    shape, flat, dtype = _gather(
        {"wi": (wi, 3), "wo": (wo, 3), "base_color": (base_color, 3)},
        {"metallic": metallic, "roughness": roughness, "specular": specular},
    )
    out = _arrays.output("out", None, flat[3].shape, dtype)
    _kernels.metallic_roughness("pdf", *flat, out)
    return out.reshape(shape)
