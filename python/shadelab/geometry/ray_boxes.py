"""Rays against boxes."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels

__all__ = ["BoxDetails", "BoxHit", "ray_aabb", "ray_obb"]


class BoxHit(NamedTuple):
    """What rays have in common with boxes, in units of the direction's length."""

    t: Floats
    """The first parameter of the ray's interval that lies in the box; infinite if none does."""
    t_enter: Floats
    """Where the whole line enters; +inf if it misses."""
    t_exit: Floats
    """Where the whole line leaves; -inf if it misses."""


class BoxDetails(NamedTuple):
    """`BoxHit` with the slabs that it was made of."""

    t: Floats
    """The first parameter of the ray's interval that lies in the box; infinite if none does."""
    t_enter: Floats
    """Where the whole line enters; +inf if it misses."""
    t_exit: Floats
    """Where the whole line leaves; -inf if it misses."""
    slab_enter: Floats
    """Where the line enters the slab of each axis, shape (..., 3); the last entry is `t_enter`."""
    slab_exit: Floats
    """Where the line leaves the slab of each axis, shape (..., 3); the first exit is `t_exit`."""
    face_enter: NDArray[np.int32]
    """The face through which the line enters: 0 to 5 for +x -x +y -y +z -z; -1 for none. `face // 2` is the axis."""
    face_exit: NDArray[np.int32]
    """The face through which it leaves."""


BoxMethod = Literal["exact", "conservative", "slabs"]
_SLABS: list[Any] = [0, 0, 0, (2, 3), (2, np.int32)]


def _details(found: tuple[NDArray[Any], ...]) -> BoxDetails:
    t, enter, leave, slabs, faces = found
    return BoxDetails(t, enter, leave, slabs[..., 0, :], slabs[..., 1, :], faces[..., 0], faces[..., 1])


@overload
def ray_aabb(
    origins: ArrayLike,
    directions: ArrayLike,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    method: BoxMethod = ...,
    t_min: ArrayLike = ...,
    t_max: ArrayLike = ...,
    full_output: Literal[False] = ...,
) -> BoxHit: ...
@overload
def ray_aabb(
    origins: ArrayLike,
    directions: ArrayLike,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    method: BoxMethod = ...,
    t_min: ArrayLike = ...,
    t_max: ArrayLike = ...,
    full_output: Literal[True],
) -> BoxDetails: ...
def ray_aabb(
    origins: ArrayLike,
    directions: ArrayLike,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    method: BoxMethod = "exact",
    t_min: ArrayLike = 0.0,
    t_max: ArrayLike = np.inf,
    full_output: bool = False,
) -> BoxHit | BoxDetails:
    """Intersect rays with axis-aligned boxes.

    Parameters
    ----------
    origins, directions : array_like, shape (..., 3)
        Rays. Directions need not be of unit length.
    lower, upper : array_like, shape (..., 3)
        The boxes' corners; infinite ones are fine. Leading axes broadcast: rays `(R, 1, 3)` with boxes `(B, 3)` give
        `(R, B)`. A box whose lower corner exceeds the upper one is empty.
    method : {"exact", "conservative", "slabs"}
        Decide by the exact order of the slabs' borders; move the exit out by its rounding error, so that nothing is
        ever lost; or multiply by the inverse direction, as textbooks do. See Notes.
    t_min, t_max : float or array_like, shape (...)
        `t` lies in the closed interval, in units of the direction's length. The others are the line's.
    full_output : bool
        Give `BoxDetails`: the interval of each slab, and the faces.

    Returns
    -------
    BoxHit or BoxDetails
        Arrays of the batch's shape. From inside, `t_enter` is negative and `t` is `t_min`.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, not of its shape, or does not broadcast; a scalar interval holds NaN.

    Notes
    -----
    Computed in the promoted precision of rays and boxes. Boxes are solid and closed: rays within a face, along an edge
    or through a corner hit, and so do they with boxes of zero thickness. NaN, an infinite origin or direction, or a
    direction of no length give NaN at that element. Directions of every normal length are as good as unit ones.

    *exact*: a line hits if and only if it does in exact arithmetic, as long as products of a border's distance and the
    smallest component of the (scaled) direction do not fall below the normal numbers. `t_enter` and `t_exit` are right
    to one machine epsilon of their size. *conservative* never loses a box, and finds some that are missed by as little
    as 4 eps: what a hierarchy of boxes asks for. *slabs* errs by a rounding either way, and for rays within a face it
    meets 0 · ∞ = NaN, which drops the ray or the slab by luck: it is here to be compared with.

    References
    ----------
    T. Ize, *Robust BVH Ray Traversal*, JCGT 2(2), 2013. T. Kay, J. Kajiya, *Ray Tracing Complex Scenes*, SIGGRAPH 1986.

    Examples
    --------
    >>> hit = ray_aabb([-1, 0, 0.5], [2.0, 0, 0], [0, 0, 0], [1, 1, 1], full_output=True)
    >>> float(hit.t), float(hit.t_exit), int(hit.face_enter), hit.slab_enter
    (0.5, 1.0, 1, array([ 0.5, -inf, -inf]))
    """
    _arrays.choice("method", method, ("exact", "conservative", "slabs"))
    given = {"origins": (origins, 3), "directions": (directions, 3), "lower": (lower, 3), "upper": (upper, 3)}
    knobs = {"t_min": t_min, "t_max": t_max}
    full = _arrays.flag("full_output", full_output)
    out = _SLABS if full else _SLABS[:3]
    found = _arrays.elementwise(_kernels.ray_aabb, given, out, method, full, knobs=knobs)
    return _details(found) if full else BoxHit(*found)


