"""The tree returns brute force's answer to the bit, whatever the rays, levels and threads; and contains bad rays."""

import numpy as np
import pytest
import shadelab as sl


def soup(rng, n, dtype, size=0.2, offset=0.0):
    """Triangles of about `size` with centres in a unit cloud."""
    centres = rng.normal(size=(n, 1, 3))
    p = (centres + size * rng.normal(size=(n, 3, 3)) + offset).reshape(-1, 3)
    return p.astype(dtype), np.arange(3 * n).reshape(-1, 3)


def same_bits(a, b):
    return all(np.array_equal(x.view(np.uint8), y.view(np.uint8)) for x, y in zip(a[:4], b[:4], strict=True))


def rays_of(kind, rng, n):
    o = rng.normal(size=(n, 3))
    if kind == "axis-parallel":
        d = np.eye(3)[rng.integers(3, size=n)] * rng.choice([-1, 1], (n, 1))
    elif kind == "coherent":
        x, y = np.meshgrid(np.linspace(-1, 1, n // 32), np.linspace(-1, 1, 32))
        d = np.stack([x, y, -3 * np.ones_like(x)], -1).reshape(-1, 3)
        o = np.broadcast_to([0.1, 0.2, 4.0], d.shape)
    else:
        d = rng.normal(size=(n, 3)) * {"random": 1.0, "tiny": 1e-20, "huge": 1e20}[kind]
    return o[: len(d)], d


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("kind", ["random", "axis-parallel", "coherent", "tiny", "huge"])
@pytest.mark.parametrize("level", sl.simd_levels())
@pytest.mark.parametrize("method", ["sah", "median", "lbvh"])
def test_tree_equals_brute_force_to_the_bit(dtype, kind, level, method):
    rng = np.random.default_rng(3)
    p, f = soup(rng, 700, dtype)
    o, d = rays_of(kind, rng, 4096)
    expected = sl.accel.brute_force(p, f, o, d)
    bvh = sl.accel.BVH(p, f, method=method)
    with sl.simd(level):
        hit = bvh.closest_hit(o, d)
        assert same_bits(hit, expected)
        assert np.array_equal(bvh.any_hit(o, d), expected.face >= 0)
    assert 0.05 < (expected.face >= 0).mean() < 1


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("kind", ["random", "axis-parallel", "coherent", "picture"])
@pytest.mark.parametrize("faces", [700, 30_000])  # of which the larger does not fit into the caches
def test_every_hit_is_brute_forces_whatever_rays_are_traced_with_it(dtype, kind, faces):
    rng = np.random.default_rng(5)
    # Leaves room for many hits a ray, and for equal ones: each tenth face is there twice.
    p, f = soup(rng, faces, dtype, size=0.3 if faces < 1000 else 0.1)
    f = np.concatenate([f, f[::10]])
    o, d = rays_of("coherent" if kind == "picture" else kind, rng, 2048)
    if kind == "picture":  # 37 wide: packets, and columns that are left over
        o, d = (np.broadcast_to(a, d.shape).reshape(32, -1, 3)[:, :37].copy() for a in (o, d))
        o[3, 5] = np.nan
        assert d.shape == (32, 37, 3)
    bvh = sl.accel.BVH(p, f)
    first = bvh.closest_hit(o, d)
    ends = rng.uniform(1, 8, o.shape[:-1]).astype(dtype)
    for limits in [{}, {"ignore_face": first.face}, {"t_min": 0.5, "t_max": ends}]:
        expected = sl.accel.brute_force_all(p, f, o, d, **limits)
        assert len(expected.t) > o[..., 0].size / 4
        found = bvh.all_hits(o, d, **limits)
        assert all(a.tobytes() == b.tobytes() for a, b in zip(found, expected, strict=True))
        for level in sl.simd_levels():
            with sl.simd(level):
                assert all(
                    a.tobytes() == b.tobytes() for a, b in zip(bvh.all_hits(o, d, **limits), expected, strict=True)
                )


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_intervals_are_open_and_ignored_faces_are_not_met(dtype):
    rng = np.random.default_rng(4)
    p, f = soup(rng, 500, dtype)
    o, d = rng.normal(size=(2, 3000, 3))
    bvh = sl.accel.BVH(p, f)
    first = bvh.closest_hit(o, d)
    assert not bvh.any_hit(o, d, t_max=first.t).any()
    for limits in [{"t_min": first.t}, {"ignore_face": first.face}, {"t_min": 0.5, "t_max": rng.uniform(size=3000)}]:
        second = bvh.closest_hit(o, d, **limits)
        assert same_bits(second, sl.accel.brute_force(p, f, o, d, **limits))
        assert (second.face[first.face >= 0] != first.face[first.face >= 0]).all() or "t_max" in limits


def test_what_is_no_ray_gives_nan_and_touches_no_other():
    rng = np.random.default_rng(5)
    p, f = soup(rng, 300, np.float32)
    o, d = rng.normal(size=(2, 1000, 3)).astype(np.float32)
    bvh = sl.accel.BVH(p, f)
    clean = bvh.closest_hit(o, d)
    bad = np.arange(0, 1000, 7)
    o[bad[0::4], 1], d[bad[1::4], 2], d[bad[2::4]], o[bad[3::4], 0] = np.nan, np.inf, 0, -np.inf
    hit = bvh.closest_hit(o, d)
    assert np.isnan(hit.t[bad]).all() and (hit.face[bad] == -1).all() and not bvh.any_hit(o, d)[bad].any()
    good = np.setdiff1d(np.arange(1000), bad)
    assert np.array_equal(hit.t[good], clean.t[good]) and np.array_equal(hit.face[good], clean.face[good])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_empty_mesh_and_no_rays(dtype):
    empty = sl.accel.BVH(np.zeros((0, 3), dtype), [])
    hit = empty.closest_hit(np.zeros((2, 5, 3)), [1, 0, 0])
    assert hit.t.shape == (2, 5) and np.isinf(hit.t).all() and (hit.face == -1).all()
    p, f = soup(np.random.default_rng(0), 1, dtype)
    assert sl.accel.BVH(p, f).closest_hit(np.zeros((0, 3)), [1, 0, 0]).t.shape == (0,)


def test_bad_meshes_name_what_is_wrong():
    p = np.zeros((4, 3))
    with pytest.raises(ValueError, match=r"faces: index 4 at \(1, 2\) is out of range \[0, 4\)"):
        sl.accel.BVH(p, [[0, 1, 2], [0, 1, 4]])
    p[2, 1] = np.nan
    with pytest.raises(ValueError, match="positions: vertex 2 is not finite"):
        sl.accel.BVH(p, [[0, 1, 3]])
    with pytest.raises(ValueError, match=r"directions: expected shape \(\.\.\., 3\), got \(7, 2\)"):
        sl.accel.BVH(np.zeros((4, 3)), [[0, 1, 3]]).closest_hit([0, 0, 0], np.zeros((7, 2)))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_equal_hits_go_to_the_lowest_face(dtype):
    rng = np.random.default_rng(6)
    p, f = soup(rng, 50, dtype, size=1.0)
    many = np.concatenate([np.roll(f, k, 0) for k in range(40)])
    o, d = rng.normal(size=(2, 2000, 3))
    hit = sl.accel.BVH(p, many).closest_hit(o, d)
    assert same_bits(hit, sl.accel.brute_force(p, many, o, d)) and hit.face.max() < 50


def test_answers_do_not_depend_on_threads():
    rng = np.random.default_rng(7)
    p, f = soup(rng, 40000, np.float32, 0.05)
    o, d = rng.normal(size=(2, 20000, 3))
    results = []
    for threads in (1, 2, 5):
        sl.set_threads(threads)
        bvh = sl.accel.BVH(p, f)
        results.append((bvh.stats()._replace(build_ms=0), bvh.closest_hit(o, d)))
    sl.set_threads(None)
    assert all(s == results[0][0] and same_bits(h, results[0][1]) for s, h in results)


def test_out_is_written_and_normals_follow_the_winding():
    p, f = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0.0]]), [[0, 1, 2]]
    bvh = sl.accel.BVH(p, f)
    first = bvh.closest_hit([[0.5, 0.5, 3], [5, 5, 5]], [0, 0, -1], normals=True)
    assert np.array_equal(first.normal, [[0, 0, 1], [np.nan] * 3], equal_nan=True)
    again = bvh.closest_hit([[0.5, 0.5, 1], [5, 5, 5]], [0, 0, -1], normals=True, out=first)
    assert again.t is first.t and first.t[0] == 1


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_negative_zero_is_a_direction_like_zero(dtype):
    corners = np.array([[-9, 1, -9], [0, 1, -9], [0, 1, 9], [-9, 1, 9]], dtype)
    tree = sl.accel.BVH(corners, [[0, 1, 2], [0, 2, 3]])
    tiny = np.finfo(dtype).smallest_subnormal
    sides = np.array([[x, 1.0, z] for x in (0.0, -0.0, tiny, -tiny) for z in (0.0, -0.0, tiny, -tiny)], dtype)
    origin = np.array([-0.5, 0, 0.25], dtype)
    assert tree.any_hit(origin, sides).all() and np.array_equal(tree.closest_hit(origin, sides).t, np.ones(16))
    assert np.array_equal(tree.closest_hit(origin + np.array([0, 2, 0], dtype), -sides).face >= 0, np.ones(16, bool))


