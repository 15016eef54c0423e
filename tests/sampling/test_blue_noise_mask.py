"""Masks: every rank once, blue noise at every threshold and around the edges, the same by brute force."""

import numpy as np
import pytest
import shadelab as sl


@pytest.mark.parametrize("size", [2, 5, (7, 3), (1, 9), 32, (40, 17)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_every_rank_is_there_once(size, dtype):
    width, height = size if isinstance(size, tuple) else (size, size)
    mask = sl.sampling.blue_noise_mask(size, seed=3, dtype=dtype)
    assert mask.shape == (height, width)
    assert mask.dtype == dtype
    n = width * height
    assert np.array_equal(np.sort(mask, axis=None), ((np.arange(n) + 0.5) / n).astype(dtype))


@pytest.mark.parametrize("level", [0.1, 0.3, 0.5, 0.8])
def test_pixels_below_any_threshold_are_blue(level):
    mask = sl.sampling.blue_noise_mask(64, seed=1)
    bits = (mask < level) - level
    power = np.abs(np.fft.fft2(bits)) ** 2 / (mask.size * level * (1 - level))
    k = np.minimum(np.arange(64), 64 - np.arange(64))
    ring = np.hypot(k, k[:, None])
    # White noise has 1 at every frequency; the Fourier transform knows the torus alone, so edges are included.
    principal = np.sqrt(min(level, 1 - level)) * 64
    assert power[(ring > 0) & (ring < 0.4 * principal)].mean() < 0.15
    assert power[ring > 25].mean() > 0.8


def test_fills_follow_the_definition():
    # From any state on, the next pixel is the one that the set ones repel least: by full convolution in doubles.
    width, height = 24, 20
    ranks = (sl.sampling.blue_noise_mask((width, height), seed=2) * width * height - 0.5).round().astype(int)

    def axis(n):
        return sum(np.exp(-((np.arange(n) + shift * n) ** 2) / 4.5) for shift in range(-3, 4))

    kernel = np.fft.rfft2(axis(height)[:, None] * axis(width))
    for rank in range(width * height // 10, width * height - 1):
        energy = np.fft.irfft2(np.fft.rfft2((ranks < rank) * 1.0) * kernel, s=ranks.shape)
        # Ties are broken at random and energies rounded to single precision.
        assert energy[ranks == rank][0] <= energy[ranks >= rank].min() + 2e-5


def test_seeds_differ_and_bad_arguments_are_named():
    assert not np.array_equal(sl.sampling.blue_noise_mask(16), sl.sampling.blue_noise_mask(16, seed=1))
    for size in (0, 1, (4096, 4096)):
        with pytest.raises(ValueError, match="size"):
            sl.sampling.blue_noise_mask(size)
    with pytest.raises(ValueError, match="sigma"):
        sl.sampling.blue_noise_mask(8, sigma=0)
