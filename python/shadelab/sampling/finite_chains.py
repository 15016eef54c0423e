"""Chains of finitely many states: what they tend to, and whether they are in balance."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays

__all__ = ["Balance", "detailed_balance", "stationary_distribution"]


def _transition(matrix: ArrayLike) -> NDArray[np.float64]:
    p = np.asarray(_arrays.floats("matrix", matrix), np.float64)
    if p.ndim != 2 or p.shape[0] != p.shape[1] or not p.size:
        raise ValueError(f"matrix: expected shape (n, n), got {p.shape}")
    if not (p >= 0).all() or not np.allclose(p.sum(1), 1, atol=1e-6):
        raise ValueError("matrix: expected probabilities whose rows sum to one")
    return p


def stationary_distribution(matrix: ArrayLike) -> NDArray[np.float64]:
    """The distribution that a finite chain leaves as it is: π P = π.

    Parameters
    ----------
    matrix : array_like, shape (n, n)
        Row i holds the probabilities of going from i to each state.

    Returns
    -------
    ndarray of float64, shape (n,)
        Sums to one.

    Raises
    ------
    TypeError, ValueError
        If `matrix` is no matrix of such rows, or states fall into groups that never meet (the answer is not unique).

    Notes
    -----
    States are eliminated one by one without a subtraction (Grassmann, Taksar, Heyman), so each probability keeps nearly
    all its digits, however small it is; in double, n³ / 3 steps. States that are left for good have none.

    References
    ----------
    W. K. Grassmann, M. I. Taksar, D. P. Heyman, *Regenerative analysis and steady state distributions for Markov
    chains*, 1985.

    Examples
    --------
    >>> stationary_distribution([[0.9, 0.1], [0.3, 0.7]])
    array([0.75, 0.25])
    """
    p = _transition(matrix)
    n = len(p)
    reach = (p > 0) | np.eye(n, dtype=bool)
    for _ in range(max(n - 1, 1).bit_length()):
        reach = reach.astype(np.float64) @ reach.astype(np.float64) > 0
    # States that all others lead to: the one group in which a chain ends.
    final = reach.all(0)
    if not final.any():
        raise ValueError("matrix: expected one group of states that chains end in, got several")
    a = p[np.ix_(final, final)].copy()
    for k in range(len(a) - 1, 0, -1):
        a[:k, k] /= a[k, :k].sum()
        a[:k, :k] += np.outer(a[:k, k], a[k, :k])
    weight = np.ones(len(a))
    for k in range(1, len(a)):
        weight[k] = weight[:k] @ a[:k, k]
    out = np.zeros(n)
    out[final] = weight / weight.sum()
    return out


class Balance(NamedTuple):
    """The flows between states under a distribution."""

    holds: bool
    """Whether every flow equals the one back, to 1e-10 of the largest."""
    violation: float
    """The largest difference of a flow and the one back."""
    flows: NDArray[np.float64]
    """π_i P_ij: what goes from i to j in a step."""


def detailed_balance(matrix: ArrayLike, distribution: ArrayLike | None = None) -> Balance:
    """Whether a finite chain is reversible: π_i P_ij = π_j P_ji for every pair.

    Parameters
    ----------
    matrix : array_like, shape (n, n)
        Row i holds the probabilities of going from i to each state.
    distribution : array_like, shape (n,), optional
        π; by default the stationary one.

    Returns
    -------
    Balance
        Whether it holds, the largest violation, and all flows.

    Raises
    ------
    TypeError, ValueError
        If an argument is of other shape, or no probabilities.

    Notes
    -----
    Detailed balance makes π stationary; the converse is false: a chain that turns in circles has a stationary
    distribution too.

    Examples
    --------
    >>> detailed_balance([[0.9, 0.1], [0.3, 0.7]]).holds
    True
    >>> detailed_balance([[0, 1, 0], [0, 0, 1], [1, 0, 0]]).holds
    False
    """
    p = _transition(matrix)
    if distribution is None:
        pi = stationary_distribution(p)
    else:
        pi = np.asarray(_arrays.floats("distribution", distribution), np.float64)
        if pi.shape != (len(p),) or not (pi >= 0).all() or abs(pi.sum() - 1) > 1e-6:
            raise ValueError(f"distribution: expected {len(p)} probabilities that sum to one, got shape {pi.shape}")
    flows = pi[:, None] * p
    violation = float(np.abs(flows - flows.T).max())
    return Balance(violation <= 1e-10 * float(flows.max()), violation, flows)
