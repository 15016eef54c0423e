"""Samples from densities given as functions, and the densities that parametrisations owe."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from ._arguments import function, many
from .generators import Generator

__all__ = ["Manifold", "Rejection", "inverse_transform", "manifold_density", "rejection_sample"]

Map: TypeAlias = Callable[[NDArray[np.float64]], ArrayLike]


class Manifold(NamedTuple):
    """A parametrisation at given parameters."""

    density: NDArray[np.float64]
    """Per measure of the manifold (length, area, volume), shape (...)."""
    stretch: NDArray[np.float64]
    """√det(JᵀJ): the manifold's measure per measure of the parameters, shape (...)."""
    jacobian: NDArray[np.float64]
    """Shape (..., n, k)."""
    points: NDArray[np.float64]
    """Shape (..., n)."""


def manifold_density(
    mapping: Map, parameters: ArrayLike, density: ArrayLike = 1.0, *, jacobian: Map | None = None, step: float = 1e-3
) -> Manifold:
    """The density on a curve, surface or volume of points whose parameters have a given density.

    Parameters
    ----------
    mapping : callable
        From parameters (m, k) in double to points (m, n), n ≥ k.
    parameters : array_like, shape (..., k)
        Where.
    density : array_like, shape (...)
        Of the parameters: 1 on the unit square.
    jacobian : callable, optional
        From parameters (m, k) to derivatives (m, n, k); else by differences.
    step : float
        Of the differences.

    Returns
    -------
    Manifold
        `density` over √det(JᵀJ), Gram's determinant of the derivatives; that root; J; the points.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain, or a callable gives another shape.

    Notes
    -----
    A map is uniform where `stretch` is constant, and a density p of points asks the parameters for the density p times
    `stretch`. The root is the product of the singular values, so nothing is squared; where it is zero (a pole) the
    density is infinite. Differences are of sixth order and right to some 1e-11 for maps that are smooth and of order 1
    within three steps; parameters at seams are differenced across them.

    References
    ----------
    M. Spivak, *Calculus on Manifolds*, 1965, chapter 5.

    Examples
    --------
    >>> from shadelab.sampling import square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf
    >>> found = manifold_density(square_to_cosine_hemisphere, [0.3, 0.9])
    >>> bool(np.isclose(found.density, square_to_cosine_hemisphere_pdf(found.points)))
    True
    """
    u = np.asarray(_arrays.floats("parameters", parameters), np.float64)
    if u.ndim == 0:
        raise ValueError(f"parameters: expected shape (..., k), got {u.shape}")
    step = _arrays.number("step", step, above=0)
    function("mapping", mapping)
    if jacobian is not None:
        function("jacobian", jacobian)
    shape, k = u.shape[:-1], u.shape[-1]
    flat = u.reshape(-1, k)
    points = _rows("mapping", mapping(flat), len(flat))
    if jacobian is not None:
        j = np.asarray(jacobian(flat), np.float64)
        if j.shape != (*points.shape, k):
            raise ValueError(f"jacobian: expected shape {(*points.shape, k)}, got {j.shape}")
    else:
        columns = []
        for axis in np.eye(k):
            ends = [_rows("mapping", mapping(flat + i * step * axis), len(flat)) for i in (1, -1, 2, -2, 3, -3)]
            near, mid, far = ends[0] - ends[1], ends[2] - ends[3], ends[4] - ends[5]
            columns.append((45 * near - 9 * mid + far) / (60 * step))
        j = np.stack(columns, -1)
    if points.shape[1] < k:
        raise ValueError(f"mapping: expected points of at least {k} coordinates, got {points.shape[1]}")
    finite = np.isfinite(j).all((1, 2))
    stretch = np.full(len(flat), np.nan)
    stretch[finite] = np.linalg.svd(j[finite], compute_uv=False).prod(-1)
    d = np.broadcast_to(np.asarray(_arrays.floats("density", density), np.float64), shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        on = d / stretch.reshape(shape)
    return Manifold(np.asarray(on), stretch.reshape(shape), j.reshape(*shape, -1, k), points.reshape(*shape, -1))


def _rows(name: str, value: ArrayLike, n: int) -> NDArray[np.float64]:
    rows = np.asarray(value, np.float64)
    rows = rows[:, None] if rows.ndim == 1 else rows
    if rows.ndim != 2 or len(rows) != n:
        raise ValueError(f"{name}: expected {n} rows, got shape {rows.shape}")
    return rows


def inverse_transform(
    u: ArrayLike,
    *,
    low: float,
    high: float,
    cdf: Callable[[NDArray[np.float64]], ArrayLike] | None = None,
    pdf: Callable[[NDArray[np.float64]], ArrayLike] | None = None,
) -> Floats:
    """Samples of a density on an interval: the points below which shares `u` of it lie.

    Parameters
    ----------
    u : array_like, shape (...)
        In [0, 1].
    low, high : float
        The interval.
    cdf : callable, optional
        From points (m,) to the share below them (m,), up to a factor and an offset: it need not run from 0 to 1.
    pdf : callable, optional
        The density, up to a factor, instead of a `cdf`; it is integrated numerically.

    Returns
    -------
    ndarray, shape (...)
        In [low, high]; NaN where `u` is not in [0, 1].

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain, not just one of `cdf` and `pdf` is given, the density is negative somewhere
        or NaN, or there is none.

    Notes
    -----
    In double. With a `cdf`: bisection, to the last digits that the `cdf` itself tells. With a `pdf`:
    Gauss-Legendre quadrature of 16 nodes in each of 512 panels, so a density smooth within panels is right to 1e-12,
    and one that jumps to a panel's share of the jump.

    References
    ----------
    L. Devroye, *Non-Uniform Random Variate Generation*, 1986, chapter II.2.

    Examples
    --------
    >>> inverse_transform([0.25, 1.0], low=0, high=2, pdf=lambda x: x)
    array([1., 2.])
    """
    given = _arrays.floats("u", u)
    low, high = _arrays.number("low", low), _arrays.number("high", high)
    if not low < high:
        raise ValueError(f"low: expected a number below high, got {low:g} and {high:g}")
    if (cdf is None) == (pdf is None):
        raise ValueError(f"cdf, pdf: expected one of both, got {'neither' if cdf is None else 'both'}")
    function("pdf" if cdf is None else "cdf", pdf if cdf is None else cdf)
    share = np.asarray(given, np.float64).ravel()
    valid = (share >= 0) & (share <= 1)
    out = np.full(share.shape, np.nan)
    if cdf is not None:
        out[valid] = _by_cdf(share[valid], low, high, cdf)
    elif pdf is not None:
        out[valid] = _by_pdf(share[valid], low, high, pdf)
    return out.reshape(given.shape).astype(given.dtype)


def _call(name: str, f: Callable[[NDArray[np.float64]], ArrayLike], x: NDArray[np.float64]) -> NDArray[np.float64]:
    values = np.asarray(f(x), np.float64)
    if values.shape != x.shape:
        raise ValueError(f"{name}: expected {x.size} values, one a point, got shape {values.shape}")
    return values


def _search(
    value: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    slope: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None,
    target: NDArray[np.float64],
    left: NDArray[np.float64],
    right: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Where an increasing function reaches the target, between `left` and `right`."""
    left, right = left.copy(), right.copy()
    x = (left + right) / 2
    for _ in range(200):
        off = value(x) - target
        left, right = np.where(off < 0, x, left), np.where(off < 0, right, x)
        middle = left + (right - left) / 2
        following = middle
        if slope is not None:
            with np.errstate(divide="ignore", invalid="ignore"):
                newton = x - off / slope(x)
            # Newton's step, where it stays well inside.
            following = np.where((newton > left) & (newton < right), newton, middle)
        done = (following == x) | (right - left <= 2 * np.spacing(np.maximum(np.abs(left), np.abs(right))))
        x = np.where(done, x, following)
        if done.all():
            break
    return x


def _by_cdf(
    share: NDArray[np.float64],
    low: float,
    high: float,
    cdf: Callable[[NDArray[np.float64]], ArrayLike],
) -> NDArray[np.float64]:
    first, last = (float(v) for v in _call("cdf", cdf, np.array([low, high])))
    if not (np.isfinite(first) and np.isfinite(last) and first < last):
        raise ValueError(f"cdf: expected finite values that rise from low to high, got {first:g} and {last:g}")
    left, right = np.full(share.shape, low), np.full(share.shape, high)
    found = _search(lambda x: _call("cdf", cdf, x), None, first + share * (last - first), left, right)
    return np.where(share == 0, low, np.where(share == 1, high, found))


_PANELS, _NODES = 512, 16


def _by_pdf(
    share: NDArray[np.float64], low: float, high: float, pdf: Callable[[NDArray[np.float64]], ArrayLike]
) -> NDArray[np.float64]:
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)

    def mass(left: NDArray[np.float64], right: NDArray[np.float64]) -> NDArray[np.float64]:
        half = (right - left) / 2
        x = (left + half)[:, None] + half[:, None] * nodes
        values = _call("pdf", pdf, x.ravel()).reshape(x.shape)
        if not (values >= 0).all():
            bad = float(x.ravel()[int((~(values >= 0)).ravel().argmax())])
            raise ValueError(f"pdf: expected densities of at least 0, got another at {bad:g}")
        return (values @ weights) * half

    ends = np.linspace(low, high, _PANELS + 1)
    sums = np.concatenate([[0.0], np.cumsum(mass(ends[:-1], ends[1:]))])
    if not (np.isfinite(sums[-1]) and sums[-1] > 0):
        raise ValueError(f"pdf: expected a density whose integral is finite and positive, got {sums[-1]:g}")
    target = share * sums[-1]
    panel = np.clip(np.searchsorted(sums, target, side="right") - 1, 0, _PANELS - 1)
    # The end of the last panel that has mass.
    panel = np.minimum(panel, int(np.flatnonzero(np.diff(sums) > 0)[-1]))
    left, right = ends[panel], ends[panel + 1]
    rest = target - sums[panel]
    return _search(lambda x: mass(left, x), lambda x: _call("pdf", pdf, x), rest, left, right)


class Rejection(NamedTuple):
    """Samples by rejection, and what they cost."""

    samples: NDArray[np.float64]
    """Shape (n, d)."""
    acceptance: float
    """How many of the candidates were kept."""
    tried: int
    """How many candidates there were."""
    largest_ratio: float
    """The largest density over its bound that was met: at most 1; far below it, the bound is loose."""


def rejection_sample(
    density: Callable[[NDArray[np.float64]], ArrayLike],
    n: int,
    *,
    bound: float,
    low: ArrayLike = 0.0,
    high: ArrayLike = 1.0,
    proposal: tuple[Callable[[NDArray[np.float64]], ArrayLike], Callable[[NDArray[np.float64]], ArrayLike]]
    | None = None,
    seed: int = 0,
    max_tries: int = 10**7,
) -> Rejection:
    """Samples of a density by keeping candidates in proportion to it, with the share that was kept.

    Parameters
    ----------
    density : callable
        From points (m, d) to densities (m,), up to a factor.
    n : int
        How many samples.
    bound : float
        M with `density` ≤ M everywhere, or, with a proposal, ≤ M times its density.
    low, high : array_like, shape () or (d,)
        The box that candidates fill evenly. With a proposal only its dimension counts.
    proposal : (callable, callable), optional
        From uniform numbers (m, d) to candidates (m, k), and their density (m,).
    seed : int
        Of all random numbers.
    max_tries : int
        Candidates to give up after.

    Returns
    -------
    Rejection
        Samples, the measured acceptance, candidates, the largest ratio.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain, the density exceeds its bound, is negative or NaN, or too few
        candidates are kept.

    Notes
    -----
    Candidates are kept where u M q ≤ p: M q must lie above p. The acceptance tends to ∫ p / M (over the box's volume);
    in many dimensions it vanishes.

    References
    ----------
    J. von Neumann, *Various techniques used in connection with random digits*, 1951.

    Examples
    --------
    >>> disk = rejection_sample(lambda x: (x**2).sum(-1) <= 1, 20000, bound=1, low=[-1, -1], high=[1, 1])
    >>> disk.samples.shape, bool(abs(disk.acceptance - np.pi / 4) < 0.01)
    ((20000, 2), True)
    """
    n = many("n", n, 1)
    function("density", density)
    if proposal is not None:
        if not isinstance(proposal, tuple | list) or len(proposal) != 2 or not all(map(callable, proposal)):
            raise TypeError(f"proposal: expected two callables, got {proposal!r}")
    bound = _arrays.number("bound", bound, above=0)
    seed, max_tries = _arrays.count("seed", seed, 0, 2**64 - 1), _arrays.count("max_tries", max_tries, 1)
    a, b = (np.atleast_1d(np.asarray(_arrays.floats(k, v), np.float64)) for k, v in (("low", low), ("high", high)))
    if a.ndim > 1 or b.ndim > 1 or not (len(a) == len(b) or 1 in (len(a), len(b))):
        raise ValueError(f"low, high: expected numbers or shapes (d,), got {a.shape} and {b.shape}")
    a, b = np.broadcast_arrays(a, b)
    if not (np.isfinite(a).all() and np.isfinite(b).all() and (a < b).all()):
        raise ValueError("low, high: expected a finite box, low below high")
    d, tried, kept, largest = len(a), 0, 0, 0.0
    parts: list[Any] = []
    while kept < n:
        if tried >= max_tries:
            raise ValueError(f"max_tries: {kept} of {n} samples were kept of {tried} candidates; is bound loose?")
        size = min(max(1024, int((n - kept) * 1.1 * max(tried, 1) / max(kept, 1))), 1 << 18, max_tries - tried)
        u = np.asarray(Generator(seed).uniform((tried + np.arange(size))[:, None], 0, np.arange(d + 1)), np.float64)
        x = a + u[:, :d] * (b - a) if proposal is None else _rows("proposal", proposal[0](u[:, :d]), size)
        p = np.asarray(density(x), np.float64)
        q = np.ones(size) if proposal is None else np.asarray(proposal[1](x), np.float64)
        if p.shape != (size,) or q.shape != (size,):
            raise ValueError(f"density: expected {size} values, one a point, got shapes {p.shape} and {q.shape}")
        if not (p >= 0).all():
            raise ValueError(f"density: expected numbers of at least 0, got another at {x[int((~(p >= 0)).argmax())]}")
        excess = p > bound * q * (1 + 1e-12)
        if excess.any():
            at = int(excess.argmax())
            raise ValueError(
                f"bound: expected at least the density, which is {p[at] / q[at]:g} at {x[at]}, got {bound:g}"
            )
        with np.errstate(divide="ignore", invalid="ignore"):
            largest = max(largest, float(np.nan_to_num(p / (bound * q), nan=0.0).max()))
        good = np.flatnonzero(u[:, d] * bound * q < p)
        if kept + len(good) >= n:
            # Count no candidate after the last sample.
            good = good[: n - kept]
            size = int(good[-1]) + 1
        parts.append(x[good])
        tried, kept = tried + size, kept + len(good)
    return Rejection(np.concatenate(parts), n / tried, tried, largest)
