"""Rays against implicit surfaces: polynomials, and functions of the user's."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels

__all__ = ["ImplicitHit", "quadric_polynomial", "ray_implicit", "torus_polynomial"]

Field = Callable[[Any], Any]
_MOST_SAMPLES = 1_000_000


class ImplicitHit(NamedTuple):
    """Where rays meet implicit surfaces."""

    t: Floats
    """Where the ray first meets the surface, in units of the direction's length; infinite if it does not."""
    normal: Floats
    """The unit vector along the function's gradient there, shape (..., 3); NaN where there is none."""
    value: Floats
    """What is left of the function there; NaN where there is no hit."""
    crossings: NDArray[np.int32]
    """How often the surface was met within the interval: all roots of a polynomial, the sign changes seen of a
    function."""


def quadric_polynomial(matrix: ArrayLike) -> Floats:
    """Give the coefficients of a quadric `p^T M p = 0`, p = (x, y, z, 1).

    Parameters
    ----------
    matrix : array_like, shape (4, 4)
        The quadric's matrix; only its symmetric part counts.

    Returns
    -------
    ndarray, shape (3, 3, 3)
        Coefficients `c[i, j, k]` of `x^i y^j z^k`, for `ray_implicit`.

    Raises
    ------
    TypeError, ValueError
        If the matrix is not real, or not 4 by 4.

    Examples
    --------
    >>> ball = quadric_polynomial(np.diag([1, 1, 1, -4.0]))
    >>> float(ray_implicit([0, 0, 5], [0, 0, -1.0], ball))
    3.0
    """
    m = _arrays.matrices("matrix", matrix, 4, np.float64)
    if m.ndim != 2:
        raise ValueError(f"matrix: expected shape (4, 4), got {m.shape}")
    c = np.zeros((3, 3, 3))
    exponents = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]])
    for row in range(4):
        for column in range(4):
            i, j, k = exponents[row] + exponents[column]
            c[i, j, k] += m[row, column]
    return c


def torus_polynomial(radius: float = 1.0, tube: float = 0.4) -> Floats:
    """Give the coefficients of a torus about the y axis, `(|p|² + R² - r²)² = 4 R² (x² + z²)`.

    Parameters
    ----------
    radius : float
        From the axis to the centre of the tube, R.
    tube : float
        Radius of the tube, r.

    Returns
    -------
    ndarray, shape (5, 5, 5)
        Coefficients `c[i, j, k]` of `x^i y^j z^k`, for `ray_implicit`; negative inside.

    Raises
    ------
    TypeError, ValueError
        If a radius is not a positive number.

    Examples
    --------
    >>> float(ray_implicit([5, 0, 0], [-1.0, 0, 0], torus_polynomial(2.0, 0.5)))
    2.5
    """
    big, small = _arrays.number("radius", radius, above=0), _arrays.number("tube", tube, above=0)
    c = np.zeros((5, 5, 5))
    squares = np.array([[2, 0, 0], [0, 2, 0], [0, 0, 2], [0, 0, 0]])
    factors = [1.0, 1.0, 1.0, (big - small) * (big + small)]
    for a in range(4):
        for b in range(4):
            i, j, k = squares[a] + squares[b]
            c[i, j, k] += factors[a] * factors[b]
    c[2, 0, 0] -= 4 * big * big
    c[0, 0, 2] -= 4 * big * big
    return c


