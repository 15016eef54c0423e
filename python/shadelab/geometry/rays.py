"""Rays against primitives."""

from __future__ import annotations

from typing import Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels

__all__ = ["PlaneDetails", "RayHit", "SphereDetails", "SphereHit", "ray_plane", "ray_sphere", "ray_triangle"]


class RayHit(NamedTuple):
    """Where rays meet triangles; `t` infinite and `u`, `v` zero where they do not."""

    t: Floats
    """Distance in units of the direction's length."""
    u: Floats
    """Weight of the vertex `b`."""
    v: Floats
    """Weight of the vertex `c`."""


def ray_triangle(
    origins: ArrayLike,
    directions: ArrayLike,
    a: ArrayLike,
    b: ArrayLike,
    c: ArrayLike,
    *,
    method: Literal["watertight", "moller_trumbore", "plane"] = "watertight",
    t_min: ArrayLike = 0.0,
    t_max: ArrayLike = np.inf,
) -> RayHit:
    """Intersect rays with triangles, one with one.

    Parameters
    ----------
    origins, directions : array_like, shape (..., 3)
        Rays. Directions need not be of unit length.
    a, b, c : array_like, shape (..., 3)
        The triangles' vertices, in either winding. Leading axes broadcast.
    method : {"watertight", "moller_trumbore", "plane"}
        Edge functions in the ray's frame, which no ray slips past between triangles that share an edge; Cramer's
        rule on the edges; or the plane's point, then barycentrics. See Notes.
    t_min, t_max : float or array_like, shape (...)
        Hits lie in the open interval, in units of the direction's length.

    Returns
    -------
    RayHit
        `t`, `u`, `v` of the batch's shape: the point is `(1 - u - v) a + u b + v c`, and `origin + t direction`.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, not of its shape, or does not broadcast; a scalar interval holds NaN.

    Notes
    -----
    Computed in the promoted precision of rays and triangles. Borders count as inside; rays in the triangle's plane
    miss, and so do rays at triangles without area, unless they pass within round-off of them. NaN or infinity in a
    ray or a triangle, or a direction of no length, gives NaN at that element. Directions of any normal length are
    as good as unit ones. On triangles of good shape, met at 30 degrees or more, `t` is right to 5 machine epsilons
    of the distance.

    *watertight* decides by the exact sign of its edge functions on vertices that are off by at most
    `3.5 eps (|a - o|)`, alike for every triangle that shares them: rays at edges and vertices of a closed mesh always
    hit. The others round each triangle by itself; at edges some rays in a million pass between, and on slivers more.
    All weights lose digits as the triangle's longest edge over its height. *moller_trumbore* costs least: about
    45 ns a ray and thread in float32, *plane* 60 and *watertight* 75. Coordinates beyond 1e18 in float32 (1e150 in
    float64) overflow, and miss; so do triangles with edges below 1e-18 (1e-150) by the two others, whose products of
    edges then vanish.

    References
    ----------
    S. Woop, C. Benthin, I. Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013. T. Möller, B. Trumbore,
    *Fast, Minimum Storage Ray/Triangle Intersection*, Journal of Graphics Tools 2(1), 1997. D. Badouel, *An Efficient
    Ray-Polygon Intersection*, Graphics Gems, 1990.

    Examples
    --------
    >>> hit = ray_triangle([0.25, 0.5, 2.0], [0, 0, -1.0], [0, 0, 0], [1, 0, 0], [0, 1, 0])
    >>> float(hit.t), float(hit.u), float(hit.v)
    (2.0, 0.25, 0.5)
    """
    _arrays.choice("method", method, ("watertight", "moller_trumbore", "plane"))
    given = {"origins": (origins, 3), "directions": (directions, 3), "a": (a, 3), "b": (b, 3), "c": (c, 3)}
    knobs = {"t_min": t_min, "t_max": t_max}
    return RayHit(*_arrays.elementwise(_kernels.ray_triangle, given, [0, 0, 0], method, knobs=knobs))


class SphereHit(NamedTuple):
    """Where rays meet spheres, in units of the direction's length."""

    t: Floats
    """The first crossing of the surface within the interval; infinite if there is none."""
    t_near: Floats
    """Where the whole line enters; +inf if it misses."""
    t_far: Floats
    """Where the whole line leaves; -inf if it misses."""


