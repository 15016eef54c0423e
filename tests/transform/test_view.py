"""The view matrix: an isometry that puts the eye at the origin and the target on -z. Inverses of frames."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from shadelab.transform import change_of_basis, look_at, rigid_inverse, scale


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


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_rigid_inverse_undoes_motions_and_mirrors(dtype):
    rng = np.random.default_rng(2)
    m = np.zeros((300, 4, 4))
    m[:, :3, :3] = Rotation.random(300, random_state=3).as_matrix() * rng.choice([-1, 1], (300, 1, 1))
    m[:, :3, 3] = rng.normal(size=(300, 3)) * 100
    m[:, 3, 3] = 1
    m = m.astype(dtype)
    got = rigid_inverse(m)
    assert got.dtype == dtype and np.array_equal(got[:, :3, :3], m[:, :3, :3].swapaxes(-1, -2))
    error = np.abs((got.astype(float) @ m - np.eye(4))[:, :3, 3]).max(-1)
    assert (error < 3 * np.finfo(dtype).eps * np.linalg.norm(m[:, :3, 3], axis=-1)).all()


def test_what_is_not_rigid_has_no_rigid_inverse():
    projective = np.eye(4)
    projective[3, 2] = -1
    for bad in (scale(2.0), scale([1.0, 1, 0]), projective):
        with pytest.raises(ValueError, match="matrix: expected a rigid motion"):
            rigid_inverse(bad)
    got = rigid_inverse(np.stack([scale(2.0), np.eye(4)]))
    assert np.isnan(got[0]).all() and np.array_equal(got[1], np.eye(4))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("sizes", [(1, 1, 1), (1e-12, 1, 1e12)])
def test_change_of_basis_inverts_the_frame(sizes, dtype):
    axes = np.random.default_rng(4).normal(size=(300, 3, 3))
    units = axes / np.linalg.norm(axes, axis=-1, keepdims=True)
    keep = np.abs(np.linalg.det(units)) > 0.05
    units, origin = units[keep], axes[keep, 0]
    x, y, z = (units[:, i].astype(dtype) * dtype(sizes[i]) for i in range(3))
    m = change_of_basis(x, y, z, origin.astype(dtype))
    assert m.dtype == dtype
    frame = np.stack([x, y, z], -1).astype(float)
    volume = np.abs(np.linalg.det(frame / np.linalg.norm(frame, axis=-2, keepdims=True)))
    bound = 4 * np.finfo(dtype).eps / volume
    wrong = np.abs((m[:, :3, :3].astype(float) @ frame - np.eye(3)) * np.array(sizes)[:, None] / np.array(sizes))
    assert (wrong.max((1, 2)) < bound).all()
    back = (m[:, :3, :3].astype(float) @ origin[..., None])[..., 0] + m[:, :3, 3]
    assert (np.abs(back * sizes).max(-1) < 4 * bound * np.linalg.norm(origin, axis=-1)).all()


def test_axes_in_a_plane_are_no_basis():
    with pytest.raises(ValueError, match="x, y, z: expected independent axes"):
        change_of_basis([1.0, 0, 0], [0, 1.0, 0], [1.0, 1.0, 0])
    got = change_of_basis([1.0, 0, 0], [0, 1.0, 0], [[1.0, 1.0, 0], [0, 0, 1]])
    assert np.isnan(got[0]).any() and np.array_equal(got[1], np.eye(4))
    assert change_of_basis(np.ones((5, 1, 3)), np.ones((4, 3)), [1.0, 2, 3]).shape == (5, 4, 4, 4)
