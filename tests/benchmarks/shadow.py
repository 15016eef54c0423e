"""Shadow lookups at 1280 x 720 with a map of 2048², beside the same filters in GLSL on Mesa llvmpipe (moderngl, EGL).

`LP_NUM_THREADS=2 python tests/benchmarks/shadow.py [threads]`: medians of wall and of processor time

Both look up the same receivers in the same map with the same points, turned by a hash of the pixel; ours also follows
the receiver's plane. Receivers and map are resident in both; the lit fractions arrive in an array. Rounds alternate.

`--only lookups`, `tables` or `moments` for a part: the second is `summed_area_table` of 2048² beside `cv2.integral`,
both in double; the third, moments of a map of 2048² beside `pcss`, prefilter and lookup, on the scene of large
penumbrae: error in penumbrae (by 256 rays) and time.
"""

import argparse
import os
import statistics
from time import perf_counter, process_time

import numpy as np
import shadelab as sl

SIZE, MAP = (1280, 720), 2048

VERTEX = "#version 330\nin vec2 at; void main() { gl_Position = vec4(at, 0, 1); }"
FRAGMENT = """#version 330
uniform sampler2D chart, receivers;
uniform vec2 disk[64];
uniform int blockers, taps;
uniform float radius, light, least;
out float lit;

// Position of the light above the origin, looking down; the window is [-1, 1]² at unit depth.
float tap(vec2 at, float depth) { return texture(chart, at * 0.5 + 0.5).r < depth - 1e-3 ? 1.0 : 0.0; }

void main() {
    vec3 p = texelFetch(receivers, ivec2(gl_FragCoord.xy), 0).xyz;
    float depth = 4.0 - p.y;
    vec2 at = vec2(p.x, p.z) / depth;
    uvec2 g = uvec2(gl_FragCoord.xy);
    uint h = (g.x * 1664525u ^ g.y * 1013904223u) * 747796405u;
    float angle = float(h >> 8) * (6.2831853 / 16777216.0);
    mat2 turn = mat2(cos(angle), sin(angle), -sin(angle), cos(angle));
    float width = radius / depth;
    if (blockers > 0) {
        float search = 0.5 * light * (1.0 / least - 1.0 / depth), sum = 0.0, count = 0.0;
        for (int i = 0; i < blockers; i++) {
            float z = texture(chart, (at + turn * disk[i] * search) * 0.5 + 0.5).r;
            if (z < depth - 1e-3) { sum += z; count += 1.0; }
        }
        if (count == 0.0) { lit = 1.0; return; }
        float blocker = sum / count;
        width = 0.5 * light * (1.0 / blocker - 1.0 / depth);
    }
    float dark = 0.0;
    for (int i = 0; i < taps; i++) dark += tap(at + turn * disk[i] * width, depth);
    lit = 1.0 - dark / float(taps);
}
"""


def vogel(n):
    i = np.arange(n)
    r, a = np.sqrt((i + 0.5) / n), i * np.pi * (3 - np.sqrt(5))
    return np.stack([r * np.cos(a), r * np.sin(a)], -1).astype("f4")


def inputs():
    """A picket fence half way between a light 4 above the ground and receivers that fill the picture."""
    x = (np.arange(MAP) + 0.5) / MAP * 2 - 1
    fence = np.sin(x * 40)[None] * np.cos(x * 25)[:, None] > 0.2
    depth = np.where(fence, np.float32(2.0), np.float32(4.0))
    u, v = np.meshgrid(np.linspace(-3.6, 3.6, SIZE[0]), np.linspace(-3.6, 3.6, SIZE[1]))
    points = np.stack([u, 0 * u, v], -1).astype(np.float32)
    down = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
    return sl.shadow.ShadowMap(depth, "perspective", [0, 4, 0], down, [-1, 1, -1, 1], 2.0, 4.0), points


