"""Projections map the volume to the clip box, in each depth convention; linear_depth undoes them."""

import numpy as np
import pytest
from shadelab.transform import linear_depth, orthographic, perspective, transform_points, viewport

RANGE = {"standard": (-1, 1), "zero_to_one": (0, 1), "reversed": (1, 0)}
EPS = {np.float32: np.finfo(np.float32).eps, np.float64: np.finfo(np.float64).eps}


def window(rng, dtype):
    l, b = rng.uniform(-3, -0.5, (2, 50))
    r, t = rng.uniform(0.5, 3, (2, 50))
    n, f = rng.uniform(0.1, 2, 50), rng.uniform(5, 500, 50)
    return [v.astype(dtype) for v in (l, r, b, t, n, f)]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("depth", RANGE)
@pytest.mark.parametrize("kind", ["perspective", "orthographic"])
def test_corners_of_the_volume_are_corners_of_the_clip_box(kind, depth, dtype):
    l, r, b, t, n, f = window(np.random.default_rng(1), dtype)
    if kind == "perspective":
        m = perspective(left=l, right=r, bottom=b, top=t, near=n, far=f, depth=depth)
    else:
        m = orthographic(l, r, b, t, n, f, depth=depth)
    assert m.dtype == dtype and m.shape == (50, 4, 4)
    m = m.astype(float)
    for x, sx in ((l, -1), (r, 1)):
        for y, sy in ((b, -1), (t, 1)):
            for z, sz in zip((n, f), RANGE[depth], strict=True):
                k = z / n if kind == "perspective" else 1.0
                corner = np.stack([x * k, y * k, -z, np.ones_like(z)], -1).astype(float)
                clip = np.einsum("nij,nj->ni", m, corner)
                ndc = clip[:, :3] / clip[:, 3:]
                # Windows are at most 7 times off-centre, and far over near at most 5000.
                assert np.abs(ndc[:, :2] - [sx, sy]).max() < 20 * EPS[dtype]
                assert np.abs(ndc[:, 2] - sz).max() < 30 * EPS[dtype]


@pytest.mark.parametrize("depth", RANGE)
def test_a_field_of_view_is_a_centred_window(depth):
    near, top = 0.5, 0.5 * np.tan(0.4)
    expected = perspective(left=-2 * top, right=2 * top, bottom=-top, top=top, near=near, far=20.0, depth=depth)
    assert np.allclose(perspective(0.8, 2.0, near, 20.0, depth=depth), expected, rtol=1e-14, atol=0)


@pytest.mark.parametrize("depth", RANGE)
def test_infinite_far_is_the_limit(depth):
    m = perspective(1.0, 1.5, 0.1, np.inf, depth=depth)
    assert np.isfinite(m).all()
    assert np.allclose(m, perspective(1.0, 1.5, 0.1, 1e15, depth=depth), rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("depth", RANGE)
def test_linear_depth_undoes_a_projection(depth, dtype):
    z = np.geomspace(0.1, 1000, 200).astype(dtype)
    points = np.stack([0 * z, 0 * z, -z], -1)
    for m in (
        perspective(1.0, near=0.1, far=1000.0, depth=depth),
        perspective(1.0, near=0.1, depth=depth),
        orthographic(-1.0, 1.0, -1.0, 1.0, 0.1, 1000.0, depth=depth),
    ):
        got = linear_depth(transform_points(points, m)[:, 2], m)
        assert got.dtype == dtype
        # z/w is rounded absolutely near one (standard, zero to one) and relatively near zero (reversed, far infinite).
        relative = 4 * EPS[dtype] * np.maximum(z / 0.1, 1) if m[3, 2] else 4 * EPS[dtype] * 1000 / z
        assert (np.abs(got - z) / z <= relative + 8 * EPS[dtype]).all()
    if depth == "reversed":
        m = perspective(1.0, near=0.1, depth=depth)
        got = linear_depth(transform_points(points, m)[:, 2], m)
        assert (np.abs(got - z) <= 4 * EPS[dtype] * z).all()


def test_what_bounds_no_volume_is_an_error_and_nan_in_a_batch():
    for bad in ({"fov_y": 0.0}, {"fov_y": 3.2}, {"fov_y": 1.0, "aspect": 0.0}, {"fov_y": 1.0, "near": 0.0}):
        with pytest.raises(ValueError, match=list(bad)[-1]):
            perspective(**bad)
    with pytest.raises(ValueError, match="far: expected more than near"):
        perspective(1.0, near=2.0, far=1.0)
    with pytest.raises(ValueError, match="either a field of view, or all of left"):
        perspective(left=0.0)
    with pytest.raises(ValueError, match="right: expected other than left"):
        orthographic(1.0, 1.0, 0.0, 1.0, 0.0, 1.0)
    with pytest.raises(ValueError, match="depth: expected one of"):
        perspective(1.0, depth="inverse")
    m = perspective(np.array([1.0, -1.0, 4.0, np.nan]))
    assert np.isfinite(m[0]).all() and np.isnan(m[1:]).any((1, 2)).all()


def test_viewport_puts_row_zero_on_top():
    m = viewport((640, 480), origin=(10, 20))
    assert np.array_equal(m @ [-1, 1, 0.5, 1], [10, 20, 0.5, 1])
    assert np.array_equal(m @ [1, -1, 0.5, 1], [650, 500, 0.5, 1])
    with pytest.raises(ValueError, match="size"):
        viewport((0, 480))
