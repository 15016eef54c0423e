"""Finite chains: stationary distributions to the last digit, and which chains are reversible."""

from fractions import Fraction

import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 8), st.integers(0, 10**6))
def test_stationary_distributions_are_left_as_they_are(n, seed):
    p = np.random.default_rng(seed).random((n, n)) ** 8 + 1e-12
    p /= p.sum(1, keepdims=True)
    pi = sl.sampling.stationary_distribution(p)
    assert pi.sum() == pytest.approx(1, abs=1e-14) and np.abs(pi @ p - pi).max() < 1e-14


def test_tiny_probabilities_keep_their_digits():
    e = 1e-14
    p = np.array([[1 - e, e, 0], [0.5, 0.5 - e, e], [0, 0.5, 0.5]])
    pi = sl.sampling.stationary_distribution(p)
    # Detailed balance of a birth and death chain: pi1 = 2e pi0, pi2 = 2e pi1.
    exact = np.array([float(x) for x in (Fraction(1), 2 * Fraction(e), 4 * Fraction(e) ** 2)])
    assert np.allclose(pi, exact / exact.sum(), rtol=1e-14)


def test_states_left_for_good_have_no_share():
    assert np.allclose(sl.sampling.stationary_distribution([[0.5, 0.5, 0], [0, 0, 1], [0, 1, 0]]), [0, 0.5, 0.5])
    with pytest.raises(ValueError, match="matrix: expected one group"):
        sl.sampling.stationary_distribution(np.eye(3))


def test_metropolis_balances_in_detail_by_either_rule():
    rng = np.random.default_rng(1)
    target = rng.random(6)
    target /= target.sum()
    q = rng.random((6, 6))
    q /= q.sum(1, keepdims=True)
    hastings = q * np.minimum(1, target * q.T / (target[:, None] * q))
    plain = q * (target * q.T) / (target * q.T).max()
    for p in (hastings, plain):
        p = p - np.diag(np.diag(p))
        p += np.diag(1 - p.sum(1))
        assert np.allclose(sl.sampling.stationary_distribution(p), target, rtol=1e-12)
        assert sl.sampling.detailed_balance(p).holds and sl.sampling.detailed_balance(p, target).holds
    # Metropolis' ratio without Hastings' factor: another distribution.
    wrong = q * np.minimum(1, target / target[:, None])
    wrong = wrong - np.diag(np.diag(wrong))
    wrong += np.diag(1 - wrong.sum(1))
    assert not sl.sampling.detailed_balance(wrong, target).holds
    assert np.abs(sl.sampling.stationary_distribution(wrong) - target).max() > 0.01


def test_a_cycle_is_stationary_but_not_reversible():
    found = sl.sampling.detailed_balance([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    assert not found.holds and found.violation == pytest.approx(1 / 3)
    assert np.allclose(found.flows.sum(0), found.flows.sum(1))


def test_arguments_are_checked():
    with pytest.raises(ValueError, match="matrix: expected probabilities"):
        sl.sampling.stationary_distribution([[0.5, 0.6], [1, 0]])
    with pytest.raises(ValueError, match=r"matrix: expected shape \(n, n\)"):
        sl.sampling.detailed_balance([[1.0, 0.0]])
    with pytest.raises(ValueError, match="distribution: "):
        sl.sampling.detailed_balance([[1.0]], [0.5])
