"""Faces that overlap boxes: the exact test on every triangle, and boxes that are none."""

import _thread
import threading
import time

import numpy as np
import pytest
import shadelab as sl


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("level", sl.simd_levels())
@pytest.mark.parametrize("grid", [False, True])
def test_equals_the_exact_test_of_every_triangle(dtype, level, grid):
    rng = np.random.default_rng(1)
    p = (rng.integers(-3, 4, (400, 3, 3)) if grid else rng.normal(size=(400, 3, 3))).astype(dtype)
    f = np.arange(1200).reshape(-1, 3)
    corner = rng.integers(-4, 4, (300, 3)) if grid else rng.normal(size=(300, 3))
    size = rng.integers(0, 3, (300, 3)) if grid else rng.exponential(0.4, (300, 3))
    low, high = corner.astype(dtype), (corner + size).astype(dtype)
    meets = sl.geometry.triangle_aabb(*(p[None, :, k] for k in range(3)), low[:, None], high[:, None])
    with sl.simd(level):
        found = sl.accel.BVH(p.reshape(-1, 3), f).overlap(low, high)
    box, face = np.nonzero(meets)
    assert np.array_equal(found.box, box) and np.array_equal(found.face, face)
    assert 0.01 < meets.mean() < 0.9


def test_triangles_decide_not_their_boxes():
    bvh = sl.accel.BVH([[0.0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    # Within the triangle's box but beyond its hypotenuse; touching it; through its plane.
    found = bvh.overlap([[2.5, 2.5, -1], [2, 2, 0], [1, 1, -1]], [[4, 4, 1], [3, 3, 1], [1, 1, 1]])
    assert np.diff(found.offsets).tolist() == [0, 1, 1]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_boxes_that_are_none_and_boxes_without_end(dtype):
    p = np.random.default_rng(2).normal(size=(30, 3)).astype(dtype)
    bvh = sl.accel.BVH(p, np.arange(30).reshape(-1, 3))
    low, high = np.full((4, 3), -9.0), np.full((4, 3), 9.0)
    low[1, 2], high[2, 0] = np.nan, -10
    low[3], high[3] = -np.inf, np.inf
    found = bvh.overlap(low, high)
    assert np.diff(found.offsets).tolist() == [10, 0, 0, 10] and found.face[:10].tolist() == list(range(10))
    assert bvh.overlap(np.zeros((0, 3)), [1, 1, 1]).offsets.tolist() == [0]
    assert sl.accel.BVH(np.zeros((0, 3), dtype), []).overlap([0, 0, 0], [1, 1, 1]).face.size == 0
    with pytest.raises(ValueError, match=r"lower: expected shape \(\.\.\., 3\)"):
        bvh.overlap([0, 0], [1, 1, 1])


def test_threads_change_nothing():
    rng = np.random.default_rng(3)
    p = rng.normal(size=(9000, 3)).astype(np.float32)
    bvh = sl.accel.BVH(p, np.arange(9000).reshape(-1, 3))
    low = rng.normal(size=(2000, 3))
    results = []
    for threads in (1, 2, 5):
        sl.set_threads(threads)
        results.append(bvh.overlap(low, low + 0.3))
    sl.set_threads(None)
    assert all(np.array_equal(r.offsets, results[0].offsets) for r in results)
    assert all(np.array_equal(r.face, results[0].face) for r in results)


def test_one_box_over_many_faces_answers_an_interrupt():
    rng = np.random.default_rng(0)
    corners = rng.normal(size=(700_000, 1, 3)) + 0.3 * rng.normal(size=(700_000, 3, 3))
    bvh = sl.accel.BVH(corners.reshape(-1, 3), np.arange(2_100_000).reshape(-1, 3), method="lbvh")
    low, high = np.full((40, 3), -9.0), np.full(3, 0.01)
    timer = threading.Timer(0.05, _thread.interrupt_main)
    timer.start()
    start = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        bvh.overlap(low, high)
        time.sleep(5)
    assert time.perf_counter() - start < 1
    timer.join()