@overload
def ray_implicit(
    origins: ArrayLike,
    directions: ArrayLike,
    surface: Field | ArrayLike,
    *,
    t_min: ArrayLike = ...,
    t_max: ArrayLike = ...,
    samples: int = ...,
    lipschitz: float | None = ...,
    full_output: Literal[False] = ...,
) -> Floats: ...
@overload
def ray_implicit(
    origins: ArrayLike,
    directions: ArrayLike,
    surface: Field | ArrayLike,
    *,
    t_min: ArrayLike = ...,
    t_max: ArrayLike = ...,
    samples: int = ...,
    lipschitz: float | None = ...,
    full_output: Literal[True],
) -> ImplicitHit: ...
def ray_implicit(
    origins: ArrayLike,
    directions: ArrayLike,
    surface: Field | ArrayLike,
    *,
    t_min: ArrayLike = 0.0,
    t_max: ArrayLike = np.inf,
    samples: int = 256,
    lipschitz: float | None = None,
    full_output: bool = False,
) -> Floats | ImplicitHit:
    """Intersect rays with the zeros of a function of space.

    Parameters
    ----------
    origins, directions : array_like, shape (..., 3)
        Rays. Directions need not be of unit length. Leading axes broadcast.
    surface : array_like, shape (l, m, n), or callable
        Coefficients `c[i, j, k]` of `x^i y^j z^k`, as `numpy.polynomial.polynomial.polyval3d` takes them, of degree 24
        at most; `quadric_polynomial` and `torus_polynomial` make some. Or a function that takes points (N, 3) in the
        rays' precision and gives N values.
    t_min, t_max : float or array_like, shape (...)
        Hits lie in the open interval, in units of the direction's length. With a callable `t_max` must be finite.
    samples : int
        With a callable: steps of equal length in which the interval is searched for a change of sign; a million at
        most.
    lipschitz : float, optional
        With a callable: a bound of its slope, at any point and direction (1 for a distance). The ray then advances by
        `|value| / lipschitz`, and no root can be stepped over; `samples` is the largest number of steps.
    full_output : bool
        Give `ImplicitHit`: the normal, the value that is left and the number of crossings.

    Returns
    -------
    ndarray, shape (...), or ImplicitHit
        `t`, infinite where the ray misses.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, not of its shape, or does not broadcast; the polynomial is constant or of too high a
        degree, or holds NaN; an interval is infinite with a callable; the callable does not give one number a point.

    Notes
    -----
    *Polynomials* are solved in double precision whatever that of the rays: no root is missed but where two come so near
    that rounding cannot tell them apart, which then count as one, and as one where rounding cannot tell whether the
    line touches. A simple root where the surface is met at a fair angle is right to some thousand roundings for a
    torus, fewer for quadrics; roots of multiplicity k have `1 / k` of the digits. The degree decides the cost: a
    torus takes some fifty to a hundred times as long as `ray_sphere`. Polynomials live about the origin: bring rays
    there, rather than expanding a polynomial about a distant centre.

    *Callables*, sampled: a surface that is entered and left within one step, or touched, is missed; so is any at which
    the function does not change its sign. A pole is taken for a root. Where the sign changes, bisection made faster
    by inverse quadratic interpolation holds the root to 2 machine epsilons of `t`, as far as the function's own
    rounding allows. *Callables with a bound* miss nothing but what is thinner than some roundings of the interval, and
    rays that need more steps (grazing ones do); a bound that is too small voids that. The normal is the difference
    quotient over the cube root of a machine epsilon.

    NaN or infinity in a ray, or a direction of no length, give NaN at that element; values of NaN are no change of
    sign.

    References
    ----------
    G. Collins, R. Loos, *Polynomial Real Root Isolation by Differentiation*, SYMSAC 1976. J. C. Hart, *Sphere Tracing*,
    The Visual Computer 12, 1996. T. R. Chandrupatla, *A New Hybrid Quadratic/Bisection Algorithm for Finding the Zero
    of a Nonlinear Function without Using Derivatives*, Advances in Engineering Software 28, 1997.

    Examples
    --------
    >>> def gyroid(p):
    ...     x, y, z = p.T
    ...     return np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
    >>> t = ray_implicit([-1.0, 0, 0.5], [1.0, 0.2, 0.1], gyroid, t_max=10)
    >>> p = np.array([[-1, 0, 0.5]]) + t * np.array([[1.0, 0.2, 0.1]])
    >>> bool(abs(gyroid(p)[0]) < 1e-12)
    True
    """
    dtype = _arrays.result_dtype(origins=origins, directions=directions)
    core = {n: (_arrays.vectors(n, v, 3, dtype), 1) for n, v in (("origins", origins), ("directions", directions))}
    core |= {n: (_arrays.knob_array(n, v, dtype), 0) for n, v in (("t_min", t_min), ("t_max", t_max))}
    shape, rays = _arrays.broadcast(core)
    n, full = rays[2].shape[0], _arrays.flag("full_output", full_output)
    found = (np.empty(n, dtype), np.empty((n, 3), dtype), np.empty(n, dtype), np.zeros(n, np.int32))
    if callable(surface):
        steps = _arrays.count("samples", samples, 1, _MOST_SAMPLES)
        bound = None if lipschitz is None else _arrays.number("lipschitz", lipschitz, above=0)
        for name, limits in (("t_min", rays[2]), ("t_max", rays[3])):
            if np.isinf(limits).any():
                raise ValueError(f"{name}: expected finite intervals with a callable surface, got infinite ones")
        _search(_Along(surface, rays[0], rays[1]), rays[2], rays[3], steps, bound, found, full)
    else:
        _kernels.ray_implicit(*_polynomial(surface), rays, list(found))
    t, normal, value, crossings = found
    if not full:
        return t.reshape(shape)
    return ImplicitHit(t.reshape(shape), normal.reshape((*shape, 3)), value.reshape(shape), crossings.reshape(shape))


