"""Every hit of each ray, beside Open3D's `list_intersections`: `python tests/benchmarks/all_hits.py [rays]`.

Rays of a picture, (H, W, 3), and random ones that aim at the mesh from all around.

One run, 2 threads, arrays in to arrays out, medians of interleaved repetitions; on a noisy machine only ratios count.
"""

import sys
import time

import numpy as np
import open3d as o3d
import shadelab as sl
import trimesh

REPEATS = 3


def scenes():
    yield "torus 16k", trimesh.creation.torus(1.0, 0.4, 90, 90)
    rng = np.random.default_rng(0)
    ball = trimesh.creation.icosphere(7)
    crumpled = ball.vertices * rng.uniform(0.99, 1.0, (len(ball.vertices), 1))
    yield "crumpled sphere 328k", trimesh.Trimesh(crumpled, ball.faces, process=False)
    # Up to forty layers: many hits a ray.
    balls = [trimesh.creation.icosphere(4, radius=r) for r in np.linspace(0.5, 1.0, 20)]
    yield "20 shells 102k", trimesh.util.concatenate(balls)


def picture(rays):
    """The rays of a square picture that the meshes fill."""
    n = int(np.sqrt(rays))
    x, y = np.meshgrid(np.linspace(-1, 1, n, dtype=np.float32), np.linspace(1, -1, n, dtype=np.float32))
    d = np.stack([x, y, np.full_like(x, -1.8)], -1)
    o = np.broadcast_to(np.float32([0.3, 0.2, 2.2]), d.shape).copy()
    return o, d


def around(rays):
    """Random rays from a sphere around the meshes to places within."""
    rng = np.random.default_rng(1)
    o = rng.normal(size=(rays, 3))
    o = (2 * o / np.linalg.norm(o, axis=-1, keepdims=True)).astype(np.float32)
    return o, (rng.uniform(-0.8, 0.8, (rays, 3)) - o).astype(np.float32)


def main(rays):
    sl.set_threads(2)
    print(
        f"{'scene':22} {'rays':8} {'hits/ray':>8} {'ours ms':>9} {'float64':>9} {'Open3D ms':>10} {'ratio':>6} "
        f"{'same count':>11}"
    )
    for name, mesh in scenes():
        p, f = np.asarray(mesh.vertices, np.float32), np.asarray(mesh.faces, np.int32)
        bvh, double = sl.accel.BVH(p, f), sl.accel.BVH(p.astype(float), f)
        scene = o3d.t.geometry.RaycastingScene(nthreads=2)
        scene.add_triangles(o3d.core.Tensor(p), o3d.core.Tensor(f.astype(np.uint32)))
        for kind, (o, d) in (("picture", picture(rays)), ("random", around(rays))):
            packed, od, dd = np.concatenate([o, d], -1), o.astype(float), d.astype(float)
            times = {"ours": [], "double": [], "open3d": []}
            for _ in range(REPEATS):
                start = time.perf_counter()
                found = bvh.all_hits(o, d)
                times["ours"].append(time.perf_counter() - start)
                start = time.perf_counter()
                double.all_hits(od, dd)
                times["double"].append(time.perf_counter() - start)
                start = time.perf_counter()
                listed = scene.list_intersections(o3d.core.Tensor(packed))
                theirs = {k: v.numpy() for k, v in listed.items()}
                times["open3d"].append(time.perf_counter() - start)
            ours, both, peer = (1e3 * float(np.median(times[k])) for k in ("ours", "double", "open3d"))
            count = np.diff(found.offsets)
            same = (count == np.diff(theirs["ray_splits"])).mean()
            print(
                f"{name:22} {kind:8} {len(found.t) / len(count):8.2f} {ours:9.1f} {both:9.1f} {peer:10.1f} "
                f"{peer / ours:6.1f} {same:11.5f}"
            )


if __name__ == "__main__":
    main(int(float(sys.argv[1])) if len(sys.argv) > 1 else 250_000)
