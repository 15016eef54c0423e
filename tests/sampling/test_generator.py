"""Random numbers: the published vectors, uniform and independent in every coordinate of the counter."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats


def test_philox_gives_the_published_vectors():
    # Random123, tests/kat_vectors: counter, key, answer.
    ones, pi = [0xFFFFFFFF] * 6, [0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344, 0xA4093822, 0x299F31D0]
    words = np.array([[0] * 6, ones, pi], np.uint32)
    got = sl.sampling.philox(words[:, :4], words[:, 4:])
    answers = [
        [0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8],
        [0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD],
        [0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1],
    ]
    assert got.tolist() == answers


@pytest.mark.parametrize("axis", ["pixel", "sample", "dimension"])
def test_numbers_are_uniform_along_each_coordinate(axis):
    n = 1 << 16
    where = {"pixel": 5, "sample": 9, "dimension": 2} | {axis: np.arange(n)}
    u = sl.sampling.Generator(3).uniform(**where)
    assert u.min() >= 0 and u.max() < 1
    # Chance of failing for a good generator: 1e-6 each, and the seed is fixed.
    assert stats.chisquare(np.histogram(u, 256, (0, 1))[0]).pvalue > 1e-6
    assert stats.chisquare(np.histogram2d(u[::2], u[1::2], 16, [(0, 1)] * 2)[0].ravel()).pvalue > 1e-6
    assert abs(np.corrcoef(u[:-1], u[1:])[0, 1]) < 5 / np.sqrt(n)


def test_seeds_and_coordinates_give_different_streams():
    i = np.arange(4)
    u = np.stack([sl.sampling.Generator(s).uniform(i[:, None, None], i[:, None], i) for s in range(4)])
    assert len(np.unique(u)) == 4**4


def test_single_precision_is_double_rounded_down():
    g = sl.sampling.Generator(2**64 - 1)
    u = g.uniform(np.arange(1000), 2**32 - 1, 2**32 - 1)
    assert np.array_equal(np.floor(u * 2**24) / 2**24, g.uniform(np.arange(1000), 2**32 - 1, 2**32 - 1, np.float32))


def test_arguments_out_of_domain_are_refused():
    with pytest.raises(ValueError, match="seed: expected an integer from 0"):
        sl.sampling.Generator(-1)
    with pytest.raises(ValueError, match=r"sample: expected integers from 0 to 4294967295, got 4294967296"):
        sl.sampling.Generator(1).uniform(0, 2**32)
    with pytest.raises(TypeError, match="pixel: expected integers"):
        sl.sampling.Generator(1).uniform(0.5)
    with pytest.raises(TypeError, match="dtype: expected float32 or float64"):
        sl.sampling.Generator(1).uniform(0, dtype=np.float16)
    with pytest.raises(ValueError, match=r"key: expected shape \(\.\.\., 2\)"):
        sl.sampling.philox([0, 0, 0, 0], [0, 0, 0])
