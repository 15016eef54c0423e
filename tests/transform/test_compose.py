"""Parts of affine matrices: composed again they are the matrix, singular and mirrored ones too."""

import numpy as np
import pytest
import trimesh.transformations as tf
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation
from shadelab.transform import compose, decompose, scale, shear, translate


def affine(linear):
    m = np.zeros((*linear.shape[:-2], 4, 4), linear.dtype)
    m[..., :3, :3], m[..., 3, 3] = linear, 1
    return m


def check(m):
    """The parts of `m` compose to it, and are what they claim to be."""
    eps = np.finfo(m.dtype).eps
    parts = decompose(m)
    wide = [np.asarray(p, float) for p in parts[:4]]
    # In double precision, so that only the parts' own errors show.
    columns = np.linalg.norm(m[..., :3, :3].astype(float), axis=-2, keepdims=True)
    error = np.abs(compose(*wide) - m)[..., :3, :3]
    assert (error <= 8 * eps * columns).all()
    assert np.abs(np.linalg.norm(wide[1], axis=-1) - 1).max(initial=0) < 2 * eps
    assert (wide[1][..., 3] >= 0).all()
    assert (wide[2][..., 1:] >= 0).all() and ((wide[2][..., 0] < 0) == parts.mirrored).all()
    assert np.array_equal(parts.translation, m[..., :3, 3])
    return parts


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_random_matrices_round_trip(dtype):
    rng = np.random.default_rng(1)
    m = affine(rng.normal(size=(2000, 3, 3))).astype(dtype)
    m[:, :3, 3] = rng.normal(size=(2000, 3))
    parts = check(m)
    assert all(p.dtype == dtype for p in parts[:4])
    assert np.array_equal(parts.mirrored, np.linalg.det(m[:, :3, :3].astype(float)) < 0)


# Numbers whose products are normal, or zero.
plain = st.floats(-9, 9).filter(lambda x: x == 0 or abs(x) > 1e-100)
entries = st.sampled_from([0.0, 0.0, 1.0, -1.0, 2.0, 0.5, 3.0, 1e-3, 1e-9, 1e5])


@settings(max_examples=300)
@given(arrays(float, (3, 3), elements=entries))
def test_singular_and_lopsided_matrices_round_trip(linear):
    check(affine(linear))
    check(affine(linear.astype(np.float32)))


@settings(max_examples=100)
@given(arrays(float, (3, 1), elements=plain), arrays(float, (1, 3), elements=plain))
def test_matrices_of_rank_one_round_trip(column, row):
    parts = check(affine(column @ row))
    assert (parts.scale != 0).sum() <= 1


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_parts_that_went_in_come_out(dtype):
    rng = np.random.default_rng(2)
    q = rng.normal(size=(500, 4))
    q *= np.sign(q[:, 3:]) / np.linalg.norm(q, axis=-1, keepdims=True)
    t, h = rng.normal(size=(2, 500, 3))
    s = rng.uniform(0.5, 2, (500, 3)) * np.where(rng.random((500, 1)) < 0.5, [-1, 1, 1], 1)
    given = [x.astype(dtype) for x in (t, q, s, h)]
    parts = decompose(compose(*given))
    assert np.array_equal(parts.mirrored, s[:, 0] < 0)
    for ours, theirs in zip(parts[:4], given, strict=True):
        # Shears of up to four tilt the columns: their axes keep a twentieth or so of the length.
        assert np.abs(ours - theirs).max() < 60 * np.finfo(dtype).eps


def test_it_is_trimeshs_where_nothing_is_mirrored():
    rng = np.random.default_rng(3)
    for _ in range(50):
        angles, offset, factors = rng.uniform(-1, 1, 3), rng.normal(size=3), rng.uniform(0.5, 2, 3)
        lean = rng.uniform(-1, 1, 3)
        # Theirs scales before it shears: their shear is ours between the scalings.
        theirs = tf.compose_matrix(scale=factors, shear=lean, angles=angles, translate=offset)
        x, y, z = factors
        parts = decompose(theirs)
        assert np.allclose(parts.scale, factors, rtol=1e-13)
        assert np.allclose(parts.shear, lean * [y / x, z / x, z / y], atol=1e-13)
        assert np.allclose(parts.translation, offset)
        assert np.allclose(parts.rotation, Rotation.from_euler("xyz", angles).as_quat(canonical=True), atol=1e-13)


def test_without_shear_it_is_the_product_of_its_parts():
    q = [0.5, -0.5, 0.5, 0.5]
    expected = translate([1, 2, 3]) @ affine(Rotation.from_quat(q).as_matrix()) @ scale([4, 5, 6]) @ shear(1, 2, 0, 3)
    assert np.allclose(compose([1, 2, 3], q, [4, 5, 6], [1, 2, 3]), expected, rtol=0, atol=1e-14)
    assert np.array_equal(compose(), np.eye(4))


def test_what_is_not_affine_is_an_error_and_nan_in_a_batch():
    projective = np.eye(4)
    projective[3, 2] = -1
    with pytest.raises(ValueError, match="matrix: expected an affine matrix"):
        decompose(projective)
    inf = np.diag([1, np.inf, 1, 1])
    parts = decompose([projective, inf, np.eye(4)])
    assert np.isnan(parts.scale[:2]).all() and np.array_equal(parts.scale[2], [1, 1, 1])
    assert np.array_equal(parts.rotation[2], [0, 0, 0, 1])
