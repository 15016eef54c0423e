"""Metropolis and Hastings: the target is reached by every rule, over pictures and callables; so do diagnostics."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats

PICTURE = np.array([[1, 2, 0, 4], [0.5, 0, 3, 1], [2, 2, 2, 2.0]])


def shares(samples, shape):
    x = samples.reshape(-1, 2)
    cell = np.floor(x * [shape[1], shape[0]]).astype(int)
    counts = np.zeros(shape)
    np.add.at(counts, (cell[:, 1], cell[:, 0]), 1)
    return counts / counts.sum()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("acceptance", ["hastings", "plain"])
def test_pictures_are_visited_as_their_weights_say(acceptance, dtype):
    found = sl.sampling.metropolis_hastings(
        PICTURE.astype(dtype), 20000, chains=8, scale=0.2, burn_in=200, thin=4, acceptance=acceptance, seed=3
    )
    assert found.samples.dtype == dtype and found.samples.shape == (8, 20000, 2)
    assert (found.samples >= 0).all() and (found.samples < 1).all()
    target = PICTURE / PICTURE.sum()
    # Each cell's share is an average whose error the effective sample size tells, here beyond 20,000: 5 sigma.
    assert np.abs(shares(found.samples, PICTURE.shape) - target).max() < 5 * np.sqrt(0.25 * 0.75 / 20000)
    assert shares(found.samples, PICTURE.shape)[PICTURE == 0].sum() == 0
    assert (found.r_hat < 1.01).all() and (found.effective_sample_size > 20000).all()
    assert ((found.acceptance > 0.05) & (found.acceptance < 0.95)).all()


def test_the_plain_rule_rests_more():
    rates = [
        sl.sampling.metropolis_hastings(PICTURE, 5000, acceptance=rule).acceptance.mean()
        for rule in ("hastings", "plain")
    ]
    assert rates[1] < 0.7 * rates[0]


def test_threads_change_nothing_and_seeds_do():
    results = []
    for threads in (1, 3):
        sl.set_threads(threads)
        results.append(sl.sampling.metropolis_hastings(PICTURE, 500, chains=5, seed=9).samples)
    sl.set_threads(None)
    assert np.array_equal(*results)
    assert not np.array_equal(results[0], sl.sampling.metropolis_hastings(PICTURE, 500, chains=5, seed=10).samples)


def test_thinning_and_burn_in_choose_states_of_one_walk():
    whole = sl.sampling.metropolis_hastings(PICTURE, 100, seed=4).samples
    part = sl.sampling.metropolis_hastings(PICTURE, 20, seed=4, burn_in=10, thin=3).samples
    assert np.array_equal(part, whole[:, 12 : 12 + 60 : 3])


def exponential(x):
    return np.where(x[:, 0] >= 0, -x[:, 0], -np.inf)


def test_gaussian_steps_reach_a_density_of_a_callable():
    found = sl.sampling.metropolis_hastings(exponential, 1500, start=[1.0], chains=100, scale=2.0, burn_in=60, seed=1)
    thinned = found.samples[:, ::50, 0].ravel()
    # Fifty steps are some ten correlation times.
    assert stats.kstest(thinned, "expon").pvalue > 1e-5
    assert found.r_hat[0] < 1.01


def uneven(state, u):
    """Steps to the right twice as often: not symmetric."""
    return state + np.where(u < 2 / 3, 0.7, -0.7) * (0.2 + u)


def lognormal(state, u):
    """A factor: q(x, y) is a density of ln y about ln x, over y."""
    return state * np.exp(stats.norm.ppf(np.clip(u, 1e-12, 1)))


def log_lognormal(here, there):
    return stats.norm.logpdf(np.log(there[:, 0] / here[:, 0])) - np.log(there[:, 0])


@pytest.mark.parametrize("acceptance", ["hastings", "plain"])
def test_hastings_ratio_mends_uneven_proposals(acceptance):
    """Candidates of density 2y, whatever the state; the target is 6 y (1 - y), so pi q is below 3."""
    found = sl.sampling.metropolis_hastings(
        lambda x: np.log(6 * x[:, 0] * (1 - x[:, 0])),
        400,
        start=[0.5],
        chains=200,
        proposal=lambda state, u: np.sqrt(1 - u),
        log_proposal=lambda here, there: np.log(2 * there[:, 0]),
        acceptance=acceptance,
        log_bound=np.log(3),
        burn_in=50,
        seed=2,
    )
    step = int(3 * found.samples[..., 0].size / found.effective_sample_size[0])
    assert stats.kstest(found.samples[:, ::step, 0].ravel(), stats.beta(2, 2).cdf).pvalue > 1e-5


def test_hastings_ratio_mends_a_walk_of_factors():
    found = sl.sampling.metropolis_hastings(
        lambda x: 3 * np.log(x[:, 0]) - x[:, 0],
        400,
        start=[2.0],
        chains=200,
        proposal=lognormal,
        log_proposal=log_lognormal,
        burn_in=100,
        seed=2,
    )
    step = int(3 * found.samples[..., 0].size / found.effective_sample_size[0])
    assert stats.kstest(found.samples[:, ::step, 0].ravel(), stats.gamma(4).cdf).pvalue > 1e-5


def test_without_the_ratio_uneven_proposals_are_wrong():
    found = sl.sampling.metropolis_hastings(
        exponential, 600, start=[1.0], chains=100, proposal=lognormal, acceptance="metropolis", burn_in=300, seed=2
    )
    # q(x, y) / q(y, x) = x / y goes missing: the walk settles on exp(-x) / x, piled up at zero.
    assert np.median(found.samples) < 0.3


def test_effective_sample_size_of_an_autoregression():
    rng = np.random.default_rng(5)
    for phi in (0.0, 0.5, 0.9):
        x = np.zeros((4, 20000))
        noise = rng.normal(size=x.shape)
        for t in range(1, x.shape[1]):
            x[:, t] = phi * x[:, t - 1] + noise[:, t]
        expected = x.size * (1 - phi) / (1 + phi)
        assert sl.sampling.effective_sample_size(x) == pytest.approx(expected, rel=0.12)


def test_r_hat_tells_chains_apart():
    x = np.random.default_rng(6).normal(size=(4, 500, 2))
    assert (sl.sampling.r_hat(x) < 1.02).all()
    x[0, :, 1] += 3
    assert sl.sampling.r_hat(x)[0] < 1.02 and sl.sampling.r_hat(x)[1] > 1.5
    assert np.isnan(sl.sampling.r_hat(np.ones((2, 10))))


def test_two_modes_apart_are_seen_by_r_hat():
    picture = np.zeros((8, 8))
    picture[1, 1] = picture[6, 6] = 1
    start = np.array([[0.2, 0.2], [0.8, 0.8]])
    stuck = sl.sampling.metropolis_hastings(picture, 2000, chains=2, scale=0.02, leap=0, start=start)
    free = sl.sampling.metropolis_hastings(picture, 20000, chains=2, scale=0.02, leap=0.5, start=start)
    assert (stuck.r_hat > 2).all() and (free.r_hat < 1.1).all()


def test_arguments_are_checked():
    with pytest.raises(ValueError, match="start: expected states to begin from"):
        sl.sampling.metropolis_hastings(exponential, 10)
    with pytest.raises(ValueError, match="start: expected states of some density, chain 0"):
        sl.sampling.metropolis_hastings(exponential, 10, start=[-1.0])
    with pytest.raises(ValueError, match="target: expected finite weights"):
        sl.sampling.metropolis_hastings(-PICTURE, 10)
    with pytest.raises(ValueError, match="log_bound: expected the logarithm"):
        sl.sampling.metropolis_hastings(exponential, 10, start=[1.0], acceptance="plain")
    with pytest.raises(ValueError, match="log_bound: expected a bound"):
        sl.sampling.metropolis_hastings(exponential, 100, start=[1.0], acceptance="plain", log_bound=-3.0)
    with pytest.raises(ValueError, match="scale: "):
        sl.sampling.metropolis_hastings(PICTURE, 10, scale=0)
    with pytest.raises(ValueError, match="proposal: expected None"):
        sl.sampling.metropolis_hastings(PICTURE, 10, proposal=uneven)
