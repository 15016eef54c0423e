"""The G-buffer holds what the separate steps give."""

import numpy as np
import pytest
import shadelab as sl


def soup(dtype):
    rng = np.random.default_rng(3)
    positions = rng.normal(size=(90, 3)) * [2, 2, 1]
    normals = rng.normal(size=(90, 3))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    m = np.array([[1.5, 0, 0, 0], [0, 2, 0, 0], [0, 0, -1.1, 3], [0, 0, -1, 3.2]])
    clip = np.concatenate([positions, np.ones((90, 1))], -1) @ m.T
    faces = np.arange(90, dtype=np.int32).reshape(-1, 3)
    return clip.astype(dtype), faces, positions.astype(dtype), normals.astype(dtype), rng.integers(0, 5, 30)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("samples", [1, 2])
def test_it_is_rasterize_and_interpolate(dtype, samples):
    clip, faces, positions, normals, ids = soup(dtype)
    got = sl.raster.g_buffer(clip, faces, positions, (70, 50), samples, normals=normals, material_ids=ids)
    seen = sl.raster.rasterize(clip, faces, (70, 50), samples)
    for a, b in zip(got[:4], seen, strict=True):
        assert a.dtype == b.dtype and np.array_equal(a, b)
    assert np.array_equal(got.position, sl.raster.interpolate(positions, faces, seen))
    hit = seen.face >= 0
    assert 0.2 < hit.mean() < 1
    n = sl.raster.interpolate(normals, faces, seen)[hit].astype(float)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    assert np.allclose(got.normal[hit], n, atol=8 * np.finfo(dtype).eps)
    assert np.array_equal(got.material[hit], ids[seen.face[hit]])
    assert (got.material[~hit] == -1).all() and (got.normal[~hit] == 0).all() and (got.position[~hit] == 0).all()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_without_normals_faces_have_their_own(dtype):
    clip, faces, positions, _, _ = soup(dtype)
    got = sl.raster.g_buffer(clip, faces, positions, (70, 50))
    hit = got.face >= 0
    a, b, c = (positions[faces[got.face[hit], k]].astype(float) for k in range(3))
    n = np.cross(b - a, c - a)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    # Edge vectors are rounded once: a thin triangle's normal loses a few bits more.
    assert np.allclose(got.normal[hit], n, atol=200 * np.finfo(dtype).eps)
    assert (got.material[hit] == 0).all()


def test_vanishing_normals_are_zero_not_nan():
    clip, faces, positions, normals, _ = soup(np.float32)
    got = sl.raster.g_buffer(clip, faces, positions, (70, 50), normals=0 * normals)
    assert (got.normal == 0).all()


def test_out_is_written_and_errors_name_the_argument():
    clip, faces, positions, normals, ids = soup(np.float32)
    first = sl.raster.g_buffer(clip, faces, positions, (70, 50))
    out = sl.raster.GBuffer(*(np.full_like(a, 9) for a in first))
    again = sl.raster.g_buffer(clip, faces, positions, (70, 50), out=out)
    assert all(a is b and np.array_equal(a, c) for a, b, c in zip(again, out, first, strict=True))
    cases = [
        (lambda: sl.raster.g_buffer(clip, faces, positions[1:], (4, 4)), r"positions: expected shape \(90, 3\)"),
        (lambda: sl.raster.g_buffer(clip, faces, positions, (4, 4), normals=normals[1:]), "normals: expected shape"),
        (
            lambda: sl.raster.g_buffer(clip, faces, positions, (4, 4), material_ids=ids[1:]),
            "material_ids: expected shape",
        ),
        (lambda: sl.raster.g_buffer(clip, faces, positions, (4, 4), out=out), r"out.face: expected shape \(4, 4\)"),
    ]
    for call, message in cases:
        with pytest.raises(ValueError, match=message):
            call()