class SphereDetails(NamedTuple):
    """`SphereHit` with what the method computed on its way."""

    t: Floats
    """The first crossing of the surface within the interval; infinite if there is none."""
    t_near: Floats
    """Where the whole line enters; +inf if it misses."""
    t_far: Floats
    """Where the whole line leaves; -inf if it misses."""
    t_closest: Floats
    """Where the line is nearest to the centre."""
    distance: Floats
    """The line's distance from the centre."""
    discriminant: Floats
    """The square of half the chord, `radius**2 - distance**2`; negative where the line misses."""


SphereMethod = Literal["robust", "quadratic", "geometric"]


@overload
def ray_sphere(
    origins: ArrayLike,
    directions: ArrayLike,
    centers: ArrayLike,
    radii: ArrayLike,
    *,
    method: SphereMethod = ...,
    t_min: ArrayLike = ...,
    t_max: ArrayLike = ...,
    full_output: Literal[False] = ...,
) -> SphereHit: ...
@overload
def ray_sphere(
    origins: ArrayLike,
    directions: ArrayLike,
    centers: ArrayLike,
    radii: ArrayLike,
    *,
    method: SphereMethod = ...,
    t_min: ArrayLike = ...,
    t_max: ArrayLike = ...,
    full_output: Literal[True],
) -> SphereDetails: ...
def ray_sphere(
    origins: ArrayLike,
    directions: ArrayLike,
    centers: ArrayLike,
    radii: ArrayLike,
    *,
    method: SphereMethod = "robust",
    t_min: ArrayLike = 0.0,
    t_max: ArrayLike = np.inf,
    full_output: bool = False,
) -> SphereHit | SphereDetails:
    """Intersect rays with spheres.

    Parameters
    ----------
    origins, directions : array_like, shape (..., 3)
        Rays. Directions need not be of unit length.
    centers : array_like, shape (..., 3)
        The spheres' centres. Leading axes broadcast: rays `(R, 1, 3)` with centres `(S, 3)` give `(R, S)`.
    radii : array_like, shape (...)
        Their radii; 0 is a point, and a negative radius gives NaN.
    method : {"robust", "quadratic", "geometric"}
        The discriminant from the perpendicular vector; the quadratic equation as in textbooks; Pythagoras. See Notes.
    t_min, t_max : float or array_like, shape (...)
        `t` lies in the open interval, in units of the direction's length. `t_near` and `t_far` are the line's.
    full_output : bool
        Give `SphereDetails`: the nearest point, its distance from the centre and the discriminant as well.

    Returns
    -------
    SphereHit or SphereDetails
        Arrays of the batch's shape. From inside, `t_near` is negative and `t` is `t_far`. A line that touches has
        `t_near = t_far`.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, not of its shape, or does not broadcast; a scalar interval holds NaN.

    Notes
    -----
    Computed in the promoted precision of rays and spheres. NaN or infinity in a ray or a sphere, or a direction of no
    length, gives NaN at that element. Offsets, radii and directions of every normal size are as good as unit ones.

    *robust* carries the rounding errors of `origin - center`, of the perpendicular vector and of the origin's power.
    Its discriminant is right to 4 machine epsilons of the squared radius at any distance up to a million radii, so a
    line is decided wrongly only if it passes within 4 eps of the radius from touching. For lines with a chord of a
    radius or more both roots are right to 4 eps of their own size, and 4 eps² of the radius: origins one rounding off
    the surface are told apart. It costs about twice the others. (`discriminant` is in squared units of length, which
    leave single precision beyond sizes of 1e19 and 1e-19; the roots do not.)

    *quadratic* and *geometric* take the difference of squared distances: the discriminant is off by some eps times
    the squared distance of the centre, so that in float32 spheres fray at 100 radii and dissolve at 4000. Near the
    surface they leave `t_near` off by some eps of the radius, whatever its size: the self-intersections of ray tracers.

    References
    ----------
    E. Haines, J. Günther, T. Akenine-Möller, *Precision Improvements for Ray/Sphere Intersection*, in *Ray Tracing
    Gems*, 2019. T. Akenine-Möller, E. Haines et al., *Real-Time Rendering*, 4th edition, 2018, section 22.6.

    Examples
    --------
    >>> hit = ray_sphere([0, 0, 3.0], [0, 0, -1.0], [0, 0, 0], 1.0)
    >>> float(hit.t), float(hit.t_near), float(hit.t_far)
    (2.0, 2.0, 4.0)
    """
    _arrays.choice("method", method, ("robust", "quadratic", "geometric"))
    given = {"origins": (origins, 3), "directions": (directions, 3), "centers": (centers, 3), "radii": (radii, 0)}
    knobs = {"t_min": t_min, "t_max": t_max}
    full = _arrays.flag("full_output", full_output)
    out = [0] * (6 if full else 3)
    found = _arrays.elementwise(_kernels.ray_sphere, given, out, method, full, knobs=knobs)
    return SphereDetails(*found) if full else SphereHit(*found)


