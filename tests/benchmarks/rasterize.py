"""Rasterise + interpolate + Lambert, picture to picture, beside Mesa's llvmpipe through EGL.

    LP_NUM_THREADS=2 python tests/benchmarks/rasterize.py MODEL.obj [--repeat 15]

Both sides take vertices and faces that lie ready in memory (llvmpipe's in its buffers), transform, draw with a depth
test, shade with interpolated normals, and end with an 8-bit RGBA picture in a NumPy array that is reused. Two threads
each; runs alternate, and medians are shown. The last columns are this library alone: the picture in float32 and the
full G-buffer (face, u, v, depth, position, normal).
"""

import os

os.environ.setdefault("LIBGL_ALWAYS_SOFTWARE", "1")
os.environ.setdefault("GALLIUM_DRIVER", "llvmpipe")
os.environ.setdefault("LP_NUM_THREADS", "2")

import argparse
import time

import numpy as np
import shadelab as sl

SIZES = [(1280, 720), (3840, 2160)]
LIGHT = np.array([0.4, 0.7, 0.6])
LIGHT /= np.linalg.norm(LIGHT)

VERTEX = """
#version 330
uniform mat4 matrix;
in vec3 position;
in vec3 normal;
out vec3 n;
void main() { gl_Position = matrix * vec4(position, 1.0); n = normal; }
"""
FRAGMENT = """
#version 330
uniform vec3 to_light;
uniform vec3 color;
in vec3 n;
out vec4 picture;
void main() { picture = vec4(color * max(0.0, dot(normalize(n), to_light)), 1.0); }
"""


def load(path, triangles):
    """The mesh, subdivided until it has about so many triangles; positions, faces, normals."""
    import trimesh

    mesh = trimesh.load(path, force="mesh", process=False)
    while len(mesh.faces) * 4 <= triangles:
        mesh = mesh.subdivide()
    if len(mesh.faces) < 0.8 * triangles:
        # The rest of the way by splitting a part of the faces.
        share = (triangles - len(mesh.faces)) // 3
        mesh = mesh.subdivide(face_index=np.arange(share))
    mesh.merge_vertices(merge_norm=True, merge_tex=True)
    positions = np.ascontiguousarray(mesh.vertices, np.float32)
    faces = np.ascontiguousarray(mesh.faces, np.int32)
    corners = positions[faces].astype(float)
    weighted = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros(positions.shape)
    for k in range(3):
        np.add.at(normals, faces[:, k], weighted)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    return positions, faces, normals.astype(np.float32)


def camera(positions, size):
    """The clip matrix of a camera that sees the mesh fill the picture's height."""
    low, high = positions.min(0).astype(float), positions.max(0).astype(float)
    centre, radius = (low + high) / 2, (high - low).max() / 2
    near, far, f = radius, 5 * radius, 2.0
    view = np.eye(4)
    view[:3, 3] = -centre - [0, 0, 2.6 * radius]
    projection = np.zeros((4, 4))
    projection[0, 0], projection[1, 1] = f * size[1] / size[0], f
    projection[2, 2], projection[2, 3] = (far + near) / (near - far), 2 * far * near / (near - far)
    projection[3, 2] = -1
    return projection @ view


class Llvmpipe:
    """The same picture by Mesa's software rasteriser."""

    def __init__(self, positions, faces, normals, matrix, size, cull):
        import moderngl

        self.gl = gl = moderngl.create_context(standalone=True, backend="egl")
        self.name = gl.info["GL_RENDERER"]
        self.program = gl.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
        self.program["matrix"].write(matrix.T.astype("f4").tobytes())
        self.program["to_light"].value = tuple(LIGHT)
        self.program["color"].value = (0.8, 0.7, 0.6)
        self.mesh = gl.vertex_array(
            self.program,
            [(gl.buffer(positions.tobytes()), "3f", "position"), (gl.buffer(normals.tobytes()), "3f", "normal")],
            index_buffer=gl.buffer(faces.tobytes()),
        )
        self.target = gl.framebuffer([gl.renderbuffer(size, 4, dtype="f1")], gl.depth_renderbuffer(size))
        self.target.use()
        gl.enable(moderngl.DEPTH_TEST)
        if cull:
            gl.enable(moderngl.CULL_FACE)
        self.picture = np.empty((size[1], size[0], 4), np.uint8)

    def __call__(self):
        self.target.clear(0, 0, 0, 0)
        self.mesh.render()
        self.target.read_into(self.picture, components=4, dtype="f1")
        return self.picture[::-1]


