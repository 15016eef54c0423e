"""Path tracing and direct light against Mitsuba 3: million samples a second, ratios within one run.

Both use as many threads as the machine has cores.

python tests/benchmarks/path_trace.py [--size 320x180] [--samples 64]
"""

import argparse
import importlib.util
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import shadelab as sl

spec = importlib.util.spec_from_file_location(
    "path_trace_scenes", Path(__file__).parents[1] / "pathtrace" / "test_path_trace.py"
)
scenes = importlib.util.module_from_spec(spec)
sys.modules["path_trace_scenes"] = scenes
spec.loader.exec_module(scenes)


def best(f, repeat=2):
    """The shortest time of `repeat` runs, after one to warm up."""
    f()
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        f()
        times.append(time.perf_counter() - start)
    return min(times)


def mitsuba_time(variant, name, samples):
    """Seconds for one of the scenes."""
    import mitsuba as mi

    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)
    with tempfile.TemporaryDirectory() as folder:
        theirs = scenes.mitsuba_scene(mi, getattr(scenes, name)(), Path(folder), 4)
        return best(lambda: np.array(mi.render(theirs, spp=samples)))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", default="320x180")
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--mitsuba", nargs=2, help=argparse.SUPPRESS)
    given = parser.parse_args()
    size = tuple(int(x) for x in given.size.split("x"))
    scenes.SIZE = size
    n = size[0] * size[1] * given.samples / 1e6
    if given.mitsuba:
        print(n / mitsuba_time(*given.mitsuba, given.samples))
        return
    print(f"{'scene':12} {'shadelab':>9} " + " ".join(f"{v:>12} {'ratio':>6}" for v in ("scalar_rgb", "llvm_ad_rgb")))
    for build in (scenes.cornell, scenes.spheres, scenes.punctual):
        world = build()
        ours = n / best(lambda world=world: sl.pathtrace.path_trace(world, size, given.samples, max_depth=4))
        row = f"{build.__name__:12} {ours:9.2f} "
        for variant in ("scalar_rgb", "llvm_ad_rgb"):
            # In a process of its own: some LLVM releases abort on Dr.Jit's code.
            command = [sys.executable, __file__, "--size", given.size, "--samples", str(given.samples)]
            run = subprocess.run([*command, "--mitsuba", variant, build.__name__], capture_output=True, text=True)
            rate = float(run.stdout) if run.returncode == 0 else float("nan")
            row += f"{rate:12.2f} {ours / rate:6.2f} "
        print(row)
    world = sl.scene.default()
    arrays = world.flatten()
    bvh = sl.accel.BVH(arrays.positions, arrays.faces)
    hit = sl.pathtrace.ray_cast(bvh, world.camera, size)
    seen = hit.face >= 0
    corners = arrays.positions[arrays.faces[hit.face[seen]]]
    weights = np.stack([1 - hit.u - hit.v, hit.u, hit.v], -1)[seen][..., None]
    points = (corners * weights).sum(-2)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    for specular in (0.0, 1.0):
        rate = (
            len(points)
            * given.samples
            / 1e6
            / best(
                lambda specular=specular: sl.pathtrace.direct_light(
                    bvh,
                    world.lights,
                    points,
                    normals,
                    [0.5] * 3,
                    specular=specular,
                    eye=world.camera.eye,
                    samples=given.samples,
                )
            )
        )
        print(f"direct light, specular {specular:.0f}: {rate:.1f} million samples/s")


if __name__ == "__main__":
    main()
