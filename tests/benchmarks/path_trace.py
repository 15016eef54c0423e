"""Path tracing against Mitsuba 3: time to equal error, time a sample over sizes and samples, time to a first picture.

Errors are against one converged picture of Mitsuba's in two independent halves A and B, mean((x − A)(x − B)), so that
its own noise drops out; efficiency is one over error² · time. Mitsuba runs in processes of its own, its kernels
compiled before they are timed. Our own independent numbers show what is due to speed and what to scrambled points.

python tests/benchmarks/path_trace.py [--size 256] [--samples 64] [--converged 1024]
"""

import argparse
import importlib.util
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import shadelab as sl
from shadelab import mesh, scene
from shadelab.environment import Environment
from shadelab.light import RectLight

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


def constancy():
    world = cornell()
    for size, samples in ((128, 64), (256, 16), (512, 4), (1024, 1), (2048, 1), (128, 1), (128, 4), (64, 4096 // 16)):
        _, seconds = timed(lambda n=size, k=samples: sl.pathtrace.path_trace(world, (n, n), k, DEPTH))
        print(f"{size:5}² {samples:5} samples: cpu {seconds[1] / size**2 / samples * 1e9:6.0f} ns a sample")


def first_picture():
    for name in ("shadelab", "llvm_ad_rgb"):
        start = time.perf_counter()
        subprocess.run([sys.executable, __file__, "--first", name], check=False)
        print(f"first picture, {name}: {time.perf_counter() - start:.2f} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--converged", type=int, default=1024)
    parser.add_argument("--mitsuba", nargs=6, help=argparse.SUPPRESS)
    parser.add_argument("--first", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.mitsuba:
        variant, name, *numbers, out = given.mitsuba
        mitsuba(variant, name, *map(int, numbers), out)
    elif given.first == "shadelab":
        sl.pathtrace.path_trace(cornell(), (256, 256), 1, DEPTH)
    elif given.first:
        with tempfile.TemporaryDirectory() as folder:
            mitsuba(given.first, "cornell", 256, 1, 0, str(Path(folder) / "first.npz"))
    else:
        equal_error(given)
        constancy()
        first_picture()


if __name__ == "__main__":
    main()
