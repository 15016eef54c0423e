"""Warps against memory: nanoseconds a point, and the fraction of the time that moving its bytes alone takes.

The yardstick is NumPy's copy of as many bytes, in the same arrays and on one thread; the kernels of warps run on one
thread, then on all, into arrays that are there. The public functions return new arrays, whose pages are fresh: beside
them stands a copy into as many fresh bytes (`ndarray.copy` of the points, and zeros for what is more).

`python tests/benchmarks/warps.py [--points 4194304]`
"""

import argparse
from time import perf_counter

import numpy as np
import shadelab as sl
from shadelab import sampling
from shadelab._kernels import sampling as kernels


def best(f, repeat=5):
    f()
    times = []
    for _ in range(repeat):
        start = perf_counter()
        f()
        times.append(perf_counter() - start)
    return min(times)


CASES = {
    "disk, concentric": ("square_to_disk", ("concentric",), 2),
    "disk, polar": ("square_to_disk", ("polar",), 2),
    "triangle, fold": ("square_to_triangle", ("fold",), 2),
    "triangle, root": ("square_to_triangle", ("root",), 2),
    "sphere": ("square_to_sphere", (), 3),
    "hemisphere": ("square_to_hemisphere", ("concentric",), 3),
    "cosine hemisphere": ("square_to_cosine_hemisphere", ("concentric",), 3),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=1 << 22)
    n = parser.parse_args().points
    threads = sl.threads()
    several = f"{threads} threads"
    head = f"{'':20} {'dtype':8} {'bytes':>5} {'copy':>6} {'1 thread':>9} {'share':>6} {several:>9} {'share':>6}"
    print(f"{head} {'fresh':>6} {'public':>9} {'share':>6}   ns")
    for name, (function, options, size) in CASES.items():
        kernel, public = getattr(kernels, function), getattr(sampling, function)
        for dtype in (np.float32, np.float64):
            u = np.random.default_rng(1).random((n, 2)).astype(dtype)
            out = np.empty((n, size), dtype)
            flat, source = out.reshape(-1), u.reshape(-1)
            moved = (u.nbytes + out.nbytes) / n

            def copy(flat=flat, source=source):
                flat[: len(source)] = source
                if len(flat) > len(source):
                    flat[len(source) :] = 0

            yard = best(copy)
            times = []
            for count in (1, threads):
                sl.set_threads(count)
                times.append(best(lambda: kernel(*options, [u], [out])))  # noqa: B023
            sl.set_threads(None)

            def fresh(u=u, n=n, size=size):
                copied = u.copy()
                if size > 2:
                    np.empty((n, size - 2), u.dtype).fill(0)
                return copied

            yard_fresh, whole = best(fresh), best(lambda: public(u, *options))  # noqa: B023
            row = " ".join(f"{1e9 * t / n:9.2f} {yard / t:6.0%}" for t in times)
            last = f"{1e9 * yard_fresh / n:6.2f} {1e9 * whole / n:9.2f} {yard_fresh / whole:6.0%}"
            print(f"{name:20} {np.dtype(dtype).name:8} {moved:5.0f} {1e9 * yard / n:6.2f} {row} {last}")


if __name__ == "__main__":
    main()
