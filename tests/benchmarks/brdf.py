"""Rough conductor over ten million pairs of directions, three colours out, single precision: against Mitsuba's
`llvm_ad_rgb` on the same arrays, and against the machine's memory. By hand: `python tests/benchmarks/brdf.py`.

Mitsuba is timed on its own arrays, one a component, which stay where they are, and from NumPy to NumPy.

Some LLVM releases abort on Dr.Jit's code: DRJIT_LIBLLVM_PATH names another.
"""

import argparse
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import shadelab as sl


def best(f, rounds):
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        f()
        times.append(time.perf_counter() - start)
    return min(times), float(np.median(times))


def directions(n, seed):
    rng = np.random.default_rng(seed)
    z, phi = rng.uniform(0.02, 1, n), rng.uniform(0, 2 * np.pi, n)
    s = np.sqrt(1 - z * z)
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], -1).astype(np.float32)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("-n", type=int, default=10_000_000)
    parser.add_argument("--rounds", type=int, default=7)
    arguments = parser.parse_args()
    n, rounds = arguments.n, arguments.rounds
    wi, wo, out = directions(n, 1), directions(n, 2), np.empty((n, 3), np.float32)
    eta, k = (0.2004, 0.924, 1.1022), (3.9129, 2.4528, 2.1421)

    model = sl.brdf.RoughConductor(0.3, eta, k, masking="separable")
    reused = best(lambda: model.eval(wi, wo, out=out), rounds)
    fresh = best(lambda: model.eval(wi, wo), rounds)
    # The same traffic and next to no arithmetic: Lambert's, 36 bytes an element.
    traffic = best(lambda: sl.brdf.Diffuse(0.5).eval(wi, wo, out=out), rounds)
    triad = best(lambda: np.add(wi, wo, out=out), rounds)
    with ThreadPoolExecutor(2) as pool:
        halves = [a[h] for h in (slice(n // 2), slice(n // 2, n)) for a in (wi, wo)]
        reading = best(lambda: list(pool.map(np.max, halves)), rounds)
    threads = sl.threads()
    sl.set_threads(1)
    alone = best(lambda: model.eval(wi, wo, out=out), rounds)
    sl.set_threads(threads)
    gigabytes = 36e-9 * n
    print(f"{n:,} pairs, float32, {sl.threads()} threads; best and median of {rounds}")
    for name, (low, middle) in (
        ("rough conductor, out=", reused),
        ("rough conductor", fresh),
        ("the same, one thread", alone),
        ("diffuse, out=", traffic),
        ("numpy max of the input", reading),
        ("numpy a + b, one thread", triad),
    ):
        print(f"{name:26} {low * 1e3:7.1f} ms {middle * 1e3:7.1f} ms  {gigabytes / low:5.1f} GB/s")
    print(f"fraction of the memory bandwidth of the same traffic: {traffic[0] / reused[0]:.2f}")
    print(f"two threads over one: {alone[0] / reused[0]:.2f}; threads of one core share its arithmetic")

    import drjit as dr
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    rgb = {key: {"type": "rgb", "value": list(v)} for key, v in (("eta", eta), ("k", k))}
    bsdf = mi.load_dict({"type": "roughconductor", "distribution": "ggx", "alpha": 0.3, **rgb})
    context, si = mi.BSDFContext(), dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(*(mi.Float(np.ascontiguousarray(wo[:, c])) for c in range(3)))
    light = mi.Vector3f(*(mi.Float(np.ascontiguousarray(wi[:, c])) for c in range(3)))
    dr.eval(si, light)
    dr.sync_thread()

    def theirs():
        value = bsdf.eval(context, si, light)
        dr.eval(value)
        dr.sync_thread()
        return value

    def through():
        """From arrays of directions to an array of colours: what their own layout costs a user of NumPy."""
        si.wi, light = mi.Vector3f(wo.T), mi.Vector3f(wi.T)
        return np.array(bsdf.eval(context, si, light)).T.copy()

    value = theirs()
    ours = model.eval(wi, wo, out=out) * wi[:, 2:]
    error = np.abs(np.array(value).reshape(3, -1).T / ours - 1)
    mitsuba = best(theirs, rounds)
    low, middle = mitsuba
    print(f"{'mitsuba llvm_ad_rgb':26} {low * 1e3:7.1f} ms {middle * 1e3:7.1f} ms  {gigabytes / low:5.1f} GB/s")
    print(f"mitsuba / ours: {low / reused[0]:.2f} (best), {middle / reused[1]:.2f} (median)")
    passed = best(through, rounds)
    print(f"{'mitsuba, NumPy to NumPy':26} {passed[0] * 1e3:7.1f} ms {passed[1] * 1e3:7.1f} ms")
    print(f"NumPy to NumPy, mitsuba / ours with a fresh array: {passed[0] / fresh[0]:.2f} (best)")
    print(
        f"three times as fast as mitsuba: {low / 3e-3:.1f} ms; the same traffic alone takes {traffic[0] * 1e3:.1f} ms"
    )
    print(f"relative difference: median {np.median(error):.1e}")


if __name__ == "__main__":
    main()