def _polynomial(surface: ArrayLike) -> tuple[Floats, tuple[int, ...]]:
    c = _arrays.floats("surface", surface, np.float64)
    if c.ndim != 3:
        raise ValueError(f"surface: expected a callable or coefficients of shape (l, m, n), got {c.shape}")
    if not np.isfinite(c).all():
        raise ValueError("surface: expected finite coefficients, got NaN or infinity")
    degree = max((int(sum(at)) for at in np.argwhere(c)), default=0)
    limit = _kernels.ray_implicit_degree()
    if not 1 <= degree <= limit:
        raise ValueError(f"surface: expected a polynomial of degree 1 to {limit}, got {degree}")
    return c.reshape(-1), c.shape


class _Along:
    """A user's function along rays."""

    def __init__(self, surface: Field, origins: Floats, directions: Floats) -> None:
        self.surface, self.origins, self.directions = surface, origins, directions

    def at(self, points: Floats) -> Floats:
        values = _arrays.array("surface", self.surface(points))
        if values.shape != points.shape[:1]:
            n = points.shape[0]
            raise ValueError(f"surface: expected {n} values for points {points.shape}, got {values.shape}")
        return _arrays.floats("surface", values, points.dtype)

    def __call__(self, rays: NDArray[np.intp], t: Floats) -> Floats:
        return self.at(self.origins[rays] + t[:, None] * self.directions[rays])


def _search(
    along: _Along,
    low: Floats,
    high: Floats,
    steps: int,
    bound: float | None,
    found: tuple[Floats, Floats, Floats, NDArray[np.int32]],
    full_output: bool,
) -> None:
    """Bracket the first change of sign, then close in on it."""
    t, normal, value, crossings = found
    normal[...], value[...] = np.nan, np.nan
    proper = np.isfinite(along.origins).all(-1) & np.isfinite(along.directions).all(-1) & along.directions.any(-1)
    proper &= ~(np.isnan(low) | np.isnan(high))
    t[...] = np.where(proper, np.inf, np.nan)
    rays = np.flatnonzero(proper & (high > low))
    if bound is None:
        brackets = _sample(along, rays, low, high, steps, crossings, full_output)
    else:
        brackets = _advance(along, rays, low, high, steps, bound, crossings)
    if not brackets[0].size:
        return
    hit, a, b, fa, fb = brackets
    root = _close_in(along, hit, a, b, fa, fb)
    within = (root > low[hit]) & (root < high[hit])
    crossings[hit[~within]] = 0
    hit, root = hit[within], root[within]
    t[hit] = root
    if full_output and hit.size:
        value[hit] = along(hit, root)
        normal[hit] = _normals(along, along.origins[hit] + root[:, None] * along.directions[hit])


Brackets = tuple[NDArray[np.intp], Floats, Floats, Floats, Floats]


def _sample(
    along: _Along, rays: Any, low: Floats, high: Floats, steps: int, crossings: NDArray[np.int32], every: bool
) -> Brackets:
    """Brackets of the first changes of sign over equal steps; all are counted if asked for."""
    parts: list[Brackets] = []
    before_t = low[rays]
    before = along(rays, before_t) if rays.size else before_t
    for step in range(1, steps + 1):
        if not rays.size:
            break
        share = low.dtype.type(step / steps)
        now_t = low[rays] + share * (high[rays] - low[rays]) if step < steps else high[rays]
        now = along(rays, now_t)
        # A zero at a sample ends the step before it; one at the start is not in the open interval.
        changed = (np.sign(before) * np.sign(now) < 0) | ((now == 0) & (before != 0) & ~np.isnan(before))
        first = changed & (crossings[rays] == 0)
        parts.append((rays[first], before_t[first], now_t[first], before[first], now[first]))
        crossings[rays[changed]] += 1
        kept = np.ones(rays.size, bool) if every else ~changed
        # Past a zero the sign is that of the next value: only a change from there on counts.
        rays, before_t, before = rays[kept], now_t[kept], now[kept]
    if not parts:
        return (np.empty(0, np.intp), *(np.empty(0, low.dtype) for _ in range(4)))  # type: ignore[return-value]
    return tuple(np.concatenate(x) for x in zip(*parts, strict=True))  # type: ignore[return-value]


