"""Path tracing against Mitsuba 3: time to equal error, time a sample over sizes and samples, time to a first picture.

Errors are against one converged picture of Mitsuba's in two independent halves A and B, mean((x − A)(x − B)), so that
its own noise drops out; efficiency is one over error² · time. Mitsuba runs in processes of its own, its kernels
compiled before they are timed. Our own independent numbers tell the causes apart: time a sample (speed), error of ours
to theirs with independent numbers (how lights are looked for), and of scrambled points to independent ones (points).
Each has the roulette that is its default, from the second surface on here and from the fifth there, and equal depths.

python tests/benchmarks/path_trace.py [--size 256] [--samples 64] [--converged 1024] [--only equal constant …]

`llvm_ad_rgb` needs an LLVM that Dr.Jit can use: name one by DRJIT_LIBLLVM_PATH if the system's aborts.
"""

import importlib.util
import os
import sys
import time
from pathlib import Path

import numpy as np
import shadelab as sl
from shadelab import mesh, scene
from shadelab.light import RectLight

# What scenes do not need is imported where it is: the first picture is timed with this file in it.

spec = importlib.util.spec_from_file_location(
    "path_trace_scenes", Path(__file__).parents[1] / "pathtrace" / "scenes.py"
)
scenes = importlib.util.module_from_spec(spec)
spec.loader.exec_module(scenes)

DEPTH = 7


def cornell():
    """Mitsuba's own Cornell box, but that the lamp reflects nothing and has a black back."""
    white, green, red = (
        scenes.lambert(*c)
        for c in (
            (0.885809, 0.698859, 0.666422),
            (0.105421, 0.37798, 0.076425),
            (0.570068, 0.0430135, 0.0443706),
        )
    )
    turn = sl.transform.rotate_axis

    def wall(at, axis, angle, material, size=(2, 2)):
        matrix = sl.transform.translate(at) @ turn(axis, np.radians(angle))
        return scene.Instance(mesh.plane(size), matrix, (material,))

    def block(at, angle, size):
        matrix = sl.transform.translate(at) @ turn((0, 1, 0), np.radians(angle))
        return scene.Instance(mesh.box(size), matrix, (white,))

    things = [
        wall((0, -1, 0), (0, 1, 0), 0, white),
        wall((0, 1, 0), (1, 0, 0), 180, white),
        wall((0, 0, -1), (1, 0, 0), 90, white),
        wall((1, 0, 0), (0, 0, 1), 90, green),
        wall((-1, 0, 0), (0, 0, 1), -90, red),
        block((0.335, -0.7, 0.38), -17, (0.6, 0.6, 0.6)),
        block((-0.33, -0.4, -0.28), 18.25, (0.6, 1.22, 0.6)),
        wall((0, 0.9905, 0.01), (0, 1, 0), 0, scenes.lambert(0, 0, 0), (0.46, 0.38)),
    ]
    lamp = RectLight((0, 0.99, 0.01), (0.46, 0, 0), (0, 0, 0.38), (18.387, 13.9873, 6.75357))
    return scene.Scene(things, (lamp,), scene.Camera((0, 0, 4), (0, 0, 0), fov_y=np.radians(39.3077)))


def bunny():
    """A bunny on the ground under a panorama."""
    from shadelab.environment import Environment

    data = Path(os.environ["SHADELAB_DATA"])
    body = scene.load_mesh(data / "bunny.obj")
    low, high = np.asarray(body.bounds, float)
    size = float((high - low).max())
    place = sl.transform.scale([1 / size] * 3) @ sl.transform.translate(-np.array([*(low + high) / 2]))
    body = body.transformed(place)
    floor = float(np.asarray(body.bounds)[0, 1])
    things = [
        scene.Instance(body, None, (scenes.lambert(0.6, 0.55, 0.5),)),
        scenes.thing(mesh.plane((6, 6)), scenes.lambert(0.5, 0.5, 0.5), (0, floor, 0)),
    ]
    camera = scene.Camera((0.6, 0.6, 1.8), (0, 0, 0), fov_y=0.7)
    return scene.Scene(things, (), camera, environment=Environment.load(data / "museum.exr"))


