"""Nanoseconds an element of the elementary functions beside NumPy's, on one thread.

`python tests/benchmarks/elementary.py`
"""

from time import perf_counter

import numpy as np
from shadelab._kernels import math, runtime


def best(f, repeat=7):
    times = []
    for _ in range(repeat):
        start = perf_counter()
        f()
        times.append(perf_counter() - start)
    return min(times)


def main(n=1 << 20):
    runtime.set_threads(1)
    rng = np.random.default_rng(0)
    angle, unit, positive = rng.uniform(-9, 9, n), rng.uniform(-1, 1, n), rng.uniform(0.01, 10, n)
    cases = {
        "sin": (np.sin, [angle]),
        "cos": (np.cos, [angle]),
        "tan": (np.tan, [angle]),
        "asin": (np.arcsin, [unit]),
        "acos": (np.arccos, [unit]),
        "exp": (np.exp, [angle]),
        "ln": (np.log, [positive]),
        "atan2": (np.arctan2, [angle, unit]),
        "pow": (np.power, [positive, angle]),
    }
    print(f"{'':6} {'dtype':8} " + " ".join(f"{level:>9}" for level in runtime.simd_levels()) + f" {'numpy':>9}  ns")
    for name, (numpy_function, arguments) in cases.items():
        for dtype in (np.float32, np.float64):
            given = [a.astype(dtype) for a in arguments]
            out = np.empty(n, dtype)
            ours = []
            for level in runtime.simd_levels():
                runtime.force_simd(level)
                apply = math.apply if len(given) == 1 else math.apply2
                ours.append(best(lambda apply=apply: apply(name, *given, out)))  # noqa: B023
            theirs = best(lambda: numpy_function(*given, out=out))  # noqa: B023
            print(f"{name:6} {np.dtype(dtype).name:8} " + " ".join(f"{t / n * 1e9:9.2f}" for t in [*ours, theirs]))
    runtime.force_simd(None)


if __name__ == "__main__":
    main()
