"""Luminance against a peer's matrix."""

import colour
import numpy as np
import pytest
import shadelab as sl


def test_is_the_y_of_xyz():
    rgb = np.random.default_rng(0).random((100, 3))
    y = colour.RGB_to_XYZ(rgb, "sRGB", apply_cctf_decoding=False)[:, 1]
    # The standard rounds its matrix to four digits, and so does the peer.
    assert np.allclose(sl.color.luminance(rgb), y, atol=5e-5)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_keeps_dtype_and_shape(dtype):
    got = sl.color.luminance(np.ones((4, 5, 3), dtype))
    assert got.shape == (4, 5) and got.dtype == dtype and np.allclose(got, 1)


def test_needs_three_components():
    with pytest.raises(ValueError, match=r"rgb: expected shape \(\.\.\., 3\), got \(2,\)"):
        sl.color.luminance([1.0, 2.0])
