"""Monte Carlo integration with its error bar, the weights that combine techniques, and roulette."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .generators import Generator
from .sequences import sobol

__all__ = [
    "Estimate",
    "Split",
    "Technique",
    "balance_heuristic",
    "integrate",
    "power_heuristic",
    "russian_roulette",
    "split_integral",
]

Function: TypeAlias = Callable[[NDArray[np.float64]], ArrayLike]
"""From points (n, d) to values (n,)."""


class Technique(NamedTuple):
    """A way to draw points: from uniform numbers (n, d) to points (n, k), and the density of points."""

    sample: Callable[[NDArray[np.float64]], ArrayLike]
    pdf: Function


class Estimate(NamedTuple):
    """An integral with its error bar."""

    value: float
    standard_error: float
    """The standard deviation of `value`, itself estimated."""
    interval: tuple[float, float]
    """Covers the integral with the confidence asked for, as far as the estimate is normally distributed."""
    evaluations: int
    """How often the integrand was evaluated."""


def _quantile(confidence: float, freedom: float) -> float:
    """Of Student's distribution, two-sided, by Fisher and Cornish's expansion; within 0.1 % from 7 degrees on."""
    from statistics import NormalDist  # not at import: it takes longer than all of this file

    z = NormalDist().inv_cdf(0.5 + confidence / 2)
    first = (z**3 + z) / 4
    second = (5 * z**5 + 16 * z**3 + 3 * z) / 96
    third = (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384
    return z + first / freedom + second / freedom**2 + third / freedom**3


def _values(name: str, function: Callable[..., ArrayLike], points: NDArray[np.float64]) -> NDArray[np.float64]:
    values = np.asarray(function(points), np.float64)
    if values.shape != points.shape[:1]:
        raise ValueError(f"{name}: expected {len(points)} values, one a point, got shape {values.shape}")
    return values


def _mean(terms: NDArray[np.float64]) -> tuple[float, float]:
    """The mean and its variance."""
    return float(terms.mean()), float(terms.var(ddof=1) / len(terms)) if len(terms) > 1 else math.inf


class _Problem(NamedTuple):
    f: Function
    low: NDArray[np.float64]
    extent: NDArray[np.float64]
    techniques: Sequence[Technique]
    beta: float
    control: tuple[Function, float] | None
    survival: Function | float

    def plain(self, u: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        x = self.low + u * self.extent
        return x, float(np.prod(self.extent)) * _values("f", self.f, x)


# Each method takes uniform numbers and gives an estimate, its variance, and how often it evaluated f.
def _plain(p: _Problem, u: NDArray[np.float64]) -> tuple[float, float, int]:
    return *_mean(p.plain(u)[1]), len(u)


def _stratified(p: _Problem, u: NDArray[np.float64]) -> tuple[float, float, int]:
    d = u.shape[1]
    cells = round((len(u) // 2) ** (1 / d))
    cells = max(cells if 2 * cells**d <= len(u) else cells - 1, 1)
    corner = np.stack(np.unravel_index(np.arange(cells**d), (cells,) * d), -1)
    # Two points a cell, so that each tells the other's spread.
    u = (corner[:, None] + u[: 2 * cells**d].reshape(-1, 2, d)) / cells
    terms = p.plain(u.reshape(-1, d))[1].reshape(-1, 2)
    return float(terms.mean()), float(((terms[:, 0] - terms[:, 1]) ** 2).sum() / 4 / cells ** (2 * d)), terms.size


def _importance(p: _Problem, u: NDArray[np.float64]) -> tuple[float, float, int]:
    x = _points(p.techniques[0], u)
    pdf = _values("pdf", p.techniques[0].pdf, x)
    return *_mean(_ratio(_values("f", p.f, x), pdf)), len(u)


def _points(technique: Technique, u: NDArray[np.float64]) -> NDArray[np.float64]:
    x = np.asarray(technique.sample(u), np.float64)
    x = x[:, None] if x.ndim == 1 else x
    if x.ndim != 2 or len(x) != len(u):
        raise ValueError(f"techniques: expected {len(u)} points from sample, got shape {x.shape}")
    return x


def _ratio(f: NDArray[np.float64], pdf: NDArray[np.float64]) -> NDArray[np.float64]:
    # A point of no density was drawn by rounding: it stands for nothing.
    return np.divide(f, pdf, out=np.zeros_like(f), where=(pdf > 0) | np.isnan(pdf))


def _mis(p: _Problem, u: NDArray[np.float64]) -> tuple[float, float, int]:
    value, variance = 0.0, 0.0
    parts = np.array_split(u, len(p.techniques))
    counts = [len(part) for part in parts]
    for i, part in enumerate(parts):
        x = _points(p.techniques[i], part)
        pdfs = np.stack([_values("pdf", t.pdf, x) for t in p.techniques], -1)
        weight = power_heuristic(pdfs, counts, power=p.beta)[:, i]
        mean, spread = _mean(weight * _ratio(_values("f", p.f, x), pdfs[:, i]))
        value, variance = value + mean, variance + spread
    return value, variance, len(u)


def _control(p: _Problem, u: NDArray[np.float64]) -> tuple[float, float, int]:
    assert p.control is not None
    x, f = p.plain(u)
    g = float(np.prod(p.extent)) * _values("control", p.control[0], x) - p.control[1]
    value, variance = 0.0, 0.0
    # Each half by the coefficient that the other shows: no bias.
    half = len(u) // 2
    for own, other in ((slice(half), slice(half, None)), (slice(half, None), slice(half))):
        centered = g[other] - g[other].mean()
        power = centered @ centered
        c = centered @ f[other] / power if power > 0 else 0.0
        mean, spread = _mean(f[own] - c * g[own])
        value, variance = value + mean / 2, variance + spread / 4
    return value, variance, len(u)


def _roulette(p: _Problem, u: NDArray[np.float64]) -> tuple[float, float, int]:
    x = p.low + u[:, :-1] * p.extent
    q = np.full(len(x), p.survival) if not callable(p.survival) else _values("survival", p.survival, x)
    if not ((q > 0) & (q <= 1)).all():
        raise ValueError(f"survival: expected probabilities in (0, 1], got {q.min():g} … {q.max():g}")
    alive = u[:, -1] < q
    terms = np.zeros(len(x))
    if alive.any():
        terms[alive] = float(np.prod(p.extent)) * _values("f", p.f, x[alive]) / q[alive]
    return *_mean(terms), int(alive.sum())


_METHODS = {
    "plain": _plain,
    "stratified": _stratified,
    "importance": _importance,
    "mis": _mis,
    "control_variate": _control,
    "roulette": _roulette,
}
_REPLICATES = 16


def integrate(
    f: Function,
    n: int,
    *,
    low: ArrayLike = 0.0,
    high: ArrayLike = 1.0,
    method: Literal["plain", "stratified", "importance", "mis", "control_variate", "roulette"] = "plain",
    techniques: Technique | Sequence[Technique] = (),
    heuristic: Literal["balance", "power"] = "balance",
    control: tuple[Function, float] | None = None,
    survival: Function | float = 0.5,
    sampler: Literal["independent", "sobol"] = "independent",
    confidence: float = 0.95,
    seed: int = 0,
) -> Estimate:
    """The integral of a function by Monte Carlo, with its standard error and a confidence interval.

    Parameters
    ----------
    f : callable
        From points (n, d) in double to values (n,).
    n : int
        How many points, at least 4.
    low, high : array_like, shape () or (d,)
        The box that is integrated over. With techniques, only its dimension counts: how many uniform numbers they take.
    method : {"plain", "stratified", "importance", "mis", "control_variate", "roulette"}
        Independent points; two in each cell of a grid; points of one technique; of several, combined by their weights;
        minus a function whose integral is known; or evaluated only where roulette lets it.
    techniques : Technique or sequence of Technique
        For "importance" and "mis": `sample` takes uniform numbers (n, d) to points, `pdf` is their density.
    heuristic : {"balance", "power"}
        For "mis"; the power is 2.
    control : (callable, float)
        For "control_variate": a function near `f` up to a factor, and its integral over the box.
    survival : callable or float
        For "roulette": how likely a point is evaluated, in (0, 1].
    sampler : {"independent", "sobol"}
        Where the uniform numbers come from; "sobol" makes 16 independently scrambled replicates of n / 16 points, whose
        spread is the standard error (not for "stratified").
    confidence : float
        Of the interval, in (0, 1).
    seed : int
        Of all random numbers.

    Returns
    -------
    Estimate
        Value, standard error, interval, and how often `f` was evaluated.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain, or a callable gives another number of values.

    Notes
    -----
    Every method is unbiased: "control_variate" takes each half's factor from the other half. The error bar is itself an
    estimate: where few samples carry most of the integral (a density that misses a peak) it is too small, as the
    interval is. The standard error falls as n^(-1/2); stratified as n^(-1/2 - 1/d) for smooth f; "sobol" as n^(-3/2) at
    best.

    References
    ----------
    E. Veach, *Robust Monte Carlo Methods for Light Transport Simulation*, 1997, chapters 2, 9, 10.
    A. B. Owen, *Monte Carlo theory, methods and examples*, 2013.

    Examples
    --------
    >>> quarter = integrate(lambda x: (x**2).sum(-1) < 1, 10000, low=[0, 0])
    >>> bool(quarter.interval[0] < np.pi / 4 < quarter.interval[1]), quarter.evaluations
    (True, 10000)
    """
    n = _arrays.count("n", n, 4)
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    _arrays.choice("method", method, tuple(_METHODS))
    _arrays.choice("heuristic", heuristic, ("balance", "power"))
    _arrays.choice("sampler", sampler, ("independent", "sobol"))
    confidence = _arrays.number("confidence", confidence, above=0, below=1)
    problem = _problem(f, low, high, method, techniques, heuristic, control, survival)
    d = len(problem.low) + (method == "roulette")
    if sampler == "independent":
        u = np.asarray(Generator(seed).uniform(np.arange(n)[:, None], 0, np.arange(d)), np.float64)
        value, variance, evaluations = _METHODS[method](problem, u)
        freedom = evaluations - 1
    else:
        if method == "stratified":
            raise ValueError('sampler: expected "independent", as Sobol\' points are stratified already')
        n = max(n // _REPLICATES, 4)
        seeds = Generator(seed).uniform(np.arange(_REPLICATES)) * 2**53
        found = [_METHODS[method](problem, np.asarray(sobol(n, d, seed=int(s)), np.float64)) for s in seeds]
        value, variance = _mean(np.array([v for v, _, _ in found]))
        evaluations, freedom = sum(k for _, _, k in found), _REPLICATES - 1
    error = math.sqrt(variance) if variance >= 0 else math.nan
    reach = _quantile(confidence, max(freedom, 1)) * error
    return Estimate(value, error, (value - reach, value + reach), evaluations)


def _problem(
    f: Function,
    low: ArrayLike,
    high: ArrayLike,
    method: str,
    techniques: Technique | Sequence[Technique],
    heuristic: str,
    control: tuple[Function, float] | None,
    survival: Function | float,
) -> _Problem:
    """The arguments checked."""
    a, b = (np.atleast_1d(np.asarray(_arrays.floats(k, v), np.float64)) for k, v in (("low", low), ("high", high)))
    if a.ndim > 1 or b.ndim > 1 or not (len(a) == len(b) or 1 in (len(a), len(b))):
        raise ValueError(f"low, high: expected numbers or shapes (d,), got {a.shape} and {b.shape}")
    a, b = np.broadcast_arrays(a, b)
    if not (np.isfinite(a).all() and np.isfinite(b).all() and (a < b).all()):
        raise ValueError("low, high: expected a finite box, low below high")
    several = [techniques] if isinstance(techniques, Technique) else list(techniques)
    wrong = not several or (method == "importance" and len(several) > 1)
    if method in ("importance", "mis") and wrong:
        raise ValueError(f"techniques: expected {'one' if method == 'importance' else 'some'}, got {len(several)}")
    if method == "control_variate":
        if control is None:
            raise ValueError("control: expected a function and its integral, got None")
        control = (control[0], _arrays.number("control", control[1]))
    if not callable(survival):
        survival = _arrays.number("survival", survival, high=1, above=0)
    return _Problem(f, a, b - a, several, 1.0 if heuristic == "balance" else 2.0, control, survival)


def balance_heuristic(pdfs: ArrayLike, counts: ArrayLike | None = None) -> Floats:
    """The weights of several techniques for a point, in proportion to how often each draws it.

    Parameters
    ----------
    pdfs : array_like, shape (..., k)
        The density of each technique at a point, by one measure.
    counts : array_like, shape (k,), optional
        How many samples each takes; by default alike.

    Returns
    -------
    ndarray, shape (..., k)
        n_i p_i / Σ n_j p_j: they sum to one; all are 0 where no technique reaches.

    Raises
    ------
    TypeError, ValueError
        If `pdfs` is not real, or `counts` of other shape.

    Notes
    -----
    Right to 4 rounding units whatever the size of densities, infinite ones included (a mirror's): these share all the
    weight. No other weights sum to much less variance.

    References
    ----------
    E. Veach, L. Guibas, *Optimally combining sampling techniques for Monte Carlo rendering*, 1995.

    Examples
    --------
    >>> balance_heuristic([1.0, 3.0])
    array([0.25, 0.75])
    """
    return power_heuristic(pdfs, counts, power=1.0)


def power_heuristic(pdfs: ArrayLike, counts: ArrayLike | None = None, *, power: float = 2.0) -> Floats:
    """As `balance_heuristic`, of powers: sharper, better where one of the techniques is nearly perfect.

    Parameters
    ----------
    pdfs : array_like, shape (..., k)
        The density of each technique at a point, by one measure.
    counts : array_like, shape (k,), optional
        How many samples each takes; by default alike.
    power : float
        At least 1; infinite is the maximum heuristic.

    Returns
    -------
    ndarray, shape (..., k)
        (n_i p_i)^power / Σ (n_j p_j)^power; all are 0 where no technique reaches.

    Raises
    ------
    TypeError, ValueError
        If `pdfs` is not real, `counts` of other shape, or `power` below 1.

    Notes
    -----
    Ratios to the largest are taken before the power, so nothing overflows.

    References
    ----------
    E. Veach, L. Guibas, *Optimally combining sampling techniques for Monte Carlo rendering*, 1995.

    Examples
    --------
    >>> power_heuristic([1.0, 3.0])
    array([0.1, 0.9])
    """
    p = _arrays.floats("pdfs", pdfs)
    if p.ndim == 0:
        raise ValueError(f"pdfs: expected shape (..., k), got {p.shape}")
    power = float(power)
    if not power >= 1:
        raise ValueError(f"power: expected a number of at least 1, got {power:g}")
    n = np.ones(p.shape[-1], p.dtype) if counts is None else _arrays.floats("counts", counts, p.dtype)
    if n.shape != p.shape[-1:] or not ((n >= 0) & np.isfinite(n)).all():
        raise ValueError(f"counts: expected {p.shape[-1]} numbers of at least 0, got shape {n.shape}")
    with np.errstate(invalid="ignore", divide="ignore", under="ignore"):
        # Each beside the largest, before the counts could overflow.
        largest = p.max(-1, keepdims=True)
        share = np.where(np.isinf(largest), np.isinf(p), p / largest) * (n / max(float(n.max()), 1e-30))
        share = np.where(largest > 0, share, largest * 0).astype(p.dtype)
        top = share.max(-1, keepdims=True)
        ratio = np.where(top > 0, share / np.where(top > 0, top, 1), top)
        ratio = np.where(ratio < 1, 0, ratio) if math.isinf(power) else ratio ** p.dtype.type(power)
        total = ratio.sum(-1, keepdims=True)
        return np.asarray(np.where(total > 0, ratio / np.where(total > 0, total, 1), total * ratio), p.dtype)


def russian_roulette(values: ArrayLike, survival: ArrayLike, u: ArrayLike, fallback: ArrayLike = 0.0) -> Floats:
    """Values that live on with a probability, weighted so that the mean stays.

    Parameters
    ----------
    values : array_like, shape (...)
        What survivors are worth.
    survival : array_like, shape (...)
        The probability to survive, in (0, 1]; where it is 0 all die. Others give NaN.
    u : array_like, shape (...)
        Uniform numbers in [0, 1): those below `survival` survive. All broadcast.
    fallback : array_like, shape (...)
        What the dead are worth.

    Returns
    -------
    ndarray, shape (...)
        (value - (1 - q) fallback) / q for survivors, else the fallback. Its mean over `u` is the value.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, or shapes do not broadcast.

    Notes
    -----
    Saves work, never variance: the variance grows by (1/q - 1) (value - fallback)². A survival of 0 where the value is
    not the fallback's is a bias.

    References
    ----------
    J. Arvo, D. Kirk, *Particle transport and image synthesis*, 1990.

    Examples
    --------
    >>> russian_roulette([1.0, 1.0], 0.5, [0.3, 0.8])
    array([2., 0.])
    """
    dtype = _arrays.result_dtype(values=values)
    v, q, x, c = (
        _arrays.floats(k, a, dtype)
        for k, a in (("values", values), ("survival", survival), ("u", u), ("fallback", fallback))
    )
    core = {"values": (v, 0), "survival": (q, 0), "u": (x, 0), "fallback": (c, 0)}
    shape, (v, q, x, c) = _arrays.broadcast(core)
    with np.errstate(divide="ignore", invalid="ignore"):
        out = np.where(x < q, (v - (1 - q) * c) / q, c)
        out = np.where((q >= 0) & (q <= 1) & (x >= 0) & (x <= 1), out, np.nan)
    return np.asarray(out, dtype).reshape(shape)


class Split(NamedTuple):
    """The product approximation of ∫ f g and what it misses."""

    product: Any
    """Mean of f on g's support, times ∫ g."""
    integral: Any
    """∫ f g itself, by quadrature."""
    error: Any
    """`product - integral`."""
    mean_f: Any
    integral_g: Any
    bound: Any
    """|error| is at most this: the support's size times both standard deviations on it."""


def split_integral(
    f: Function | ArrayLike,
    g: Function | ArrayLike,
    *,
    low: ArrayLike = 0.0,
    high: ArrayLike = 1.0,
    nodes: int = 256,
    weights: ArrayLike | None = None,
) -> Split:
    """∫ f g ≈ (mean of f on g's support) × ∫ g: what shadow maps, ambient occlusion and split sums rest on.

    Parameters
    ----------
    f, g : callables, or array_like of shape (..., n)
        From points (n, d) to values (n,); or values at the nodes of a quadrature of one's own.
    low, high : array_like, shape () or (d,)
        The box, for callables.
    nodes : int
        Along each axis, for callables: composite Gauss-Legendre quadrature of 4 nodes a panel.
    weights : array_like, shape (n,), optional
        The quadrature's weights, for arrays; by default 1/n each: means.

    Returns
    -------
    Split
        The product, the integral, the error, its factors and its bound.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain, or only one of `f` and `g` is callable.

    Notes
    -----
    The error is minus the support's size times the covariance of f and g on it: none where either is constant there, or
    where they are unrelated. So the approximation is good where g's support is small (a point light) or f is smooth
    (a diffuse surface under even light). Where f or g jumps, the quadrature itself errs by about a panel.

    References
    ----------
    T. Akenine-Möller and others, *Real-Time Rendering*, 2018, section 7.
    B. Karis, *Real Shading in Unreal Engine 4*, 2013 (the split sum).

    Examples
    --------
    >>> found = split_integral(lambda x: x[:, 0], lambda x: 1 + x[:, 0])
    >>> round(found.product, 6), round(found.integral, 6), round(found.error, 6)
    (0.75, 0.833333, -0.083333)
    """
    if callable(f) != callable(g):
        raise TypeError("f, g: expected two callables or two arrays, got one of each")
    if callable(f) and callable(g):
        nodes = _arrays.count("nodes", nodes, 4, 4096)
        p = _problem(f, low, high, "plain", (), "balance", None, 0.5)
        points, w = _grid(nodes // 4, len(p.low))
        points, w = p.low + points * p.extent, w * float(np.prod(p.extent))
        fs, gs = _values("f", f, points), _values("g", g, points)
    else:
        fs, gs = (np.asarray(_arrays.floats(k, v), np.float64) for k, v in (("f", f), ("g", g)))  # type: ignore[arg-type]
        if fs.ndim == 0 or gs.ndim == 0 or fs.shape[-1] != gs.shape[-1]:
            raise ValueError(f"f, g: expected values at the same nodes, got shapes {fs.shape} and {gs.shape}")
        n = fs.shape[-1]
        w = np.full(n, 1 / n) if weights is None else np.asarray(_arrays.floats("weights", weights), np.float64)
        if w.shape != (n,):
            raise ValueError(f"weights: expected shape ({n},), got {w.shape}")
    inside = gs != 0
    with np.errstate(invalid="ignore", divide="ignore"):
        size = (w * inside).sum(-1)
        mean_f = np.where(size > 0, (w * inside * fs).sum(-1) / size, 0.0)
        integral_g = (w * gs).sum(-1)
        mean_g = np.where(size > 0, integral_g / size, 0.0)
        spread = [(w * inside * (x - m[..., None]) ** 2).sum(-1) for x, m in ((fs, mean_f), (gs, mean_g))]
    integral, product = (w * fs * gs).sum(-1), mean_f * integral_g
    bound = np.sqrt(np.maximum(spread[0], 0) * np.maximum(spread[1], 0))
    found = (product, integral, product - integral, mean_f, integral_g, bound)
    return Split(*(float(x) if np.ndim(x) == 0 else x for x in found))


def _grid(panels: int, d: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nodes and weights of the unit cube."""
    if (4 * panels) ** d > 1 << 24:
        raise ValueError(f"nodes: expected at most {int((1 << 24) ** (1 / d))} along each of {d} axes")
    x, w = np.polynomial.legendre.leggauss(4)
    x = ((np.arange(panels)[:, None] + (x + 1) / 2) / panels).ravel()
    w = np.tile(w / 2 / panels, panels)
    points = np.stack(np.meshgrid(*[x] * d, indexing="ij"), -1).reshape(-1, d)
    return points, np.asarray(np.prod(np.meshgrid(*[w] * d, indexing="ij"), axis=0)).ravel()
