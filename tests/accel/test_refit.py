"""Moved vertices, pickles, copies: what comes out answers as brute force does, and what is damaged is refused."""

import copy
import pickle
import struct
import threading

import numpy as np
import pytest
import shadelab as sl


def soup(rng, n, dtype, size=0.2):
    p = rng.normal(size=(n, 1, 3)) + size * rng.normal(size=(n, 3, 3))
    return p.reshape(-1, 3).astype(dtype), np.arange(3 * n).reshape(-1, 3)


def same_bits(a, b):
    return all(np.array_equal(x.view(np.uint8), y.view(np.uint8)) for x, y in zip(a[:4], b[:4], strict=True))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("method", ["sah", "median", "lbvh"])
@pytest.mark.parametrize("faces", [0, 1, 3, 70, 3000])
def test_moved_meshes_are_hit_as_by_brute_force(dtype, method, faces):
    rng = np.random.default_rng(1)
    p, f = soup(rng, faces, dtype)
    bvh = sl.accel.BVH(p, f, method=method)
    moved = (p[:, [1, 2, 0]] * [3, 1, -1] + rng.normal(size=p.shape) * 0.1).astype(dtype)
    refitted = bvh.refit(moved)
    o, d = rng.normal(size=(2, 2000, 3))
    assert same_bits(refitted.closest_hit(o, d), sl.accel.brute_force(moved, f, o, d))
    assert same_bits(bvh.closest_hit(o, d), sl.accel.brute_force(p, f, o, d))
    near, expected = (refitted.closest_point(o, method=m) for m in ("tree", "brute_force"))
    assert np.array_equal(near.distance, expected.distance) and np.array_equal(near.face, expected.face)
    assert np.array_equal(refitted.positions, moved) and not refitted.positions.flags.writeable


def test_refitting_to_the_same_place_changes_nothing_and_disorder_costs():
    rng = np.random.default_rng(2)
    p, f = soup(rng, 5000, np.float32)
    bvh = sl.accel.BVH(p, f)
    assert bvh.refit(p).stats()._replace(build_ms=0) == bvh.stats()._replace(build_ms=0)
    shuffled = p.reshape(-1, 3, 3)[rng.permutation(5000)].reshape(-1, 3)
    assert bvh.refit(shuffled).stats().sah_cost > 3 * bvh.stats().sah_cost


def test_bad_positions_are_refused():
    p, f = soup(np.random.default_rng(4), 5, np.float64)
    bvh = sl.accel.BVH(p, f)
    with pytest.raises(ValueError, match=r"positions: expected shape \(15, 3\), got \(14, 3\)"):
        bvh.refit(p[1:])
    p[7, 1] = np.nan
    with pytest.raises(ValueError, match="positions: vertex 7 is not finite"):
        bvh.refit(p)
    with pytest.raises(ValueError, match="lies beyond"):
        bvh.refit(np.where(np.isnan(p), 1e200, p))


def test_refitting_does_not_disturb_who_traces():
    rng = np.random.default_rng(5)
    p, f = soup(rng, 2000, np.float32)
    bvh = sl.accel.BVH(p, f)
    o, d = rng.normal(size=(2, 5000, 3))
    expected, wrong = bvh.closest_hit(o, d), []

    def trace():
        wrong.extend(1 for _ in range(5) if not same_bits(bvh.closest_hit(o, d), expected))

    threads = [threading.Thread(target=trace) for _ in range(3)]
    [t.start() for t in threads]
    for k in range(10):
        bvh.refit(p + k)
    [t.join() for t in threads]
    assert not wrong


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("faces", [0, 1, 2000])
def test_pickles_and_copies_are_the_same_tree(dtype, faces):
    rng = np.random.default_rng(6)
    p, f = soup(rng, faces, dtype)
    bvh = sl.accel.BVH(p, f)
    o, d = rng.normal(size=(2, 1000, 3))
    expected = bvh.closest_hit(o, d)
    for other in (pickle.loads(pickle.dumps(bvh)), copy.copy(bvh), copy.deepcopy(bvh)):
        assert same_bits(other.closest_hit(o, d), expected) and other.stats() == bvh.stats()
        assert np.array_equal(other.counts(o, d).boxes, bvh.counts(o, d).boxes)
        assert not other.positions.flags.writeable and other.dtype == dtype
    # Blocks and boxes follow from the mesh: some 10 bytes a face beside it.
    assert len(bvh.__getstate__()["tree"]) < 200 + 30 * faces


