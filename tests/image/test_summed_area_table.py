"""Summed-area tables: sums of whole numbers are exact, precision is lost as stated, threads do not matter."""

import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st

table_of = sl.image.summed_area_table


def brute_force(image):
    padded = np.zeros((image.shape[0] + 1, image.shape[1] + 1, *image.shape[2:]))
    padded[1:, 1:] = image.astype(np.float64).cumsum(0).cumsum(1)
    return padded


@given(
    st.integers(0, 200),
    st.integers(0, 40),
    st.sampled_from([None, 1, 2, 3, 4, 5]),
    st.sampled_from([np.float32, np.float64]),
    st.sampled_from(["double", "compensated", "single"]),
)
@settings(max_examples=60, deadline=None)
def test_whole_numbers_are_summed_exactly(height, width, channels, dtype, precision):
    shape = (height, width) if channels is None else (height, width, channels)
    image = np.random.default_rng(1).integers(-9, 9, shape).astype(dtype)
    table = table_of(image, precision=precision)
    assert table.dtype == (np.float64 if precision == "double" else np.float32)
    assert np.array_equal(table, brute_force(image))


def test_rectangles_are_differences_of_four_entries():
    rng = np.random.default_rng(2)
    image = rng.random((130, 70))
    table = table_of(image)
    for _ in range(100):
        i, k = np.sort(rng.integers(0, 131, 2))
        j, l = np.sort(rng.integers(0, 71, 2))
        quick = table[k, l] - table[i, l] - table[k, j] + table[i, j]
        assert quick == pytest.approx(image[i:k, j:l].sum(), abs=1e-11)


def test_agrees_with_opencv():
    cv2 = pytest.importorskip("cv2")
    image = np.random.default_rng(3).random((301, 203, 3))
    # Both round in an order of their own: 60,000 terms of up to 1.
    np.testing.assert_allclose(table_of(image), cv2.integral(image, sdepth=cv2.CV_64F), rtol=0, atol=1e-9)


def worst_mean(table, image, side=9):
    t = table.astype(np.float64)
    mean = (t[side:, side:] - t[:-side, side:] - t[side:, :-side] + t[:-side, :-side]) / side**2
    exact = brute_force(image)
    truth = (exact[side:, side:] - exact[:-side, side:] - exact[side:, :-side] + exact[:-side, :-side]) / side**2
    return np.abs(mean - truth).max()


def test_what_each_precision_loses():
    """The figures of the docstring; a factor of two allows for other random pictures."""
    image = np.random.default_rng(4).random((2048, 2048), np.float32)
    lost = {p: worst_mean(table_of(image, precision=p), image) for p in ("double", "compensated", "single")}
    assert lost["double"] < 1e-10
    # An entry near 2²¹ is rounded to 1/8: four halves of it over 81 pixels.
    assert 1e-3 < lost["compensated"] < 0.25 / 81
    assert lost["single"] > 2 * lost["compensated"]


def test_the_same_for_any_number_of_threads():
    image = np.random.default_rng(5).random((333, 217), np.float32)
    tables = []
    for n in (1, 2, 3):
        sl.set_threads(n)
        tables.append([table_of(image, precision=p) for p in ("double", "single")])
    sl.set_threads(None)
    for other in tables[1:]:
        assert all(np.array_equal(a, b) for a, b in zip(tables[0], other, strict=True))


def test_out_and_errors():
    image = np.ones((3, 4), np.float32)
    out = np.empty((4, 5))
    assert table_of(image, out=out) is out and out[-1, -1] == 12
    with pytest.raises(TypeError, match="image"):
        table_of(np.ones((3, 4), int))
    with pytest.raises(ValueError, match="precision"):
        table_of(image, precision="half")
    with pytest.raises(ValueError, match="out"):
        table_of(image, precision="single", out=out)
    with pytest.raises(ValueError, match="image"):
        table_of(np.ones(3))