BUILDS = {"cornell": cornell, "bunny": bunny}


def clock():
    """Wall and processor seconds, all threads."""
    return np.array([time.perf_counter(), time.process_time()])


def timed(f):
    f()
    start = clock()
    result = f()
    return result, clock() - start


def error(picture, halves):
    a, b = (picture.astype(np.float64) - half for half in halves)
    return float((a * b).mean())


def mitsuba(variant, name, size, samples, converged, out):
    """Times a picture; with `converged` samples, two halves of the reference as well."""
    import tempfile

    import mitsuba as mi

    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)
    scenes.SIZE = (size, size)
    with tempfile.TemporaryDirectory() as folder:
        theirs = scenes.mitsuba_scene(mi, BUILDS[name](), Path(folder), DEPTH, roulette=5)
        picture, seconds = timed(lambda: np.array(mi.render(theirs, spp=samples, seed=1)))
        halves = np.zeros((2, *picture.shape))
        for i in range(2 * (converged // 64)):
            halves[i % 2] += np.array(mi.render(theirs, spp=64, seed=100 + i)) / (converged // 64)
    np.savez(out, picture=picture, seconds=seconds, halves=halves)


def of_mitsuba(variant, name, given, converged=0):
    import subprocess
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "result.npz")
        numbers = [str(n) for n in (given.size, given.samples, converged)]
        # In a process of its own: some LLVM releases abort on Dr.Jit's code.
        run = subprocess.run([sys.executable, __file__, "--mitsuba", variant, name, *numbers, out], check=False)
        return dict(np.load(out)) if run.returncode == 0 else None


def equal_error(given):
    for name, build in BUILDS.items():
        world, size = build(), (given.size, given.size)
        llvm = of_mitsuba("llvm_ad_rgb", name, given, given.converged)
        scalar = of_mitsuba("scalar_rgb", name, given, 0 if llvm else given.converged)
        halves = (llvm or scalar)["halves"]
        rows = {"llvm_ad_rgb": llvm, "scalar_rgb": scalar}
        rows = {k: (v["picture"], v["seconds"]) for k, v in rows.items() if v}
        for sampler in ("sobol", "independent"):
            options = {"samples": given.samples, "max_depth": DEPTH, "seed": 1, "sampler": sampler}
            traced, seconds = timed(lambda o=options: sl.pathtrace.path_trace(world, size, **o))  # noqa: B023
            rows[f"shadelab {sampler}"] = traced.radiance, seconds
        best = {k: error(p, halves) * t for k, (p, t) in rows.items()}
        count = given.size**2 * given.samples
        for k, (picture, seconds) in rows.items():
            ratio = best["shadelab sobol"] / best[k]
            wall, cpu = seconds / count * 1e9
            spread = error(picture, halves) * given.samples
            print(f"{name:8} {k:22} wall {wall:6.0f} ns, cpu {cpu:6.0f} ns a sample, error² · samples {spread:.5f},")
            print(f"{'':31} efficiency over ours: wall {ratio[0]:.3f}, cpu {ratio[1]:.3f}")
        plain, (_, ours) = error(rows["shadelab independent"][0], halves), rows["shadelab sobol"]
        points = plain / error(rows["shadelab sobol"][0], halves)
        for k in ("llvm_ad_rgb", "scalar_rgb"):
            if k in rows:
                theirs = rows[k]
                speed, lights = theirs[1][1] / ours[1], error(theirs[0], halves) / plain
                print(f"{name:8} against {k}: speed {speed:.2f} × lights {lights:.2f} × points {points:.2f}")


def constancy(given):
    """Processor time a sample with one thread, beside that of one and the same small picture right before and after.

    So what else the machine does drops out; the median of five rounds. Few samples of many pixels, and many of few.
    """
    world = cornell()
    sl.set_threads(1)

    def spent(size, count, seed):
        start = time.process_time()
        # Small pictures again and again, for a quarter of a million paths.
        times = max(1, 2**18 // (size**2 * count))
        for i in range(times):
            sl.pathtrace.path_trace(world, (size, size), count, DEPTH, seed + i)
        return (time.process_time() - start) / (times * size**2 * count) * 1e9

    sizes = [(size, 4) for size in (128, 256, 512, 1024, 2048)]
    samples = [(min(128, 2 ** (10 - k)), 4**k) for k in range(7)]
    for kind, cases in (("sizes", sizes), ("samples", samples)):
        rounds = {case: [] for case in cases}
        yards = []
        for seed in range(5):
            before = spent(128, 16, seed)
            for case in cases:
                ns, after = spent(*case, seed), spent(128, 16, seed)
                rounds[case].append(2 * ns / (before + after))
                yards.append(after)
                before = after
        yard = min(yards)
        ratios = {case: float(np.median(found)) for case, found in rounds.items()}
        for (size, count), ratio in ratios.items():
            print(f"{size:5}² {count:5} samples: cpu {ratio * yard:6.0f} ns a sample", flush=True)
        print(f"over {kind}: largest over least {max(ratios.values()) / min(ratios.values()):.3f}")
    sl.set_threads(None)


def memory():
    """The peak of a process of its own, by samples."""
    import subprocess

    for samples in (1, 64, 4096):
        code = (
            "import runpy, resource, shadelab as sl;"
            f"world = runpy.run_path({__file__!r}, run_name='given')['cornell']();"
            f"sl.pathtrace.path_trace(world, (64, 64), {samples}, {DEPTH});"
            "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)"
        )
        out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
        print(f"64² {samples:5} samples: peak {float(out):.1f} MB")


FIRST = {
    "shadelab": f"import runpy, shadelab as sl; world = runpy.run_path({__file__!r}, run_name='given')['cornell']();"
    f"sl.pathtrace.path_trace(world, (256, 256), 1, {DEPTH})",
    **{
        name: f"import mitsuba as mi; mi.set_variant({name!r}); box = mi.cornell_box();"
        f"box['sensor']['film'].update(width=256, height=256); box['integrator']['max_depth'] = {DEPTH + 1};"
        "mi.render(mi.load_dict(box), spp=1).numpy()"
        for name in ("llvm_ad_rgb", "scalar_rgb")
    },
}


def first_picture(given):
    """From the start of Python to one sample a pixel, in processes of their own that find no compiled kernels."""
    import resource
    import subprocess
    import tempfile

    least = {}

    def spent():
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return np.array([time.perf_counter(), used.ru_utime + used.ru_stime])

    for _ in range(5):
        for name, code in {"Python with NumPy": "import numpy", **FIRST}.items():
            with tempfile.TemporaryDirectory() as home:
                start = spent()
                done = subprocess.run(
                    [sys.executable, "-c", code], check=False, capture_output=True, env={**os.environ, "HOME": home}
                )
            if done.returncode == 0:
                least[name] = np.minimum(spent() - start, least.get(name, np.inf))
    for name, seconds in least.items():
        (wall, cpu), ratio = seconds, seconds / least["shadelab"]
        print(f"first picture, {name}: wall {wall:.2f} s, cpu {cpu:.2f} s; of ours {ratio[0]:.1f} and {ratio[1]:.1f}")


def main():
    import argparse

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--converged", type=int, default=1024)
    parser.add_argument("--only", nargs="+", choices=("equal", "constant", "memory", "first"))
    parser.add_argument("--mitsuba", nargs=6, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.mitsuba:
        variant, name, *numbers, out = given.mitsuba
        mitsuba(variant, name, *map(int, numbers), out)
    else:
        rows = {"equal": equal_error, "constant": constancy, "memory": lambda given: memory(), "first": first_picture}
        for name in given.only or rows:
            rows[name](given)


if __name__ == "__main__":
    main()
