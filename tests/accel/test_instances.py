"""Instances answer as each object's own tree does on carried rays, to the bit; transforms are checked."""

import copy
import pickle

import numpy as np
import pytest
import shadelab as sl


def affine(rng, n, kind):
    m = np.tile(np.eye(4), (n, 1, 1))
    m[:, :3, :3] = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0]
    if kind != "rigid":
        m[:, :3, :3] *= 10 ** rng.uniform(-1.5, 1, (n, 1, 3))
    if kind == "sheared":
        m[:, :3, :3] @= np.eye(3) + np.triu(rng.normal(size=(n, 3, 3)), 1)
    m[:, :3, 3] = 4 * rng.normal(size=(n, 3))
    return m


def objects(rng, dtype):
    ball, box = sl.mesh.icosphere(2), sl.mesh.box((1, 2, 3))
    triangle = rng.normal(size=(3, 3))
    meshes = [(ball.positions, ball.faces), (box.positions, box.faces), (triangle, [[0, 1, 2]]), (np.zeros((0, 3)), [])]
    return [sl.accel.BVH(np.asarray(p, dtype), f) for p, f in meshes]


def each_for_itself(scene, o, d, **limits):
    """The nearest of all instances' own answers."""
    best = None
    for i, bvh in enumerate(scene.objects):
        hit = bvh.closest_hit(*scene.carried(o, d, i), **limits)
        mine = [hit.t, hit.face, hit.u, hit.v, np.where(hit.face >= 0, i, -1)]
        nearer = None if best is None else (hit.face >= 0) & (hit.t < best[0])
        best = mine if best is None else [np.where(nearer, a, b) for a, b in zip(mine, best, strict=True)]
    return best


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("kind", ["rigid", "scaled", "sheared"])
@pytest.mark.parametrize("level", sl.simd_levels())
@pytest.mark.parametrize("shift", [0.0, 1e4])
def test_equal_to_every_instance_for_itself(dtype, kind, level, shift):
    rng = np.random.default_rng(1)
    some = objects(rng, dtype)
    m = affine(rng, 60, kind)
    m[:, :3, 3] += shift
    scene = sl.accel.InstancedBVH([some[i % 4] for i in range(60)], m)
    o, d = 5 * rng.normal(size=(3000, 3)) + shift, rng.normal(size=(3000, 3)) * 10 ** rng.uniform(-3, 3, (3000, 1))
    # At the instances' centres, along axes too.
    d[:1000] = (m[rng.integers(60, size=1000), :3, 3] - o[:1000]) * 3
    d[:100] = np.eye(3)[rng.integers(3, size=100)]
    o, d = o.astype(dtype), d.astype(dtype)
    for limits in ({}, {"t_min": 0.5, "t_max": 2.0}):
        expected = each_for_itself(scene, o, d, **limits)
        with sl.simd(level):
            hit = scene.closest_hit(o, d, **limits)
            assert all(np.array_equal(a, b) for a, b in zip(hit[:5], expected, strict=True))
            assert np.array_equal(scene.any_hit(o, d, **limits), expected[1] >= 0)
        assert 0.01 < (hit.face >= 0).mean() < 1


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_all_hits_are_those_of_every_instance_in_order(dtype):
    rng = np.random.default_rng(2)
    some = objects(rng, dtype)
    scene = sl.accel.InstancedBVH([some[i % 3] for i in range(40)], affine(rng, 40, "scaled"))
    o, d = (rng.normal(size=(2, 1500, 3)) * 4).astype(dtype)
    found = scene.all_hits(o, d)
    rows = []
    for i, bvh in enumerate(scene.objects):
        own = bvh.all_hits(*scene.carried(o, d, i))
        rows.append(np.stack([own.ray, own.t, np.full(len(own.t), i), own.face, own.u, own.v]))
    rows = np.concatenate(rows, 1).astype(float)
    rows = rows[:, np.lexsort((rows[3], rows[2], rows[1], rows[0]))]
    ray = np.repeat(np.arange(1500), np.diff(found.offsets))
    assert np.array_equal(np.stack([ray, found.t, found.instance, found.face, found.u, found.v]).astype(float), rows)
    hit = scene.closest_hit(o, d)
    first = np.diff(found.offsets) > 0
    assert np.array_equal(first, hit.face >= 0)
    assert np.array_equal(found.instance[found.offsets[:-1][first]], hit.instance[first])