def _advance(
    along: _Along, rays: Any, low: Floats, high: Floats, steps: int, bound: float, crossings: NDArray[np.int32]
) -> Brackets:
    """Brackets found by steps that no root is shorter than."""
    parts: list[Brackets] = []
    t = low[rays]
    speed = (bound * np.linalg.norm(along.directions[rays].astype(np.float64), axis=-1)).astype(low.dtype)
    eps = np.finfo(low.dtype).eps
    before = along(rays, t) if rays.size else t
    for _ in range(steps):
        if not rays.size:
            break
        # At least some roundings ahead, so that a root is passed and seen by the change of sign.
        step = np.maximum(np.abs(before) / speed, 4 * eps * np.maximum(np.abs(t), high[rays] - low[rays]))
        now_t = np.minimum(t + step, high[rays])
        now = along(rays, now_t)
        met = (np.sign(before) * np.sign(now) < 0) | ((now == 0) & (before != 0))
        parts.append((rays[met], t[met], now_t[met], before[met], now[met]))
        crossings[rays[met]] = 1
        kept = ~met & (now_t < high[rays]) & ~np.isnan(now)
        rays, t, speed, before = rays[kept], now_t[kept], speed[kept], now[kept]
    if not parts:
        return (np.empty(0, np.intp), *(np.empty(0, low.dtype) for _ in range(4)))  # type: ignore[return-value]
    return tuple(np.concatenate(x) for x in zip(*parts, strict=True))  # type: ignore[return-value]


def _close_in(along: _Along, rays: Any, a: Floats, b: Floats, fa: Floats, fb: Floats) -> Floats:
    """Chandrupatla's method on all brackets together: `b` the newest point, `a` across the root, `c` the one before."""
    eps = np.finfo(a.dtype).eps
    a, b, fa, fb = b.copy(), a.copy(), fb.copy(), fa.copy()
    c, fc = a.copy(), fa.copy()
    share = np.full_like(a, 0.5)
    best = np.where(np.abs(fa) < np.abs(fb), a, b)
    active = np.arange(a.size)
    for _ in range(200):
        k = active
        t = b[k] + share[k] * (a[k] - b[k])
        f = along(rays[k], t)
        same = np.sign(f) == np.sign(fb[k])
        c[k], fc[k] = np.where(same, b[k], a[k]), np.where(same, fb[k], fa[k])
        a[k], fa[k] = np.where(same, a[k], b[k]), np.where(same, fa[k], fb[k])
        b[k], fb[k] = t, f
        best[k] = np.where(np.abs(fa[k]) < np.abs(f), a[k], t)
        width = np.abs(b[k] - a[k])
        tolerance = eps * np.abs(best[k]) + np.finfo(a.dtype).tiny
        open_ = (width > 2 * tolerance) & (f != 0) & (fa[k] != 0)
        active = k[open_]
        if not active.size:
            break
        k = active
        with np.errstate(all="ignore"):
            xi, phi = (b[k] - a[k]) / (c[k] - a[k]), (fb[k] - fa[k]) / (fc[k] - fa[k])
            fits = (phi**2 < xi) & ((1 - phi) ** 2 < 1 - xi)
            inner = fb[k] / (fa[k] - fb[k]) * fc[k] / (fa[k] - fc[k])
            outer = (c[k] - b[k]) / (a[k] - b[k]) * fb[k] / (fc[k] - fb[k]) * fa[k] / (fc[k] - fa[k])
            quadratic = inner + outer
        edge = np.minimum(0.5, tolerance[open_] / width[open_])
        share[k] = np.clip(np.where(fits & np.isfinite(quadratic), quadratic, 0.5), edge, 1 - edge)
    return best


def _normals(along: _Along, points: Floats) -> Floats:
    """Central differences, normalised."""
    step = np.cbrt(np.finfo(points.dtype).eps) * np.maximum(1, np.abs(points).max(-1))
    gradient = np.empty_like(points)
    for axis in range(3):
        ahead, behind = points.copy(), points.copy()
        ahead[:, axis] += step
        behind[:, axis] -= step
        gradient[:, axis] = along.at(ahead) - along.at(behind)
    with np.errstate(invalid="ignore"):
        return gradient / np.linalg.norm(gradient, axis=-1, keepdims=True)