def restored(bvh, tree):
    other = sl.accel.BVH.__new__(sl.accel.BVH)
    other.__setstate__(bvh.__getstate__() | {"tree": tree})
    return other


def signed(body, nodes, blocks, magic=b"shadelab.BVH.001"):
    """Bytes whose checksum is right, whatever they hold."""
    h = 0xCBF29CE484222325
    words = len(body) // 8
    for w in [*struct.unpack(f"<{words}Q", body[: 8 * words]), *body[8 * words :]]:
        h = ((h ^ w) * 0x100000001B3) & (2**64 - 1)
        h = ((h << 23) | (h >> 41)) & (2**64 - 1)
    return magic + struct.pack("<QQQ", nodes, blocks, h) + body


def test_damaged_trees_are_refused():
    p, f = soup(np.random.default_rng(7), 300, np.float32)
    bvh = sl.accel.BVH(p, f)
    good = bvh.__getstate__()["tree"]
    nodes, blocks = struct.unpack("<QQ", good[16:32])
    assert signed(good[40:], nodes, blocks) == good
    o, d = np.random.default_rng(8).normal(size=(2, 200, 3))
    assert same_bits(restored(bvh, good).closest_hit(o, d), bvh.closest_hit(o, d))
    bad = {
        "too short": good[:10],
        "not a saved tree": b"x" + good[1:],
        'of version "002", expected "001"': good[:13] + b"002" + good[16:],
        "of the wrong length": good[:-4],
        "damaged": good[:-1] + bytes([good[-1] ^ 1]),
    }
    for message, data in bad.items():
        with pytest.raises(ValueError, match=message):
            restored(bvh, data)
    with pytest.raises(ValueError, match="lacks tree"):
        bvh.__setstate__({"positions": p, "faces": f, "build_ms": 0})
    with pytest.raises(ValueError, match="the saved tree is bad: face"):
        restored(sl.accel.BVH(p, f[:-1]), good)
    with pytest.raises(ValueError, match="the saved tree is bad: faces are missing"):
        restored(sl.accel.BVH(p, np.concatenate([f, f[:1]])), good)


def test_no_forgery_passes_that_a_traversal_could_stumble_over():
    """Any child or face overwritten, the checksum made right again: refused, or still a tree over every face."""
    p, f = soup(np.random.default_rng(8), 60, np.float32)
    bvh = sl.accel.BVH(p, f)
    good = bvh.__getstate__()["tree"]
    nodes, blocks = struct.unpack("<QQ", good[16:32])
    rng = np.random.default_rng(9)
    o, d = rng.normal(size=(2, 200, 3))
    refused = 0
    for _ in range(400):
        body = bytearray(good[40:])
        at = 4 * int(rng.integers(len(body) // 4))
        other = 4 * int(rng.integers(len(body) // 4))
        word = rng.choice([0, 1, 2**31, 2**32 - 1, 2**31 + 2**27, int(rng.integers(2**32)), int(rng.integers(60))])
        body[at : at + 4] = struct.pack("<I", int(word)) if rng.uniform() < 0.7 else body[other : other + 4]
        try:
            tree = restored(bvh, signed(bytes(body), nodes, blocks))
        except ValueError as error:
            assert "the saved tree is bad" in str(error)
            refused += 1
        else:
            assert same_bits(tree.closest_hit(o, d), bvh.closest_hit(o, d))
    assert refused > 300
