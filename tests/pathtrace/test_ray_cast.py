"""Ray casting: the rays of the camera, traced."""

import numpy as np
import pytest
import shadelab as sl
from shadelab.scene import Camera


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("size", [(40, 24), (17, 31)])
def test_sees_what_the_cameras_rays_hit(dtype, size):
    ball = sl.mesh.icosphere(3)
    bvh = sl.accel.BVH(ball.positions.astype(dtype), ball.faces)
    camera = Camera((1.0, 2.0, 3.0), (0.1, 0.0, 0.0), up=(0.1, 1, 0), fov_y=0.6)
    got = sl.pathtrace.ray_cast(bvh, camera, size)
    origins, directions = camera.rays(size)
    directions = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    wanted = bvh.closest_hit(origins, directions)
    assert got.face.shape == size[::-1] and got.t.dtype == dtype
    # Rays differ by rounding, which matters on edges and silhouettes alone.
    same = got.face == wanted.face
    assert same.mean() > 0.99 and (got.face >= 0).any() and (got.face < 0).any()
    hit = same & (got.face >= 0)
    assert np.allclose(got.t[hit], wanted.t[hit], rtol=100 * np.finfo(dtype).eps)


def test_misses_are_infinite():
    bvh = sl.accel.BVH(np.zeros((0, 3)), np.zeros((0, 3), int))
    got = sl.pathtrace.ray_cast(bvh, Camera((0, 0, 1), (0, 0, 0)), (3, 2))
    assert np.isinf(got.t).all() and (got.face == -1).all()
    with pytest.raises(ValueError, match="size: expected"):
        sl.pathtrace.ray_cast(bvh, Camera((0, 0, 1), (0, 0, 0)), 3)


def test_copies_are_seen_where_they_stand():
    ball = sl.mesh.icosphere(2)
    one = sl.accel.BVH(ball.positions, ball.faces)
    copies = sl.accel.InstancedBVH([one, one], [sl.transform.translate((x, 0, 0)) for x in (-1.5, 1.5)])
    camera = Camera((0, 0, 8), (0, 0, 0), fov_y=0.7)
    got = sl.pathtrace.ray_cast(copies, camera, (32, 16))
    assert got.instance.shape == (16, 32) and set(np.unique(got.instance)) == {-1, 0, 1}
    assert (got.instance[:, :16] <= 0).all() and (got.instance[:, 16:] != 0).all()


def test_a_scene_is_lit_by_its_lights_alone():
    """A facing card under a lamp of irradiance π shows its albedo; beside a wall no brighter, before one black."""
    lamp = sl.light.DirectionalLight((0, 0, -1), irradiance=(np.pi,) * 3)
    card = sl.scene.Instance(sl.mesh.box((2, 2, 0.1)), materials=sl.scene.Material((0.5, 0.4, 0.3), specular=0.0))
    eye = Camera((0, 0, 3), (0, 0, 0), fov_y=0.2)
    world = sl.scene.Scene(card, lamp, Camera((9, 9, 9), (0, 0, 0)))
    got = sl.pathtrace.ray_cast(world, eye, (4, 3))
    assert got.radiance.dtype == np.float32 and got.samples.max() == 1
    np.testing.assert_allclose(got.radiance, np.broadcast_to([0.5, 0.4, 0.3], (3, 4, 3)), rtol=1e-6)
    behind = sl.scene.Instance(sl.mesh.box((9, 9, 0.1)), sl.transform.translate((0, 0, 6)))
    dark = sl.pathtrace.ray_cast(sl.scene.Scene([card, behind], lamp, eye), size=(4, 3), samples=4, dtype=np.float64)
    assert dark.radiance.dtype == np.float64 and not dark.radiance.any()
    same = sl.pathtrace.whitted(world, (8, 8), max_depth=0)
    assert np.array_equal(sl.pathtrace.ray_cast(world, size=(8, 8)).radiance, same.radiance)


def test_what_cannot_be_cast_is_named():
    bvh = sl.accel.BVH(np.zeros((0, 3)), np.zeros((0, 3), int))
    with pytest.raises(TypeError, match="camera: expected a Camera, got NoneType"):
        sl.pathtrace.ray_cast(bvh)
    with pytest.raises(TypeError, match="samples: expected with a scene alone"):
        sl.pathtrace.ray_cast(bvh, Camera((0, 0, 1), (0, 0, 0)), samples=4)
    with pytest.raises(TypeError, match="scene: expected a Scene"):
        sl.pathtrace.ray_cast(3)
    with pytest.raises(TypeError, match="max_depth"):
        sl.pathtrace.ray_cast(sl.scene.default(), size=(2, 2), max_depth=3)
