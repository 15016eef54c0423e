"""No ray from inside a closed mesh escapes, though aimed at its edges and vertices.

In either precision, at any scale and distance. `python tests/accel/test_watertight.py 1e7` does it at length.
"""

import sys

import numpy as np
import pytest
import shadelab as sl
import trimesh


def closed_mesh(kind):
    """A star-shaped closed mesh around the origin, about one unit in size."""
    if kind == "box":
        # Edges along the axes: boxes of no thickness, and zeros in every direction.
        mesh = trimesh.creation.box((2, 2, 2)).subdivide().subdivide()
    else:
        mesh = trimesh.creation.icosphere(4)
    p = np.array(mesh.vertices)
    if kind == "crumpled":
        p = p * np.random.default_rng(0).uniform(0.6, 1.0, (len(p), 1))
    return p, np.array(mesh.faces)


def leaks(kind, dtype, scale, shift, n, seed, ordered=False):
    """Rays of `n` that miss, from near the centre to vertices (a quarter) and along edges."""
    rng = np.random.default_rng(seed)
    p, f = closed_mesh(kind)
    p = (p * scale + shift).astype(dtype)
    bvh = sl.accel.BVH(p, f)
    missed = 0
    for begin in range(0, n, 1 << 20):
        m = min(1 << 20, n - begin)
        face, k = rng.integers(len(f), size=m), rng.integers(3, size=m)
        if ordered:
            face = np.sort(face)
        a, b = p[f[face, k]].astype(np.float64), p[f[face, (k + 1) % 3]].astype(np.float64)
        w = np.where(np.arange(m) % 4 == 0, 0, rng.uniform(size=m))[:, None]
        # Some from the very centre, so that rays along axes and diagonals occur; packets all from one point.
        spread = 0.0 if ordered else 0.2
        o = (spread * scale * rng.uniform(-1, 1, (m, 3)) * (np.arange(m) % 8 != 0)[:, None] + shift).astype(dtype)
        d = (a + w * (b - a) - o).astype(dtype)
        missed += int((bvh.closest_hit(o, d).face < 0).sum()) + int((~bvh.any_hit(o, d)).sum())
    return missed


PLACES = [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e3), (100.0, 1e6), (1e3, -1e6)]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("kind", ["box", "sphere", "crumpled"])
@pytest.mark.parametrize(("scale", "shift"), PLACES)
def test_no_ray_leaves_a_closed_mesh(kind, dtype, scale, shift):
    assert leaks(kind, dtype, scale, shift, 20_000, 1) == 0
    assert leaks(kind, dtype, scale, shift, 20_000, 2, ordered=True) == 0


def test_the_aim_is_good_enough_to_slip_past_other_tests():
    """Möller-Trumbore leaks on the very rays, so the test above could fail."""
    rng = np.random.default_rng(3)
    p, f = closed_mesh("crumpled")
    p = p.astype(np.float32)
    face = rng.integers(len(f), size=1500)
    a, b = p[f[face, 0]].astype(float), p[f[face, 1]].astype(float)
    o = rng.uniform(-0.2, 0.2, (1500, 3)).astype(np.float32)
    d = (a + rng.uniform(size=(1500, 1)) * (b - a) - o).astype(np.float32)
    t = sl.geometry.ray_triangle(o[:, None], d[:, None], *(p[f[:, k]] for k in range(3)), "moller_trumbore").t
    assert np.isinf(t).all(1).any()


if __name__ == "__main__":
    n = int(float(sys.argv[1])) if len(sys.argv) > 1 else 10**7
    for dtype in (np.float32, np.float64):
        for scale, shift in PLACES:
            share = n // (3 * len(PLACES)) + 1
            found = [leaks(k, dtype, scale, shift, share, 5) for k in ("box", "sphere", "crumpled")]
            print(f"{dtype.__name__} scale {scale:g} at {shift:g}: leaks {found} of {share} rays each")
