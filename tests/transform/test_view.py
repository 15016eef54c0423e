"""The view matrix: an isometry that puts the eye at the origin and the target on -z."""

import numpy as np
import pytest
from shadelab.transform import look_at


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_view_is_an_isometry_with_the_target_on_minus_z(dtype):
    rng = np.random.default_rng(1)
    eye, target, up = rng.normal(size=(3, 400, 3)).astype(dtype)
    m = look_at(eye, target, up)
    assert m.dtype == dtype
    m = m.astype(float)
    eye, target, up = (v.astype(float) for v in (eye, target, up))
    r = m[:, :3, :3]
    eps = np.finfo(dtype).eps
    assert np.abs(r @ r.swapaxes(-1, -2) - np.eye(3)).max() < 8 * eps
    assert (np.linalg.det(r) > 0).all()
    apply = lambda p: np.einsum("nij,nj->ni", r, p) + m[:, :3, 3]  # noqa: E731
    assert np.abs(apply(eye)).max() < 16 * eps
    distance = np.linalg.norm(target - eye, axis=-1)
    expected = np.stack([0 * distance, 0 * distance, -distance], -1)
    assert np.abs(apply(target) - expected).max() < 40 * eps
    # Up appears upwards and not sideways; its roll is as uncertain as eps over the sine to the line of sight.
    seen = np.einsum("nij,nj->ni", r, up)
    sine = np.linalg.norm(np.cross(up, target - eye), axis=-1) / np.linalg.norm(up, axis=-1) / distance
    assert (seen[:, 1] > 0).all() and (np.abs(seen[:, 0]) / np.linalg.norm(up, axis=-1) * sine < 16 * eps).all()


def test_a_view_that_does_not_exist_is_an_error():
    with pytest.raises(ValueError, match="up: expected a direction not parallel"):
        look_at([0.0, 5.0, 0.0], [0.0, 0.0, 0.0])
    with pytest.raises(ValueError, match="target: expected a point other than the eye"):
        look_at([1.0, 2.0, 3.0], [1.0, 2.0, 3.0])


def test_in_a_batch_it_is_nan_and_touches_no_other():
    m = look_at([[0.0, 5, 0], [1, 5, 0], [np.nan, 0, 0]], [0.0, 0, 0])
    assert np.isnan(m[0]).any() and np.isfinite(m[1]).all() and np.isnan(m[2]).any()


def test_eyes_targets_and_ups_broadcast():
    assert look_at(np.ones((5, 1, 3)), np.zeros((4, 3))).shape == (5, 4, 4, 4)
