"""Whatever is given for an argument: an answer, or an error that names the argument; no warning, no panic."""

import copy
import inspect
import re
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shadelab as sl
from shadelab import accel, brdf, environment, geometry, light, raster, scene, shadow, transform

CHAPTERS = {"transform": transform, "geometry": geometry, "accel": accel}

EYE = np.eye(4)
P, Q, R, S = np.array([[0.1, 0.2, 2.0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
RAYS = {"origins": P, "directions": -S}
BOX = {"lower": -P - 1, "upper": P + 1}
OBB = {"center": P, "axes": np.eye(3), "half_extents": np.ones(3)}
ABC = {"a": Q, "b": R, "c": S}
PLANE = np.array([0.0, 0.6, 0.8, -1])
SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
PLANES = geometry.frustum_planes(transform.perspective(1.0, near=0.1, far=9.0))
BALL = sl.mesh.icosphere(1)
MESH = {"positions": BALL.positions, "faces": BALL.faces}
QUATERNION = np.array([0.1, 0.2, 0.3, 0.9])
CAMERA = transform.perspective(1.0, near=0.1, far=9.0)


def pair(a: dict[str, Any], b: dict[str, Any] | None = None) -> dict[str, Any]:
    return {f"a_{k}": v for k, v in a.items()} | {f"b_{k}": v for k, v in (b or a).items()}


# A right call of every function: what is not listed keeps its default.
CALLS: dict[str, dict[str, Any]] = {
    "transform.compose": {},
    "transform.decompose": {"matrix": EYE},
    "transform.scale": {"factors": P},
    "transform.shear": {},
    "transform.shear_2d": {},
    "transform.translate": {"offset": P},
    "transform.normal_matrix": {"matrix": EYE},
    "transform.project": {"points": P, "matrix": CAMERA, "size": (640, 480)},
    "transform.unproject": {"pixels": P, "matrix": CAMERA, "size": (640, 480)},
    "transform.transform_normals": {"normals": S, "matrix": EYE},
    "transform.transform_points": {"points": P, "matrix": EYE},
    "transform.transform_vectors": {"vectors": P, "matrix": EYE},
    "transform.depth_precision": {"distance": 2.0, "near": 0.1},
    "transform.linear_depth": {"depth": np.array([0.5]), "projection": CAMERA},
    "transform.orthographic": {"left": -1, "right": 1, "bottom": -1, "top": 1, "near": 0.5, "far": 2},
    "transform.perspective": {"fov_y": 1.0},
    "transform.quaternion_conjugate": {"q": QUATERNION},
    "transform.quaternion_from_axis": {"axis": P, "angle": 1.0},
    "transform.quaternion_from_matrix": {"matrix": EYE},
    "transform.quaternion_inverse": {"q": QUATERNION},
    "transform.quaternion_multiply": {"a": QUATERNION, "b": QUATERNION},
    "transform.quaternion_rotate": {"q": QUATERNION, "vectors": P},
    "transform.quaternion_slerp": {"a": QUATERNION, "b": QUATERNION, "t": 0.5},
    "transform.quaternion_to_matrix": {"q": QUATERNION},
    "transform.cross_matrix": {"vectors": P},
    "transform.euler": {"angles": P},
    "transform.euler_angles": {"matrix": EYE},
    "transform.rotate_2d": {"angle": 1.0},
    "transform.rotate_axis": {"axis": P, "angle": 1.0},
    "transform.rotate_x": {"angle": 1.0},
    "transform.rotate_y": {"angle": 1.0},
    "transform.rotate_z": {"angle": 1.0},
    "transform.angle_between": {"a": P, "b": Q},
    "transform.orthonormal_basis": {"normals": S},
    "transform.project_onto": {"vectors": P, "onto": Q},
    "transform.change_of_basis": {"x": Q, "y": R, "z": S},
    "transform.look_at": {"eye": P, "target": Q},
    "transform.rigid_inverse": {"matrix": EYE},
    "transform.viewport": {"size": (640, 480)},
    "geometry.bounding_aabb": {"points": SQUARE},
    "geometry.bounding_kdop": {"points": SQUARE},
    "geometry.bounding_obb": {"points": SQUARE},
    "geometry.bounding_sphere": {"points": SQUARE},
    "geometry.clip_homogeneous": {"polygon": np.c_[SQUARE, np.ones(4)]},
    "geometry.clip_polygon": {"polygon": SQUARE[:, :2], "window": SQUARE[:, :2] + 0.5},
    "geometry.clip_segment": {"start": P[:2], "end": Q[:2], "lower": [0.0, 0], "upper": [1.0, 1]},
    "geometry.frustum_aabb": {"planes": PLANES, **BOX},
    "geometry.frustum_obb": {"planes": PLANES, **OBB},
    "geometry.frustum_planes": {"matrix": CAMERA},
    "geometry.frustum_sphere": {"planes": PLANES, "center": P, "radius": 1.0},
    "geometry.quadric_polynomial": {"matrix": EYE},
    "geometry.ray_implicit": {**RAYS, "surface": geometry.torus_polynomial()},
    "geometry.torus_polynomial": {},
    "geometry.line_line": {"origins_1": P, "directions_1": Q, "origins_2": R, "directions_2": S},
    "geometry.segment_segment": {**ABC, "d": P},
    "geometry.octahedral_decode": {"codes": [0.5, 0.25]},
    "geometry.octahedral_encode": {"directions": P},
    "geometry.aabb_aabb": pair(BOX),
    "geometry.obb_obb": pair(OBB),
    "geometry.plane_aabb": {"plane": PLANE, **BOX},
    "geometry.plane_obb": {"plane": PLANE, **OBB},
    "geometry.polygon_aabb": {"polygon": SQUARE, **BOX},
    "geometry.sphere_aabb": {"center": P, "radius": 1.0, **BOX},
    "geometry.sphere_sphere": pair({"center": P, "radius": 1.0}),
    "geometry.sphere_triangle": {"center": P, "radius": 1.0, **ABC},
    "geometry.three_planes": {"a": [1, 0, 0, 1.0], "b": [0, 1, 0, 1.0], "c": [0, 0, 1, 1.0]},
    "geometry.triangle_aabb": {**ABC, **BOX},
    "geometry.triangle_triangle": {"a0": P, "a1": Q, "a2": R, "b0": S, "b1": Q, "b2": R},
    "geometry.barycentric": {"points": P, **ABC},
    "geometry.closest_point_triangle": {"points": P, **ABC},
    "geometry.perspective_barycentric": {"weights": P, "w": P},
    "geometry.point_in_polygon": {"points": P[:2], "polygon": SQUARE[:, :2]},
    "geometry.ray_polygon": {**RAYS, "polygon": SQUARE},
    "geometry.signed_area": {"polygon": SQUARE[:, :2]},
    "geometry.sort_by_angle": {"points": SQUARE[:, :2]},
    "geometry.ray_aabb": {**RAYS, **BOX},
    "geometry.ray_obb": {**RAYS, "centers": P, "axes": np.eye(3), "half_extents": np.ones(3)},
    "geometry.ray_plane": {**RAYS, "planes": PLANE},
    "geometry.ray_sphere": {**RAYS, "centers": P, "radii": 1.0},
    "geometry.ray_triangle": {**RAYS, **ABC},
    "accel.brute_force": {**MESH, **RAYS},
    "accel.brute_force_all": {**MESH, **RAYS},
    "accel.morton_encode": {"points": np.array([[1, 2, 3]])},
    "accel.morton_decode": {"codes": np.array([1, 2, 3])},
    "accel.radix_tree": {"codes": np.array([1, 2, 3])},
    "accel.offset_ray": {"points": P, "normals": S},
    "accel.BVH": MESH,
    "accel.UniformGrid": MESH,
    "accel.Octree": MESH,
    "accel.KDTree": MESH,
    "accel.BSPTree": MESH,
    "accel.InstancedBVH": {"objects": [accel.BVH(**MESH)], "transforms": EYE},
}
METHODS: dict[str, dict[str, Any]] = {
    "all_hits": RAYS,
    "any_hit": RAYS,
    "closest_hit": RAYS,
    "counts": RAYS,
    "carried": {**RAYS, "instance": 0},
    "closest_point": {"points": P},
    "contains": {"points": P},
    "signed_distance": {"points": P},
    "winding_number": {"points": P},
    "order": {"eye": P},
    "overlap": BOX,
    "refit": {"positions": BALL.positions},
    "stats": {},
}
# Other ways of calling, for arguments that the calls above leave idle.
WAYS: dict[str, list[dict[str, Any]]] = {
    "geometry.octahedral_encode": [{"bits": 8}],
    "geometry.octahedral_decode": [{"codes": np.array([5, 7]), "bits": 8}],
    "geometry.ray_implicit": [{"surface": lambda p: p[:, 2] - 0.5, "t_max": 9.0}],
    "geometry.clip_homogeneous": [{"attributes": SQUARE}],
    "accel.morton_encode": [{"points": P, "lower": -P - 1, "upper": P + 1}],
    "accel.morton_decode": [{"lower": -P - 1, "upper": P + 1}],
    "transform.perspective": [{"fov_y": None, "left": -1, "right": 1, "bottom": -1, "top": 1}],
    "transform.scale": [{"factors": 2.0}],
}


def functions() -> dict[str, tuple[Callable[..., Any], dict[str, Any]]]:
    """Every public function, class with a call of its own, and method, with a right call of it."""
    found: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {}
    for chapter, module in CHAPTERS.items():
        for name in module.__all__:
            thing, full = getattr(module, name), f"{chapter}.{name}"
            if inspect.isfunction(thing):
                found[full] = thing, CALLS[full]
            elif inspect.isclass(thing) and not issubclass(thing, tuple) and thing is not accel.Structure:
                found[full] = thing, CALLS[full]
                made = thing(**CALLS[full])
                for method, _ in inspect.getmembers(thing, inspect.isfunction):
                    if not method.startswith("_"):
                        found[f"{full}.{method}"] = getattr(made, method), METHODS[method]
    for name, ways in WAYS.items():
        for i, way in enumerate(ways):
            found[f"{name}#{i}"] = found[name][0], found[name][1] | way
    return found


FUNCTIONS = functions()

THINGS = {"positions": BALL.positions, "faces": BALL.faces}
SUN, PANEL = light.DirectionalLight((0.3, -1, 0.2)), light.RectLight((0, 4, 0), (1, 0, 0), (0, 0, 1), (5, 5, 5))
AT = {"receivers": np.array([[0.0, -1.0, 0.0]]), "normals": np.array([0.0, 1.0, 0.0])}
CHART = shadow.shadow_map(**THINGS, light=PANEL, resolution=32)
MOMENTS = shadow.moment_map(CHART, "moment", filter="mip")
SEEN = {
    "clip": np.array([[-1.0, -1, 0, 1], [3, -1, 0, 1], [-1, 3, 0, 1]]),
    "faces": np.array([[0, 1, 2]]),
    "size": (4, 4),
}
FRACTIONS = {"lit": np.ones(3), "reference": np.ones(3)}
VIEW = scene.Camera((0, 2, 6), (0, 0, 0), near=0.1, far=20.0)

# Of other chapters, for hostile values alone.
OTHERS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "raster.rasterize": (raster.rasterize, SEEN),
    "raster.rasterize_depth": (raster.rasterize_depth, SEEN),
    "raster.g_buffer": (raster.g_buffer, {**SEEN, "positions": np.eye(3)}),
    "raster.interpolate": (
        raster.interpolate,
        {"attributes": np.ones((3, 1)), "faces": SEEN["faces"], "raster": raster.rasterize(**SEEN)},
    ),
    "light.with_flux": (light.with_flux, {"light": PANEL, "watts": 1.0}),
    "light.flux": (light.flux, {"light": PANEL}),
    "light.intensity": (light.intensity, {"light": PANEL, "directions": -R}),
    "light.irradiance": (light.irradiance, {"light": PANEL, "points": P, "normals": R}),
    "light.light_sample": (light.light_sample, {"light": PANEL, "points": P, "u": [0.5, 0.25]}),
    "light.light_pdf": (light.light_pdf, {"light": PANEL, "points": P, "wi": R}),
    "light.ltc": (light.ltc, {"light": PANEL, "points": P, "normals": R, "wo": R, "alpha": 0.3}),
    "light.fit_ltc": (light.fit_ltc, {"size": (2, 2), "steps": 2}),
    "light.polygon_irradiance": (light.polygon_irradiance, {"corners": SQUARE + R, "points": P, "normals": R}),
    "light.polygon_moments": (light.polygon_moments, {"corners": SQUARE + R, "points": P, "normals": R}),
    "light.photometric": (light.photometric, {"values": P}),
    "light.radiometric": (light.radiometric, {"values": P}),
    "light.unshadowed": (
        light.unshadowed,
        {"lights": PANEL, "points": P, "normals": R, "base_color": Q, "wo": R, "samples": 2},
    ),
    "light.LightSelection": (light.LightSelection, {"lights": [PANEL, SUN]}),
    "light.PointLight": (light.PointLight, {"position": P}),
    "light.SpotLight": (light.SpotLight, {"position": P, "direction": -R}),
    "light.DirectionalLight": (light.DirectionalLight, {"direction": -R}),
    "light.RectLight": (light.RectLight, {"center": P, "edge_u": Q, "edge_v": S}),
    "light.DiskLight": (light.DiskLight, {"center": P, "normal": R, "radius": 1.0}),
    "light.SphereLight": (light.SphereLight, {"center": P, "radius": 1.0}),
    "light.PolygonLight": (light.PolygonLight, {"corners": SQUARE}),
    "light.AmbientLight": (light.AmbientLight, {}),
    "scene.Camera": (scene.Camera, {"eye": P, "target": Q}),
    "scene.Material": (scene.Material, {}),
    "scene.Instance": (scene.Instance, {"mesh": BALL}),
    "scene.Scene": (scene.Scene, {"instances": [BALL]}),
    "environment.Environment": (environment.Environment, {"radiance": np.ones((2, 4, 3))}),
    **{
        f"brdf.{name}": (getattr(brdf, name), {})
        for name in (
            "Diffuse",
            "OrenNayar",
            "Phong",
            "BlinnPhong",
            "Dielectric",
            "RoughDielectric",
            "Conductor",
            "RoughConductor",
            "Plastic",
            "MetallicRoughness",
            "SpecularGlossiness",
            "Principled",
        )
    },
    "brdf.Model.eval": (brdf.Principled().eval, {"wi": S, "wo": S}),
    "brdf.Model.pdf": (brdf.Principled().pdf, {"wi": S, "wo": S}),
    "brdf.Model.sample": (brdf.Principled().sample, {"wo": S, "u": P % 1}),
    "brdf.ndf": (brdf.ndf, {"normals": S, "alpha": 0.5}),
    "brdf.masking_shadowing": (brdf.masking_shadowing, {"wi": S, "wo": S, "alpha": 0.5}),
    "brdf.lambert": (brdf.lambert, {"wi": S, "wo": S, "albedo": Q}),
    "brdf.half_lambert": (brdf.half_lambert, {"wi": S}),
    "brdf.kulla_conty": (brdf.kulla_conty, {"wi": S, "wo": S, "alpha": 0.5, "fresnel": 0.5}),
    "brdf.to_specular_glossiness": (brdf.to_specular_glossiness, {"base_color": Q, "metallic": 0.5}),
    "brdf.to_metallic_roughness": (brdf.to_metallic_roughness, {"diffuse": Q, "specular": R}),
    "brdf.fresnel_schlick": (brdf.fresnel_schlick, {"cos_theta": 0.5, "f0": 0.04}),
    "brdf.refract": (brdf.refract, {"w": S, "normal": S, "eta": 1.5}),
    "brdf.metallic_roughness": (brdf.metallic_roughness, {"wi": S, "wo": S, "base_color": Q}),
    "brdf.metallic_roughness_pdf": (brdf.metallic_roughness_pdf, {"wi": S, "wo": S, "base_color": Q}),
    "brdf.metallic_roughness_sample": (brdf.metallic_roughness_sample, {"wo": S, "u": P % 1, "base_color": Q}),
    "brdf.ggx": (brdf.ggx, {"wi": S, "wo": S, "alpha": 0.5}),
    "brdf.ggx_pdf": (brdf.ggx_pdf, {"wi": S, "wo": S, "alpha": 0.5}),
    "brdf.ggx_sample": (brdf.ggx_sample, {"wo": S, "u": [0.5, 0.25], "alpha": 0.5}),
    "brdf.reflected_radiance": (
        brdf.reflected_radiance,
        {"model": brdf.Diffuse(), "wo": S, "radiance": np.ones_like, "samples": 4},
    ),
    "brdf.fresnel": (brdf.fresnel, {"cos_theta": 0.5, "eta": 1.5}),
    "brdf.fresnel_average": (brdf.fresnel_average, {"eta": 1.5}),
    "brdf.reflect": (brdf.reflect, {"w": S, "normal": S}),
    "brdf.directional_albedo": (brdf.directional_albedo, {"model": brdf.Diffuse(), "wo": S, "samples": 4}),
    "brdf.white_furnace": (brdf.white_furnace, {"model": brdf.Diffuse(), "directions": 2, "samples": 4}),
    "shadow.shadow_map": (shadow.shadow_map, {**THINGS, "light": PANEL, "resolution": 32}),
    "shadow.cube_shadow_map": (
        shadow.cube_shadow_map,
        {**THINGS, "light": light.PointLight((0, 4, 0)), "resolution": 32},
    ),
    "shadow.cascades": (shadow.cascades, {**THINGS, "light": SUN, "camera": VIEW, "resolution": 32}),
    "shadow.cascade_splits": (shadow.cascade_splits, {"near": 1.0, "far": 9.0}),
    "shadow.virtual_shadow_map": (
        shadow.virtual_shadow_map,
        {**THINGS, "light": SUN, "receivers": AT["receivers"], "resolution": 64, "page": 64},
    ),
    "shadow.hard": (shadow.hard, {"shadow_map": CHART, **AT}),
    "shadow.pcf": (shadow.pcf, {"shadow_map": CHART, **AT}),
    "shadow.pcss": (shadow.pcss, {"shadow_map": CHART, **AT}),
    "shadow.moment_map": (shadow.moment_map, {"shadow_map": CHART, "kind": "moment"}),
    "shadow.moment": (shadow.moment, {"moment_map": MOMENTS, **AT}),
    "shadow.variance_soft": (shadow.variance_soft, {"moment_map": MOMENTS, **AT}),
    "shadow.ray_traced": (shadow.ray_traced, {"bvh": accel.BVH(**THINGS), **AT, "light": PANEL, "samples": 2}),
    "shadow.half_plane": (
        shadow.half_plane,
        {**AT, "light": PANEL, "occluders": np.array([[0.0, 1, 0], [0, 0, 1], [-1, 0, 0]])},
    ),
    "shadow.distance_grid": (shadow.distance_grid, {"sources": accel.BVH(**THINGS), "resolution": 4}),
    "shadow.acne": (shadow.acne, FRACTIONS),
    "shadow.detached": (shadow.detached, FRACTIONS),
    "shadow.detached_gap": (shadow.detached_gap, {**FRACTIONS, "receivers": np.ones((3, 3))}),
}

HOSTILE: dict[str, Any] = {
    "none": None,
    "object": object(),
    "text": "text",
    "number as text": "1.0",
    "bytes": b"1",
    "ragged": [[1.0, 2.0], [3.0]],
    "ragged rows": [[[1.0, 2.0, 3.0], [4.0]], [[1.0, 2.0, 3.0]]],
    "list with none": [None, 1.0, 2.0],
    "list of text": ["a", "b", "c"],
    "dict": {},
    "set": {1.0, 2.0, 3.0},
    "generator": (x for x in (1.0, 2.0, 3.0)),
    "function": lambda *_: 1.0,
    "complex": 1 + 2j,
    "complex array": np.ones(3, np.complex64),
    "huge": 10**30,
    "minus huge": -(10**30),
    "huge list": [10**30, 10**400, 1],
    "beyond int64": 2**63,
    "minus one": -1,
    "zero": 0,
    "large": 10**9,
    "fraction": 26.5,
    "nan": np.nan,
    "inf": np.inf,
    "minus inf": -np.inf,
    "nan array": np.full(3, np.nan),
    "inf array": np.full(3, -np.inf),
    "nan matrix": np.full((4, 4), np.nan),
    "nans float32": np.full((2, 3), np.nan, np.float32),
    "huge array": np.full(3, 1e300),
    "huge float32": np.full((1, 3), 3e38, np.float32),
    "tiny array": np.full(3, 5e-324),
    "zeros": np.zeros(3),
    "zero matrix": np.zeros((4, 4)),
    "four zeros": np.zeros(4),
    "empty list": [],
    "empty": np.empty((0, 3)),
    "empty vectors": np.empty((3, 0)),
    "empty integers": np.empty((0, 3), int),
    "0-d": np.array(1.5),
    "0-d object": np.array(None),
    "two": [1.0, 2.0],
    "five": np.arange(5.0),
    "seven by seven": np.ones((7, 7)),
    "deep": np.ones((2, 3, 5)),
    "no batch of the others": np.ones((11, 13, 3)),
    "bool": True,
    "bools": np.ones(3, bool),
    "integers": np.arange(3),
    "negative integers": -np.arange(3),
    "uint64": np.full(3, 2**64 - 1, np.uint64),
    "objects": np.array([1.0, "a", None], object),
    "strings": np.array(["1", "2", "3"]),
    "dates": np.array(["2020-01-01"] * 3, "datetime64[D]"),
    "records": np.zeros(3, [("x", float), ("y", int)]),
    "void": np.zeros(3, "V4"),
    "class": float,
    "itself": pytest,
}
# Arguments that fix the shape of others, which are named then.
RELATED = {
    ("geometry.clip_segment", "start"): "end",
    ("raster.g_buffer", "clip"): "positions",
    ("raster.interpolate", "attributes"): "faces",
    ("raster.interpolate", "faces"): "raster",
    ("shadow.cascade_splits", "near"): "far",
    **{("light.unshadowed", n): "base_color" for n in ("metallic", "roughness", "specular")},
    ("shadow.distance_grid", "sources"): "bounds",
    **{(f"shadow.{n}", "positions"): "faces" for n in ("shadow_map", "cube_shadow_map", "cascades")},
    ("shadow.virtual_shadow_map", "positions"): "faces",
    ("geometry.clip_polygon", "polygon"): "window",
    ("transform.transform_points", "points"): "matrix",
    ("transform.transform_vectors", "vectors"): "matrix",
    ("accel.morton_encode#0", "points"): "lower",
    **{(f"accel.{n}", "positions"): "faces" for n in ("BVH", "UniformGrid", "Octree", "KDTree", "BSPTree")},
    **{(f"accel.{n}", "positions"): "faces" for n in ("brute_force", "brute_force_all")},
}
# What these raise is the user's own.
CALLED = {"progress", "surface", "radiance"}


def complaint(name: str, argument: str, value: Any) -> str | None:
    """What is wrong with how a function takes a value for an argument."""
    f, right = (FUNCTIONS | OTHERS)[name]
    given = {k: (v if callable(v) else copy.copy(v)) for k, v in right.items()} | {argument: value}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            f(**given)
    except (TypeError, ValueError) as error:
        names = {argument, RELATED.get((name, argument), argument)}
        if any(re.search(rf"\b{n}\b", str(error)) for n in names):
            return None
        return f"{type(error).__name__} without the name: {error}"
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            raise
        return f"{type(error).__name__}: {error}"
    return None


@pytest.mark.parametrize("name", FUNCTIONS | OTHERS)
def test_hostile_values_name_their_argument(name: str) -> None:
    signature = inspect.signature((FUNCTIONS | OTHERS)[name][0])
    wrong = {
        f"{argument} = {kind}": said
        for argument in signature.parameters
        for kind, value in HOSTILE.items()
        if not (argument in CALLED and callable(value))
        if (said := complaint(name, argument, value))
    }
    assert not wrong, "\n".join(f"{k}: {v}" for k, v in wrong.items())


@pytest.mark.parametrize("kind", ["none", "object", "bytes", "dict", "fraction", "integers", "function", "class"])
@pytest.mark.parametrize("f", [scene.load, scene.load_mesh, scene.load_image, environment.Environment.load])
def test_paths_of_other_kinds_name_their_argument(f: Callable[..., Any], kind: str) -> None:
    with pytest.raises(TypeError, match="path: expected a path, got"):
        f(HOSTILE[kind])
    with pytest.raises(TypeError, match="path: expected a path, got"):
        scene.save_image(HOSTILE[kind], np.ones((2, 2, 3)))


@pytest.mark.parametrize("path", ["", "a\0b.png"])
def test_paths_of_no_file_are_named(path: str) -> None:
    with pytest.raises(ValueError, match="path: expected the path of a file"):
        scene.load_image(path)


def same(a: Any, b: Any) -> None:
    """To the bit, through tuples of arrays."""
    if isinstance(a, tuple):
        for x, y in zip(a, b, strict=True):
            same(x, y)
    elif isinstance(a, np.ndarray | np.generic):
        assert a.dtype == b.dtype
        np.testing.assert_array_equal(a, b)


def strided(array: np.ndarray) -> np.ndarray:
    """Every second place of a larger array, from behind."""
    return np.flip(np.repeat(np.flip(array), 2, -1))[..., 1::2] if array.ndim else array


def read_only(array: np.ndarray) -> np.ndarray:
    copied = array.copy()
    copied.flags.writeable = False
    return copied


LAYOUTS = {
    "strided": strided,
    "columns first": np.asfortranarray,
    "big-endian": lambda a: a.astype(a.dtype.newbyteorder(">")),
    "read-only": read_only,
    "lists": lambda a: a.tolist(),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_layout_does_not_matter(name: str) -> None:
    f, right = FUNCTIONS[name]
    expected = f(**right)
    for argument, value in right.items():
        if isinstance(value, np.ndarray):
            for layout in LAYOUTS.values():
                same(expected, f(**right | {argument: layout(value)}))


@pytest.mark.parametrize("name", [n for n in FUNCTIONS if n.split("#")[0].count(".") == 1])
def test_half_precision_is_computed_in_single(name: str) -> None:
    f, right = FUNCTIONS[name]

    def turned(dtype: type) -> dict[str, Any]:
        # Through half, so that both get the same numbers.
        arrays = {k: np.asarray(v) for k, v in right.items() if not callable(v) and k not in ("objects", "size")}
        return right | {k: v.astype(np.float16).astype(dtype) for k, v in arrays.items() if v.dtype.kind == "f"}

    same(f(**turned(np.float32)), f(**turned(np.float16)))


def test_results_may_go_where_arguments_lie() -> None:
    """Element by element, as NumPy's own functions allow."""
    points = np.arange(30.0).reshape(10, 3) / 7
    turn = transform.rotate_axis(P, 0.5)
    for f in (transform.transform_points, transform.transform_vectors, transform.transform_normals):
        expected, moved = f(points, turn), points.copy()
        assert f(moved, turn, out=moved) is moved
        np.testing.assert_array_equal(moved, expected)
    for g in (transform.project, transform.unproject):
        expected, moved = g(points, CAMERA, (9, 9)), points.copy()
        np.testing.assert_array_equal(g(moved, CAMERA, (9, 9), out=moved), expected)
    depth = np.linspace(-0.9, 0.9, 7)
    expected = transform.linear_depth(depth, CAMERA)
    np.testing.assert_array_equal(transform.linear_depth(depth, CAMERA, out=depth), expected)
    # Shifted by one element: what is read later must not be overwritten before.
    store = np.zeros((11, 3))
    store[:10] = points
    expected = transform.transform_points(points, turn)
    np.testing.assert_array_equal(transform.transform_points(store[:10], turn, out=store[1:]), expected)
    normals = np.broadcast_to(S, points.shape)
    expected, moved = accel.offset_ray(points, normals), points.copy()
    np.testing.assert_array_equal(accel.offset_ray(moved, normals, out=moved), expected)


def test_hits_may_go_where_intervals_lie() -> None:
    bvh = accel.BVH(**MESH)
    origins = np.array([[0.1, 0.2, 5], [0.1, 0.2, 5], [9, 9, 9]])
    far = np.array([np.inf, 4.5, np.inf])
    expected = bvh.closest_hit(origins, -S, t_max=far)
    out = accel.Hit(far, np.empty(3, np.int32), np.empty(3), np.empty(3))
    same(bvh.closest_hit(origins, -S, t_max=far, out=out)[:4], expected[:4])


def test_numbers_of_other_libraries() -> None:
    """What has a dtype of its own, which NumPy does not know, but turns into an array."""

    class Foreign:
        dtype = "foreign.float32"

        def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
            return np.array([1.0, 2.0, 3.0], np.float32)

    same(transform.translate(Foreign()), transform.translate(np.array([1, 2, 3], np.float32)))
