"""Scenes that the tests and the benchmark of the path tracer share, and the same scenes for Mitsuba 3."""

import numpy as np
import shadelab as sl
from shadelab import brdf, mesh, scene
from shadelab.environment import Environment
from shadelab.light import DirectionalLight, DiskLight, PointLight, RectLight

SIZE = (48, 32)


def lambert(*color):
    return scene.Material(color, specular=0.0)


def thing(shape, material, at=(0.0, 0.0, 0.0), turn=0.0):
    matrix = sl.transform.translate(at) @ sl.transform.rotate_axis((0, 1, 0), turn)
    return scene.Instance(shape, matrix, (material,))


def cornell():
    """A box open to the front, two blocks, a rectangle under a plate, seen from above the light's plane."""
    white, red, green = lambert(0.7, 0.7, 0.7), lambert(0.6, 0.1, 0.1), lambert(0.1, 0.5, 0.1)
    wall = mesh.box((0.1, 2.2, 2.0))
    things = [
        thing(mesh.box((2.2, 0.1, 2.0)), white, (0, -1.05, 0)),
        thing(mesh.box((2.2, 0.1, 2.0)), white, (0, 1.05, 0)),
        thing(mesh.box((2.2, 2.2, 0.1)), white, (0, 0, -1.05)),
        thing(wall, red, (-1.05, 0, 0)),
        thing(wall, green, (1.05, 0, 0)),
        thing(mesh.box((0.6, 0.02, 0.6)), lambert(0, 0, 0), (0, 0.82, 0)),
        thing(mesh.box((0.5, 0.6, 0.5)), white, (0.4, -0.7, 0.3), -0.3),
        thing(mesh.box((0.5, 1.2, 0.5)), white, (-0.4, -0.4, -0.3), 0.4),
    ]
    lamp = RectLight((0, 0.8, 0), (0.6, 0, 0), (0, 0, 0.6), (12, 10, 8))
    return scene.Scene(things, (lamp,), scene.Camera((0, 0.85, 4.2), (0, -0.1, 0), fov_y=0.6))


def spheres():
    """Metal balls on a diffuse floor, under a plate with a rectangle below it, in an even sky."""
    ball = mesh.icosphere(4, 0.5)
    things = [
        thing(mesh.plane((6, 6)), lambert(0.5, 0.4, 0.3), (0, -0.5, 0)),
        thing(ball, scene.Material((1, 1, 1), metallic=1.0, roughness=0.3), (-0.6, 0, 0)),
        thing(ball, scene.Material((1, 1, 1), metallic=1.0, roughness=0.2), (0.6, 0, 0.2)),
        thing(mesh.box((1.2, 0.02, 1.2)), lambert(0, 0, 0), (0, 2.02, 0)),
    ]
    lamp = RectLight((0, 2, 0), (1, 0, 0), (0, 0, 1), (4, 4, 5))
    camera = scene.Camera((0, 1.2, 3.2), (0, 0, 0), fov_y=0.7)
    return scene.Scene(things, (lamp,), camera, background=(0.3, 0.4, 0.5))


def punctual():
    """Blocks under a point and a distant light, interreflecting."""
    things = [
        thing(mesh.plane((6, 6)), lambert(0.7, 0.6, 0.5), (0, -0.5, 0)),
        thing(mesh.box((0.6, 1.0, 0.6)), lambert(0.2, 0.4, 0.7), (-0.5, 0, 0), 0.5),
        thing(mesh.torus(0.4, 0.15), lambert(0.8, 0.3, 0.3), (0.6, -0.2, 0.3)),
    ]
    lights = (PointLight((1.5, 1.5, 1.0), (6, 5, 4)), DirectionalLight((0.5, -1.0, -0.4), (1.0, 1.2, 1.5)))
    return scene.Scene(things, lights, scene.Camera((0, 1.5, 3.0), (0, -0.1, 0), fov_y=0.7))


def furnace():
    """A grey ball in an even sky: it sees nothing but the sky."""
    ball = thing(mesh.icosphere(4, 0.9), lambert(0.8, 0.5, 0.2))
    return scene.Scene(ball, (), scene.Camera((0, 0, 3.5), (0, 0, 0), fov_y=0.7), background=(1, 1, 1))


def glass():
    """A slab and a block of glass over a floor, lit through them by an even sky."""
    clear = brdf.Dielectric(1.5)
    things = [
        thing(mesh.plane((6, 6)), lambert(0.6, 0.5, 0.4), (0, -0.5, 0)),
        thing(mesh.box((0.7, 0.8, 0.5)), clear, (-0.5, -0.05, 0), 0.5),
        thing(mesh.box((0.6, 0.6, 0.1)), brdf.RoughDielectric(0.3, 1.5), (0.6, 0.0, 0.2), -0.4),
    ]
    camera = scene.Camera((0, 0.8, 3.0), (0, -0.1, 0), fov_y=0.7)
    return scene.Scene(things, (), camera, background=(0.9, 1.0, 1.1))


