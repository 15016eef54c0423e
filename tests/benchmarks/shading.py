"""Deferred shading of a G-buffer of 1280 x 720 with 16 point lights and GGX, beside the same shader on Mesa's llvmpipe.

    LP_NUM_THREADS=2 python tests/benchmarks/shading.py [--lights 16] [--repeat 15] [--threads 2]

Both read positions, normals and material ids that lie ready in memory (llvmpipe's in float textures and a buffer of
uniforms), evaluate the same model (GGX with height-correlated Smith masking, Schlick's Fresnel, a diffuse base under
it), and end with linear radiance in a NumPy array of float32 that is reused. Two threads each; runs alternate, and
medians are shown. The pictures are compared.
"""

import os

os.environ.setdefault("LIBGL_ALWAYS_SOFTWARE", "1")
os.environ.setdefault("GALLIUM_DRIVER", "llvmpipe")
os.environ.setdefault("LP_NUM_THREADS", "2")

import argparse
import time

import numpy as np
import shadelab as sl
from shadelab.light import PointLight
from shadelab.scene import Camera, Instance, Material, Scene

SIZE = (1280, 720)
MATERIALS = [
    Material((0.62, 0.6, 0.56), roughness=0.9),
    Material((0.72, 0.32, 0.2), roughness=0.7),
    Material((0.85, 0.8, 0.68), roughness=0.35),
    Material((0.95, 0.64, 0.54), 1.0, 0.25),
]

VERTEX = "#version 330\nin vec2 at; void main() { gl_Position = vec4(at, 0, 1); }"
FRAGMENT = """#version 330
#define LIGHTS %d
uniform sampler2D positions, normals;
uniform vec3 eye;
uniform vec3 light_position[LIGHTS], light_intensity[LIGHTS];
uniform vec4 base_metallic[4];
uniform float roughness[4];
out vec4 radiance;

float schlick(float c) { float x = 1.0 - c, y = x * x; return y * y * x; }

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 p = texelFetch(positions, at, 0);
    if (p.w < 0.0) { radiance = vec4(0.0); return; }
    vec3 n = texelFetch(normals, at, 0).xyz;
    int m = int(p.w);
    vec3 base = base_metallic[m].rgb;
    float metallic = base_metallic[m].a;
    float alpha = max(roughness[m] * roughness[m], 1e-4), a2 = alpha * alpha;
    vec3 diffuse = base * (1.0 - metallic) / 3.14159265358979;
    vec3 f0 = mix(vec3(0.04), base, metallic);
    vec3 wo = normalize(eye - p.xyz);
    float co = dot(n, wo), so = sqrt(co * co + a2 * (1.0 - co * co));
    diffuse *= 1.0 - mix(0.04, 1.0, schlick(co));
    vec3 sum = vec3(0.0);
    if (co > 0.0) {
        for (int i = 0; i < LIGHTS; ++i) {
            vec3 to = light_position[i] - p.xyz;
            float inverse2 = 1.0 / dot(to, to);
            vec3 wi = to * sqrt(inverse2);
            float ci = dot(n, wi);
            if (ci <= 0.0) continue;
            vec3 h = normalize(wi + wo);
            float nh = dot(n, h), w = nh * nh * (a2 - 1.0) + 1.0;
            float si = sqrt(ci * ci + a2 * (1.0 - ci * ci));
            float dv = a2 / (3.14159265358979 * w * w) * 0.5 / (ci * so + co * si);
            vec3 f = f0 + (1.0 - f0) * schlick(min(dot(wo, h), 1.0));
            float through = 1.0 - mix(0.04, 1.0, schlick(ci));
            sum += (diffuse * through + f * dv) * light_intensity[i] * (inverse2 * ci);
        }
    }
    radiance = vec4(sum, 1.0);
}
"""


