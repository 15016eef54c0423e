"""Scenes whose light is all emission seen through mirrors, glass and lenses; and the same for Mitsuba."""

import numpy as np
import shadelab as sl
from shadelab import brdf, mesh, scene

from .scenes import ply

GLOW = [(0.9, 0.2, 0.1), (0.1, 0.8, 0.3), (0.2, 0.3, 1.0)]


def tiles(picture, side=8):
    """Means over squares of pixels."""
    h, w, c = picture.shape
    return picture.astype(np.float64).reshape(h // side, side, w // side, side, c).mean((1, 3))


def glowing(color):
    return scene.Material((0, 0, 0), specular=0.0, emission=color)


def cards(**camera):
    """Three glowing cards at distances of 2, 4 and 8 before the camera."""
    upright = sl.transform.rotate_axis((1, 0, 0), np.pi / 2)
    things = [
        scene.Instance(
            mesh.plane((0.25 * d, 0.5 * d)),
            sl.transform.translate((0.3 * d * (i - 1), 0.0, -d)) @ upright,
            glowing(GLOW[i]),
        )
        for i, d in enumerate((2.0, 4.0, 8.0))
    ]
    return scene.Scene(things, (), scene.Camera((0, 0, 0), (0, 0, -1), fov_y=0.6, **camera))


def through_mirrors_and_glass():
    """A metal and a glass ball over glowing tiles, in an even sky."""
    tiles = [
        scene.Instance(mesh.plane((1.0, 3.0)), sl.transform.translate((i - 1.0, -0.5, 0)), glowing(GLOW[i]))
        for i in range(3)
    ]
    ball = mesh.icosphere(4, 0.5)
    balls = [
        scene.Instance(ball, sl.transform.translate((-0.6, 0, 0)), scene.Material((0.9, 0.7, 0.5), 1.0, 0.0)),
        scene.Instance(ball, sl.transform.translate((0.6, 0.1, 0.2)), brdf.Dielectric(eta=1.5)),
    ]
    camera = scene.Camera((0.3, 1.0, 3.5), (0, 0, 0), fov_y=0.6)
    return scene.Scene(tiles + balls, (), camera, background=(0.3, 0.4, 0.5))


def mitsuba_picture(mi, world, folder, size, spp, seed, depth=-1, rfilter="box"):
    """A picture by Mitsuba's path tracer."""
    rgb = lambda c: {"type": "rgb", "value": [float(x) for x in c]}  # noqa: E731
    camera = world.camera
    sensor = {
        "type": "thinlens" if camera.aperture else "perspective",
        "fov": np.degrees(camera.fov_y),
        "fov_axis": "y",
        "to_world": mi.ScalarTransform4f().look_at(origin=camera.eye, target=camera.target, up=camera.up),
        "film": {
            "type": "hdrfilm",
            "width": size[0],
            "height": size[1],
            "rfilter": rfilter if isinstance(rfilter, dict) else {"type": rfilter},
            "pixel_format": "rgb",
        },
        "sampler": {"type": "independent"},
    }
    if camera.aperture:
        sensor |= {"aperture_radius": camera.aperture / 2, "focus_distance": camera.focus_distance}
    arrays = world.flatten(np.float32)
    out = {"type": "scene", "integrator": {"type": "path", "max_depth": depth, "rr_depth": 100}, "sensor": sensor}
    for i, m in enumerate(arrays.materials):
        ply(folder / f"{i}.ply", arrays, i)
        shape = {"type": "ply", "filename": str(folder / f"{i}.ply")}
        if isinstance(m, brdf.Dielectric):
            shape["bsdf"] = {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}
        elif m.metallic:
            # Schlick's reflectance has no counterpart: the colour at normal incidence is told apart in the test.
            shape["bsdf"] = {"type": "conductor", "material": "none"}
        else:
            shape["bsdf"] = {"type": "diffuse", "reflectance": 0.0}
            shape["emitter"] = {"type": "area", "radiance": rgb(m.emission)}
        out[f"shape{i}"] = shape
    if any(world.background):
        out["sky"] = {"type": "constant", "radiance": rgb(world.background)}
    return np.array(mi.render(mi.load_dict(out), spp=spp, seed=seed))
