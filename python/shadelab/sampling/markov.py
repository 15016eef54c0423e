"""Markov chains: Metropolis' and Gibbs' samplers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import sampling as _kernels
from ._arguments import many
from .diagnostics import effective_sample_size, r_hat
from .generators import Generator
from .tabulated import Tabulated2D

__all__ = ["Chains", "gibbs", "metropolis_hastings"]

LogDensity: TypeAlias = Callable[[Floats], ArrayLike]
"""From states (chains, d) to the logarithm of a density, up to a constant, (chains,)."""


Acceptance: TypeAlias = Literal["hastings", "metropolis", "plain"]


class Chains(NamedTuple):
    """What Markov chains visited, and how far that may be trusted."""

    samples: Floats
    """Shape (chains, n, d), without the burn-in."""
    acceptance: NDArray[np.float64]
    """Of each chain after the burn-in: how many of its steps were taken."""
    burn_in: int
    """Steps dropped at the start of each chain."""
    effective_sample_size: NDArray[np.float64]
    """How many independent samples tell as much, for each dimension; all chains together."""
    r_hat: NDArray[np.float64]
    """How far chains disagree, for each dimension: 1 where they are alike, above 1.01 run them longer."""


def _result(samples: Floats, acceptance: NDArray[np.float64], burn_in: int) -> Chains:
    known = samples.shape[1] >= 4
    none = np.full(samples.shape[2:], np.nan)
    size, disagree = (effective_sample_size(samples), r_hat(samples)) if known else (none, none)
    return Chains(samples, acceptance, burn_in, size, disagree)


def _numbers(seed: int, steps: int, chains: int, d: int) -> Iterator[NDArray[np.float64]]:
    """Uniform numbers (chains, d) for each step, made in blocks."""
    block = 1024
    for first in range(0, steps, block):
        number = first + np.arange(min(block, steps - first))
        chain = np.arange(chains)[:, None]
        yield from np.asarray(Generator(seed).uniform(chain, number[:, None, None], np.arange(d)), np.float64)


def _starts(start: ArrayLike | None, chains: int, seed: int, dtype: np.dtype[Any], size: int | None) -> Floats:
    """States (chains, d) to begin from; a single one is every chain's."""
    if start is None:
        if size is None:
            raise ValueError("start: expected states to begin from, as the target is a callable; got None")
        u = Generator(seed).uniform(np.arange(chains)[:, None], 0, 2**31 + np.arange(size), dtype)
        return np.ascontiguousarray(u)
    given = _arrays.floats("start", start, dtype)
    if given.ndim not in (1, 2) or given.shape[-1] < 1 or (given.ndim == 2 and len(given) != chains):
        raise ValueError(f"start: expected shape (d,) or ({chains}, d), got {given.shape}")
    if size is not None and (given.shape[-1] != size or not ((given >= 0) & (given < 1)).all()):
        raise ValueError(f"start: expected {size} numbers in [0, 1) a chain, got {given.shape} from {given.min()}")
    return np.array(np.broadcast_to(given, (chains, given.shape[-1])))


