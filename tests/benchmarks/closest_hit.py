"""closest_hit and any_hit against Open3D's RaycastingScene (Embree 4): two threads each, arrays in to arrays out.

`python tests/benchmarks/closest_hit.py [--rays 4e6] [--levels 3] [--repeats 5]`. A box of 36 triangles; the bunny of
the shared data and its subdivisions; a picture that the mesh fills (coherent) and rays from anywhere in its bounds to
anywhere (random). Contenders alternate, and medians are compared, so that a busy machine slows both. `cpu` is the ratio
of processor time, which a busy machine does not blur. Ratios above one: we are faster. The last column is our time in
float64 over that in float32.
"""

import argparse
import os
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import open3d as o3d
import shadelab as sl
import trimesh

DATA = Path(os.environ.get("SHADELAB_DATA") or Path(__file__).resolve().parents[3] / "shared/data")


def box_of_boxes():
    """36 triangles: a room with two boxes in it."""
    parts = [trimesh.creation.box((4, 4, 4)), trimesh.creation.box((1, 2, 1)), trimesh.creation.box((1, 1, 1))]
    parts[1].apply_translation((-0.8, -1, -0.6))
    parts[2].apply_translation((0.9, -1.5, 0.5))
    mesh = trimesh.util.concatenate(parts)
    return np.array(mesh.vertices, np.float32), np.array(mesh.faces, np.int32)


def bunnies(levels):
    """A quarter of the bunny, the bunny, and subdivisions of it by four."""
    mesh = trimesh.load(DATA / "bunny.obj", process=False, force="mesh")
    small = o3d.geometry.TriangleMesh(
        o3d.utility.Vector3dVector(mesh.vertices), o3d.utility.Vector3iVector(mesh.faces)
    ).simplify_quadric_decimation(16_000)
    yield np.asarray(small.vertices, np.float32), np.asarray(small.triangles, np.int32)
    v, f = np.array(mesh.vertices), np.array(mesh.faces)
    for _ in range(levels):
        yield v.astype(np.float32), f.astype(np.int32)
        v, f = trimesh.remesh.subdivide(v, f)


def coherent_rays(v, n):
    """A picture whose frame the mesh's bounds fill, (H, W, 3)."""
    low, high = v.min(0).astype(float), v.max(0).astype(float)
    centre, size = (low + high) / 2, high - low
    side = int(n**0.5)
    y, x = (np.mgrid[0:side, 0:side] + 0.5) / side - 0.5
    eye = centre + np.array([0, 0, 1.1 * np.linalg.norm(size)])
    target = np.stack([centre[0] + x * 0.62 * size[0], centre[1] - y * 0.62 * size[1], np.full_like(x, centre[2])], -1)
    d = target - eye
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    return np.broadcast_to(eye, d.shape).astype(np.float32), d.astype(np.float32)


def random_rays(v, n):
    rng = np.random.default_rng(1)
    d = rng.normal(size=(n, 3))
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    return rng.uniform(v.min(0), v.max(0), (n, 3)).astype(np.float32), d.astype(np.float32)


def timed(f):
    wall, cpu = time.perf_counter(), time.process_time()
    result = f()
    return result, time.perf_counter() - wall, time.process_time() - cpu


def race(ours, theirs, repeats):
    """Medians of wall and processor time of both, taken in turns after a warm-up."""
    ours(), theirs()
    times = np.array([[timed(f)[1:] for f in (ours, theirs)] for _ in range(repeats)])
    return np.median(times, axis=0)


def embree(v, f):
    scene = o3d.t.geometry.RaycastingScene(nthreads=2)
    scene.add_triangles(o3d.core.Tensor(v), o3d.core.Tensor(f.astype(np.uint32)))
    # The first query commits the scene.
    scene.cast_rays(o3d.core.Tensor(np.zeros((1, 6), np.float32)))
    return scene


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rays", type=float, default=4e6)
    parser.add_argument("--levels", type=int, default=3)
    parser.add_argument("--repeats", type=int, default=5)
    args = parser.parse_args()
    sl.set_threads(2)
    print(
        f"{'faces':>9} {'kind':10} {'ours M/s':>9} {'open3d':>8} {'ratio':>6} {'cpu':>6} {'any':>9}  hits  disagree"
        "  float64 / float32"
    )
    for v, f in [box_of_boxes(), *bunnies(args.levels)]:
        bvh, scene = sl.accel.BVH(v, f), embree(v, f)
        double = sl.accel.BVH(v.astype(np.float64), f)
        for kind, make in (("coherent", coherent_rays), ("random", random_rays)):
            o, d = make(v, int(args.rays))
            both = np.concatenate([o, d], -1)

            def theirs(scene=scene, both=both):
                hit = scene.cast_rays(o3d.core.Tensor(both), nthreads=2)
                return [hit[k].numpy() for k in ("t_hit", "primitive_ids", "primitive_uvs", "primitive_normals")]

            def theirs_any(scene=scene, both=both):
                return scene.test_occlusions(o3d.core.Tensor(both), nthreads=2).numpy()

            def ours(bvh=bvh, o=o, d=d):
                return bvh.closest_hit(o, d)

            def ours_any(bvh=bvh, o=o, d=d):
                return bvh.any_hit(o, d)

            (wall, cpu), (wall_o3d, cpu_o3d) = race(ours, theirs, args.repeats)
            wide = o.astype(np.float64), d.astype(np.float64)

            def ours_double(double=double, wide=wide):
                return double.closest_hit(*wide)

            (any_wall, _), (any_o3d, _) = race(ours_any, theirs_any, args.repeats)
            (single_wall, _), (double_wall, _) = race(ours, ours_double, args.repeats)
            hit = ours()
            millions = hit.t.size / 1e6
            met = hit.face >= 0
            print(
                f"{len(f):9d} {kind:10} {millions / wall:9.2f} {millions / wall_o3d:8.2f} {wall_o3d / wall:6.2f} "
                f"{cpu_o3d / cpu:6.2f} {any_o3d / any_wall:9.2f}  {met.mean():.2f}  "
                f"{(np.isfinite(theirs()[0]) != met).mean():.0e}  {double_wall / single_wall:.2f}",
                flush=True,
            )
        (wall, cpu), (wall_o3d, cpu_o3d) = race(lambda v=v, f=f: sl.accel.BVH(v, f), lambda v=v, f=f: embree(v, f), 3)
        print(
            f"{len(f):9d} build      {wall * 1e3:6.0f} ms {wall_o3d * 1e3:5.0f} ms {wall_o3d / wall:6.2f} "
            f"{cpu_o3d / cpu:6.2f}            {bvh.stats().bytes / len(f):.0f} bytes a face",
            flush=True,
        )


if __name__ == "__main__":
    main()
