"""Change of measure: against the solid angle itself, both ways, at extreme sizes."""

import numpy as np
import pytest
import shadelab as sl


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_small_areas_have_their_solid_angle(dtype):
    rng = np.random.default_rng(1)
    center, side = rng.normal(size=(200, 3)), 1e-3
    eu = np.cross(center, rng.normal(size=(200, 3)))
    eu, normal = eu / np.linalg.norm(eu, axis=-1, keepdims=True), rng.normal(size=(200, 3))
    normal -= eu * (normal * eu).sum(-1, keepdims=True)
    ev = np.cross(normal, eu) / np.linalg.norm(normal, axis=-1, keepdims=True)
    per_area = np.full(200, 1 / side**2)
    got = sl.sampling.area_to_solid_angle(per_area.astype(dtype), center.astype(dtype), normal.astype(dtype))
    exact = sl.sampling.square_to_spherical_rectangle(
        [0.5, 0.5], center, eu * side, ev * side, full_output=True
    ).solid_angle
    # The square's own extent: its side over its distance, squared.
    keep = np.linalg.norm(center, axis=-1) > 0.3
    keep &= np.abs((center * normal).sum(-1)) > 0.1 * np.linalg.norm(center, axis=-1) * np.linalg.norm(normal, axis=-1)
    assert got.dtype == dtype
    assert np.allclose((got * exact)[keep], 1, rtol=1e-4)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("scale", [1e-18, 1e-6, 1.0, 1e6, 1e18])
def test_there_and_back(dtype, scale):
    rng = np.random.default_rng(2)
    points, normals = (rng.normal(size=(100, 3)).astype(dtype) for _ in range(2))
    there = sl.sampling.area_to_solid_angle(np.ones(100, dtype), points * dtype(scale), normals * dtype(1e15))
    exact = sl.sampling.area_to_solid_angle(1.0, points.astype(float), normals.astype(float)) * float(dtype(scale)) ** 2
    assert np.allclose(there, exact, rtol=16 * np.finfo(dtype).eps)
    back = sl.sampling.area_to_solid_angle(there, points * dtype(scale), normals, inverse=True)
    assert np.allclose(back, 1, rtol=16 * np.finfo(dtype).eps)


def test_edge_on_is_infinite_and_nan_stays_in_its_row():
    got = sl.sampling.area_to_solid_angle(
        1.0, [[1, 0, 0], [1, 0, 0], [np.nan, 0, 0]], [[0, 1, 0], [1, 0, 0], [1, 0, 0]]
    )
    assert np.isposinf(got[0]) and got[1] == 1 and np.isnan(got[2])
