"""Depths stored as integers, and depths of other surfaces than the first."""

import numpy as np
import pytest
import shadelab as sl
import trimesh
from shadelab.light import DirectionalLight

BITS = (16, 24, 32)
KINDS = ("rect", "point", "sun")


def ball(scenes, dtype=np.float32):
    sphere = trimesh.creation.icosphere(3, 0.7)
    positions, faces = scenes.join(
        (sphere.vertices + np.array([0, 1, 0]), np.asarray(sphere.faces)), scenes.quad(0.0, (-2, 2), (-2, 2), float)
    )
    return positions.astype(dtype), faces


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("bits", BITS)
@pytest.mark.parametrize("kind", KINDS)
def test_rounding_loses_half_a_step_at_most(scenes, kind, bits, dtype):
    mesh, light = ball(scenes, dtype), scenes.lights()[kind]
    exact, stored = (sl.shadow.shadow_map(*mesh, light, 128, bits=b) for b in (None, bits))
    assert stored.depth.dtype == (np.uint16 if bits == 16 else np.uint32) and stored.dtype == dtype
    assert stored.bytes == 128 * 128 * (2 if bits == 16 else 4) and (exact.step, exact.bits) == (0.0, None)
    assert stored.step == (stored.far - stored.near) / (2**bits - 2)
    drawn = np.isfinite(exact.depth)
    found = stored.depths()
    assert found.dtype == dtype and np.array_equal(np.isinf(found), ~drawn)
    # The depth's own rounding comes on top: an ulp of the farthest.
    error = np.abs(found[drawn].astype(np.float64) - exact.depth[drawn]).max()
    assert error <= 0.5 * stored.step * (1 + 1e-9) + np.finfo(dtype).eps * stored.far
    if bits == 16:
        assert error > 0.3 * stored.step


@pytest.mark.parametrize("bits", BITS)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("tilt", [0.0, 1.0, 1.4])
def test_a_lit_plane_shows_no_acne_in_any_format(scenes, kind, bits, tilt):
    turn = trimesh.transformations.rotation_matrix(tilt, [0, 0, 1])[:3, :3]
    square = (np.array([[-3.0, 0, -3], [3, 0, -3], [3, 0, 3], [-3, 0, 3]]) @ turn.T).astype(np.float32)
    weights = np.random.default_rng(1).uniform(0.001, 0.999, (20_000, 2))
    points = square[0] + weights[:, :1] * (square[1] - square[0]) + weights[:, 1:] * (square[3] - square[0])
    m = sl.shadow.shadow_map(square, [[0, 2, 1], [0, 3, 2]], scenes.lights()[kind], 256, bits=bits)
    assert (sl.shadow.hard(m, points, turn @ [0, 1, 0]) == 1).all()
    assert (sl.shadow.pcf(m, points, turn @ [0, 1, 0], radius=20.0) == 1).all()


@pytest.mark.parametrize("look", ["hard", "pcf", "pcss"])
def test_lookups_agree_with_those_of_floats(scenes, look):
    mesh, light = ball(scenes), scenes.lights()["rect"]
    x, z = np.meshgrid(np.linspace(-1.5, 1.5, 101, dtype=np.float32), np.linspace(-1.5, 1.5, 101, dtype=np.float32))
    points = np.stack([x, 0 * x, z], -1)
    exact, *stored = (
        getattr(sl.shadow, look)(sl.shadow.shadow_map(*mesh, light, 256, bits=b), points, [0, 1, 0])
        for b in (None, *BITS)
    )
    assert 0 < exact.mean() < 1
    for lit in stored:
        assert lit.dtype == np.float32 and np.abs(lit - exact).mean() < 1e-3


def test_moments_of_stored_depths_are_those_of_what_they_stand_for(scenes):
    m = sl.shadow.shadow_map(*ball(scenes), scenes.lights()["rect"], 64, bits=24)
    a = sl.shadow.moment_map(m, "variance")
    b = sl.shadow.moment_map(sl.shadow.shadow_map(*ball(scenes), scenes.lights()["rect"], 64), "variance")
    assert np.abs(a.moments - b.moments).max() < 1e-5


def test_stored_depths_are_checked():
    def made(depth, bits):
        frame = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
        return sl.shadow.ShadowMap(depth, "perspective", [0, 4, 0], frame, [-1, 1, -1, 1], 1.0, 2.0, bits=bits)

    assert made(np.array([[0, 65534, 65535]], np.uint16), 16).depths().tolist() == [[1.0, 2.0, np.inf]]
    for depth, bits, kind, name in (
        (np.zeros((2, 2)), 16, TypeError, "depth: expected uint16"),
        (np.zeros((2, 2), np.uint16), 24, TypeError, "depth: expected uint32"),
        (np.full((2, 2), 2**24, np.uint32), 24, ValueError, "below 2\\*\\*24"),
        (np.zeros((2, 2), np.uint16), 12, ValueError, "bits"),
        (np.zeros((2, 2), np.uint16), True, ValueError, "bits"),
        (np.zeros((2, 2), np.uint16), np.zeros(2), ValueError, "bits"),
    ):
        with pytest.raises(kind, match=name):
            made(depth, bits)


