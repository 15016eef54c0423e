"""Shadow lookups at 1280 x 720 with a map of 2048², beside the same filters in GLSL on Mesa llvmpipe (moderngl, EGL).

`LP_NUM_THREADS=2 python tests/benchmarks/shadow.py [threads]`: medians of wall and of processor time

Both look up the same receivers in the same map with the same points, turned by a hash of the pixel; ours also follows
the receiver's plane. Receivers and map are resident in both; the lit fractions arrive in an array. Rounds alternate.
"""

import os
import statistics
import sys
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


def main(rounds=9):
    sl.set_threads(int(sys.argv[1]) if len(sys.argv) > 1 else 2)
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
    times = {(who, name): [] for who, group in (("ours", ours), ("llvmpipe", theirs)) for name in group}
    for _ in range(rounds + 2):
        for (who, name), list_ in times.items():
            start, worked = perf_counter(), process_time()
            (ours if who == "ours" else theirs)[name]()
            list_.append((perf_counter() - start, process_time() - worked))
    reads = {"hard": 1, "pcf 16": 16, "pcf 64": 64, "pcss 16+32": 48}
    print(
        f"{'':12} {'ours ms':>9} {'cpu':>7} {'ns/read':>8} {'llvmpipe':>9} {'cpu':>7} {'ratio':>6} {'cpu':>5}  mean lit"
    )
    for name in ours:
        wall, cpu = (statistics.median(t) * 1e3 for t in zip(*times["ours", name][2:], strict=True))
        line = f"{name:12} {wall:9.1f} {cpu:7.1f} {cpu * 1e6 / points[..., 0].size / reads[name]:8.2f}"
        if name in theirs:
            other, busy = (statistics.median(t) * 1e3 for t in zip(*times["llvmpipe", name][2:], strict=True))
            line += f" {other:9.1f} {busy:7.1f} {other / wall:6.2f} {busy / cpu:5.2f}"
            line += f"   {ours[name]().mean():.4f} {theirs[name]().mean():.4f}"
        print(line)


if __name__ == "__main__":
    main()
