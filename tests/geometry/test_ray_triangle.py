"""Rays and triangles: the point is reconstructed, exact arithmetic agrees, nothing passes between neighbours."""

from fractions import Fraction

import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st

METHODS = ["watertight", "moller_trumbore", "plane"]


def aimed(rng, n, dtype):
    """Triangles and rays, most of which meet."""
    a, b, c, o = rng.normal(size=(4, n, 3))
    w = rng.dirichlet([1, 1, 1], n) + 0.3 * rng.normal(size=(n, 3))
    d = w[:, :1] * a + w[:, 1:2] * b + w[:, 2:] * c - o
    return [x.astype(dtype) for x in (o, d, a, b, c)]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("method", METHODS)
def test_hit_is_one_point_on_ray_and_triangle(dtype, method):
    o, d, a, b, c = aimed(np.random.default_rng(1), 5000, dtype)
    hit = sl.geometry.ray_triangle(o, d, a, b, c, method=method)
    assert hit.t.dtype == dtype
    met = np.isfinite(hit.t)
    t, u, v = (x[met, None].astype(np.float64) for x in hit)
    on_ray = o[met] + t * d[met]
    on_triangle = (1 - u - v) * a[met] + u * b[met] + v * c[met]
    # A ray that grazes its triangle's plane multiplies the error by the inverse of its sine, and so does a sliver.
    n = np.cross((b - a)[met].astype(float), (c - a)[met].astype(float))
    length = np.linalg.norm(n, axis=-1)
    sine = np.abs((n * d[met]).sum(-1)) / (length * np.linalg.norm(d[met], axis=-1))
    scale = 60 / (sine * np.minimum(length, 1)) * (1 + np.abs(t[:, 0]))
    assert (np.abs(on_ray - on_triangle).max(-1) < np.finfo(dtype).eps * scale).all()
    assert 0.3 < met.mean() < 0.95


def det3(m):
    return (
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
        - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    )


@pytest.mark.parametrize("method", METHODS)
def test_methods_agree_with_exact_arithmetic_away_from_edges(method):
    rng = np.random.default_rng(2)
    rays = aimed(rng, 300, np.float64)
    hit = sl.geometry.ray_triangle(*rays, method=method)
    for i in range(300):
        o, d, a, b, c = ([Fraction(x) for x in v[i]] for v in rays)
        m = [[b[k] - a[k], c[k] - a[k], -d[k]] for k in range(3)]
        det, rhs = det3(m), [o[k] - a[k] for k in range(3)]
        u, v, t = (det3([[rhs[r] if q == k else m[r][q] for q in range(3)] for r in range(3)]) / det for k in range(3))
        if min(abs(x) for x in (u, v, 1 - u - v, t)) < 1e-9:
            continue
        inside = u > 0 and v > 0 and u + v < 1 and t > 0
        assert np.isfinite(hit.t[i]) == inside
        if inside:
            # Rays and triangles at random: at worst some thousand round-offs.
            assert np.allclose([hit.t[i], hit.u[i], hit.v[i]], [float(t), float(u), float(v)], rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("length", [1e-20, 1e20])
@pytest.mark.parametrize("method", METHODS)
def test_length_of_direction_scales_t_alone(dtype, length, method):
    o, d, a, b, c = aimed(np.random.default_rng(3), 1000, dtype)
    # A power of two, so that the scaled direction is the same to the bit.
    factor = dtype(2.0 ** np.round(np.log2(length)))
    one, many = (sl.geometry.ray_triangle(o, x, a, b, c, method=method) for x in (d, d * factor))
    assert np.array_equal(one.u, many.u) and np.array_equal(one.t / factor, many.t)


fan = st.lists(st.floats(-1, 1, width=32), min_size=8, max_size=8)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shift", [0, 1e6])
@settings(max_examples=150, deadline=None)
@given(radii=fan, target=st.integers(0, 7), along=st.floats(0, 1), origin=st.tuples(*[st.floats(-2, 2)] * 2))
def test_no_ray_passes_a_fan_at_its_edges_and_hub(dtype, shift, radii, target, along, origin):
    angles = np.arange(8) * np.pi / 4
    rim = np.stack([np.cos(angles), np.sin(angles), radii], -1) * 1.5 + shift
    hub = np.array([0.01, 0.02, 0.0]) + shift
    rim, hub = rim.astype(dtype), hub.astype(dtype)
    o = np.array([*origin, 5.0]) + shift
    goal = hub + 0.9 * along * (rim[target].astype(float) - hub)
    o, d = o.astype(dtype), (goal - o).astype(dtype)
    hit = sl.geometry.ray_triangle(o, d, hub, rim, np.roll(rim, -1, 0))
    # Seen aslant the fan may fold over; what hides the goal is then hit itself.
    assert np.isfinite(hit.t).any()


@pytest.mark.parametrize("method", METHODS)
def test_degenerate_triangles_and_rays_in_the_plane_miss(method):
    o, d = np.array([0.2, 0.2, 1.0]), np.array([0, 0, -1.0])
    line = sl.geometry.ray_triangle(o, d, [0, 0, 0], [1, 1, 0], [2, 2, 0], method=method)
    point = sl.geometry.ray_triangle(o, d, [[0.2, 0.2, 0]], [0.2, 0.2, 0], [0.2, 0.2, 0], method=method)
    within = sl.geometry.ray_triangle([-1, 0.2, 0], [1.0, 0, 0], [0, 0, 0], [1, 0, 0], [0, 1, 0], method=method)
    assert all(np.isinf(h.t).all() and (h.u == 0).all() for h in (line, point, within))


@pytest.mark.parametrize("method", METHODS)
def test_nan_and_infinity_stay_in_their_element(method):
    o, d, a, b, c = aimed(np.random.default_rng(4), 6, np.float64)
    clean = sl.geometry.ray_triangle(o, d, a, b, c, method=method)
    o[0, 1], d[1], a[2, 2], c[3, 0], t_max = np.nan, 0, np.inf, np.nan, np.full(6, np.inf)
    t_max[4] = np.nan
    hit = sl.geometry.ray_triangle(o, d, a, b, c, method=method, t_max=t_max)
    assert np.isnan(hit.t[:5]).all() and np.array_equal(hit.t[5], clean.t[5])


def test_interval_is_open_and_scalars_are_checked():
    triangle = ([0.0, 0, 0], [1, 0, 0], [0, 1, 0])
    ray = ([0.25, 0.25, 2.0], [0, 0, -1.0])
    assert np.isinf(sl.geometry.ray_triangle(*ray, *triangle, t_max=2).t)
    assert np.isinf(sl.geometry.ray_triangle(*ray, *triangle, t_min=2).t)
    assert sl.geometry.ray_triangle(*ray, *triangle, t_min=1.999, t_max=2.001).t == 2
    with pytest.raises(ValueError, match="t_min: expected a number, got nan"):
        sl.geometry.ray_triangle(*ray, *triangle, t_min=np.nan)
    with pytest.raises(ValueError, match="method: expected one of"):
        sl.geometry.ray_triangle(*ray, *triangle, method="fast")