@overload
def ray_obb(
    origins: ArrayLike,
    directions: ArrayLike,
    centers: ArrayLike,
    axes: ArrayLike,
    half_extents: ArrayLike,
    *,
    t_min: ArrayLike = ...,
    t_max: ArrayLike = ...,
    full_output: Literal[False] = ...,
) -> BoxHit: ...
@overload
def ray_obb(
    origins: ArrayLike,
    directions: ArrayLike,
    centers: ArrayLike,
    axes: ArrayLike,
    half_extents: ArrayLike,
    *,
    t_min: ArrayLike = ...,
    t_max: ArrayLike = ...,
    full_output: Literal[True],
) -> BoxDetails: ...
def ray_obb(
    origins: ArrayLike,
    directions: ArrayLike,
    centers: ArrayLike,
    axes: ArrayLike,
    half_extents: ArrayLike,
    *,
    t_min: ArrayLike = 0.0,
    t_max: ArrayLike = np.inf,
    full_output: bool = False,
) -> BoxHit | BoxDetails:
    """Intersect rays with oriented boxes.

    Parameters
    ----------
    origins, directions : array_like, shape (..., 3)
        Rays. Directions need not be of unit length.
    centers : array_like, shape (..., 3)
        The boxes' centres. Leading axes broadcast.
    axes : array_like, shape (..., 3, 3)
        The boxes' axes as orthonormal rows. The box is the set of points `center + x @ axes` with `|x| <=
        half_extents`.
    half_extents : array_like, shape (..., 3)
        Half the box's size along each axis; zero is flat, a negative one gives NaN.
    t_min, t_max : float or array_like, shape (...)
        `t` lies in the closed interval, in units of the direction's length. The others are the line's.
    full_output : bool
        Give `BoxDetails`: the interval of each slab, and the faces, numbered along the box's own axes.

    Returns
    -------
    BoxHit or BoxDetails
        Arrays of the batch's shape. From inside, `t_enter` is negative and `t` is `t_min`.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, not of its shape, or does not broadcast; a scalar interval holds NaN.

    Notes
    -----
    Computed in the promoted precision of rays and boxes. Boxes are solid and closed. The axes are taken as they are:
    where they are not quite orthonormal, the slabs `|axes @ (p - center)| <= half_extents` are meant. Each border of a
    slab is right to 4 machine epsilons of its own `t`, however far the box is from the origin of the ray or the scene;
    so the answer is right unless the line passes an edge within 8 eps of `t`. Rays are parallel to a slab only if they
    are exactly. NaN, infinity, or a direction of no length give NaN at that element.

    References
    ----------
    T. Akenine-Möller, E. Haines et al., *Real-Time Rendering*, 4th edition, 2018, section 22.7.1.

    Examples
    --------
    >>> hit = ray_obb([0, 3, 0], [0, -1.0, 0], [0, 0, 0], [[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]], [1, 1, 1])
    >>> float(hit.t)
    1.75
    """
    given: dict[str, tuple[ArrayLike, _arrays.Core]] = {
        "origins": (origins, 3),
        "directions": (directions, 3),
        "centers": (centers, 3),
        "axes": (axes, (3, 3)),
        "half_extents": (half_extents, 3),
    }
    knobs = {"t_min": t_min, "t_max": t_max}
    full = _arrays.flag("full_output", full_output)
    out = _SLABS if full else _SLABS[:3]
    found = _arrays.elementwise(_kernels.ray_obb, given, out, full, knobs=knobs)
    return _details(found) if full else BoxHit(*found)