def llvmpipe(m, points):
    """A function (blockers, taps, radius, light) -> lit fractions, on the software rasteriser."""
    import moderngl

    gl = moderngl.create_context(standalone=True, backend="egl")
    print(gl.info["GL_RENDERER"], f"LP_NUM_THREADS={os.environ.get('LP_NUM_THREADS', 'unset')}")
    program = gl.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
    # Rows of the map run with z, as the shader's second coordinate does.
    chart = gl.texture((MAP, MAP), 1, m.depth.tobytes(), dtype="f4")
    chart.filter = (moderngl.NEAREST, moderngl.NEAREST)
    receivers = gl.texture(SIZE, 3, points.tobytes(), dtype="f4")
    target = gl.framebuffer([gl.texture(SIZE, 1, dtype="f4")])
    quad = gl.vertex_array(program, [(gl.buffer(np.array([-1, -1, 3, -1, -1, 3], "f4").tobytes()), "2f", "at")])
    out = np.empty((SIZE[1], SIZE[0]), np.float32)

    def run(blockers, taps, radius=0.0, light=0.0):
        target.use()
        chart.use(0)
        receivers.use(1)
        program["chart"], program["receivers"] = 0, 1
        n = max(blockers, taps)
        program["disk"] = np.pad(vogel(n), ((0, 64 - n), (0, 0))).tolist()
        program["taps"], program["blockers"] = taps, blockers
        for name, value in (("radius", radius), ("light", light), ("least", m.near)):
            program[name] = value
        quad.render()
        target.read_into(out, components=1, dtype="f4")
        return out

    return run


def timed(functions, rounds, skipped=2):
    """Medians of wall and of processor milliseconds; rounds alternate between all."""
    times = {name: [] for name in functions}
    for _ in range(rounds + skipped):
        for name, run in functions.items():
            start, worked = perf_counter(), process_time()
            run()
            times[name].append((perf_counter() - start, process_time() - worked))
    return {k: [statistics.median(t) * 1e3 for t in zip(*v[skipped:], strict=True)] for k, v in times.items()}


def lookups(rounds=9):
    m, points = inputs()
    out = np.empty(points.shape[:2], np.float32)
    up = np.broadcast_to(np.float32([0, 1, 0]), points.shape).copy()
    ours = {
        "hard": lambda: sl.shadow.hard(m, points, up, out=out),
        "pcf 16": lambda: sl.shadow.pcf(m, points, up, samples=16, radius=0.1, units="world", out=out),
        "pcf 64": lambda: sl.shadow.pcf(m, points, up, samples=64, radius=0.1, units="world", out=out),
        "pcss 16+32": lambda: sl.shadow.pcss(m, points, up, light_size=0.4, kernel="vogel", out=out),
    }
    theirs = {}
    try:
        gl = llvmpipe(m, points)
        theirs = {
            "pcf 16": lambda: gl(0, 16, radius=0.1),
            "pcf 64": lambda: gl(0, 64, radius=0.1),
            "pcss 16+32": lambda: gl(16, 32, light=0.4),
        }
    except Exception as error:
        print(f"no llvmpipe: {error}")
    every = {("ours", name): run for name, run in ours.items()} | {("llvmpipe", k): run for k, run in theirs.items()}
    times = timed(every, rounds)
    reads = {"hard": 1, "pcf 16": 16, "pcf 64": 64, "pcss 16+32": 48}
    print(
        f"{'':12} {'ours ms':>9} {'cpu':>7} {'ns/read':>8} {'llvmpipe':>9} {'cpu':>7} {'ratio':>6} {'cpu':>5}  mean lit"
    )
    for name in ours:
        wall, cpu = times["ours", name]
        line = f"{name:12} {wall:9.1f} {cpu:7.1f} {cpu * 1e6 / points[..., 0].size / reads[name]:8.2f}"
        if name in theirs:
            other, busy = times["llvmpipe", name]
            line += f" {other:9.1f} {busy:7.1f} {other / wall:6.2f} {busy / cpu:5.2f}"
            line += f"   {ours[name]().mean():.4f} {theirs[name]().mean():.4f}"
        print(line)


