"""Spectra: the definition, Fourier transforms of grids, ones for random points, silence for even ones."""

import numpy as np
import pytest
import shadelab as sl


def test_it_is_the_definition():
    p = np.random.default_rng(0).uniform(size=(77, 2))
    got = sl.sampling.power_spectrum(p, reach=40)
    k = np.arange(-40, 41)
    waves = np.exp(-2j * np.pi * p[:, 0, None] * k)[:, None, :] * np.exp(-2j * np.pi * p[:, 1, None] * k)[:, :, None]
    expected = np.abs(waves.sum(0)) ** 2 / 77
    assert got.power.shape == (81, 81)
    assert np.abs(got.power - expected).max() < 1e-14 * 40 * 77
    assert got.power[40, 40] == pytest.approx(77, rel=1e-12)


def test_grids_are_delta_functions():
    power = sl.sampling.power_spectrum(sl.sampling.stratified((8, 8), jitter=False), reach=16).power
    k = np.arange(-16, 17) % 8 == 0
    assert np.allclose(power, 64 * (k[:, None] & k), atol=1e-10)


def test_rings_average_and_random_points_have_one():
    rng = np.random.default_rng(1)
    spectrum = sl.sampling.power_spectrum(rng.uniform(size=(60, 400, 2)), reach=30)
    # A ring of some 2πk frequencies, half of them independent, over 60 sets: at k = 1 the error is 1 / √240.
    assert np.abs(spectrum.radial[4:] - 1).max() < 0.25
    assert abs(spectrum.radial[4:].mean() - 1) < 0.02
    assert np.all(np.abs(spectrum.frequency - np.arange(1, 31)) < 0.25)
    one = sl.sampling.power_spectrum(rng.uniform(size=(400, 2)), reach=30)
    # The power of random points has an exponential distribution, whose variance is its squared mean.
    assert abs(one.anisotropy[10:].mean() - 1) < 0.15


def test_multi_jittered_points_are_silent_along_the_axes():
    sets = np.stack([sl.sampling.multi_jittered((16, 16), seed=s) for s in range(40)])
    power = sl.sampling.power_spectrum(sets, reach=40).power
    assert power[40, 41:56].max() < 0.2
    assert power[41:56, 40].max() < 0.2


def test_bad_arguments_are_named():
    with pytest.raises(ValueError, match="points"):
        sl.sampling.power_spectrum([[0.5, 0.5, 0.5]])
    with pytest.raises(ValueError, match="points"):
        sl.sampling.power_spectrum([[0.5, np.nan]])
    with pytest.raises(ValueError, match="reach"):
        sl.sampling.power_spectrum([[0.5, 0.5]], reach=0)
