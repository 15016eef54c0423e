"""Monte Carlo integration with its error bar."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from ._arguments import function, many
from .generators import Generator
from .heuristics import power_heuristic
from .sequences import sobol

__all__ = ["Estimate", "Technique", "integrate"]

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


def _freedom(method: str, n: int, evaluations: int, techniques: int) -> int:
    """Degrees of freedom of the variance: one a cell; those of one technique's part, or of a half with a factor."""
    if method == "stratified":
        return evaluations // 2
    if method == "mis":
        return n // techniques - 1
    return n // 2 - 2 if method == "control_variate" else n - 1


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
    interval is. Intervals of 95 % of the exponential on [0, 1] held it 92 to 96 % of the time with 8 to 64 points, 89
    to 96 % with 4, by all methods. The standard error falls as n^(-1/2); stratified as n^(-1/2 - 1/d) for smooth f;
    "sobol" as n^(-3/2) at best.

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
    n = many("n", n, 4)
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
        freedom = _freedom(method, n, evaluations, len(problem.techniques))
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
    function("f", f)
    several = [techniques] if isinstance(techniques, Technique) else techniques
    if not isinstance(several, Sequence) or not all(isinstance(t, Technique) for t in several):
        raise TypeError(f"techniques: expected one Technique or several, got {techniques!r}")
    wrong = not several or (method == "importance" and len(several) > 1)
    if method in ("importance", "mis") and wrong:
        raise ValueError(f"techniques: expected {'one' if method == 'importance' else 'some'}, got {len(several)}")
    if method == "control_variate":
        if control is None:
            raise ValueError("control: expected a function and its integral, got None")
        if not isinstance(control, tuple | list) or len(control) != 2 or not callable(control[0]):
            raise TypeError(f"control: expected a callable and its integral, got {control!r}")
        control = (control[0], _arrays.number("control", control[1]))
    if not callable(survival):
        survival = _arrays.number("survival", survival, high=1, above=0)
    return _Problem(f, a, b - a, list(several), 1.0 if heuristic == "balance" else 2.0, control, survival)
