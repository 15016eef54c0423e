"""Lines and segments: where they come nearest."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels

__all__ = ["NearestPair", "line_line", "segment_segment"]


class NearestPair(NamedTuple):
    """The nearest points of two lines or segments."""

    s: Floats
    """Parameter of the point on the first."""
    t: Floats
    """Parameter of the point on the second."""
    distance: Floats
    """Distance between the two."""
    first: Floats
    """The point on the first, shape (..., 3)."""
    second: Floats
    """The point on the second, shape (..., 3)."""
    parallel: NDArray[np.bool_]
    """Whether they are parallel, so that other pairs are as near."""


_PAIR: list[int | tuple[int, type]] = [0, 0, 0, 3, 3, (0, np.bool_)]


def line_line(
    origins_1: ArrayLike, directions_1: ArrayLike, origins_2: ArrayLike, directions_2: ArrayLike
) -> NearestPair:
    """Where pairs of lines come nearest to each other.

    Parameters
    ----------
    origins_1, directions_1 : array_like, shape (..., 3)
        The first lines, `origin + s direction`.
    origins_2, directions_2 : array_like, shape (..., 3)
        The second lines, `origin + t direction`. Leading axes broadcast.

    Returns
    -------
    NearestPair
        Parameters, distance and points. Of parallel lines, the first one's origin (`s = 0`) and the point across.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, or not of three components, or leading axes do not broadcast.

    Notes
    -----
    Computed in the promoted precision of all arguments. NaN or infinity, or a direction of no length, give NaN at that
    element; directions of every normal length are as good as unit ones.

    The cross product of the directions is computed so that nothing cancels: `parallel` says that the directions, as
    given, are so exactly. With the lines' origins at the distance `w`, meeting at the angle θ, the points on the lines
    are right to 10 machine epsilons of `w / sin θ`, and `distance` to 10 eps of `w`; lines that do meet are
    thus some eps apart. Where the origins are far from each other compared with the places of interest, move them
    there.

    References
    ----------
    R. Goldman, *Intersection of Two Lines in Three-Space*, Graphics Gems, 1990.

    Examples
    --------
    >>> pair = line_line([0, 0, 0], [1.0, 0, 0], [2, 5, 1], [0, 1.0, 0])
    >>> float(pair.s), float(pair.t), float(pair.distance), pair.second
    (2.0, -5.0, 1.0, array([2., 0., 1.]))
    """
    given = {
        "origins_1": (origins_1, 3),
        "directions_1": (directions_1, 3),
        "origins_2": (origins_2, 3),
        "directions_2": (directions_2, 3),
    }
    return NearestPair(*_arrays.elementwise(_kernels.line_line, given, _PAIR))


def segment_segment(a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike) -> NearestPair:
    """Where pairs of segments come nearest to each other.

    Parameters
    ----------
    a, b : array_like, shape (..., 3)
        Ends of the first segments.
    c, d : array_like, shape (..., 3)
        Ends of the second segments. Leading axes broadcast.

    Returns
    -------
    NearestPair
        The points `a + s (b - a)` and `c + t (d - c)` with `s` and `t` in [0, 1]. Of several nearest pairs, one with an
        end of a segment in it.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, or not of three components, or leading axes do not broadcast.

    Notes
    -----
    Computed in the promoted precision of all arguments. Parallel, overlapping and crossing segments, and segments that
    are points, need no care: no tolerance takes part. `distance` is right to 8 machine epsilons of the larger of the
    segments' lengths and their distance; `parallel` says that the differences of the ends, as rounded, are so, and is
    true of points. NaN or infinity gives NaN at that
    element.

    References
    ----------
    D. Eberly, *Robust Computation of Distance Between Line Segments*, 2018. C. Ericson, *Real-Time Collision
    Detection*, 2005, section 5.1.9.

    Examples
    --------
    >>> pair = segment_segment([0, 0, 0], [4.0, 0, 0], [1, 2, 1], [1, 5, 1])
    >>> float(pair.s), float(pair.t), pair.first
    (0.25, 0.0, array([1., 0., 0.]))
    """
    given = {"a": (a, 3), "b": (b, 3), "c": (c, 3), "d": (d, 3)}
    return NearestPair(*_arrays.elementwise(_kernels.segment_segment, given, _PAIR))
