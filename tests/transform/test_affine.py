"""Translation, scaling, rotation: against SciPy and by composition."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from shadelab.transform import rotate_axis, scale, translate


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_rotations_are_scipys(dtype):
    rng = np.random.default_rng(1)
    axis = rng.normal(size=(300, 3)) * 10.0 ** rng.uniform(-20, 20, (300, 1))
    angle = rng.uniform(-10, 10, 300)
    axis, angle = axis.astype(dtype), angle.astype(dtype)
    got = rotate_axis(axis, angle)
    assert got.dtype == dtype and got.shape == (300, 4, 4)
    unit = axis.astype(float) / np.linalg.norm(axis.astype(float), axis=-1, keepdims=True)
    half = angle.astype(float)[:, None] / 2
    expected = Rotation.from_quat(np.concatenate([unit * np.sin(half), np.cos(half)], -1)).as_matrix()
    # A product of three rounded unit components, a sine within two ulps, and SciPy's own normalisation.
    assert np.abs(got[:, :3, :3] - expected).max() < 6 * np.finfo(dtype).eps
    assert (got[:, 3] == [0, 0, 0, 1]).all() and (got[:, :3, 3] == 0).all()


def test_small_angles_keep_their_cosine():
    m = rotate_axis([0.0, 0.0, 1.0], 1e-8)
    assert m[1, 0] == pytest.approx(1e-8, rel=1e-15) and m[0, 0] == 1.0
    m = rotate_axis([0.0, 0.0, 1.0], 1e-7)
    assert 1 - m[0, 0] == pytest.approx(5e-15, rel=0.02)  # 5e-15 itself is 45 rounding units below one


def test_a_zero_axis_gives_nan_and_touches_no_other():
    m = rotate_axis([[0.0, 0, 0], [0, 0, 1]], 1.0)
    assert np.isnan(m[0]).any() and np.isfinite(m[1]).all()


def test_axes_and_angles_broadcast():
    assert rotate_axis(np.eye(3)[:, None], np.linspace(0, 1, 5)).shape == (3, 5, 4, 4)


def test_scale_and_translate_compose_on_column_vectors():
    p = np.array([1.0, 2.0, 3.0, 1.0])
    assert np.array_equal(translate([1.0, 0, 0]) @ scale([2.0, 3.0, 4.0]) @ p, [3, 6, 12, 1])
    assert np.array_equal(scale([2.0, 3.0, 4.0]) @ translate([1.0, 0, 0]) @ p, [4, 6, 12, 1])
    assert translate(np.zeros((0, 3), np.float32)).shape == (0, 4, 4)
    assert scale(np.float32(2)).dtype == np.float32
    with pytest.raises(ValueError, match=r"offset: expected shape \(\.\.\., 3\)"):
        translate([1.0, 2.0])