def g_buffer(size):
    """Positions, normals, material ids, eye: floors, spheres, tori and boxes that fill the picture."""
    rng = np.random.default_rng(1)
    things = [Instance(sl.mesh.plane(24.0), None, MATERIALS[0])]
    for k in range(40):
        x, z = rng.uniform(-5, 5, 2)
        shape = (sl.mesh.icosphere(4, 0.5), sl.mesh.torus(0.5, 0.2, 64, 32), sl.mesh.box(0.8))[k % 3]
        things.append(Instance(shape, sl.transform.translate([x, 0.5, z]), MATERIALS[1 + k % 3]))
    scene = Scene(things, camera=Camera((0, 5, 9), (0, 0, 0.5), fov_y=0.7))
    arrays = scene.flatten(np.float32)
    camera = scene.camera
    matrix = camera.projection(size[0] / size[1], depth="reversed") @ camera.view()
    clip = (np.concatenate([arrays.positions, np.ones((len(arrays.positions), 1))], -1) @ matrix.T).astype(np.float32)
    drawn = sl.raster.g_buffer(
        clip, arrays.faces, arrays.positions, size, normals=arrays.normals,
        material_ids=arrays.material_ids, depth="reversed",
    )  # fmt: skip
    return drawn, arrays.materials, np.asarray(camera.eye, np.float32)


class Llvmpipe:
    """The same picture by Mesa's software rasteriser."""

    def __init__(self, drawn, materials, eye, lights, size):
        import moderngl

        self.gl = gl = moderngl.create_context(standalone=True, backend="egl")
        self.name = gl.info["GL_RENDERER"]
        self.program = program = gl.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT % len(lights))
        packed = np.concatenate([drawn.position, drawn.material[..., None].astype(np.float32)], -1)
        padded = np.concatenate([drawn.normal, np.zeros_like(drawn.normal[..., :1])], -1)
        self.textures = [gl.texture(size, 4, np.ascontiguousarray(x, np.float32).tobytes(), dtype="f4")
                         for x in (packed, padded)]  # fmt: skip
        for unit, (name, texture) in enumerate(zip(("positions", "normals"), self.textures, strict=True)):
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
            texture.use(unit)
            program[name].value = unit
        program["eye"].value = tuple(eye.tolist())
        program["light_position"].value = [x.position for x in lights]
        program["light_intensity"].value = [x.intensity for x in lights]
        program["base_metallic"].value = [(*m.base_color, m.metallic) for m in materials]
        program["roughness"].value = [m.roughness for m in materials]
        corners = np.array([[-1, -1], [3, -1], [-1, 3]], np.float32)
        self.quad = gl.vertex_array(program, [(gl.buffer(corners.tobytes()), "2f", "at")])
        self.target = gl.framebuffer([gl.texture(size, 4, dtype="f4")])
        self.target.use()
        self.picture = np.empty((size[1], size[0], 4), np.float32)

    def __call__(self):
        self.quad.render()
        self.target.read_into(self.picture, components=4, dtype="f4")
        return self.picture[..., :3]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--lights", type=int, default=16)
    parser.add_argument("--repeat", type=int, default=15)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    sl.set_threads(options.threads)
    drawn, materials, eye = g_buffer(SIZE)
    rng = np.random.default_rng(2)
    lights = [
        PointLight((*rng.uniform(-6, 6, 1), rng.uniform(1, 4), *rng.uniform(-6, 6, 1)), tuple(rng.uniform(1, 9, 3)))
        for _ in range(options.lights)
    ]
    out = np.empty((SIZE[1], SIZE[0], 3), np.float32)

    def ours():
        return sl.renderer.shade(
            drawn.position, drawn.normal, materials, lights, eye=eye, material_ids=drawn.material, out=out
        )

    gl = Llvmpipe(drawn, materials, eye, lights, SIZE)
    a, b = ours(), gl()
    bright = float(np.abs(b).max())
    print(f"{gl.name}; {options.lights} lights, {(drawn.face >= 0).mean():.0%} of {SIZE[0]} x {SIZE[1]} covered")
    rms = np.sqrt(np.mean((a - b) ** 2)) / b.mean()
    print(f"largest difference {np.abs(a - b).max() / bright:.2g} of the brightest, rms {rms:.2g} of the mean")
    calls = {"shadelab": ours, "llvmpipe": gl}
    times = {name: [] for name in calls}
    for _ in range(options.repeat):
        for name, call in calls.items():
            start = time.perf_counter()
            call()
            times[name].append(1e3 * (time.perf_counter() - start))
    for name, t in times.items():
        print(f"{name:10} {np.median(t):8.2f} ms   least {min(t):8.2f} ms")
    print(f"llvmpipe / shadelab: {np.median(times['llvmpipe']) / np.median(times['shadelab']):.2f} (medians), "
          f"{min(times['llvmpipe']) / min(times['shadelab']):.2f} (least)")  # fmt: skip


if __name__ == "__main__":
    main()