def test_t_is_the_worlds_whatever_the_scale_and_mirrors_do_no_harm():
    ball = sl.mesh.icosphere(3)
    bvh = sl.accel.BVH(ball.positions, ball.faces)
    m = np.stack([np.diag([s, s, s, 1.0]) for s in (1e-3, -2.0, 1e3)])
    for matrix, radius in zip(m, (1e-3, 2.0, 1e3), strict=True):
        hit = sl.accel.InstancedBVH([bvh], matrix).closest_hit([0, 0, 5e3], [0, 0, -2.0])
        # Aimed at a vertex or next to one.
        assert np.isclose(hit.t, (5e3 - radius) / 2, rtol=1e-3) and hit.instance == 0


def test_equal_hits_go_to_the_lowest_instance():
    box = sl.mesh.box()
    bvh = sl.accel.BVH(box.positions, box.faces)
    scene = sl.accel.InstancedBVH([bvh] * 30, np.tile(np.eye(4), (30, 1, 1)))
    o = np.random.default_rng(3).uniform(-0.4, 0.4, (500, 3)) + np.array([0, 0, 3])
    hit = scene.closest_hit(o, [0, 0, -1])
    assert (hit.instance == 0).all() and np.array_equal(hit.face, bvh.closest_hit(o, [0, 0, -1]).face)
    found = scene.all_hits(o[:1], [0, 0, -1])
    assert np.array_equal(np.unique(found.instance), np.arange(30))


def test_bad_rays_no_instances_and_threads():
    box = sl.mesh.box()
    bvh = sl.accel.BVH(box.positions, box.faces)
    scene = sl.accel.InstancedBVH([bvh], np.eye(4))
    hit = scene.closest_hit([[0, 0, 3], [np.nan, 0, 3], [0, 0, 3]], [[0, 0, -1], [0, 0, -1], [0, 0, 0]])
    assert np.isnan(hit.t).tolist() == [False, True, True] and hit.instance.tolist() == [0, -1, -1]
    none = sl.accel.InstancedBVH([], np.zeros((0, 4, 4)))
    assert np.isinf(none.closest_hit([0, 0, 3], [0, 0, -1]).t) and len(none) == 0
    rng = np.random.default_rng(4)
    scene = sl.accel.InstancedBVH([bvh] * 100, affine(rng, 100, "scaled"))
    o, d = rng.normal(size=(2, 5000, 3)) * 4
    results = []
    for threads in (1, 2, 5):
        sl.set_threads(threads)
        results.append(scene.closest_hit(o, d))
    sl.set_threads(None)
    assert all(np.array_equal(a, b) for r in results for a, b in zip(r, results[0], strict=True))


def test_bad_transforms_are_named():
    box = sl.mesh.box()
    bvh = sl.accel.BVH(box.positions, box.faces)
    bad = np.tile(np.eye(4), (2, 1, 1))
    for change, message in (
        ((1, 2, 2, 0.0), "matrix 1 is singular"),
        ((0, 3, 1, 1.0), "the last row of matrix 0"),
        ((1, 0, 3, np.nan), "matrix 1 is not finite"),
    ):
        m = bad.copy()
        m[change[:3]] = change[3]
        with pytest.raises(ValueError, match=message):
            sl.accel.InstancedBVH([bvh, bvh], m)
    with pytest.raises(ValueError, match="transforms: expected 1"):
        sl.accel.InstancedBVH([bvh], bad)
    with pytest.raises(TypeError, match="objects: expected all of float64"):
        sl.accel.InstancedBVH([bvh, sl.accel.BVH(np.asarray(box.positions, np.float32), box.faces)], bad)
    with pytest.raises(TypeError, match="objects: expected BVHs, got int at 0"):
        sl.accel.InstancedBVH([3], np.eye(4))


def forest(dtype=np.float64):
    """Copies of two meshes, one mirrored, that reach into each other."""
    ball, box = sl.mesh.icosphere(1), sl.mesh.box()
    objects = [sl.accel.BVH(m.positions.astype(dtype), m.faces) for m in (ball, box)]
    places = [
        sl.transform.translate([0.3, 0, 0]),
        sl.transform.rotate_axis([1, 2, 3], 0.5),
        sl.transform.scale([-1.0, 2.0, 0.5]) @ sl.transform.rotate_x(0.3),
    ]
    return sl.accel.InstancedBVH([objects[0], objects[1], objects[0]], places)


