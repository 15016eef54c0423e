"""Points of sequences and sets beside SciPy's: nanoseconds a coordinate, and how many times as fast.

Both write double precision; SciPy uses one thread, and so do we, besides the last column. Times are of the processor,
the least of a few rounds. `python tests/benchmarks/sampling.py`
"""

from time import perf_counter, process_time
from typing import get_args

import numpy as np
import shadelab as sl
from scipy.stats import qmc


def best(f, clock=process_time, repeat=3):
    times = []
    for _ in range(repeat):
        start = clock()
        f()
        times.append(clock() - start)
    return min(times)


def main():
    rng = np.random.default_rng(0)
    few, some = rng.uniform(size=(300, 2)), rng.uniform(size=(2000, 5))
    rows = []
    for n, d in ((1 << 18, 2), (1 << 16, 16), (1 << 10, 1024)):
        count = n * d
        sets = {
            "sobol, plain": (
                lambda n=n, d=d: sl.sampling.sobol(n, d, scramble=None),
                lambda n=n, d=d: qmc.Sobol(d, scramble=False, bits=32).random(n),
            ),
            "sobol, scrambled": (
                lambda n=n, d=d: sl.sampling.sobol(n, d),
                lambda n=n, d=d: qmc.Sobol(d, bits=32, rng=1).random(n),
            ),
            "halton, plain": (
                lambda n=n, d=d: sl.sampling.halton(n, d, scramble=None),
                lambda n=n, d=d: qmc.Halton(d, scramble=False).random(n),
            ),
            "halton, digits": (
                lambda n=n, d=d: sl.sampling.halton(n, d, scramble="digits"),
                lambda n=n, d=d: qmc.Halton(d, rng=1).random(n),
            ),
            "halton, owen": (
                lambda n=n, d=d: sl.sampling.halton(n, d),
                lambda n=n, d=d: qmc.Halton(d, rng=1).random(n),
            ),
            "latin hypercube": (
                lambda n=n, d=d: sl.sampling.latin_hypercube(n, d),
                lambda n=n, d=d: qmc.LatinHypercube(d, rng=1).random(n),
            ),
        }
        rows += [(f"{name} {n} x {d}", count, *both) for name, both in sets.items()]
    rows += [
        ("discrepancy 2000 x 5", 2000**2 * 5, lambda: sl.sampling.discrepancy(some), lambda: qmc.discrepancy(some)),
        (
            "poisson disk 0.02",
            1800 * 2,
            lambda: sl.sampling.poisson_disk(0.02, domain="square"),
            lambda: qmc.PoissonDisk(2, radius=0.02, rng=1).fill_space(),
        ),
        ("star discrepancy 300 x 2", 300, lambda: sl.sampling.star_discrepancy(few), None),
    ]
    print(f"{'':36} {'ours':>9} {'scipy':>9}  ns  {'ratio':>7} {'threads':>8}")
    for name, count, ours, theirs in rows:
        sl.set_threads(1)
        a = best(ours) / count * 1e9
        sl.set_threads(None)
        wall = best(ours, perf_counter) / count * 1e9
        b = best(theirs, repeat=2) / count * 1e9 if theirs else float("nan")
        print(f"{name:36} {a:9.2f} {b:9.2f}      {b / a:7.1f} {wall:8.2f}")
    pixel, sample = np.arange(1 << 16)[:, None], np.arange(8)
    for kind in get_args(sl.sampling.SamplerKind):
        s = sl.sampling.Sampler(kind, samples=64)
        sl.set_threads(1)
        t = best(lambda s=s: s.uniform(pixel, sample, 4, np.float32))
        sl.set_threads(None)
        print(f"sampler {kind:28} {t / (1 << 19) * 1e9:9.2f}")
    start = process_time()
    sl.sampling.blue_noise_mask(128)
    print(f"blue noise mask 128 x 128: {process_time() - start:.2f} s")


if __name__ == "__main__":
    main()