@pytest.mark.parametrize(("dtype", "bad"), [(np.float32, (1e30, 1e-25)), (np.float64, (1e300, 1e-200))])
def test_meshes_too_large_or_too_small_to_test_are_refused(dtype, bad):
    triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype)
    with pytest.raises(ValueError, match="positions: vertex 1 lies beyond"):
        sl.accel.BVH(triangle * dtype(bad[0]), [[0, 1, 2]])
    with pytest.raises(ValueError, match=r"positions: extent .* scale the mesh up"):
        sl.accel.BVH(triangle * dtype(bad[1]), [[0, 1, 2]])


@pytest.mark.parametrize(("dtype", "held"), [(np.float32, (1e17, 2e-12)), (np.float64, (1e149, 2e-100))])
def test_meshes_at_the_ends_of_the_domain_are_hit(dtype, held):
    triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype)
    for size in held:
        size = dtype(size)
        bvh = sl.accel.BVH(triangle * size, [[0, 1, 2]])
        hit = bvh.closest_hit(np.array([0.25, 0.5, 2], dtype) * size, np.array([0, 0, -1], dtype))
        assert hit.face == 0 and np.isclose(hit.t / size, 2, rtol=1e-6)


def makes(rng):
    """Meshes that builders stumble over: name, positions, faces."""
    p, f = soup(rng, 3000, np.float64, 0.01)
    yield "one place", np.tile(p[:3], (3000, 1)), f
    yield (
        "one centre",
        (p[:3] - p[:3].mean(0))[None].repeat(3000, 0).reshape(-1, 3) * np.repeat(rng.normal(size=(3000, 1)), 3, 0),
        f,
    )
    yield "a line", p * [1, 0, 0] + [0, 1, 2], f
    yield "nested scales", p * np.repeat(10.0 ** rng.uniform(-9, 0, (3000, 1)), 3, 0), f
    yield "two far clusters", p + np.repeat(rng.choice([0, 1e6], (3000, 1)), 3, 0), f
    yield "a fan of needles", np.where(np.arange(9000)[:, None] % 3 == 0, 0.0, p), f


