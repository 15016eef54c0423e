"""What chains tell of themselves: effective sample size, R-hat."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .generators import Generator  # noqa: F401 (examples)

__all__ = ["effective_sample_size", "r_hat"]


def effective_sample_size(samples: ArrayLike) -> NDArray[np.float64]:
    """How many independent samples tell as much about the mean as those of correlated chains.

    Parameters
    ----------
    samples : array_like, shape (chains, n, ...)
        Of at least one chain and four steps.

    Returns
    -------
    ndarray of float64, shape (...)
        `chains * n` over the sum of autocorrelations; NaN where all samples are one number.

    Raises
    ------
    TypeError, ValueError
        If `samples` is not real, or of fewer steps.

    Notes
    -----
    Autocorrelations of all chains are pooled and summed in pairs while these stay positive and decrease (Geyer). Chains
    that disagree count for less. Chains that drift back and forth can count for more than their length.

    References
    ----------
    C. J. Geyer, *Practical Markov chain Monte Carlo*, 1992.
    A. Vehtari, A. Gelman, D. Simpson, B. Carpenter, P.-C. Bürkner, *Rank-normalization, folding, and localization: an
    improved R-hat for assessing convergence of MCMC*, 2021.

    Examples
    --------
    >>> x = Generator(1).uniform(np.arange(4)[:, None], np.arange(1000))
    >>> bool(3000 < effective_sample_size(x) < 5000)
    True
    """
    x = _chains(samples)
    m, n = x.shape[:2]
    centered = x - x.mean(1, keepdims=True)
    # Autocovariances by Fourier's transform, padded so that ends do not meet.
    size = 1 << (2 * n - 1).bit_length()
    spectrum = np.fft.rfft(centered, size, axis=1)
    covariance = np.fft.irfft(np.abs(spectrum) ** 2, size, axis=1)[:, :n].mean(0) / n
    within = covariance[0] * n / (n - 1)
    total = covariance[0] + (x.mean(1).var(0, ddof=1) if m > 1 else 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        rho = 1 - (within - covariance * n / (n - 1)) / total
    rho[0] = 1
    pairs = rho[: n // 2 * 2].reshape(n // 2, 2, *x.shape[2:]).sum(1)
    positive = np.logical_and.accumulate(pairs > 0, axis=0)
    summed = np.where(positive, np.minimum.accumulate(pairs, axis=0), 0).sum(0)
    with np.errstate(divide="ignore", invalid="ignore"):
        # Chains that alternate could seem worth infinitely much.
        tau = np.maximum(2 * summed - 1, 1 / np.log10(max(m * n, 10)))
        return np.asarray(np.where(total > 0, m * n / tau, np.nan))


def r_hat(samples: ArrayLike) -> NDArray[np.float64]:
    """How far chains disagree: the spread of all samples over that within chains, each chain split in two.

    Parameters
    ----------
    samples : array_like, shape (chains, n, ...)
        Of at least one chain and four steps.

    Returns
    -------
    ndarray of float64, shape (...)
        1 where chains are alike; NaN where all samples are one number, infinite where chains stand still apart.

    Raises
    ------
    TypeError, ValueError
        If `samples` is not real, or of fewer steps.

    Notes
    -----
    It cannot see what no chain has visited.

    References
    ----------
    A. Gelman, D. B. Rubin, *Inference from iterative simulation using multiple sequences*, 1992; split as in A. Gelman
    and others, *Bayesian Data Analysis*, 2013, section 11.4.

    Examples
    --------
    >>> x = Generator(1).uniform(np.arange(4)[:, None], np.arange(1000))
    >>> bool(r_hat(x) < 1.01), bool(r_hat(x + np.arange(4)[:, None]) > 2)
    (True, True)
    """
    x = _chains(samples)
    half = x.shape[1] // 2
    parts = np.concatenate([x[:, :half], x[:, -half:]])
    within = parts.var(1, ddof=1).mean(0)
    between = parts.mean(1).var(0, ddof=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.sqrt((half - 1) / half + between / within))


def _chains(samples: ArrayLike) -> NDArray[np.float64]:
    x = np.asarray(_arrays.floats("samples", samples), np.float64)
    if x.ndim < 2 or x.shape[0] < 1 or x.shape[1] < 4:
        raise ValueError(f"samples: expected shape (chains, n, ...) with n of at least 4, got {x.shape}")
    return x