def mirror():
    """A mirror, and one of rough copper, beside a diffuse block, under a disk."""
    things = [
        thing(mesh.plane((6, 6)), lambert(0.6, 0.5, 0.4), (0, -0.5, 0)),
        thing(mesh.box((0.1, 1.2, 1.6)), brdf.Conductor(), (-0.9, 0.15, 0), -0.4),
        thing(mesh.box((0.1, 1.2, 1.6)), brdf.RoughConductor(0.3, masking="separable"), (0.9, 0.15, 0), 0.4),
        thing(mesh.box((0.4, 0.7, 0.4)), lambert(0.2, 0.5, 0.7), (0, -0.1, 0), 0.3),
    ]
    lamp = DiskLight((0, 2.5, 0.5), (0, -1, 0), 0.5, (9, 8, 7))
    return scene.Scene(things, (lamp,), scene.Camera((0, 1.0, 3.0), (0, 0, 0), fov_y=0.7), background=(0.1, 0.1, 0.1))


def many_lights():
    """Points of all colours over blocks."""
    rng = np.random.default_rng(5)
    place = rng.uniform((-2, 0.6, -2), (2, 1.6, 1.2), (20, 3)).tolist()
    lights = [PointLight(p, c) for p, c in zip(place, rng.uniform(0.1, 0.5, (20, 3)).tolist(), strict=True)]
    things = [thing(mesh.plane((6, 6)), lambert(0.7, 0.7, 0.7), (0, -0.5, 0))]
    block = mesh.box((0.4, 0.8, 0.4))
    for x in (-1, 0, 1):
        things += [thing(block, lambert(0.8, 0.6, 0.4), (x, -0.1, z), x) for z in (-0.8, 0.4)]
    return scene.Scene(things, lights, scene.Camera((0, 2.2, 3.4), (0, -0.2, 0), fov_y=0.7))


def sky(height=64):
    """A smooth panorama with a bright, soft sun."""
    blank = Environment(np.zeros((height, 2 * height, 3), np.float32))
    w = blank.directions()
    sun = np.asarray([0.5, 0.6, 0.62]) / np.linalg.norm([0.5, 0.6, 0.62])
    glare = np.exp(40 * ((w * sun).sum(-1, keepdims=True) - 1))
    return Environment((0.3 + 0.2 * w[..., 1:2] + glare * (30, 25, 18) + 0 * w).astype(np.float32))


def environment():
    """A block and a knot under a panorama."""
    things = [
        thing(mesh.plane((6, 6)), lambert(0.6, 0.6, 0.6), (0, -0.5, 0)),
        thing(mesh.box((0.5, 0.9, 0.5)), lambert(0.7, 0.4, 0.2), (-0.6, -0.05, 0), 0.5),
        thing(mesh.torus(0.4, 0.15), lambert(0.3, 0.5, 0.7), (0.6, -0.3, 0.3)),
    ]
    camera = scene.Camera((0, 1.5, 3.0), (0, -0.1, 0), fov_y=0.7)
    return scene.Scene(things, (), camera, environment=sky())


def emissive_mesh():
    """A glowing torus between blocks."""
    glow = scene.Material((0, 0, 0), specular=0.0, emission=(5, 4, 2))
    things = [
        thing(mesh.plane((6, 6)), lambert(0.7, 0.7, 0.7), (0, -0.5, 0)),
        thing(mesh.torus(0.3, 0.08, 24, 12), glow, (0, 0.1, 0.3)),
        thing(mesh.box((0.4, 1.0, 0.4)), lambert(0.8, 0.3, 0.3), (-0.8, 0, 0), 0.4),
        thing(mesh.box((0.4, 1.0, 0.4)), lambert(0.3, 0.8, 0.3), (0.8, 0, 0), -0.4),
    ]
    return scene.Scene(things, (), scene.Camera((0, 1.2, 3.0), (0, -0.1, 0), fov_y=0.7))


def small_bright_light():
    """A box with a rectangle of four centimetres."""
    lamp = RectLight((0, 0.8, 0), (0.04, 0, 0), (0, 0, 0.04), (2500, 2200, 1800))
    box = cornell()
    return scene.Scene(box.instances, (lamp,), box.camera)


def ply(path, arrays, material):
    """One material's faces as Mitsuba reads them, with their normals."""
    used, faces = np.unique(arrays.faces[arrays.material_ids == material], return_inverse=True)
    faces = faces.reshape(-1, 3)
    names = "x y z nx ny nz".split()
    head = ["ply", "format ascii 1.0", f"element vertex {len(used)}", *(f"property float {n}" for n in names)]
    head += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    rows = np.concatenate([arrays.positions[used], arrays.normals[used]], -1)
    lines = [" ".join(map(repr, map(float, row))) for row in rows] + [f"3 {a} {b} {c}" for a, b, c in faces]
    path.write_text("\n".join(head + lines) + "\n")


