"""Coverage against exact integers, visibility against ray casting, and the edges of the domain."""

import numpy as np
import pytest
import shadelab as sl

rasterize = sl.raster.rasterize
DTYPES = [np.float32, np.float64]
CENTRE = np.array([[128, 128]])
SAMPLES = {
    1: CENTRE,
    2: CENTRE + 16 * np.array([[4, 4], [-4, -4]]),
    4: CENTRE + 16 * np.array([[-2, -6], [6, -2], [-6, 2], [2, 6]]),
    8: CENTRE + 16 * np.array([[1, -3], [-1, 3], [5, 1], [-3, -5], [-5, 5], [-7, -1], [3, 7], [7, -7]]),
}


def to_clip(pixels, size, w=1.0, z=0.0, dtype=np.float64):
    """Vertices at given pixel positions (x, y), exactly where sizes are powers of two."""
    p = np.asarray(pixels, float)
    x, y = 2 * p[..., 0] / size[0] - 1, 1 - 2 * p[..., 1] / size[1]
    w, z = np.broadcast_to(w, x.shape), np.broadcast_to(z, x.shape)
    return np.stack([x * w, y * w, z * w, w], -1).astype(dtype)


def coverage(clip, size, samples):
    """Exact coverage (H, W, S) of one triangle in front of the eye, in Python integers.

    A sample on an edge belongs to the triangle that holds it after a shift by (e, e²), e -> 0: the top-left rule said
    in another way.
    """
    width, height = size
    wide = clip.astype(np.float64)
    x = np.rint((wide[:, 0] / wide[:, 3] * (width / 2) + width / 2) * 256).astype(np.int64).astype(object)
    y = np.rint((height / 2 - wide[:, 1] / wide[:, 3] * (height / 2)) * 256).astype(np.int64).astype(object)
    area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
    if area == 0:
        return np.zeros((height, width, samples), bool)
    sx = (np.arange(width)[None, :, None] * 256 + SAMPLES[samples][:, 0]).astype(object)
    sy = (np.arange(height)[:, None, None] * 256 + SAMPLES[samples][:, 1]).astype(object)
    inside = np.ones((height, width, samples), bool)
    for i in range(3):
        j = (i + 1) % 3
        dx, dy = x[j] - x[i], y[j] - y[i]
        # The edge function, and its change under the shift to the right and then down.
        terms = [np.sign(area) * ((sy - y[i]) * dx - (sx - x[i]) * dy), np.sign(area) * -dy, np.sign(area) * dx]
        inside &= (terms[0] > 0) | ((terms[0] == 0) & ((terms[1] > 0) | ((terms[1] == 0) & (terms[2] > 0))))
    return inside


def each_face_alone(clip, faces, size, samples=1, **options):
    """How often each sample is covered, by drawing every face alone."""
    shape = (size[1], size[0]) if samples == 1 else (size[1], size[0], samples)
    count = np.zeros(shape, int)
    for f in faces:
        count += rasterize(clip, f[None], size, samples, **options).face == 0
    return count


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("samples", [1, 2, 4, 8])
def test_coverage_is_exact(dtype, samples):
    rng = np.random.default_rng(samples)
    size = (24, 16)
    kinds = [
        rng.uniform(-8, 32, (20, 3, 2)),  # any
        rng.uniform(0, 2, (10, 3, 2)) + rng.uniform(0, 15, (10, 1, 2)),  # about one pixel
        rng.integers(-4, 56, (40, 3, 2)) / 2,  # edges and vertices on centres
        rng.integers(-30, 300, (20, 3, 2)) / 16,  # and on the samples of rotated grids
        rng.uniform(-9000, 9000, (10, 3, 2)),  # beyond the guard band's edge
    ]
    for pixels in np.concatenate(kinds):
        clip = to_clip(pixels, size, dtype=dtype)
        if np.abs(pixels).max() > 8000:
            # Cut triangles are snapped where they are cut; those fully within the band are not cut.
            continue
        got = rasterize(clip, [[0, 1, 2]], size, samples).face.reshape(16, 24, samples) == 0
        assert np.array_equal(got, coverage(clip, size, samples))


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("samples", [1, 4])
def test_triangulations_cover_each_sample_once(dtype, samples):
    rng = np.random.default_rng(5)
    size = (48, 32)
    from scipy.spatial import Delaunay

    # A square beyond the picture, filled by a random triangulation; a part of its vertices on centres and corners.
    inner = np.concatenate([rng.uniform(0, 48, (40, 2)), rng.integers(0, 96, (40, 2)) / 2])
    corners = np.array([[-60, -50], [90, -55], [100, 80], [-70, 90]])
    points = np.unique(np.concatenate([corners, inner]), axis=0)
    faces = Delaunay(points).simplices.astype(np.int32)
    clip = to_clip(points, size, w=rng.uniform(0.5, 4, len(points)), dtype=dtype)
    assert (each_face_alone(clip, faces, size, samples) == 1).all()
    # Together they leave no hole, whichever way each face turns.
    faces[::2] = faces[::2, ::-1]
    assert (rasterize(clip, faces, size, samples).face >= 0).all()


