"""What is wrong with a shadow, measured against a reference: acne, and shadows that do not begin at their caster."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats

__all__ = ["acne", "detached", "detached_gap"]


def _fractions(**given: ArrayLike) -> list[Floats]:
    """Lit fractions of one shape, in double."""
    arrays = [_arrays.floats(name, value, np.float64) for name, value in given.items()]
    if any(a.shape != arrays[0].shape for a in arrays):
        shapes = ", ".join(f"{name}: {a.shape}" for name, a in zip(given, arrays, strict=True))
        raise ValueError(f"expected arrays of one shape, got {shapes}")
    return arrays


def _tolerance(value: Any) -> float:
    return _arrays.number("tolerance", value, 0.0, below=1.0)


def acne(lit: ArrayLike, reference: ArrayLike, *, tolerance: float = 0.0) -> float:
    """The share of what is lit in the reference that a technique darkens.

    Parameters
    ----------
    lit, reference : array_like, shape (...)
        Lit fractions by the technique, and of the reference (`ray_traced`).
    tolerance : float
        How much less than all of the light counts as all of it.

    Returns
    -------
    float
        In [0, 1]; NaN where the reference is lit nowhere. Elements that are NaN in either do not count.

    Raises
    ------
    TypeError, ValueError
        If shapes differ, or the tolerance is not in [0, 1).

    Notes
    -----
    Not only moiré on lit surfaces counts, but all false darkness: a shadow edge that is off by half a texel too. To see
    the former alone, leave the neighbourhood of edges out. One pass over the arrays.

    References
    ----------
    L. Williams, *Casting Curved Shadows on Curved Surfaces*, 1978, who shows it.

    Examples
    --------
    >>> acne([1.0, 0.0, 1.0, 0.0], [1.0, 1.0, 1.0, 0.0]).__round__(3)
    0.333
    """
    dark, exact = _fractions(lit=lit, reference=reference)
    slack = _tolerance(tolerance)
    bright = (exact >= 1.0 - slack) & ~np.isnan(dark)
    return float((dark[bright] < 1.0 - slack).mean()) if bright.any() else float("nan")


def detached(lit: ArrayLike, reference: ArrayLike, *, tolerance: float = 0.0) -> float:
    """The share of what is dark in the reference that a technique lights: detached shadows and leaks.

    Parameters
    ----------
    lit, reference : array_like, shape (...)
        Lit fractions by the technique, and of the reference (`ray_traced`).
    tolerance : float
        How much light counts as none.

    Returns
    -------
    float
        In [0, 1]; NaN where the reference is dark nowhere. Elements that are NaN in either do not count.

    Raises
    ------
    TypeError, ValueError
        If shapes differ, or the tolerance is not in [0, 1).

    Notes
    -----
    The counterpart of `acne`: biases trade one for the other. One pass over the arrays.

    References
    ----------
    W. Reeves, D. Salesin, R. Cook, *Rendering Antialiased Shadows with Depth Maps*, 1987.

    Examples
    --------
    >>> detached([1.0, 0.0, 1.0, 0.0], [1.0, 1.0, 0.0, 0.0])
    0.5
    """
    bright, exact = _fractions(lit=lit, reference=reference)
    slack = _tolerance(tolerance)
    dark = (exact <= slack) & ~np.isnan(bright)
    return float((bright[dark] > slack).mean()) if dark.any() else float("nan")


def detached_gap(
    lit: ArrayLike, reference: ArrayLike, receivers: ArrayLike, *, tolerance: float = 0.5
) -> NDArray[np.float64]:
    """How far from where it should a shadow begins, along lines of receivers away from the caster.

    Parameters
    ----------
    lit, reference : array_like, shape (..., n)
        Lit fractions along each line, by the technique and of the reference (`ray_traced`).
    receivers : array_like, shape (..., n, 3)
        The points of each line, in order, beginning where the caster stands.
    tolerance : float
        The lit fraction from which on a point counts as lit.

    Returns
    -------
    ndarray, shape (...)
        Length in world units from the first point that is dark in the reference to the first one from there on that is
        dark by the technique; to the end of the reference's shadow if there is none before. 0 where the reference is
        lit all along.

    Raises
    ------
    TypeError, ValueError
        If shapes do not agree, or the tolerance is not in [0, 1).

    Notes
    -----
    Known to the distance between two points of a line. A constant bias b detaches the shadow of a wall by b times the
    tangent of the light's angle to the ground's normal. One pass over the arrays.

    References
    ----------
    W. Reeves, D. Salesin, R. Cook, *Rendering Antialiased Shadows with Depth Maps*, 1987.

    Examples
    --------
    >>> import numpy as np
    >>> line = np.linspace([0.0, 0, 0], [1.0, 0, 0], 5)
    >>> detached_gap([1.0, 1, 0, 0, 1], [1.0, 0, 0, 0, 1], line)
    array(0.25)
    """
    mine, exact = _fractions(lit=lit, reference=reference)
    points = _arrays.vectors("receivers", receivers, 3, np.float64)
    if points.shape[:-1] != mine.shape or mine.ndim == 0:
        raise ValueError(f"receivers: expected shape {(*mine.shape, 3)} of lines, got {points.shape}")
    slack = _tolerance(tolerance)
    n = mine.shape[-1]
    if n == 0:
        return np.zeros(mine.shape[:-1])
    steps = np.linalg.norm(np.diff(points, axis=-2), axis=-1)
    along = np.concatenate([np.zeros((*mine.shape[:-1], 1)), np.cumsum(steps, -1)], -1)
    places = np.arange(n)
    dark = exact <= slack
    begin = np.where(dark.any(-1), dark.argmax(-1), n)[..., None]
    # The end of the stretch of darkness that begins there.
    after = ~dark & (places > begin)
    end = np.where(after.any(-1), after.argmax(-1), n - 1)[..., None]
    found = (mine <= slack) & (places >= begin) & (places <= end)
    first = np.where(found.any(-1)[..., None], found.argmax(-1)[..., None], end)
    clipped = np.minimum(begin, n - 1)
    gap = (np.take_along_axis(along, first, -1) - np.take_along_axis(along, clipped, -1))[..., 0]
    return np.asarray(np.where(begin[..., 0] < n, gap, 0.0))
