"""What arrives from lights, nothing in between, in closed form."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import light as _kernels
from .kinds import Light, PointLight, _table  # noqa: F401

__all__ = ["irradiance", "polygon_irradiance", "polygon_moments"]


def oriented(points: ArrayLike, normals: ArrayLike) -> tuple[tuple[int, ...], list[Floats], np.dtype[Any]]:
    dtype = _arrays.result_dtype(points=points, normals=normals)
    named = {"points": points, "normals": normals}
    shape, flat = _arrays.broadcast({n: (_arrays.vectors(n, v, 3, dtype), 1) for n, v in named.items()})
    return shape, flat, dtype


def irradiance(light: Light, points: ArrayLike, normals: ArrayLike) -> Floats:
    """The irradiance of a light on oriented points, nothing in between, in closed form.

    Parameters
    ----------
    light : light
        Any of this chapter.
    points : array_like, shape (..., 3)
    normals : array_like, shape (..., 3)
        Unit normals.

    Returns
    -------
    ndarray, shape (..., 3)
        W/m² on the side that the normal points to, per channel. Zero at the light's own position or plane.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, or not of three components, or leading axes do not broadcast.

    Notes
    -----
    I cos θ / d², E cos θ, Lambert's formula (see `polygon_irradiance`), and disks and spheres by their rims, all
    clipped exactly at the horizon. Area lights are computed in double whatever the precision; two-sided ones shine to
    both sides, a sphere outwards alone.

    References
    ----------
    J. H. Lambert, *Photometria*, 1760.
    D. C. Hamilton, W. R. Morgan, *Radiant-interchange configuration factors*, NACA TN 2836, 1952.
    J. M. Snyder, *Area light sources for real-time graphics*, 1996.

    Examples
    --------
    >>> irradiance(PointLight((0, 2, 0), intensity=(8, 4, 0)), [0.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    array([2., 1., 0.])
    """
    packed = _table("light", light)
    shape, (points, normals), dtype = oriented(points, normals)
    out = _arrays.output("out", None, points.shape, dtype)
    _kernels.irradiance(packed, points, normals, out)
    return out.reshape(*shape, 3)


def polygon_moments(corners: ArrayLike, points: ArrayLike, normals: ArrayLike) -> Floats:
    """The integrals of powers of the cosine over what is seen of a polygon above the horizon.

    Parameters
    ----------
    corners : array_like, shape (n, 3)
        A planar polygon without self-intersection; its front is seen counter-clockwise.
    points, normals : array_like, shape (..., 3)
        Where from, with unit normals.

    Returns
    -------
    ndarray, shape (..., 7)
        ∫ cosⁿθ dω for n = 0 … 6: the solid angle, the irradiance of unit radiance, and so on. Negative where the back
        is seen.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, or the polygon has less than three corners.

    Notes
    -----
    Computed in double whatever the precision, and within 1e-15 of the exact moment, times one over the sine of the
    smallest angle between the polygon's edges and the point; so the relative error grows as one over the solid angle.
    At points in the polygon's own plane the sign of zero is a matter of rounding. About 100 ns an edge and thread.

    References
    ----------
    J. Arvo, *Applications of irradiance tensors to the simulation of non-Lambertian phenomena*, 1995.

    Examples
    --------
    >>> square = [[-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]]
    >>> bool(np.isclose(polygon_moments(square, [0, 0, 0], [0, 1, 0])[0], 4 * np.pi / 6))
    True
    """
    polygon = _arrays.vectors("corners", corners, 3, np.float64)
    if polygon.ndim != 2 or len(polygon) < 3:
        raise ValueError(f"corners: expected shape (n, 3) with n of at least 3, got {polygon.shape}")
    shape, (points, normals), dtype = oriented(points, normals)
    out = _arrays.output("out", None, (len(points), 7), dtype)
    _kernels.polygon_moments(polygon, points, normals, out)
    return out.reshape(*shape, 7)


def polygon_irradiance(corners: ArrayLike, points: ArrayLike, normals: ArrayLike) -> Floats:
    """The irradiance of a polygon of unit radiance: Lambert's formula, clipped exactly at the horizon.

    Parameters
    ----------
    corners : array_like, shape (n, 3)
        A planar polygon without self-intersection; its front is seen counter-clockwise.
    points, normals : array_like, shape (..., 3)
        Where it arrives, with unit normals.

    Returns
    -------
    ndarray, shape (...)
        W/m² for a radiance of 1 W/(m² sr); negative where the back is seen. Over π, the form factor.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, or the polygon has less than three corners.

    Notes
    -----
    The first of `polygon_moments`, whose accuracy it has.

    References
    ----------
    J. H. Lambert, *Photometria*, 1760.

    Examples
    --------
    >>> square = [[-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]]
    >>> float(polygon_irradiance(square, [0, 0, 0], [0, 1, 0]).round(6))
    1.74084
    """
    moments: Floats = polygon_moments(corners, points, normals)[..., 1]
    return moments