@pytest.mark.parametrize("step", [1.0, 0.5, 2.5])
def test_grids_and_strips_with_edges_through_centres_cover_once(step):
    size = (32, 32)
    n = int(32 / step) + 3
    ys, xs = np.mgrid[-1 : n - 1, -1 : n - 1]
    clip = to_clip(np.stack([xs * step + 0.5, ys * step + 0.5], -1).reshape(-1, 2), size)
    q = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.stack([q, q + 1, q + n], -1), np.stack([q + 1, q + n + 1, q + n], -1)])
    count = np.zeros((32, 32), int)
    # Faces of one parity are disjoint from one another only if each sample has one owner: count by subsets.
    for k in range(0, len(faces), max(1, len(faces) // 64)):
        chosen = faces[k : k + max(1, len(faces) // 64)]
        front = rasterize(clip, chosen, size).face
        back = rasterize(clip, chosen[::-1], size).face
        covered = front >= 0
        # At equal depth the lowest face wins, so both orders agree only where a single face covers.
        assert np.array_equal(covered, back >= 0)
        assert np.array_equal(front[covered], len(chosen) - 1 - back[covered])
        count += covered
    assert (count == 1).all()


@pytest.mark.parametrize("dtype", DTYPES)
def test_fans_about_a_sample_give_it_to_one_triangle(dtype):
    rng = np.random.default_rng(7)
    for _ in range(50):
        n = rng.integers(3, 40)
        angles = np.sort(rng.uniform(0, 2 * np.pi, n))
        angles = np.concatenate([angles, [angles[0] + 2 * np.pi]])
        if np.diff(angles).max() >= 3:
            continue
        rim = 8.5 + 7 * np.stack([np.cos(angles[:-1]), np.sin(angles[:-1])], -1)
        clip = to_clip(np.concatenate([[[8.5, 8.5]], rim]), (16, 16), dtype=dtype)
        faces = np.stack([np.zeros(n, int), 1 + np.arange(n), 1 + (np.arange(n) + 1) % n], -1)
        count = each_face_alone(clip, faces, (16, 16))
        assert count[8, 8] == 1 and count.max() == 1


def scene(rng, n, dtype, spread=1.0):
    """Random triangles about the eye, many of them across the near plane or behind; positions, faces, matrix."""
    a = rng.normal(size=(n, 1, 3)) * [3, 3, 4] - [0, 0, 3]
    positions = (a + spread * rng.normal(size=(n, 3, 3))).reshape(-1, 3)
    near, far, f, aspect = 0.1, 50.0, 1.5, 1.5
    m = np.zeros((4, 4))
    m[0, 0], m[1, 1] = f / aspect, f
    m[2, 2], m[2, 3], m[3, 2] = (far + near) / (near - far), 2 * far * near / (near - far), -1
    return positions, np.arange(3 * n).reshape(n, 3), m


def pixel_rays(size, m):
    """Directions with z = -1 from an eye at the origin through pixel centres."""
    j, i = np.meshgrid(np.arange(size[0]) + 0.5, np.arange(size[1]) + 0.5)
    return np.stack([(2 * j / size[0] - 1) / m[0, 0], (1 - 2 * i / size[1]) / m[1, 1], -np.ones_like(i)], -1)


def cast(positions, faces, rays, near, far):
    """Every ray against every triangle's plane, in double: depth along -z, u, v, (F, H, W)."""
    a, b, c = (positions[faces[:, k]][:, None, None] for k in range(3))
    e1, e2 = b - a, c - a
    p = np.cross(rays[None], e2)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1 / (e1 * p).sum(-1)
        u = (-a * p).sum(-1) * inverse
        q = np.cross(-a, e1)
        v = (rays[None] * q).sum(-1) * inverse
        t = (e2 * q).sum(-1) * inverse
    margin = np.minimum(np.minimum(u, v), 1 - u - v)
    return t, u, v, margin


@pytest.mark.parametrize("dtype", DTYPES)
def test_visibility_agrees_with_ray_casting_across_the_near_plane(dtype):
    rng = np.random.default_rng(11)
    size = (48, 32)
    positions, faces, m = scene(rng, 120, dtype)
    clip = np.concatenate([positions, np.ones((len(positions), 1))], -1) @ m.T
    assert ((clip[:, 3].reshape(-1, 3) < 0).any(1) & (clip[:, 3].reshape(-1, 3) > 0).any(1)).sum() > 10
    got = rasterize(clip.astype(dtype), faces, size)
    t, u, v, margin = cast(positions, faces, pixel_rays(size, m), 0.1, 50.0)
    hit = (margin >= 0) & (t > 0.1) & (t < 50)
    t = np.where(hit, t, np.inf)
    nearest = t.argmin(0)
    i, j = np.indices(nearest.shape)
    expected = np.where(np.isfinite(t.min(0)), nearest, -1)
    # Snapping moves edges by 1/512 pixel: few pixels of 1536 lie so near an edge.
    same = got.face == expected
    assert same.mean() > 0.985
    seen = same & (expected >= 0)
    assert seen.sum() > 500
    at = (nearest[seen], i[seen], j[seen])
    # Steep triangles magnify rounding: their condition is how fast u, v change from one pixel to the next.
    slope = np.abs(np.diff(u, axis=2, append=np.nan)) + np.abs(np.diff(v, axis=2, append=np.nan))
    slope = np.nan_to_num(slope, nan=1e3)[at] + 1
    tolerance = 200 * np.finfo(dtype).eps * 48 * slope**2
    assert (np.abs(got.u[seen] - u[at]) < tolerance).mean() > 0.99
    assert (np.abs(got.v[seen] - v[at]) < tolerance).mean() > 0.99
    z = (m[2, 2] * -t[at] + m[2, 3]) / t[at]
    assert np.allclose(got.depth[seen], z, atol=2e4 * np.finfo(dtype).eps)


@pytest.mark.parametrize("dtype", DTYPES)
def test_depth_conventions_name_the_same_surface(dtype):
    rng = np.random.default_rng(12)
    positions, faces, m = scene(rng, 100, dtype)
    h = np.concatenate([positions, np.ones((len(positions), 1))], -1)
    near, far = 0.1, 50.0
    rows = {"standard": m[2], "zero_to_one": (m[2] + m[3]) / 2, "reversed": (m[3] - m[2]) / 2}
    pictures = {}
    for name, row in rows.items():
        k = m.copy()
        k[2] = row
        pictures[name] = rasterize((h @ k.T).astype(dtype), faces, (64, 48), depth=name)
    standard = pictures["standard"]
    hit = standard.face >= 0
    assert 0.3 < hit.mean()
    linear = 2 * far * near / (far + near - standard.depth[hit].astype(float) * (far - near))
    for name, got in pictures.items():
        # Other roundings of z move the cut at the near plane by less than a subpixel.
        assert (got.face == standard.face).mean() > 0.995
        assert np.isinf(got.depth[got.face < 0]).all()
        both = hit & (got.face == standard.face)
        d = got.depth[both].astype(float)
        z = {"standard": (d + 1) / 2, "zero_to_one": d, "reversed": 1 - d}[name]
        assert np.allclose(z, (standard.depth[both] + 1) / 2, atol=1e3 * np.finfo(dtype).eps)
        assert d.min() >= (-1 if name == "standard" else 0) and d.max() <= 1
    assert linear.min() > 0.099


@pytest.mark.parametrize("dtype", DTYPES)
def test_walls_a_hundred_thousand_pixels_wide_meet_without_gap(dtype):
    # Two triangles share a diagonal that crosses the picture, far beyond every guard plane on both sides.
    rng = np.random.default_rng(13)
    for _ in range(50):
        direction = rng.normal(size=2)
        direction *= 1e5 / np.linalg.norm(direction)
        centre = rng.uniform(0, 64, 2)
        side = np.array([-direction[1], direction[0]])
        pixels = [centre - direction, centre + direction, centre + side, centre - side]
        clip = to_clip(pixels, (64, 64), w=rng.uniform(0.5, 2, 4), dtype=dtype)
        faces = np.array([[0, 1, 2], [1, 0, 3]])
        assert (each_face_alone(clip, faces, (64, 64)) == 1).all()


@pytest.mark.parametrize("dtype", DTYPES)
def test_a_floor_through_the_eye_s_plane_meets_without_gap(dtype):
    # A fan of floor triangles, most of them cut by the near plane: below the horizon each sample is covered once.
    rng = np.random.default_rng(14)
    m = scene(rng, 1, dtype)[2]
    angle = np.linspace(0, 2 * np.pi, 13)[:-1] + 0.1
    rim = np.stack([300 * np.cos(angle), np.full(12, -1.0), 300 * np.sin(angle)], -1)
    positions = np.concatenate([[[0.3, -1, -2.0]], rim, 1.5 * rim])
    k = np.arange(12)
    faces = np.concatenate([np.stack([0 * k, 1 + k, 1 + (k + 1) % 12], -1)])
    clip = (np.concatenate([positions, np.ones((len(positions), 1))], -1) @ m.T).astype(dtype)
    far_is_off = m.copy()
    far_is_off[2] = [0, 0, -1, -0.2]
    clip[:, 2] = (np.concatenate([positions, np.ones((len(positions), 1))], -1) @ far_is_off.T)[:, 2]
    count = each_face_alone(clip, faces, (96, 64))
    assert count.max() == 1
    # The floor's edge, 290 away or farther, stands within 0.2 pixel of the horizon at row 32.
    assert (count[33:] == 1).all() and (count[:31] == 0).all()


def test_equal_depth_goes_to_the_lowest_face():
    rng = np.random.default_rng(15)
    clip = to_clip(rng.uniform(0, 200, (900, 2)), (200, 200), z=0.25)
    faces = rng.permutation(900).reshape(-1, 3)
    for f in (faces, faces[::-1]):
        got = rasterize(clip, f, (200, 200))
        lowest = np.full((200, 200), -1)
        for k in range(len(f))[::-1]:
            lowest[rasterize(clip, f[k : k + 1], (200, 200)).face == 0] = k
        assert np.array_equal(got.face, lowest)
        # A triangle of constant depth has that depth, not a rounded neighbour of it.
        assert (got.depth[got.face >= 0] == 0.25).all()


@pytest.mark.parametrize("samples", [1, 8])
def test_culling_splits_what_is_seen_by_its_turn(samples):
    rng = np.random.default_rng(16)
    clip = to_clip(rng.uniform(0, 64, (60, 2)), (64, 64), z=rng.uniform(-1, 1, 60))
    faces = np.arange(60).reshape(-1, 3)
    p = clip[faces][..., :2]
    (ax, ay), (bx, by) = (p[:, 1] - p[:, 0]).T, (p[:, 2] - p[:, 0]).T
    turn = ax * by - bx * ay
    for cull, kept in (("back", turn > 0), ("front", turn < 0)):
        got = rasterize(clip, faces, (64, 64), samples, cull=cull)
        alone = rasterize(clip, faces[kept], (64, 64), samples)
        expected = np.append(np.flatnonzero(kept), -1)[alone.face]
        assert np.array_equal(got.face, expected) and np.array_equal(got.depth, alone.depth)


def test_degenerate_and_mirrored_triangles():
    size = (16, 16)
    line = to_clip([[0, 0], [8, 8], [16, 16]], size)
    point = to_clip([[3.5, 3.5]] * 3, size)
    assert (rasterize(line, [[0, 1, 2]], size).face < 0).all()
    assert (rasterize(point, [[0, 1, 2], [0, 0, 1]], size).face < 0).all()
    clip = to_clip([[1, 1], [14, 3], [4, 13]], size, w=[1, 2, 3.0])
    one, other = rasterize(clip, [[0, 1, 2]], size), rasterize(clip, [[0, 2, 1]], size)
    assert np.array_equal(one.face, other.face) and (one.face == 0).sum() > 50
    # The mirrored face has its coordinates exchanged.
    assert np.allclose(one.u, other.v, atol=1e-14) and np.allclose(one.v, other.u, atol=1e-14)


def test_vertices_that_are_not_finite_hide_their_triangles_alone():
    rng = np.random.default_rng(17)
    clip = to_clip(rng.uniform(0, 32, (30, 2)), (32, 32), z=rng.uniform(-1, 1, 30))
    faces = np.arange(30).reshape(-1, 3)
    for bad in (np.nan, np.inf, -np.inf):
        for component in range(4):
            broken = clip.copy()
            broken[4, component] = bad
            got = rasterize(broken, faces, (32, 32))
            expected = rasterize(clip, np.delete(faces, 1, 0), (32, 32))
            assert np.array_equal(got.face, np.append(np.delete(np.arange(10), 1), -1)[expected.face])
            assert np.array_equal(got.depth, expected.depth)


@pytest.mark.parametrize("samples", [1, 4])
def test_threads_and_simd_levels_change_nothing(samples):
    rng = np.random.default_rng(18)
    positions, faces, m = scene(rng, 3000, np.float32, spread=0.3)
    clip = (np.concatenate([positions, np.ones((len(positions), 1))], -1) @ m.T).astype(np.float32)
    runs = []
    try:
        for threads in (1, 2, 5):
            sl.set_threads(threads)
            for level in sl.simd_levels():
                with sl.simd(level):
                    runs.append(rasterize(clip, faces, (200, 150), samples))
    finally:
        sl.set_threads(None)
    for other in runs[1:]:
        assert all(a.tobytes() == b.tobytes() for a, b in zip(runs[0], other, strict=True))


def test_a_subpixel_grid_at_the_largest_size():
    # The last pixel of a picture of 16384: one subpixel decides whether its centre is covered.
    size = (16384, 2)
    for x, expected in ((16383.5, True), (16383.5 + 1 / 256, False)):
        clip = to_clip([[x, -5], [16400, -5], [x, 20]], size)
        got = rasterize(clip, [[0, 1, 2]], size)
        assert (got.face[0, -1] == 0) == expected and (got.face[0, :-1] < 0).all()


def test_out_is_written_and_returned():
    clip = to_clip([[1, 1], [14, 3], [4, 13]], (16, 16), dtype=np.float32)
    expected = rasterize(clip, [[0, 1, 2]], (16, 16))
    out = sl.raster.Raster(*(np.full_like(a, 7) for a in expected))
    got = rasterize(clip, [[0, 1, 2]], (16, 16), out=out)
    for a, b, c in zip(got, out, expected, strict=True):
        assert a is b and np.array_equal(a, c)
    depth = np.empty_like(out.depth)
    assert sl.raster.rasterize_depth(clip, [[0, 1, 2]], (16, 16), out=depth) is depth
    assert np.array_equal(depth, expected.depth)


def test_no_faces_no_vertices_no_pixels():
    assert (rasterize(np.zeros((0, 4)), np.zeros((0, 3), np.int32), (4, 3)).face == -1).all()
    assert rasterize(to_clip([[0, 0], [4, 0], [0, 4]], (4, 4)), [[0, 1, 2]], (0, 3)).face.shape == (3, 0)
    assert (rasterize(np.zeros((0, 4)), [], (4, 3)).face == -1).all()


def test_errors_name_the_argument():
    clip, faces = np.zeros((3, 4)), [[0, 1, 2]]
    larger = rasterize(clip, faces, (5, 4))
    cases = [
        (lambda: rasterize(np.zeros((3, 3)), faces, (4, 4)), r"clip: expected shape \(\.\.\., 4\), got \(3, 3\)"),
        (lambda: rasterize(clip, [[0, 1, 3]], (4, 4)), r"faces: index 3 at \(0, 2\) is out of range \[0, 3\)"),
        (lambda: rasterize(clip, np.array([[0, 1, 2], [0, -1, 2]], np.int32), (4, 4)), r"index -1 at \(1, 1\)"),
        (lambda: rasterize(clip, [[0, 1]], (4, 4)), r"faces: expected shape \(m, 3\), got \(1, 2\)"),
        (lambda: rasterize(clip, faces, (4, 4), 3), "samples: expected 1, 2, 4 or 8, got 3"),
        (lambda: rasterize(clip, faces, (20000, 4)), "size: expected an integer from 0 to 16384, got 20000"),
        (lambda: rasterize(clip, faces, 4), r"size: expected \(width, height\), got 4"),
        (lambda: rasterize(clip, faces, (4, 4), cull="both"), "cull: expected one of"),
        (lambda: rasterize(clip, faces, (4, 4), depth="float"), "depth: expected one of"),
        (
            lambda: rasterize(clip, faces, (4, 4), out=larger),
            r"out.face: expected shape \(4, 4\)",
        ),
    ]
    for call, message in cases:
        with pytest.raises(ValueError, match=message):
            call()
    with pytest.raises(TypeError, match="faces: expected integers"):
        rasterize(clip, np.zeros((1, 3)), (4, 4))