def metropolis_hastings(
    target: LogDensity | ArrayLike,
    n: int,
    *,
    start: ArrayLike | None = None,
    chains: int = 4,
    scale: float | None = None,
    leap: float = 0.1,
    proposal: Callable[[Floats, Floats], ArrayLike] | None = None,
    log_proposal: Callable[[Floats, Floats], ArrayLike] | None = None,
    acceptance: Acceptance = "hastings",
    log_bound: float | None = None,
    burn_in: int = 0,
    thin: int = 1,
    seed: int = 0,
    progress: bool | Callable[[int, int], object] = False,
) -> Chains:
    """Samples in proportion to a density known up to a factor, by a walk that its ratios steer.

    Parameters
    ----------
    target : callable, or array_like of shape (H, W)
        From states (chains, d) to the logarithm of a density (chains,); or a picture of weights on the unit square (x
        along its rows, y from row 0 on), which runs compiled.
    n : int
        Samples kept of each chain.
    start : array_like, shape (d,) or (chains, d)
        Where chains begin; for a picture by default anywhere, else needed.
    chains : int
        Independent walks.
    scale : float
        Standard deviation of the Gaussian steps, 1 by default, or 0.05 of a picture's width (wrapped around its ends).
    leap : float
        For a picture: how often a step goes anywhere instead.
    proposal : callable, optional
        From states (chains, d) and uniform numbers (chains, d) to candidates; instead of Gaussian steps.
    log_proposal : callable, optional
        `log_proposal(from, to)`: the logarithm of the proposal's density; symmetric ones need none.
    acceptance : {"hastings", "metropolis", "plain"}
        By min(1, π(y) q(y, x) / (π(x) q(x, y))); the same without q, which is right for symmetric proposals alone; or
        by π(y) q(y, x) over its bound, right too, but it rests more.
    log_bound : float
        For "plain" with a callable: the logarithm of the bound of π q.
    burn_in : int
        Steps dropped at the start.
    thin : int
        Keep every so many-th.
    seed : int
        Of all random numbers.
    progress : bool or callable
        For a picture: show progress, or be told (done, total).

    Returns
    -------
    Chains
        Samples, acceptance, effective sample size, R-hat.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain; if a chain starts where the target is NaN or of no density; or if "plain"
        meets a density above its bound.

    Notes
    -----
    Samples follow the target only in the limit; neighbours in a chain are correlated. Where the target falls to zero
    between two modes, steps must be wide enough to pass (or leap). About 0.2 µs a step and thread for a picture,
    and 0.4 more for each sample that is kept, since its correlations are judged.

    References
    ----------
    N. Metropolis, A. Rosenbluth, M. Rosenbluth, A. Teller, E. Teller, *Equation of state calculations by fast computing
    machines*, 1953.
    W. K. Hastings, *Monte Carlo sampling methods using Markov chains and their applications*, 1970.

    Examples
    --------
    >>> found = metropolis_hastings(lambda x: -(x[:, 0] ** 2) / 2, 5000, start=[0.0], scale=2.4, burn_in=100)
    >>> bool(abs(found.samples.std() - 1) < 0.1), bool(0.3 < found.acceptance.mean() < 0.6)
    (True, True)
    """
    n, chains = many("n", n, 1), many("chains", chains, 1)
    burn_in, thin = many("burn_in", burn_in), many("thin", thin, 1)
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    _arrays.choice("acceptance", acceptance, ("hastings", "metropolis", "plain"))
    if scale is not None:
        scale = _arrays.number("scale", scale, above=0)
    if not callable(target):
        for name, value in {"proposal": proposal, "log_proposal": log_proposal, "log_bound": log_bound}.items():
            if value is not None:
                raise ValueError(f"{name}: expected None, as the target is a picture")
        leap = _arrays.number("leap", leap, 0, 1)
        weights = _picture(target)
        state = _starts(start, chains, seed, weights.dtype, 2)
        samples, counted = np.empty((chains, n, 2), weights.dtype), np.zeros(chains, np.uint64)
        walk = (0.05 if scale is None else scale, leap, "plain" if acceptance == "plain" else "hastings")
        callback = _arrays.progress_callback(progress, "metropolis_hastings")
        _kernels.metropolis_hastings(weights, walk, (seed, burn_in, thin), state, samples, counted, callback)
        return _result(samples, counted / (n * thin), burn_in)
    if acceptance == "plain" and log_bound is None:
        raise ValueError('log_bound: expected the logarithm of a bound, as acceptance is "plain"; got None')
    if log_proposal is not None and proposal is None:
        raise ValueError("log_proposal: expected None, as there is no proposal of its own")
    state = _starts(start, chains, seed, _arrays.result_dtype(start=start), None)
    step = _Step(target, proposal, log_proposal, acceptance, log_bound, 1.0 if scale is None else scale, state)
    samples, moved = np.empty((chains, n, state.shape[1]), state.dtype), np.zeros(chains)
    for number, u in enumerate(_numbers(seed, burn_in + n * thin, chains, 2 * state.shape[1] + 1)):
        went = step(u)
        if number >= burn_in:
            moved += went
            if (number - burn_in + 1) % thin == 0:
                samples[:, (number - burn_in) // thin] = step.state
    return _result(samples, moved / (n * thin), burn_in)


class _Step:
    """One step of all chains: propose, weigh, accept or rest."""

    def __init__(
        self,
        target: LogDensity,
        proposal: Callable[[Floats, Floats], ArrayLike] | None,
        log_proposal: Callable[[Floats, Floats], ArrayLike] | None,
        acceptance: str,
        log_bound: float | None,
        scale: float,
        state: Floats,
    ) -> None:
        self.target, self.proposal, self.log_proposal = target, proposal, log_proposal
        self.acceptance, self.log_bound, self.scale, self.state = acceptance, log_bound, scale, state
        self.log = self._density(state)
        bad = np.isnan(self.log) | (self.log == -np.inf)
        if bad.any():
            raise ValueError(f"start: expected states of some density, chain {int(bad.argmax())} has none")

    def _density(self, state: Floats) -> NDArray[np.float64]:
        log = np.asarray(self.target(state), np.float64)
        if log.shape != state.shape[:1]:
            raise ValueError(f"target: expected {state.shape[0]} numbers, one a chain, got shape {log.shape}")
        return log

    def __call__(self, u: NDArray[np.float64]) -> NDArray[np.bool_]:
        d = self.state.shape[1]
        if self.proposal is None:
            # Box and Muller: two uniform numbers for each normal one.
            radius = np.sqrt(-2 * np.log1p(-u[:, :d]))
            to = self.state + self.scale * radius * np.cos(2 * np.pi * u[:, d : 2 * d])
            to = to.astype(self.state.dtype)
        else:
            to = np.asarray(self.proposal(self.state, u[:, :d].astype(self.state.dtype)), self.state.dtype)
            if to.shape != self.state.shape:
                raise ValueError(f"proposal: expected candidates of shape {self.state.shape}, got {to.shape}")
        log = self._density(to)
        forth = back = np.zeros(len(log))
        if self.log_proposal is not None:
            forth = np.asarray(self.log_proposal(self.state, to), np.float64)
            back = np.asarray(self.log_proposal(to, self.state), np.float64)
        with np.errstate(invalid="ignore"):
            if self.acceptance == "hastings":
                ratio = (log + back) - (self.log + forth)
            elif self.acceptance == "metropolis":
                ratio = log - self.log
            else:
                ratio = log + back - float(self.log_bound or 0.0)
                if (ratio > 1e-9).any():
                    raise ValueError(
                        f"log_bound: expected a bound of the target, which exceeds it by {ratio.max():.3g}"
                    )
            # NaN is never accepted.
            went = np.log1p(-u[:, 2 * d]) < ratio
        self.state = np.where(went[:, None], to, self.state)
        self.log = np.where(went, log, self.log)
        return np.asarray(went)


def _picture(target: Any) -> Floats:
    weights = _arrays.floats("target", target)
    if weights.ndim != 2 or not weights.size:
        raise ValueError(f"target: expected a callable, or a picture of shape (H, W), got shape {weights.shape}")
    if not (np.isfinite(weights).all() and (weights >= 0).all() and (weights > 0).any()):
        raise ValueError("target: expected finite weights of at least 0, one of them positive")
    return weights


def gibbs(
    target: Sequence[Callable[[Floats, Floats], ArrayLike]] | ArrayLike,
    n: int,
    *,
    start: ArrayLike | None = None,
    chains: int = 4,
    burn_in: int = 0,
    thin: int = 1,
    seed: int = 0,
    progress: bool | Callable[[int, int], object] = False,
) -> Chains:
    """Samples of a density by drawing one coordinate at a time, given the others.

    Parameters
    ----------
    target : sequence of d callables, or array_like of shape (H, W)
        The i-th draws coordinate i: from states (chains, d) and uniform numbers (chains,) to new values (chains,). Or a
        picture of weights on the unit square, which runs compiled.
    n : int
        Samples kept of each chain; one sample renews every coordinate.
    start : array_like, shape (d,) or (chains, d)
        Where chains begin; for a picture by default anywhere.
    chains : int
        Independent walks.
    burn_in, thin : int
        Samples dropped at the start, and how many are made for one that is kept.
    seed : int
        Of all random numbers.
    progress : bool or callable
        For a picture: show progress, or be told (done, total).

    Returns
    -------
    Chains
        Samples, acceptance (1 always), effective sample size, R-hat.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain, or a callable gives another number of values.

    Notes
    -----
    Where coordinates are tightly bound to each other, steps are short and chains slow; modes that share no row and no
    column are never exchanged (`r_hat` tells, if chains begin in each).

    References
    ----------
    S. Geman, D. Geman, *Stochastic relaxation, Gibbs distributions, and the Bayesian restoration of images*, 1984.

    Examples
    --------
    >>> found = gibbs([[0.0, 1.0], [1.0, 2.0]], 20000, burn_in=10)
    >>> x, y = (found.samples.reshape(-1, 2) > 0.5).T
    >>> bool(abs((x & y).mean() - 0.5) < 0.02), bool((~x & ~y).any())
    (True, False)
    """
    n, chains = many("n", n, 1), many("chains", chains, 1)
    burn_in, thin = many("burn_in", burn_in), many("thin", thin, 1)
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    if isinstance(target, Sequence) and target and all(callable(f) for f in target):
        d = len(target)
        if start is None:
            raise ValueError("start: expected states to begin from, as the target is callables; got None")
        state = _starts(start, chains, seed, _arrays.result_dtype(start=start), None)
        if state.shape[1] != d:
            raise ValueError(f"start: expected {d} numbers a chain, as there are {d} callables, got {state.shape[1]}")
        samples = np.empty((chains, n, d), state.dtype)
        for number, u in enumerate(_numbers(seed, burn_in + n * thin, chains, d)):
            for i, draw in enumerate(target):
                values = np.asarray(draw(state, u[:, i].astype(state.dtype)), state.dtype)
                if values.shape != (chains,):
                    raise ValueError(f"target: expected {chains} numbers of callable {i}, got shape {values.shape}")
                state[:, i] = values
            if number >= burn_in and (number - burn_in + 1) % thin == 0:
                samples[:, (number - burn_in) // thin] = state
        return _result(samples, np.ones(chains), burn_in)
    weights = _picture(target)
    tables = Tabulated2D(weights)._table, Tabulated2D(np.ascontiguousarray(weights.T))._table
    state = _starts(start, chains, seed, weights.dtype, 2)
    samples = np.empty((chains, n, 2), weights.dtype)
    callback = _arrays.progress_callback(progress, "gibbs")
    _kernels.gibbs(tables, (seed, burn_in, thin), state, samples, callback)
    return _result(samples, np.ones(chains), burn_in)
