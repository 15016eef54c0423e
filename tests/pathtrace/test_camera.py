"""Rays of a thin lens and of a moving camera: against geometry, and against Mitsuba's lens."""

import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st
from shadelab.pathtrace import camera_rays
from shadelab.scene import Camera

SIZE = (20, 12)


def camera(**options):
    return Camera((1.0, 2.0, 5.0), (0.2, 0.1, -0.3), up=(0.1, 1.0, 0.0), fov_y=0.7, **options)


def grid():
    x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
    return np.stack([x, y], -1)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_without_a_lens_rays_are_the_pinholes(dtype):
    origins, directions = camera_rays(camera(), SIZE, grid().astype(dtype), np.array([0.1, 0.9], dtype))
    wanted_o, wanted_d = camera().rays(SIZE)
    eps = np.finfo(dtype).eps
    assert origins.dtype == dtype
    assert np.abs(origins - wanted_o).max() <= 5 * eps and np.abs(directions - wanted_d).max() <= 4 * eps


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@settings(max_examples=30, deadline=None)
@given(st.floats(1e-3, 10), st.floats(0.1, 1e3), st.integers(0, 99))
def test_rays_of_a_pixel_meet_on_the_plane_of_focus(dtype, aperture, focus, seed):
    cam = camera(aperture=aperture, focus_distance=focus)
    xy = np.array([3.2, 7.9], dtype)
    lens = np.random.default_rng(seed).random((16, 2)).astype(dtype)
    origins, directions = camera_rays(cam, SIZE, xy, lens)
    forward = -cam.view()[2, :3]
    o, d = origins.astype(float), directions.astype(float)
    # Origins on the lens: across the axis, within the radius.
    assert np.abs((o - cam.eye) @ forward).max() <= 8 * np.finfo(dtype).eps * (6 + aperture)
    assert np.linalg.norm(o - cam.eye, axis=-1).max() <= aperture / 2 * (1 + 1e-5) + 8 * np.finfo(dtype).eps * 6
    t = (focus - (o - cam.eye) @ forward) / (d @ forward)
    points = o + d * t[:, None]
    (eye,), (direction,) = (a.reshape(1, 3) for a in camera_rays(camera(), SIZE, xy.astype(float)))
    sharp = eye + direction * focus / (direction @ forward)
    assert np.abs(points - sharp).max() <= 16 * np.finfo(dtype).eps * (6 + aperture + 2 * focus)


def test_focus_at_infinity_gives_parallel_rays():
    cam = camera(aperture=0.5, focus_distance=np.inf)
    lens = np.random.default_rng(0).random((64, 2))
    origins, directions = camera_rays(cam, SIZE, [4.0, 4.0], lens)
    assert (directions == directions[0]).all() and np.ptp(origins, axis=0).max() > 0.3


@pytest.mark.parametrize(("z", "focus"), [(2.0, 4.0), (8.0, 4.0), (3.0, np.inf)])
def test_a_point_is_blurred_to_its_circle_of_confusion(z, focus):
    """Which part of the picture sees a point at distance z: a disk of the analytic diameter, around its image."""
    height = 100
    cam = Camera((0, 0, 0), (0, 0, -1), aperture=0.3, focus_distance=focus, fov_y=0.8)
    lens = np.random.default_rng(1).random((20_000, 2))
    origins, _ = camera_rays(cam, (height, height), [50.0, 50.0], lens)
    # From the lens' point l a point p at z is seen in direction (p − l) / z + l / f on the plane at distance one.
    seen = -origins[:, :2] * (1 / z - 1 / focus)
    step = 2 * np.tan(0.4) / height
    # By the rays themselves: the pixel that looks at the point is where its ray through l passes it.
    xy = 50 + seen * [1, -1] / step
    o, d = camera_rays(cam, (height, height), xy, lens)
    at = o + d * (z / -d[:, 2:])
    assert np.abs(at - [0, 0, -z]).max() < 1e-12
    radius = np.hypot(*(xy - 50).T).max()
    sharp = 0 if np.isinf(focus) else z / focus
    assert radius == pytest.approx(0.15 * abs(1 - sharp) / z / step, rel=2e-3)


def test_a_moving_camera_goes_straight():
    end = Camera((3.0, 2.0, 5.0), (2.2, 0.1, -0.3), up=(0.1, 1.0, 0.0), fov_y=0.7)
    cam = camera(end=end, shutter=(0.25, 0.75))
    time = np.linspace(0, 1, 5)
    origins, directions = camera_rays(cam, SIZE, [10.0, 6.0], time=time)
    at = 0.25 + 0.5 * time
    assert np.allclose(origins, (1 - at)[:, None] * camera().eye + at[:, None] * np.array(end.eye))
    # It moves without turning.
    assert np.abs(directions - directions[0]).max() < 1e-15


def test_extremes_and_bad_elements():
    cam = camera(aperture=1.0)
    xy = np.array([[1.0, 1.0], [np.nan, 1.0], [1.0, 1.0]])
    lens = np.array([[0.2, 0.2], [0.2, 0.2], [1.2, 0.2]])
    origins, directions = camera_rays(cam, SIZE, xy, lens)
    assert np.isfinite(directions[0]).all() and np.isnan(directions[1]).all()
    assert np.isnan(origins[2]).any()
    for scale in (1e-6, 1e6):
        far = Camera((0, 0, scale), (0, 0, 0), aperture=0.1 * scale)
        o, d = camera_rays(far, SIZE, np.array([3.0, 4.0], np.float32), np.array([0.9, 0.3], np.float32))
        near_o, near_d = camera_rays(Camera((0, 0, 1), (0, 0, 0), aperture=0.1), SIZE, [3.0, 4.0], [0.9, 0.3])
        assert np.allclose(o / scale, near_o, rtol=1e-6) and np.allclose(d, near_d, atol=1e-6)


def test_wrong_cameras_name_the_argument():
    with pytest.raises(ValueError, match="aperture: expected a number"):
        camera(aperture=-1)
    with pytest.raises(ValueError, match="focus_distance: expected a number"):
        camera(focus_distance=0)
    with pytest.raises(ValueError, match="shutter: expected a number"):
        camera(shutter=(0.5, 0.25))
    with pytest.raises(TypeError, match="end: expected a Camera"):
        camera(end=3)


def test_wrong_calls_are_named():
    world = sl.scene.default()
    with pytest.raises(TypeError, match="camera: expected a Camera, got NoneType"):
        sl.pathtrace.camera_rays(None, (4, 4), [0.5, 0.5])
    with pytest.raises(TypeError, match="samples: expected an integer, got NoneType"):
        sl.pathtrace.whitted(world, (4, 4), None)
    with pytest.raises(TypeError, match="dtype: expected float32 or float64"):
        world.camera.rays((4, 4), dtype=np.float16)
    with pytest.raises(TypeError, match="dtype: expected float32 or float64, got 3"):
        world.flatten(3)
