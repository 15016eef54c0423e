"""The fused picture against the same pipeline in NumPy."""

import numpy as np
import pytest
import shadelab as sl

LIGHT = np.array([0.3, 0.5, 0.8])


def ball(dtype, n=24):
    """A sphere of latitude and longitude, seen in perspective: positions, faces, normals, matrix."""
    theta, phi = np.meshgrid(np.linspace(0.01, np.pi - 0.01, n), np.linspace(0, 2 * np.pi, 2 * n, endpoint=False))
    p = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(2 * n), np.arange(n - 1), indexing="ij")
    a, b = (i * n + j).ravel(), ((i + 1) % (2 * n) * n + j).ravel()
    faces = np.concatenate([np.stack([a, b + 1, a + 1], -1), np.stack([a, b, b + 1], -1)])
    m = np.array([[1.8, 0, 0, 0.1], [0, 2.4, 0, 0], [0, 0, -1.1, 1.9], [0, 0, -1, 3.0]])
    return p.astype(dtype), faces.astype(np.int32), p.astype(dtype), m


def expected(positions, faces, normals, m, size, samples=1, color=(1, 1, 1), background=(0, 0, 0), **options):
    clip = np.concatenate([positions, np.ones((len(positions), 1))], -1) @ m.T
    r = sl.raster.rasterize(clip.astype(positions.dtype), faces, size, samples, **options)
    face, u, v = (a.reshape(size[1], size[0], samples) for a in (r.face, r.u, r.v))
    n = normals[faces[face]].astype(float)
    n = (1 - u - v)[..., None] * n[..., 0, :] + u[..., None] * n[..., 1, :] + v[..., None] * n[..., 2, :]
    shade = np.maximum(n @ (LIGHT / np.linalg.norm(LIGHT)) / np.linalg.norm(n, axis=-1), 0)[..., None]
    return np.where(face[..., None] >= 0, shade * color, background).mean(2)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("samples", [1, 4])
def test_the_picture_is_that_of_the_separate_steps(dtype, samples):
    mesh = ball(dtype)
    look = {"color": (0.8, 0.5, 0.2), "background": (0.1, 0.2, 0.3)}
    got = sl.raster.render_lambert(*mesh, (160, 120), samples, to_light=LIGHT, **look)
    assert got.dtype == dtype and got.shape == (120, 160, 3)
    # NumPy's product and the kernel's round clip positions differently, so a subpixel may snap differently.
    error = np.abs(got - expected(*mesh, (160, 120), samples, **look)).max(-1)
    assert (error < 2e4 * np.finfo(dtype).eps).mean() > 0.999
    assert (got.max(-1) > 0.31).mean() > 0.2


@pytest.mark.parametrize("cull", ["none", "back", "front"])
def test_culling_and_depth_reach_the_kernel(cull):
    mesh = ball(np.float64)
    mesh[3][2] = [0, 0, 0.4, 0.9]
    look = {"cull": cull, "depth": "reversed"}
    got = sl.raster.render_lambert(*mesh, (80, 60), to_light=LIGHT, **look)
    assert (np.abs(got - expected(*mesh, (80, 60), **look)).max(-1) < 1e-9).mean() > 0.999


def test_eight_bits_are_the_rounded_floats_and_alpha_the_coverage():
    mesh = ball(np.float32)
    color = (1.5, 0.5, -1.0)
    floats = sl.raster.render_lambert(*mesh, (160, 120), 4, to_light=LIGHT, color=color)
    bytes_ = sl.raster.render_lambert(*mesh, (160, 120), 4, to_light=LIGHT, color=color, format="rgba8")
    assert np.array_equal(bytes_[..., :3], np.rint(255 * np.clip(floats, 0, 1)))
    covered = sl.raster.render_lambert(*mesh, (160, 120), 4, color=(0, 0, 0), background=(1, 1, 1))[..., 0]
    assert np.array_equal(bytes_[..., 3], np.rint(255 * (1 - covered)))
    assert 0 < (bytes_[..., 3] == 128).sum() < 2000


def test_two_sided_light_reaches_both_sides():
    p, f, n, m = ball(np.float64)
    front = sl.raster.render_lambert(p, f, n, m, (80, 60), to_light=LIGHT)
    back = sl.raster.render_lambert(p, f, n, m, (80, 60), to_light=-LIGHT)
    both = sl.raster.render_lambert(p, f, n, m, (80, 60), to_light=LIGHT, two_sided=True)
    assert np.array_equal(both, np.maximum(front, back))


def test_threads_and_simd_levels_change_nothing():
    mesh = ball(np.float32, 60)
    runs = []
    try:
        for threads in (1, 3):
            sl.set_threads(threads)
            for level in sl.simd_levels():
                with sl.simd(level):
                    runs.append(sl.raster.render_lambert(*mesh, (200, 150), to_light=LIGHT).tobytes())
    finally:
        sl.set_threads(None)
    assert len(set(runs)) == 1


def test_out_is_reused_and_errors_name_the_argument():
    p, f, n, m = ball(np.float32)
    for format, shape, dtype in (("float", (6, 8, 3), np.float32), ("rgba8", (6, 8, 4), np.uint8)):
        out = np.full(shape, 9, dtype)
        assert sl.raster.render_lambert(p, f, n, m, (8, 6), format=format, out=out) is out
        assert np.array_equal(out, sl.raster.render_lambert(p, f, n, m, (8, 6), format=format))
    draw = sl.raster.render_lambert
    cases = [
        (lambda: draw(p, f, n[1:], m, (8, 6)), r"normals: expected shape \(1152, 3\), got \(1151, 3\)"),
        (lambda: draw(p, f, n, m[:3], (8, 6)), r"matrix: expected shape \(\.\.\., 4, 4\), got \(3, 4\)"),
        (lambda: draw(p, f + 1000, n, m, (8, 6)), r"faces: index \d+ at \(\d+, \d\) is out of range \[0, 1152\)"),
        (lambda: draw(p, f, n, m, (8, 6), to_light=(0, 0, 0)), "to_light: expected a direction"),
        (lambda: draw(p, f, n, m, (8, 6), color=(1, np.nan, 1)), "color: expected three finite numbers"),
        (lambda: draw(p, f, n, m, (8, 6), format="png"), "format: expected one of 'float', 'rgba8'"),
        (lambda: draw(p, f, n, m, (8, 6), out=np.empty((6, 8, 4))), r"out: expected shape \(6, 8, 3\)"),
    ]
    for call, message in cases:
        with pytest.raises(ValueError, match=message):
            call()