@pytest.mark.parametrize("method", ["sah", "median", "lbvh"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_every_builder_holds_whatever_the_mesh(method, dtype):
    rng = np.random.default_rng(11)
    d = rng.normal(size=(2000, 3))
    for name, p, f in makes(rng):
        p = p.astype(dtype)
        # At the mesh, from near by, so that small parts are met too.
        at = p[rng.integers(len(p), size=2000)]
        hit = sl.accel.BVH(p, f, method=method).closest_hit(at - 1e-3 * d, d)
        assert same_bits(hit, sl.accel.brute_force(p, f, at - 1e-3 * d, d)), name


@pytest.mark.parametrize("crowd", ["even", "nested", "half in one cell", "all but one in one cell"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_morton_order_of_large_crowded_meshes(crowd, dtype):
    """Long enough to be sorted in parts; in crowds the upper bits of many codes are equal, and the lower decide."""
    rng = np.random.default_rng(15)
    n = 60_000
    scale = {
        "even": np.ones(n),
        "nested": 10.0 ** rng.uniform(-7, 0, n),
        "half in one cell": np.where(rng.random(n) < 0.5, 1e-4, 1.0),
        "all but one in one cell": np.where(np.arange(n) == 0, 1.0, 1e-4),
    }[crowd]
    p, f = soup(rng, n, np.float64, size=0.05)
    p = (p * np.repeat(scale, 3)[:, None]).astype(dtype)
    lbvh, sah = (sl.accel.BVH(p, f, method=method) for method in ("lbvh", "sah"))
    d = rng.normal(size=(4000, 3))
    o = p[rng.integers(len(p), size=4000)] - 0.1 * d * scale[-1]
    hit = lbvh.closest_hit(o, d)
    assert same_bits(hit, sah.closest_hit(o, d))
    assert (hit.face >= 0).sum() > 100
    # Without the lower bits rays would meet most of a crowd: tens of times as much.
    boxes, triangles = (np.mean(a) / np.mean(b) for a, b in zip(lbvh.counts(o, d), sah.counts(o, d), strict=True))
    assert boxes < 2.5 and triangles < 2.5


@pytest.mark.parametrize("method", ["sah", "median", "lbvh"])
def test_trees_do_not_depend_on_threads(method):
    """Large enough that lists are cut, binned and written by several tasks."""
    p, f = soup(np.random.default_rng(12), 90_000, np.float32)
    found = []
    for n in (1, 3):
        sl.set_threads(n)
        bvh = sl.accel.BVH(p, f, method=method)
        o, d = np.random.default_rng(13).normal(size=(2, 3000, 3))
        found.append((bvh.stats()._replace(build_ms=0), bvh.counts(o, d)))
    sl.set_threads(None)
    assert found[0][0] == found[1][0]
    assert all(np.array_equal(a, b) for a, b in zip(found[0][1], found[1][1], strict=True))


@pytest.mark.parametrize("shape", [(40, 33), (3, 64), (7, 35), (2, 9, 40), (50, 4)])
def test_a_picture_has_the_hits_of_a_list(shape):
    """Whatever the order in which its rays are traced."""
    rng = np.random.default_rng(14)
    p, f = soup(rng, 400, np.float32)
    o, d = rays_of("coherent", rng, 4096)
    n = int(np.prod(shape))
    o, d = o[:n].reshape(*shape, 3), d[:n].reshape(*shape, 3)
    bvh = sl.accel.BVH(p, f)
    hit, listed = bvh.closest_hit(o, d), bvh.closest_hit(o.reshape(-1, 3), d.reshape(-1, 3))
    assert hit.t.shape == shape and same_bits([x.reshape(-1) for x in hit[:4]], listed)
    assert (bvh.any_hit(o, d) == (hit.face >= 0)).all()


def test_unknown_methods_are_named():
    with pytest.raises(ValueError, match="method: expected one of"):
        sl.accel.BVH(np.eye(3), [[0, 1, 2]], method="best")


def test_results_that_share_memory_are_refused():
    p, f = soup(np.random.default_rng(1), 20, np.float32)
    bvh = sl.accel.BVH(p, f)
    buffer = bytearray(400)
    t, u = (np.frombuffer(buffer, np.float32) for _ in range(2))
    out = sl.accel.Hit(t, np.zeros(100, np.int32), u, np.zeros(100, np.float32))
    with pytest.raises(ValueError, match=r"out\.t: shares memory with out\.u"):
        bvh.closest_hit(np.zeros((100, 3), np.float32), [0, 0, 1], out=out)