def around(n):
    o = np.random.default_rng(5).normal(size=(n, 3)) * 3
    return o, -o + np.random.default_rng(6).normal(size=(n, 3)) * 0.5


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_ignored_faces_are_of_one_instance(dtype):
    two = forest(dtype)
    o, d = around(500)
    hit = two.closest_hit(o, d)
    everything = two.all_hits(o, d)
    got = two.closest_hit(o, d, ignore_face=hit.face, ignore_instance=hit.instance)
    others = two.all_hits(o, d, ignore_face=hit.face, ignore_instance=hit.instance)
    for i in range(500):
        here = slice(*everything.offsets[i : i + 2])
        kept = [
            (t, f, n)
            for t, f, n in zip(everything.t[here], everything.face[here], everything.instance[here], strict=True)
            if (f, n) != (hit.face[i], hit.instance[i])
        ]
        there = slice(*others.offsets[i : i + 2])
        assert kept == list(zip(others.t[there], others.face[there], others.instance[there], strict=True))
        assert (got.t[i], got.face[i], got.instance[i]) == (kept[0] if kept else (np.inf, -1, -1))
    shadow = two.any_hit(o, d, ignore_face=hit.face, ignore_instance=hit.instance)
    np.testing.assert_array_equal(shadow, got.face >= 0)
    with pytest.raises(ValueError, match="ignore_face, ignore_instance: expected both"):
        two.any_hit(o, d, ignore_face=3)
    with pytest.raises(ValueError, match="ignore_instance: expected -1 or an instance below 3"):
        two.any_hit(o, d, ignore_face=3, ignore_instance=3)


def test_normals_are_those_of_the_placed_mesh():
    two = forest()
    o, d = around(500)
    hit = two.closest_hit(o, d, normals=True)
    met = hit.face >= 0
    assert np.isnan(hit.normal[~met]).all()
    for i in np.flatnonzero(met):
        bvh = two.objects[hit.instance[i]]
        a, b, c = sl.transform.transform_points(bvh.positions[bvh.faces[hit.face[i]]], two.transforms[hit.instance[i]])
        n = np.cross(b - a, c - a) * np.sign(np.linalg.det(two.transforms[hit.instance[i]]))
        assert hit.normal[i] @ n / np.linalg.norm(n) == pytest.approx(1, abs=1e-12)
    # Closed meshes seen from outside: normals look back.
    first = hit.normal[met]
    assert (np.einsum("ij,ij->i", first, d[met]) < 0).mean() > 0.9


def test_hits_are_written_where_asked():
    two = forest()
    o, d = around(60)
    expected = two.closest_hit(o, d, normals=True)
    out = sl.accel.instances.InstanceHit(
        np.empty(60), np.empty(60, np.int32), np.empty(60), np.empty(60), np.empty(60, np.int32), np.empty((60, 3))
    )
    got = two.closest_hit(o, d, normals=True, out=out)
    for a, b, c in zip(expected, got, out, strict=True):
        assert b is c
        np.testing.assert_array_equal(a, b)
    lit = np.empty(60, bool)
    assert two.any_hit(o, d, out=lit) is lit
    np.testing.assert_array_equal(lit, expected.face >= 0)
    with pytest.raises(TypeError, match="out: expected an InstanceHit"):
        two.closest_hit(o, d, out=expected[:4])


def test_counts_are_of_both_levels():
    one = sl.accel.BVH(*(lambda m: (m.positions, m.faces))(sl.mesh.icosphere(2)))
    o, d = around(200)
    own = one.counts(o, d)
    placed = sl.accel.InstancedBVH([one], np.eye(4)).counts(o, d)
    reached = placed.triangles > 0
    np.testing.assert_array_equal(placed.triangles[reached], own.triangles[reached])
    # The upper tree has one node with one box.
    entered = placed.boxes > 1
    np.testing.assert_array_equal(placed.boxes[entered], own.boxes[entered] + 1)
    two = forest()
    every = two.counts(o, d, query="all_hits")
    first, shadow = two.counts(o, d), two.counts(o, d, query="any_hit")
    assert (every.triangles >= first.triangles).all() and (first.triangles >= shadow.triangles).all()
    with pytest.raises(ValueError, match="query"):
        two.counts(o, d, query="nearest")


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda s: pickle.loads(pickle.dumps(s))])
def test_copies_share_objects(copied):
    two = forest()
    other = copied(two)
    o, d = around(100)
    for a, b in zip(two.all_hits(o, d), other.all_hits(o, d), strict=True):
        np.testing.assert_array_equal(a, b)
    assert other.objects[0] is other.objects[2] and len(other) == 3
    assert other.stats()[:-1] == two.stats()[:-1]
    assert two.stats().faces == two.stats().references == 3
    assert repr(two) == "InstancedBVH(3 instances, float64)"
    with pytest.raises(ValueError, match="lacks transforms"):
        sl.accel.InstancedBVH.__new__(sl.accel.InstancedBVH).__setstate__({"objects": ()})