# Other surfaces than the first.


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_second_and_midpoint_of_stacked_squares(scenes, dtype):
    mesh = scenes.join(*(scenes.quad(h, (-2, 2), (-2, 2), dtype) for h in (0.0, 1.0, 2.0)))
    light = DirectionalLight((0, -1, 0))
    first, second, middle = (sl.shadow.shadow_map(*mesh, light, 32, surface=s) for s in ("first", "second", "midpoint"))
    drawn = np.isfinite(first.depth)
    assert np.array_equal(drawn, np.isfinite(second.depth)) and np.array_equal(drawn, np.isfinite(middle.depth))
    eps = 8 * np.finfo(dtype).eps
    assert np.allclose(second.depth[drawn] - first.depth[drawn], 1.0, atol=eps)
    assert np.allclose(middle.depth[drawn], (first.depth[drawn] + second.depth[drawn]) / 2, atol=eps)
    lone = sl.shadow.shadow_map(*scenes.quad(0.0, (-2, 2), (-2, 2), dtype), light, 32, surface="midpoint")
    assert np.isinf(lone.depth).all()


@pytest.mark.parametrize("kind", KINDS)
def test_second_surface_is_that_of_rays(scenes, kind):
    mesh = ball(scenes, np.float64)
    light = scenes.lights()[kind]
    m = sl.shadow.shadow_map(*mesh, light, 96, surface="second")
    height, width = m.depth.shape
    left, right, bottom, top = m.window
    x, y = np.meshgrid(
        left + (np.arange(width) + 0.5) / width * (right - left),
        top - (np.arange(height) + 0.5) / height * (top - bottom),
    )
    aside = x[..., None] * m.frame[0] + y[..., None] * m.frame[1]
    if m.projection == "perspective":
        origins, directions = np.broadcast_to(m.position, aside.shape), aside + m.frame[2]
    else:
        origins, directions = m.position + aside, np.broadcast_to(m.frame[2], aside.shape)
    bvh = sl.accel.BVH(*mesh)
    one = bvh.closest_hit(origins, directions)
    two = bvh.closest_hit(origins, directions, t_min=one.t + 1e-9, ignore_face=one.face)
    both = np.isfinite(two.t) & np.isfinite(m.depth)
    assert both.sum() > 200
    # Silhouettes differ by the rasteriser's grid of 1/256 texel.
    assert (np.isfinite(two.t) != np.isfinite(m.depth)).mean() < 5e-3
    # The ball's outline is a tenth of its texels.
    assert (np.abs(two.t - m.depth)[both] > 1e-7).mean() < 1e-2


@pytest.mark.parametrize("surface", ["second", "midpoint"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_closed_body_needs_no_bias(scenes, kind, surface):
    mesh, light = ball(scenes), scenes.lights()[kind]
    knobs = {"slope_bias": 0.0, "receiver_plane": False}
    x, z = np.meshgrid(np.linspace(-1.6, 1.6, 161, dtype=np.float32), np.linspace(-1.6, 1.6, 161, dtype=np.float32))
    plain = np.stack([x, 0 * x, z], -1).reshape(-1, 3)
    sphere = trimesh.creation.icosphere(3, 0.7)
    on, face = trimesh.sample.sample_surface(sphere, 20_000, seed=2)
    normals = sphere.face_normals[face]
    on = (on + np.array([0, 1, 0])).astype(np.float32)
    facing = (normals * scenes.towards_light(light, on)).sum(-1) > 0.2
    on, normals = on[facing], normals[facing].astype(np.float32)
    points = np.concatenate([plain, on])
    up = np.concatenate([np.broadcast_to(np.float32([0, 1, 0]), plain.shape), normals])
    exact = sl.shadow.ray_traced(sl.accel.BVH(*mesh), points, up, getattr(scenes, "centre", lambda l: l)(light), 16)
    whole = exact == 1
    first = sl.shadow.hard(sl.shadow.shadow_map(*mesh, light, 256), points, up, **knobs)
    other = sl.shadow.hard(sl.shadow.shadow_map(*mesh, light, 256, surface=surface), points, up, **knobs)
    # Without a bias half of the facets darken themselves; of other surfaces nothing does.
    assert sl.shadow.acne(first, exact) > 0.1
    assert sl.shadow.acne(other[whole], exact[whole]) < 3e-3
    # And what is dark in full stays dark, but for half a texel at its edge.
    assert sl.shadow.detached(other, exact) < 0.05
