"""Morton codes and the radix tree: bits one by one, prefixes by definition."""

import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st


def interleaved(cell, bits):
    return sum(((int(cell[k]) >> b) & 1) << (3 * b + k) for b in range(bits // 3) for k in range(3))


@pytest.mark.parametrize("bits", [30, 63])
def test_codes_interleave_bits(bits):
    rng = np.random.default_rng(0)
    top = 1 << bits // 3
    cells = np.concatenate([rng.integers(top, size=(300, 3)), [[0, 0, 0], [top - 1] * 3]])
    codes = sl.accel.morton_encode(cells, bits)
    assert codes.dtype == (np.uint32 if bits == 30 else np.uint64)
    assert codes.tolist() == [interleaved(c, bits) for c in cells]
    assert (sl.accel.morton_decode(codes, bits) == cells).all()


@pytest.mark.parametrize("bits", [30, 63])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_points_come_back_within_half_a_cell(bits, dtype):
    p = np.random.default_rng(1).normal(size=(4, 50, 3)).astype(dtype) * [1, 1e-3, 1e6]
    low, high = p.min((0, 1)), p.max((0, 1))
    codes = sl.accel.morton_encode(p, bits)
    assert codes.shape == (4, 50)
    back = sl.accel.morton_decode(codes, bits, lower=low, upper=high)
    # A rounding unit more, since borders of cells are rounded.
    assert (np.abs(back - p) <= (high - low) * (0.5 / 2 ** (bits // 3) + 1e-15) + np.abs(p) * 1e-15).all()


def test_flat_and_huge_boxes():
    p = [[0.0, 5.0, 1.0], [1.0, 5.0, 1.0]]
    assert sl.accel.morton_decode(sl.accel.morton_encode(p, 30), 30).tolist() == [[0, 0, 0], [1023, 0, 0]]
    huge = np.array([[-1.5e308, 0, 0], [1.5e308, 0, 0]])
    assert sl.accel.morton_decode(sl.accel.morton_encode(huge, 30), 30)[:, 0].tolist() == [0, 1023]
    assert sl.accel.morton_encode(np.zeros((0, 3))).shape == (0,)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (dict(points=[[0, 0, 1024]], bits=30), "points: expected cell numbers"),
        (dict(points=[[0, -1, 0]]), "points: expected cell numbers"),
        (dict(points=[[0.0, np.nan, 0]]), "points: expected finite"),
        (dict(points=[[0.0, 2.0, 0]], lower=[0, 0, 0], upper=[1, 1, 1]), "points: expected points between"),
        (dict(points=[[0.0, 0.5, 0]], lower=[0, 1, 0], upper=[1, 0, 1]), "upper: expected at least lower"),
        (dict(points=[[0.0, 0.5]]), "points: expected shape"),
        (dict(points=[[0, 0, 0]], bits=32), "bits: expected 30 or 63"),
        (dict(points=[[0, 0, 0]], lower=[0, 0, 0]), "lower: cell numbers have no box"),
    ],
)
def test_bad_points_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        sl.accel.morton_encode(**arguments)


def check(codes):
    """Against the definition: children share a longer prefix than their node, and all leaves hang on the root."""
    tree = sl.accel.radix_tree(codes)
    n = len(codes)
    keys = [(int(c) << 32) | i for i, c in enumerate(codes)]

    def prefix(i, j):
        return 96 - (keys[i] ^ keys[j]).bit_length()

    assert (tree.first[0], tree.last[0]) == (0, n - 1)
    assert tree.parent[0] == -1 and (tree.parent[1:] >= 0).all()
    for i in range(n - 1):
        ends = []
        for child in (tree.left[i], tree.right[i]):
            assert tree.parent[child] == i
            ends.append((child - n + 1,) * 2 if child >= n - 1 else (tree.first[child], tree.last[child]))
        (a, b), (c, d) = ends
        assert (a, d) == (tree.first[i], tree.last[i]) and c == b + 1
        # Whatever lies on one side shares more with its side than with the other.
        assert prefix(a, b) > prefix(a, d) or a == b
        assert prefix(c, d) > prefix(a, d) or c == d


def test_the_tree_of_the_paper():
    tree = sl.accel.radix_tree([0b00001, 0b00010, 0b00100, 0b00101, 0b10011, 0b11000, 0b11001, 0b11110])
    # Figure 3: the root parts four codes from four.
    assert (tree.first[tree.left[0]], tree.last[tree.left[0]]) == (0, 3)
    assert (tree.first[tree.right[0]], tree.last[tree.right[0]]) == (4, 7)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.integers(0, 2**63 - 1) | st.integers(0, 5), min_size=2, max_size=40))
def test_radix_trees_are_what_they_are_defined_as(codes):
    check(sorted(codes))


def test_all_codes_equal():
    check([7] * 33)


@pytest.mark.parametrize("codes", [[1], [[1, 2]], [2, 1], [-1, 2]])
def test_bad_codes_are_named(codes):
    with pytest.raises(ValueError, match="codes"):
        sl.accel.radix_tree(codes)


def test_threads_change_nothing():
    codes = np.sort(np.random.default_rng(3).integers(2**40, size=20_000))
    trees = []
    for n in (1, 2, 5):
        sl.set_threads(n)
        trees.append(sl.accel.radix_tree(codes))
    sl.set_threads(None)
    for other in trees[1:]:
        assert all((a == b).all() for a, b in zip(trees[0], other, strict=True))