def tables(rounds=15):
    """Sums of a picture of one channel."""
    picture = np.random.default_rng(0).random((MAP, MAP))
    out = np.empty((MAP + 1, MAP + 1))
    table = sl.image.summed_area_table
    runs = {"ours": lambda: table(picture), "ours, out=": lambda: table(picture, out=out)}
    try:
        import cv2

        cv2.setNumThreads(sl.threads())
        runs["cv2"] = lambda: cv2.integral(picture, sdepth=cv2.CV_64F)
        runs["cv2, out="] = lambda: cv2.integral(picture, out, sdepth=cv2.CV_64F)
        assert np.allclose(table(picture), cv2.integral(picture, sdepth=cv2.CV_64F), rtol=1e-12)
    except ImportError as error:
        print(f"no cv2: {error}")
    times = timed(runs, rounds)
    for name, (wall, cpu) in times.items():
        peer = times.get(name.replace("ours", "cv2"))
        ratio = f"   {peer[0] / wall:.2f} {peer[1] / cpu:.2f} of the speed of cv2" if peer and "ours" in name else ""
        print(f"table of {MAP}², double, {name:10} {wall:7.2f} ms wall {cpu:7.2f} cpu{ratio}")


def moments(rounds=3):
    """A scene without umbra: prefilter and lookup of moments beside what searches and filters in the lookup."""
    from shadelab.study.questions._shadow_scenes import SCENES

    scene = SCENES["large penumbra"]()
    arrays, lamp = scene.flatten(np.float32), scene.lights[0]
    seen = sl.render(sl.scene.Scene(scene.instances, lights=(), camera=scene.camera), size=SIZE)
    there = seen.face >= 0
    points = seen.position[there]
    normals = sl.mesh.face_normals(arrays.positions, arrays.faces)[seen.face[there]]
    away = points - np.asarray(scene.camera.eye, np.float32)
    normals = np.where((normals * away).sum(-1, keepdims=True) > 0, -normals, normals)
    m = sl.shadow.shadow_map(arrays.positions, arrays.faces, lamp, MAP, receivers=points)
    some = np.random.default_rng(0).choice(len(points), 20000, replace=False)
    bvh = sl.accel.BVH(arrays.positions, arrays.faces)
    exact = sl.shadow.ray_traced(bvh, points[some], normals[some], lamp, 256)
    facing = ((np.asarray(lamp.center) - points[some]) * normals[some]).sum(-1) > 0.05
    inside = facing & (exact > 0.004) & (exact < 0.996)
    out = np.empty(len(points), np.float32)

    def of_moments(filter, reduce):
        def run():
            table = sl.shadow.moment_map(m, filter=filter, reduce=reduce)
            return sl.shadow.variance_soft(table, points, normals, out=out)

        return run

    runs = {"pcss 16+32": lambda: sl.shadow.pcss(m, points, normals, out=out)}
    for filter, reduce in (("mip", 4), ("mip", 8), ("summed_area", 4), ("summed_area", 8)):
        runs[f"moments, {filter}, reduce={reduce}"] = of_moments(filter, reduce)
    times = timed(runs, rounds, 1)
    for name, (wall, cpu) in times.items():
        error = np.sqrt(np.mean((runs[name]()[some][inside] - exact[inside]) ** 2))
        share = wall / times["pcss 16+32"][0], cpu / times["pcss 16+32"][1]
        print(f"{name:32} {wall:7.1f} ms wall {cpu:7.1f} cpu, {share[0]:.2f} {share[1]:.2f} of pcss; error {error:.4f}")


def main():
    parts = {"lookups": lookups, "tables": tables, "moments": moments}
    parser = argparse.ArgumentParser()
    parser.add_argument("threads", nargs="?", type=int, default=2)
    parser.add_argument("--only", choices=list(parts))
    given = parser.parse_args()
    sl.set_threads(given.threads)
    for name, run in parts.items():
        if given.only in (None, name):
            run()


if __name__ == "__main__":
    main()
