"""Attributes against ray casting, derivatives against finite differences."""

import numpy as np
import pytest
import shadelab as sl

DTYPES = [np.float32, np.float64]


def floor(dtype):
    """A floor that runs from behind the eye to the distance; clip positions, faces, positions."""
    positions = np.array([[-3, -1, 2], [4, -1, 1], [5, -1.5, -60], [-6, -0.5, -40]], float)
    m = np.array([[1.5, 0, 0, 0], [0, 2, 0, 0], [0, 0, -1.002, -0.2], [0, 0, -1, 0]])
    clip = np.concatenate([positions, np.ones((4, 1))], -1) @ m.T
    return clip.astype(dtype), np.array([[0, 1, 2], [0, 2, 3]]), positions.astype(dtype), m


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("samples", [1, 4])
def test_positions_lie_on_the_rays_that_see_them(dtype, samples):
    clip, faces, positions, _ = floor(dtype)
    seen = sl.raster.rasterize(clip, faces, (64, 48), samples)
    got = sl.raster.interpolate(positions, faces, seen).astype(float)
    assert got.shape == (*seen.face.shape, 3)
    hit = seen.face >= 0
    assert hit.mean() > 0.3 and (got[~hit] == 0).all()
    if samples == 1:
        j, i = np.meshgrid(np.arange(64) + 0.5, np.arange(48) + 0.5)
        x, y = 1.5 * got[..., 0] / -got[..., 2], 2 * got[..., 1] / -got[..., 2]
        scale = 2e3 * np.finfo(dtype).eps
        assert np.allclose(x[hit], (2 * j / 64 - 1)[hit], atol=scale)
        assert np.allclose(y[hit], (1 - 2 * i / 48)[hit], atol=scale)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("samples", [1, 8])
def test_derivatives_are_the_limit_of_differences(dtype, samples):
    clip, faces, _, _ = floor(np.float64)
    rng = np.random.default_rng(1)
    attributes = rng.normal(size=(4, 2))
    seen = sl.raster.rasterize(clip.astype(dtype), faces, (32, 24), samples)
    got = sl.raster.interpolate(attributes, faces, seen, derivatives=True, clip=clip)
    assert np.array_equal(got.value, sl.raster.interpolate(attributes, faces, seen))
    # Moving the picture under a sample by a part of a pixel shifts clip x or y by so much of w.
    step = 1e-4
    for axis, slope in ((0, got.dx), (1, got.dy)):
        shifted = []
        for sign in (1, -1):
            moved = clip.copy()
            moved[:, axis] -= sign * step * (2 / 32 if axis == 0 else -2 / 24) * clip[:, 3]
            fine = sl.raster.rasterize(moved, faces, (32, 24), samples)
            shifted.append((fine.face, sl.raster.interpolate(attributes, faces, fine)))
        same = (shifted[0][0] == seen.face) & (shifted[1][0] == seen.face) & (seen.face >= 0)
        assert same.mean() > 0.25
        difference = (shifted[0][1] - shifted[1][1])[same] / (2 * step)
        scale = 1 + np.abs(difference)
        # Samples outside the unsnapped triangle are clamped to it, and have no such limit: edges, at most.
        close = np.abs(difference - slope[same]) < (1e-4 if dtype == np.float64 else 2e-3) * scale
        assert close.mean() > 0.97


def test_constant_attributes_are_kept_to_the_bit():
    clip, faces, _, _ = floor(np.float32)
    seen = sl.raster.rasterize(clip, faces, (64, 48))
    got = sl.raster.interpolate(np.full((4, 3), 0.1, np.float32), faces, seen, derivatives=True, clip=clip)
    hit = seen.face >= 0
    assert (got.value[hit] == np.float32(0.1)).all() and (got.dx == 0).all() and (got.dy == 0).all()


def test_the_raster_s_precision_governs_and_out_is_written():
    clip, faces, positions, _ = floor(np.float32)
    seen = sl.raster.rasterize(clip, faces, (16, 12))
    out = np.empty((12, 16, 3), np.float32)
    assert sl.raster.interpolate(positions.astype(float), faces, seen, out=out) is out
    assert sl.raster.interpolate(np.zeros((4, 0)), faces, seen).shape == (12, 16, 0)


def test_errors_name_the_argument():
    clip, faces, positions, _ = floor(np.float32)
    seen = sl.raster.rasterize(clip, faces, (16, 12))
    interpolate = sl.raster.interpolate
    cases = [
        (lambda: interpolate(positions[:, 0], faces, seen), r"attributes: expected shape \(n, c\), got \(4,\)"),
        (lambda: interpolate(positions[:3], faces, seen), r"faces: index 3 at \(1, 2\) is out of range \[0, 3\)"),
        (lambda: interpolate(positions, faces[:1], seen), r"raster: face 1 at element \d+ is out of range \[-1, 1\)"),
        (lambda: interpolate(positions, faces, seen, derivatives=True), "clip: expected the vertices"),
        (lambda: interpolate(positions, faces, seen, True, clip=clip[:3]), r"clip: expected shape \(4, 4\), got"),
        (lambda: interpolate(positions, faces, seen._replace(u=seen.u[1:])), r"raster.u: expected shape \(12, 16\)"),
    ]
    for call, message in cases:
        with pytest.raises(ValueError, match=message):
            call()
