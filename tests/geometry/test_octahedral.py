"""Octahedral directions: there and back, angles by bits, best codes, folds."""

import itertools

import numpy as np
import pytest
import shadelab as sl

PRECISIONS = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def directions(n, seed=1):
    v = np.random.default_rng(seed).normal(size=(n, 3))
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def angle(a, b):
    return 2 * np.arcsin(np.linalg.norm(a.astype(float) - b, axis=-1) / 2)


@PRECISIONS
def test_there_and_back_to_three_roundings(dtype):
    v = directions(20000)
    axes = np.array(list(itertools.product([-1, 0, 1], repeat=3)), float)
    axes = axes[axes.any(-1)]
    seams = directions(2000, 2) * np.random.default_rng(3).choice([0, 1e-9, 1e-4, 1], (2000, 3))
    v = np.concatenate([v, axes, seams[seams.any(-1)]])
    v = (v / np.linalg.norm(v, axis=-1, keepdims=True)).astype(dtype)
    square = sl.geometry.octahedral_encode(v)
    assert square.dtype == dtype and (np.abs(square) <= 1).all()
    back = sl.geometry.octahedral_decode(square)
    assert back.dtype == dtype and angle(back, v).max() <= 3 * np.finfo(dtype).eps
    assert np.abs(np.linalg.norm(back.astype(float), axis=-1) - 1).max() <= 2 * np.finfo(dtype).eps


@PRECISIONS
@pytest.mark.parametrize(
    ("bits", "precise", "nearest"), [(6, 2.61, 3.90), (8, 0.635, 0.954), (12, 0.03945, 0.0594), (16, 0.00248, 0.0037)]
)
def test_largest_angle_by_bits(dtype, bits, precise, nearest):
    v = directions(100000)
    for rounding, bound in (("precise", precise), ("nearest", nearest)):
        codes = sl.geometry.octahedral_encode(v.astype(dtype), bits, rounding=rounding)
        assert codes.dtype == (np.int8 if bits <= 8 else np.int16) and np.abs(codes.astype(int)).max() < 2 ** (bits - 1)
        found = np.degrees(angle(sl.geometry.octahedral_decode(codes, bits, dtype=np.float64), v)).max()
        # Of the docstring's table; a hundred thousand directions come near the largest.
        assert 0.9 * bound < found <= bound


@PRECISIONS
@pytest.mark.parametrize("bits", [2, 3, 5])
def test_precise_codes_are_the_best_of_the_four_around(dtype, bits):
    v = directions(3000).astype(dtype)
    scale = 2 ** (bits - 1) - 1
    got = angle(sl.geometry.octahedral_decode(sl.geometry.octahedral_encode(v, bits), bits, dtype=np.float64), v)
    low = np.floor(sl.geometry.octahedral_encode(v) * scale)
    four = np.clip([low + np.array([i, j]) for i in (0, 1) for j in (0, 1)], -scale, scale) / scale
    best = angle(sl.geometry.octahedral_decode(four), v).min(0)
    assert np.abs(got - best).max() < 1e-5
    plain = sl.geometry.octahedral_decode(
        sl.geometry.octahedral_encode(v, bits, rounding="nearest"), bits, dtype=np.float64
    )
    assert (got <= angle(plain, v) + 1e-6).all()


def test_every_code_comes_back():
    grid = np.stack(np.meshgrid(np.arange(-15, 16), np.arange(-15, 16)), -1).astype(np.int8)
    v = sl.geometry.octahedral_decode(grid, 5)
    again = sl.geometry.octahedral_decode(sl.geometry.octahedral_encode(v, 5), 5)
    assert v.dtype == np.float32 and np.abs(v - again).max() < 1e-6


@PRECISIONS
@pytest.mark.parametrize("length", [1e-42, 1e-20, 1e20, 1e38])
def test_length_does_not_matter(dtype, length):
    v = directions(500)
    got = sl.geometry.octahedral_encode((v * length).astype(dtype))
    # Subnormal numbers have few digits left.
    bound = 1e-2 if dtype == np.float32 and length < 1e-37 else 20 * np.finfo(dtype).eps
    assert np.abs(got - sl.geometry.octahedral_encode(v)).max() < bound


def test_nan_has_the_code_that_is_left():
    v = np.array([[0, 0, 0], [np.nan, 0, 1], [np.inf, 0, 1], [0, 0, 1.0]])
    assert np.isnan(sl.geometry.octahedral_encode(v)[:3]).all()
    codes = sl.geometry.octahedral_encode(v, 8)
    assert codes.tolist() == [[-128, -128]] * 3 + [[0, 0]]
    assert np.isnan(sl.geometry.octahedral_decode(codes, 8)).tolist() == [[True] * 3] * 3 + [[False] * 3]
    assert np.isnan(sl.geometry.octahedral_decode([[1.5, 0], [0, np.nan]])).all()


def test_bad_options_are_named():
    with pytest.raises(ValueError, match="bits: expected an integer from 2 to 24"):
        sl.geometry.octahedral_encode([0, 0, 1], 25)
    with pytest.raises(ValueError, match="rounding: expected one of"):
        sl.geometry.octahedral_encode([0, 0, 1], 8, rounding="floor")
    with pytest.raises(TypeError, match="codes: expected bits="):
        sl.geometry.octahedral_decode(np.array([1, 2], np.int8))
    with pytest.raises(TypeError, match="codes: expected integers"):
        sl.geometry.octahedral_decode([0.5, 0.5], 8)