class PlaneDetails(NamedTuple):
    """Where rays meet planes, and how."""

    t: Floats
    """Where the ray meets the plane within its interval; infinite if it does not."""
    t_line: Floats
    """Where the whole line does; infinite if it is parallel."""
    distance: Floats
    """The origin's distance from the plane, positive on the side that the normal points to."""
    cosine: Floats
    """The cosine between ray and normal: 0 parallel to the plane, negative towards its front."""


@overload
def ray_plane(
    origins: ArrayLike,
    directions: ArrayLike,
    planes: ArrayLike,
    *,
    t_min: ArrayLike = ...,
    t_max: ArrayLike = ...,
    full_output: Literal[False] = ...,
) -> Floats: ...
@overload
def ray_plane(
    origins: ArrayLike,
    directions: ArrayLike,
    planes: ArrayLike,
    *,
    t_min: ArrayLike = ...,
    t_max: ArrayLike = ...,
    full_output: Literal[True],
) -> PlaneDetails: ...
def ray_plane(
    origins: ArrayLike,
    directions: ArrayLike,
    planes: ArrayLike,
    *,
    t_min: ArrayLike = 0.0,
    t_max: ArrayLike = np.inf,
    full_output: bool = False,
) -> Floats | PlaneDetails:
    """Intersect rays with planes, from either side.

    Parameters
    ----------
    origins, directions : array_like, shape (..., 3)
        Rays. Directions need not be of unit length.
    planes : array_like, shape (..., 4)
        Planes `n · x + d = 0` as `(n, d)`; normals need not be of unit length. Leading axes broadcast. The plane
        through a point `p` has `d = -n · p`.
    t_min, t_max : float or array_like, shape (...)
        Hits lie in the open interval, in units of the direction's length.
    full_output : bool
        Give `PlaneDetails`.

    Returns
    -------
    ndarray, shape (...), or PlaneDetails
        `t`, infinite where the ray misses: points away, is parallel, or lies in the plane.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, not of its shape, or does not broadcast; a scalar interval holds NaN.

    Notes
    -----
    Computed in the promoted precision of rays and planes. `t` is right to 4 machine epsilons of itself for the plane as
    given, however far from the origin, and however flat the ray: sums are carried on with the errors of their rounding.
    Rays are parallel only if they are exactly. `d = -n · p` is itself rounded, by some eps of `|n| |p|`: far from the
    origin that moves the plane. NaN or infinity, a normal or a direction of no length give NaN at that element.

    References
    ----------
    T. Ogita, S. M. Rump, S. Oishi, *Accurate Sum and Dot Product*, SIAM Journal on Scientific Computing 26, 2005.

    Examples
    --------
    >>> float(ray_plane([0, 3, 0], [0, -2.0, 0], [0, 1, 0, -1]))
    1.0
    """
    given = {"origins": (origins, 3), "directions": (directions, 3), "planes": (planes, 4)}
    knobs = {"t_min": t_min, "t_max": t_max}
    full = _arrays.flag("full_output", full_output)
    out = [0] * (4 if full else 1)
    found = _arrays.elementwise(_kernels.ray_plane, given, out, full, knobs=knobs)
    return PlaneDetails(*found) if full else found[0]
