"""Building hierarchies: time against Open3D's commit (Embree 4), memory, and growth to ten million faces.

`python tests/benchmarks/build.py [--largest 1e7] [--repeats 3]`. Two threads each, arrays in to a structure that
answers. The meshes are bumpy spheres of our own. Contenders alternate; medians are compared. `rays` is the time of a
random ray, in ns on two threads; `growth` that time over the row above, beside the growth of log2 of the faces. Peak
memory is measured in a process of its own, which builds once.
"""

import argparse
import os
import subprocess
import sys

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import shadelab as sl
from closest_hit import embree, race, random_rays, timed


def bumpy_sphere(faces, dtype=np.float32):
    """About as many faces as asked for."""
    rows = max(int((faces / 4) ** 0.5), 3)
    columns = 2 * rows
    theta = np.linspace(0, np.pi, rows + 1)[:, None]
    phi = np.linspace(0, 2 * np.pi, columns, endpoint=False)
    r = 1 + 0.05 * np.sin(20 * theta) * np.sin(20 * phi)
    p = np.stack(
        np.broadcast_arrays(r * np.sin(theta) * np.cos(phi), r * np.cos(theta), r * np.sin(theta) * np.sin(phi)), -1
    )
    i, j = np.mgrid[0:rows, 0:columns]
    a, b = i * columns + j, i * columns + (j + 1) % columns
    f = np.stack([np.stack([a, b, a + columns], -1), np.stack([b, b + columns, a + columns], -1)], 2)
    return p.reshape(-1, 3).astype(dtype), f.reshape(-1, 3).astype(np.int32)


def peak(faces, dtype, method):
    """Peak resident memory in GiB of a process that builds once, arrays included, and what it had before the build."""
    code = (
        "import resource, sys; sys.path.insert(0, sys.argv[1]); import numpy as np, shadelab as sl;"
        "from build import bumpy_sphere;"
        f"v, f = bumpy_sphere({faces}, np.{dtype});"
        "before = int(open('/proc/self/statm').read().split()[1]) * resource.getpagesize();"
        "open('/proc/self/clear_refs', 'w').write('5');"
        f"sl.set_threads(2); b = sl.accel.BVH(v, f, method='{method}');"
        "most = [l for l in open('/proc/self/status') if l.startswith('VmHWM')][0].split()[1];"
        "print(before / 2**30, int(most) / 2**20)"
    )
    here = os.path.dirname(os.path.abspath(__file__))
    out = subprocess.run([sys.executable, "-c", code, here], capture_output=True, text=True, check=True).stdout
    return [float(x) for x in out.split()]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--largest", type=float, default=1e7)
    parser.add_argument("--repeats", type=int, default=3)
    args = parser.parse_args()
    sl.set_threads(2)
    sizes = [10**k for k in range(3, 8) if 10**k <= args.largest]
    print("build in ms; ratio to Open3D above one: we are faster")
    print(
        f"{'faces':>9} {'open3d':>8} {'sah':>8} {'ratio':>6} {'median':>8} {'lbvh':>8}"
        f" {'sah/lbvh':>9} {'sah/refit':>9} {'bytes/face':>10}",
        end="",
    )
    print(f" {'float64/32':>10}  {'sah, median, lbvh rays ns':>26} {'growth':>7} {'log':>5}")
    last = None
    for size in sizes:
        v, f = bumpy_sphere(size)
        (sah, _), (theirs, _) = race(lambda v=v, f=f: sl.accel.BVH(v, f), lambda v=v, f=f: embree(v, f), args.repeats)
        (sah2, _), (lbvh, _) = race(
            lambda v=v, f=f: sl.accel.BVH(v, f), lambda v=v, f=f: sl.accel.BVH(v, f, method="lbvh"), args.repeats
        )
        double = v.astype(np.float64)
        (sah3, _), (wide, _) = race(
            lambda v=v, f=f: sl.accel.BVH(v, f), lambda v=double, f=f: sl.accel.BVH(v, f), args.repeats
        )
        o, d = random_rays(v, 1_000_000)
        times = []
        for method in ("sah", "median", "lbvh"):
            bvh = sl.accel.BVH(v, f, method=method)
            bvh.closest_hit(o, d)
            times.append(
                np.median([timed(lambda b=bvh, o=o, d=d: b.closest_hit(o, d))[1] for _ in range(args.repeats)]) * 1e3
            )
            if method == "sah":
                size_of = bvh.stats().bytes / len(f)
                refit = np.median([timed(lambda b=bvh, v=v: b.refit(v))[1] for _ in range(args.repeats)])
            if method == "median":
                median = bvh.stats().build_ms
            del bvh
        growth = f"{times[0] / last[0]:7.2f} {np.log2(len(f)) / np.log2(last[1]):5.2f}" if last else ""
        last = times[0], len(f)
        print(
            f"{len(f):9d} {theirs * 1e3:8.1f} {sah * 1e3:8.1f} {theirs / sah:6.2f} {median:8.1f} {lbvh * 1e3:8.1f} "
            f"{sah2 / lbvh:9.2f} {sah / refit:9.2f} {size_of:10.1f} {wide / sah3:10.2f}  "
            + " ".join(f"{t:8.0f}" for t in times)
            + f" {growth}",
            flush=True,
        )
    for dtype in ("float32", "float64"):
        for method in ("sah", "lbvh"):
            before, most = peak(int(args.largest), dtype, method)
            what = f"{args.largest:.0e} faces, {dtype}, {method}"
            print(f"peak of {what}: {most:.2f} GiB, of which {before:.2f} before the build")


if __name__ == "__main__":
    main()
