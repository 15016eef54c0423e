"""Questions whose answers are known exactly: a ramp, a reference with chosen noise, candidates of chosen bias."""

import numpy as np
from shadelab.study import Candidate, Mask, Metric, MonteCarlo, Question

SIZE = (96, 64)


def truth(inputs):
    width, height = inputs.size
    y, x = np.mgrid[0:height, 0:width]
    return (0.5 + 0.4 * np.sin(x / 9) * np.cos(y / 7)).astype(inputs.dtype)


def noise(shape, seed, start, samples):
    """The mean of unit normals `start … start + samples` of a stream: one generator a sample."""
    return np.mean([np.random.default_rng([seed, i]).normal(size=shape) for i in range(start, start + samples)], axis=0)


def estimate(sigma):
    def sample(inputs, samples, seed, start, where):
        exact = truth(inputs)
        return (exact + sigma * noise(exact.shape, seed, start, samples)).astype(inputs.dtype)

    return sample


def biased(inputs, prepared, bias):
    return truth(inputs) + np.asarray(bias, inputs.dtype)


def noisy(inputs, prepared, samples, seed):
    exact = truth(inputs)
    return exact + (0.1 * noise(exact.shape, seed, 0, samples)).astype(inputs.dtype)


DIFFERENCE = Metric("difference", lambda x, r, _: x - r, about="The difference.")
LEFT = Mask("left half", lambda r, inputs: np.broadcast_to(np.arange(r.shape[1]) < r.shape[1] // 2, r.shape))


def question(sigma=0.0, candidates=None, mask=LEFT, scenes=("ramp",), **more):
    reference = MonteCarlo(estimate(sigma), first=4, most=256) if sigma else truth
    if candidates is None:
        candidates = [
            Candidate("biased", biased, {"bias": (0.01, 0.1)}),
            Candidate("noisy", noisy, {"samples": (4, 16)}, seeded=True),
        ]
    return Question("toy", dict.fromkeys(scenes, 0), reference, DIFFERENCE, candidates, mask, size=SIZE, **more)
