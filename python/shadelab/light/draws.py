"""Directions towards lights, drawn from the unit square, and their densities."""

from __future__ import annotations

from typing import Literal, NamedTuple, TypeAlias

from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import light as _kernels
from .kinds import AreaLight, RectLight, area_table  # noqa: F401

__all__ = ["LightSample", "light_pdf", "light_sample"]


Method: TypeAlias = Literal["area", "solid_angle"]


def _evenly(method: str) -> bool:
    return _arrays.choice("method", method, ("area", "solid_angle")) == "solid_angle"


class LightSample(NamedTuple):
    """Points on a light as seen from elsewhere."""

    wi: Floats
    """Unit directions towards the light, (..., 3); zero where the density is."""
    distance: Floats
    """To the light; infinite for ambient light, zero where the density is."""
    pdf: Floats
    """Density per solid angle; zero where the light does not shine."""


def light_sample(light: AreaLight, points: ArrayLike, u: ArrayLike, *, method: Method = "area") -> LightSample:
    """Directions to points drawn on a light.

    Parameters
    ----------
    light : RectLight, DiskLight, SphereLight, PolygonLight or AmbientLight
    points : array_like, shape (..., 3)
        Where the light is seen from.
    u : array_like, shape (..., 2)
        In [0, 1); leading axes broadcast with those of `points`.
    method : {"area", "solid_angle"}
        How rectangles and polygons draw: evenly over their area, or over the solid angle in which they are seen.

    Returns
    -------
    LightSample
        Directions, distances, densities per solid angle.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, `light` has no area, or `method` is unknown.

    Notes
    -----
    Rectangles, disks and polygons draw evenly over their area, with the density distance² / (area · cos θ), θ at the
    light: to 12 rounding units, times one over that cosine. Spheres draw evenly over the cone in which they are seen,
    so that every direction has one density; ambient light draws evenly over all directions. By solid angle rectangles
    and polygons have one density as well, so that a sample near a large light carries no more than others; disks have
    no such map here and draw over their area.

    References
    ----------
    P. Shirley, C. Wang, K. Zimmerman, *Monte Carlo techniques for direct lighting calculations*, 1996.
    C. Ureña, M. Fajardo, A. King, *An area-preserving parametrization for spherical rectangles*, 2013.
    J. Arvo, *Stratified sampling of spherical triangles*, 1995.

    Examples
    --------
    >>> light = RectLight((0, 2, 0), (1, 0, 0), (0, 0, 1))
    >>> light_sample(light, [0.0, 0.0, 0.0], [0.5, 0.5])
    LightSample(wi=array([0., 1., 0.]), distance=array(2.), pdf=array(4.))
    """
    packed = area_table(light)
    dtype = _arrays.result_dtype(points=points, u=u)
    core = {"points": (_arrays.vectors("points", points, 3, dtype), 1), "u": (_arrays.vectors("u", u, 2, dtype), 1)}
    shape, (points, u) = _arrays.broadcast(core)
    n = len(points)
    wi, distance, pdf = (_arrays.output("out", None, s, dtype) for s in ((n, 3), (n,), (n,)))
    _kernels.light_sample(packed, _evenly(method), points, u, (wi, distance, pdf))
    return LightSample(wi.reshape(*shape, 3), distance.reshape(shape), pdf.reshape(shape))


def light_pdf(light: AreaLight, points: ArrayLike, wi: ArrayLike, *, method: Method = "area") -> Floats:
    """The density of `light_sample` per solid angle.

    Parameters
    ----------
    light : RectLight, DiskLight, SphereLight, PolygonLight or AmbientLight
    points : array_like, shape (..., 3)
        Where the light is seen from.
    wi : array_like, shape (..., 3)
        Unit directions.
    method : {"area", "solid_angle"}
        As of `light_sample`.

    Returns
    -------
    ndarray, shape (...)
        Zero where a direction misses the light or meets a side that does not shine.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, `light` has no area, or `method` is unknown.

    Examples
    --------
    >>> float(light_pdf(RectLight((0, 2, 0), (1, 0, 0), (0, 0, 1)), [0.0, 0.0, 0.0], [0.0, 1.0, 0.0]))
    4.0
    """
    packed = area_table(light)
    dtype = _arrays.result_dtype(points=points, wi=wi)
    core = {"points": (_arrays.vectors("points", points, 3, dtype), 1), "wi": (_arrays.vectors("wi", wi, 3, dtype), 1)}
    shape, (points, wi) = _arrays.broadcast(core)
    out = _arrays.output("out", None, (len(points),), dtype)
    _kernels.light_pdf(packed, _evenly(method), points, wi, out)
    return out.reshape(shape)
