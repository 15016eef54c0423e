"""The mirrors' light of a rectangle on a glossy floor: linearly transformed cosines beside samples of light and lobe.

`python tests/benchmarks/light.py [threads]`

Root mean square errors are over the picture, relative to its brightest pixel, against 2^13 samples. Times are processor
seconds over threads, since neighbours on the machine then count for less; every run takes some tenths of a second, best
of five, rounds alternate.
"""

import sys
import time

import numpy as np
import shadelab as sl

SIZE = (64, 36)


def scene():
    x, z = np.meshgrid(np.linspace(-3, 3, SIZE[0]), np.linspace(-2, 2, SIZE[1]))
    points = np.stack([x, 0 * x, z], -1).astype(np.float32).reshape(-1, 3)
    return sl.light.RectLight((0, 1.2, -0.5), (2, 0, 0), (0, 0.6, 0.8), (5, 5, 5)), points


def seconds(run):
    before = time.process_time()
    run()
    return time.process_time() - before


def main():
    sl.set_threads(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
    light, points = scene()
    up, eye = np.array([0, 1, 0], np.float32), np.array([0, 1.5, 4], np.float32)
    for roughness in (0.25, 0.5, 0.8):

        def shade(repeat=1, roughness=roughness, **how):
            p = np.tile(points, (repeat, 1))
            return sl.light.unshadowed(light, p, up, [0.9] * 3, 1.0, roughness, eye=eye, **how)

        exact = shade(samples=1 << 13).astype(np.float64)
        peak = exact.max()
        print(f"roughness {roughness}: brightest {peak:.3g}")
        rows = [("ltc", dict(method="ltc")), ("representative point", dict(method="representative_point"))]
        rows += [(f"{n} samples", dict(samples=n, seed=1)) for n in (1, 4, 16, 64, 256)]
        times = {name: [] for name, _ in rows}
        repeat = {name: max(128 // how.get("samples", 2), 1) for name, how in rows}
        for _ in range(5):
            for name, how in rows:
                times[name].append(seconds(lambda how=how, n=repeat[name]: shade(n, **how)) / repeat[name])
        errors = {name: np.sqrt(((shade(**how) - exact) ** 2).mean()) / peak for name, how in rows}
        costs = {name: min(times[name]) / len(points) * 1e9 for name, _ in rows}
        for name, _ in rows:
            print(f"  {name:22} {costs[name]:9.0f} ns a point   error {errors[name]:.5f}")
        sampled = [name for name, how in rows if "samples" in how]
        # Between two numbers of samples both error and cost are straight lines of their logarithms.
        falling = np.log([errors[name] for name in sampled])[::-1]
        cost = np.log([costs[name] for name in sampled])[::-1]
        equal = np.exp(np.interp(np.log(errors["ltc"]), falling, cost))
        where = (
            ""
            if falling[0] <= np.log(errors["ltc"]) <= falling[-1]
            else " (at least: its error is beyond those sampled)"
        )
        print(f"  samples of equal error cost {equal / costs['ltc']:.1f} times what ltc does{where}")


if __name__ == "__main__":
    main()
