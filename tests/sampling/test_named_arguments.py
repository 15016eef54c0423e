"""What cannot be is named by its argument, in the chapter's words rather than NumPy's."""

import numpy as np
import pytest
from shadelab import sampling as s

HUGE = 2**63


def ramp(x):
    return x[:, 0]


@pytest.mark.parametrize(
    "call",
    [
        lambda: s.halton(HUGE, 2),
        lambda: s.hammersley(HUGE, 2),
        lambda: s.r2(HUGE),
        lambda: s.sobol(HUGE, 2),
        lambda: s.fibonacci_sphere(HUGE),
        lambda: s.vogel_disk(HUGE),
        lambda: s.gibbs(np.ones((4, 4)), HUGE),
        lambda: s.metropolis_hastings(np.ones((4, 4)), HUGE),
        lambda: s.integrate(ramp, 2**64),
        lambda: s.rejection_sample(ramp, HUGE, bound=1),
    ],
)
def test_more_points_than_any_memory_holds(call):
    with pytest.raises(ValueError, match=r"^n: expected an integer from \d+ to 1099511627776"):
        call()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: s.metropolis_hastings(np.ones((4, 4)), 4, burn_in=2**64), "burn_in: expected an integer"),
        (lambda: s.gibbs(np.ones((4, 4)), 4, chains=2**64), "chains: expected an integer"),
        (lambda: s.stratified(None), "counts: expected an integer or several, got NoneType"),
        (lambda: s.blue_noise_mask(()), "size: expected 2 integers"),
        (lambda: s.integrate(ramp, 64, method="mis", techniques=3), "techniques: expected one Technique or several"),
        (lambda: s.integrate(3, 64), "f: expected a callable"),
        (lambda: s.integrate(ramp, 64, method="control_variate", control=(3, 1)), "control: expected a callable"),
        (lambda: s.balance_heuristic([]), "pdfs: expected shape"),
        (lambda: s.power_heuristic([1.0, 2.0], power=None), "power: expected a number"),
        (lambda: s.inverse_transform([0.5], low=0, high=1, pdf=3), "pdf: expected a callable"),
        (lambda: s.inverse_transform([0.5], low=0, high=1, cdf=3), "cdf: expected a callable"),
        (lambda: s.manifold_density(3, [[0.5]]), "mapping: expected a callable"),
        (lambda: s.manifold_density(lambda u: u, [[0.5]], jacobian=3), "jacobian: expected a callable"),
        (lambda: s.rejection_sample(3, 4, bound=1), "density: expected a callable"),
        (lambda: s.rejection_sample(ramp, 4, bound=1, proposal=()), "proposal: expected two callables"),
    ],
)
def test_arguments_are_named(call, message):
    with pytest.raises((TypeError, ValueError), match=f"^{message}"):
        call()


def test_the_maximum_heuristic_is_still_there():
    assert np.array_equal(s.power_heuristic([1.0, 3.0], power=np.inf), [0, 1])