def ours(positions, faces, normals, matrix, size, cull, format):
    """The fused pass into a reused picture."""
    shape, dtype = ((4,), np.uint8) if format == "rgba8" else ((3,), np.float32)
    out = np.empty((size[1], size[0], *shape), dtype)
    mode = "back" if cull else "none"

    def draw():
        return sl.raster.render_lambert(
            positions, faces, normals, matrix, size, to_light=LIGHT, color=(0.8, 0.7, 0.6), cull=mode,
            format=format, out=out,
        )  # fmt: skip

    return draw


def g_buffer(positions, faces, normals, matrix, size, cull):
    """Face, u, v, depth, position, normal and material into reused arrays."""
    clip = (np.concatenate([positions, np.ones((len(positions), 1))], -1) @ matrix.T).astype(np.float32)
    mode = "back" if cull else "none"
    out = sl.raster.g_buffer(clip, faces, positions, size, normals=normals, cull=mode)
    return lambda: sl.raster.g_buffer(clip, faces, positions, size, normals=normals, cull=mode, out=out)


def medians(calls, repeat):
    """Milliseconds of each call; calls take turns."""
    times = [[] for _ in calls]
    for call in calls:
        call()
        call()
    for _ in range(repeat):
        for call, mine in zip(calls, times, strict=True):
            start = time.perf_counter()
            call()
            mine.append(1e3 * (time.perf_counter() - start))
    return [float(np.median(t)) for t in times]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model")
    parser.add_argument("--repeat", type=int, default=15)
    parser.add_argument("--cull", action="store_true", help="drop back faces on both sides")
    parser.add_argument("--only-ours", action="store_true")
    parser.add_argument("--save", help="write the last pair of pictures to this stem")
    args = parser.parse_args()
    sl.set_threads(2)
    print("triangles    picture  llvmpipe     ours  ratio    float32 G-buffer  ms")
    for triangles in (70_000, 1_000_000):
        mesh = load(args.model, triangles)
        for size in SIZES:
            matrix = camera(mesh[0], size)
            calls = [ours(*mesh, matrix, size, args.cull, "rgba8"), ours(*mesh, matrix, size, args.cull, "float")]
            calls.append(g_buffer(*mesh, matrix, size, args.cull))
            if not args.only_ours:
                calls.append(Llvmpipe(*mesh, matrix, size, args.cull))
            t = medians(calls, args.repeat)
            peer = t[3] if len(t) > 3 else float("nan")
            print(
                f"{len(mesh[1]):9d} {size[0]:5d}x{size[1]:4d} {peer:9.1f} {t[0]:8.1f} {peer / t[0]:6.2f}   "
                f"{t[1]:8.1f} {t[2]:8.1f}",
                flush=True,
            )
            if not args.only_ours:
                difference = np.abs(calls[0]().astype(int) - calls[3]().astype(int)).max(-1)
                print(f"    pixels that differ by more than 2 of 255: {(difference > 2).mean():.5%}; {calls[3].name}")
            if args.save:
                from PIL import Image

                Image.fromarray(calls[0]()[..., :3]).save(f"{args.save}-ours-{len(mesh[1])}-{size[1]}.png")
                if not args.only_ours:
                    Image.fromarray(calls[3]()[..., :3]).save(f"{args.save}-llvmpipe-{len(mesh[1])}-{size[1]}.png")


if __name__ == "__main__":
    main()
