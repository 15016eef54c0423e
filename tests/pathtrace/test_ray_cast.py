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