def envmap(panorama, height=512):
    """The panorama as Mitsuba looks into one: rows run from pole to pole, columns from −z."""
    polar = np.pi * np.arange(height)[:, None] / (height - 1)
    azimuth = 2 * np.pi * (np.arange(2 * height) + 0.5) / (2 * height)
    w = np.stack([np.sin(polar) * np.sin(azimuth), np.cos(polar) + 0 * azimuth, -np.sin(polar) * np.cos(azimuth)], -1)
    return np.ascontiguousarray(panorama.eval(w.astype(np.float32)))


def mitsuba_scene(mi, world, folder, depth, roulette=100):
    """The same scene for Mitsuba, whose depth counts one more."""
    transform, rgb = mi.ScalarTransform4f, lambda c: {"type": "rgb", "value": [float(x) for x in c]}
    camera = world.camera
    to_world = transform().look_at(origin=camera.eye, target=camera.target, up=camera.up)
    film = {"type": "hdrfilm", "width": SIZE[0], "height": SIZE[1], "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    out = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": depth + 1, "rr_depth": roulette},
        "sensor": {"type": "perspective", "fov": np.degrees(camera.fov_y), "fov_axis": "y", "to_world": to_world},
    }
    out["sensor"] |= {"film": film, "sampler": {"type": "independent"}}
    arrays = world.flatten(np.float32)
    for i, m in enumerate(arrays.materials):
        if isinstance(m, brdf.Dielectric | brdf.RoughDielectric):
            bsdf = {"type": "dielectric", "int_ior": float(m.eta), "ext_ior": 1.0}
            if isinstance(m, brdf.RoughDielectric):
                bsdf |= {"type": "roughdielectric", "alpha": float(m.alpha), "distribution": "ggx"}
        elif isinstance(m, brdf.Conductor | brdf.RoughConductor):
            bsdf = {"type": "conductor", "eta": rgb(m.eta), "k": rgb(m.k)}
            if isinstance(m, brdf.RoughConductor):
                bsdf |= {"type": "roughconductor", "alpha": float(m.alpha), "distribution": "ggx"}
        elif m.metallic == 1:
            bsdf = {"type": "roughconductor", "material": "none", "alpha": m.roughness**2, "distribution": "ggx"}
        else:
            assert m.specular == 0
            bsdf = {"type": "diffuse", "reflectance": rgb(m.base_color)}
        ply(folder / f"{i}.ply", arrays, i)
        if "dielectric" not in bsdf["type"]:
            bsdf = {"type": "twosided", "inner": bsdf}
        shape = {"type": "ply", "filename": str(folder / f"{i}.ply"), "bsdf": bsdf}
        if any(getattr(m, "emission", ())):
            shape["emitter"] = {"type": "area", "radiance": rgb(m.emission)}
            # With normals of vertices Mitsuba's density of points on an emitter takes the cosine of those, while the
            # points are drawn on the faces: 0.7 per cent of a glowing torus of 576 faces.
            shape["face_normals"] = True
        out[f"shape{i}"] = shape
    for i, light in enumerate(world.lights):
        if isinstance(light, PointLight):
            out[f"light{i}"] = {"type": "point", "position": light.position, "intensity": rgb(light.intensity)}
        elif isinstance(light, DirectionalLight):
            kind = {"type": "directional", "direction": light.direction}
            out[f"light{i}"] = kind | {"irradiance": rgb(light.irradiance)}
        elif isinstance(light, DiskLight):
            at = np.add(light.center, light.normal)
            place = transform().look_at(origin=light.center, target=at, up=(0.6, 0.0, 0.8))
            shape = {"type": "disk", "to_world": place @ transform().scale(light.radius)}
            shape["bsdf"] = {"type": "diffuse", "reflectance": 0.0}
            out[f"light{i}"] = shape | {"emitter": {"type": "area", "radiance": rgb(light.radiance)}}
        else:
            matrix = np.eye(4)
            matrix[:3] = np.stack(
                [np.divide(light.edge_u, 2), np.divide(light.edge_v, 2), light.normal, light.center], 1
            )
            shape = {
                "type": "rectangle",
                "to_world": transform(matrix),
                "bsdf": {"type": "diffuse", "reflectance": 0.0},
            }
            out[f"light{i}"] = shape | {"emitter": {"type": "area", "radiance": rgb(light.radiance)}}
    if world.environment is not None:
        out["sky"] = {"type": "envmap", "bitmap": mi.Bitmap(envmap(world.environment)), "scale": 1.0}
    if any(world.background):
        out["sky"] = {"type": "constant", "radiance": rgb(world.background)}
    return mi.load_dict(out)
