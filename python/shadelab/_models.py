"""Models from files, through trimesh: a scene graph becomes instances, and a model without lights gets a stage.

Public through `shadelab.scene`.
"""

from __future__ import annotations

import json
import math
import os
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _arrays, color, transform
from . import mesh as _mesh
from ._arrays import Floats
from .mesh import Mesh

if TYPE_CHECKING:
    from .scene import Instance, Material, Scene

__all__ = ["load", "load_mesh"]

FORMATS = (".obj", ".ply", ".stl", ".glb", ".gltf")
_CREASE = math.radians(40)

_FARTHEST = 1e18
"""Coordinates may reach this far: their squares are still numbers in float32."""


def load(path: str | os.PathLike[str], *, stage: bool = True) -> Scene:
    """A scene from a model file: OBJ, PLY, STL, GLB or glTF.

    Parameters
    ----------
    path : path
    stage : bool
        Set the model on a ground plane, under a rectangular area light.

    Returns
    -------
    Scene
        Nodes of the file are instances with their transforms, normals, texture coordinates, and materials (base
        colour, metallic, roughness, emission: of glTF up to one, of OBJ `Ke`). Textures of the base colour are taken
        at the vertices, as vertex colours. The camera is fitted to the model.

    Warns
    -----
    UserWarning
        If the file has lights or cameras of its own (glTF): they are not read.

    Raises
    ------
    ImportError
        If trimesh is not installed (``pip install 'shadelab[io]'``).
    TypeError
        If an argument has the wrong type.
    FileNotFoundError, IsADirectoryError
        If there is no such file, or it is a directory.
    ValueError
        If the format is not known, the file is broken, or holds no triangles, or none that has a size.

    Notes
    -----
    Coordinates are kept; the ground is laid at the model's lowest point, y up. Faces without normals in the file are
    smoothed, but where they meet at more than about 40 degrees. Vertex colours of OBJ, PLY and STL are sRGB, those of
    glTF linear.

    Examples
    --------
    >>> load("no-such-file.obj")
    Traceback (most recent call last):
    FileNotFoundError: no-such-file.obj: no such file
    """
    from .scene import Instance, Material, Scene, fit_camera

    staged = _arrays.flag("stage", stage)
    things = _instances(_arrays.path("path", path))
    if not staged:
        return Scene(things)
    from .light import RectLight

    bounds = Scene(things).bounds
    low, high = bounds
    center, radius = (low + high) / 2, math.hypot(*(high - low).tolist()) / 2
    floor = np.array([center[0], low[1], center[2]])
    ground = Material((0.62, 0.6, 0.56), roughness=0.9, name="ground")
    things.append(Instance(_mesh.plane(8 * radius), transform.translate(floor), ground))
    # A square of the model's size that looks at it from four radii away; its light does not depend on the scale.
    away = np.array([-0.5, 0.8, 0.35])
    away *= 4 * radius / np.linalg.norm(away)
    u = np.cross(-away, [0.0, 1.0, 0.0])
    u *= radius / np.linalg.norm(u)
    v = np.cross(-away, u)
    v *= radius / np.linalg.norm(v)
    light = RectLight(_tuple(center + away), _tuple(u), _tuple(v), (52.0, 49.0, 45.0))
    return Scene(things, light, fit_camera(bounds), background=(0.08, 0.095, 0.12))


def load_mesh(path: str | os.PathLike[str]) -> Mesh:
    """All triangles of a model file as one mesh in world space, without materials.

    Parameters
    ----------
    path : path
        OBJ, PLY, STL, GLB or glTF.

    Returns
    -------
    Mesh
        float64, with shading normals.

    Raises
    ------
    ImportError, FileNotFoundError, ValueError
        As `load`.

    Examples
    --------
    >>> load_mesh("model.step")
    Traceback (most recent call last):
    ValueError: model.step: unknown format '.step'; expected one of .obj, .ply, .stl, .glb, .gltf
    """
    from .scene import Scene

    flat = Scene(_instances(_arrays.path("path", path))).flatten(np.float64)
    return Mesh(flat.positions, flat.faces, flat.normals, flat.uvs, flat.colors)


def _tuple(v: NDArray[Any]) -> tuple[float, float, float]:
    x, y, z = v.tolist()
    return x, y, z


def _instances(path: Path) -> list[Instance]:
    """The instances in a file, or one clear error."""
    from .scene import Instance

    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"{path}: unknown format {path.suffix!r}; expected one of {', '.join(FORMATS)}")
    if path.is_dir():
        raise IsADirectoryError(f"{path}: is a directory")
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    try:
        import trimesh
    except ImportError:
        raise ImportError("loading models needs trimesh: pip install 'shadelab[io]'") from None
    linear = path.suffix.lower() in (".glb", ".gltf")
    unread = _unread(path) if linear else []
    if unread:
        warnings.warn(f"{path}: its {' and '.join(unread)} are not read", UserWarning, stacklevel=3)
    try:
        if path.suffix.lower() == ".gltf" and not isinstance(json.loads(path.read_bytes()), dict):
            raise ValueError("it holds no JSON object")
        loaded = trimesh.load_scene(path, process=False)
        made = []
        for node in loaded.graph.nodes_geometry:
            matrix, name = loaded.graph[node]
            geometry = loaded.geometry[name]
            if isinstance(geometry, trimesh.Trimesh) and len(geometry.faces):
                made.append(Instance(*_mesh_of(geometry, matrix, linear)))
    # Whatever a parser stumbles over in a broken file is the file's error.
    except Exception as error:
        raise ValueError(f"{path}: cannot be read as {path.suffix[1:].upper()}: {_reason(error)}") from error
    if not made:
        raise ValueError(f"{path}: holds no triangles")
    bounds = np.stack([i.world().bounds for i in made])
    if not (bounds[:, 0].min(0) < bounds[:, 1].max(0)).any():
        raise ValueError(f"{path}: all vertices are at one point")
    return made


def _unread(path: Path) -> list[str]:
    """What a glTF file holds that no scene is made of."""
    try:
        data = path.read_bytes()
        if data[:4] == b"glTF":
            # A header of twelve bytes, then the first chunk: its length, its kind, the JSON.
            data = data[20 : 20 + int.from_bytes(data[12:16], "little")]
        held = json.loads(data)
        lights = held.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights")
        return [name for name, there in (("lights", lights), ("cameras", held.get("cameras"))) if there]
    # A broken file is the parser's to tell.
    except (OSError, ValueError, AttributeError):
        return []


def _reason(error: Exception) -> str:
    """What is wrong with a file, of what its parser stumbled over."""
    text = str(error).strip().split("\n")[0]
    if isinstance(error, ModuleNotFoundError):
        # Which guesses at the encoding of what cannot be decoded.
        return "it is not text" if error.name in ("charset_normalizer", "chardet") else text
    if isinstance(error, json.JSONDecodeError | UnicodeDecodeError):
        return f"it is not JSON ({text})"
    if isinstance(error, FileNotFoundError):
        return f"a file that it names is missing ({error.filename or text})"
    if isinstance(error, KeyError):
        return f"it lacks {text}"
    if isinstance(error, IndexError):
        return "it ends too early, or an index in it is out of range"
    if isinstance(error, AttributeError | TypeError | NameError):
        return "its structure is not that of the format"
    return text or type(error).__name__


def _check_reach(positions: NDArray[np.float64], matrix: Any) -> None:
    """Refuse coordinates, in the mesh or the world, whose squares would overflow."""
    with np.errstate(all="ignore"):
        world = positions @ np.asarray(matrix, np.float64)[:3, :3].T + np.asarray(matrix, np.float64)[:3, 3]
        reach = max(float(np.abs(positions).max(initial=0.0)), float(np.abs(world).max(initial=0.0)))
    if reach > _FARTHEST:
        raise ValueError(f"expected coordinates up to {_FARTHEST:g}, got {reach:g}")


def _mesh_of(geometry: Any, matrix: Any, linear: bool) -> tuple[Mesh, Any, Material]:
    """Mesh, transform and material of one of trimesh's geometries."""
    positions = np.asarray(geometry.vertices, np.float64)
    faces = np.asarray(geometry.faces)
    _check_reach(positions, matrix)
    visual = geometry.visual
    uvs = getattr(visual, "uv", None)
    uvs = None if uvs is None or len(uvs) != len(positions) else np.nan_to_num(np.asarray(uvs, np.float64))[:, :2]
    colors: Floats | None = None
    if visual.kind == "vertex":
        stored = np.asarray(visual.vertex_colors, np.float64)[:, :3] / 255
        colors = stored if linear else color.decode_transfer(stored, "srgb")
    material, texture = _material(getattr(visual, "material", None))
    if texture is not None and uvs is not None:
        colors = _sample(texture, uvs)
    # Only normals that stand in the file: trimesh would make its own when asked.
    normals = geometry.vertex_normals if "vertex_normals" in geometry._cache else None
    if normals is not None and len(normals) == len(positions):
        normals = np.asarray(normals, np.float64)
        length = np.linalg.norm(normals, axis=-1, keepdims=True)
        if np.isfinite(length).all() and (length > 0).all():
            made = Mesh(positions, faces, normals / length, uvs, colors)
            return made, matrix, material
    return _shaded(Mesh(positions, faces, None, uvs, colors)), matrix, material


def _material(given: Any) -> tuple[Material, Any]:
    """Our material from one of trimesh's, and the base colour's texture."""
    from .scene import Material

    if given is None:
        return Material(), None
    if hasattr(given, "baseColorFactor"):  # glTF
        base = _factor(given.baseColorFactor, (1.0, 1.0, 1.0))
        metallic = 1.0 if given.metallicFactor is None else float(given.metallicFactor)
        roughness = 1.0 if given.roughnessFactor is None else float(given.roughnessFactor)
        emission = _factor(given.emissiveFactor, (0.0, 0.0, 0.0))
        made = Material(base, min(max(metallic, 0), 1), min(max(roughness, 0), 1), emission, str(given.name or ""))
        return made, given.baseColorTexture
    texture = getattr(given, "image", None)
    name = str(getattr(given, "name", None) or "")
    emission = _emission(getattr(given, "kwargs", None) or {})
    diffuse = np.asarray(getattr(given, "diffuse", (204, 204, 204)), np.float64)[:3] / 255
    # trimesh's stand-in for what names no material is grey, and has a texture of 2 by 2 where there are coordinates.
    if not getattr(given, "kwargs", None) and np.allclose(diffuse, 0.4, atol=0.01):
        if texture is None or max(texture.size) <= 2:
            return Material(), None
    if texture is not None:
        return Material((1.0, 1.0, 1.0), emission=emission, name=name), texture
    return Material(_tuple(diffuse.clip(0, 1)), emission=emission, name=name), None


def _emission(given: Mapping[str, Any]) -> tuple[float, float, float]:
    """`Ke` of a material of OBJ: radiance; none where it is missing or no three numbers."""
    try:
        values = np.asarray([float(v) for v in np.ravel(given.get("ke", ()))])
    except (TypeError, ValueError):
        return (0.0, 0.0, 0.0)
    if values.shape != (3,) or not (np.isfinite(values) & (values >= 0)).all():
        return (0.0, 0.0, 0.0)
    return _tuple(values)


def _factor(value: Any, otherwise: tuple[float, float, float]) -> tuple[float, float, float]:
    if value is None:
        return otherwise
    array = np.asarray(value)
    scaled = array[:3] / 255 if array.dtype.kind in "iu" else array[:3]
    return _tuple(np.clip(np.asarray(scaled, np.float64), 0, 1))


def _sample(texture: Any, uvs: NDArray[np.float64]) -> NDArray[np.float64]:
    """The texture's linear colours at texture coordinates, repeated beyond [0, 1), bilinearly."""
    pixels = color.decode_transfer(np.asarray(texture.convert("RGB"), np.float64) / 255, "srgb")
    height, width = pixels.shape[:2]
    # Texture coordinate (0, 0) is the bottom left corner, row 0 the top.
    x, y = uvs[:, 0] * width - 0.5, (1 - uvs[:, 1]) * height - 0.5
    j, i = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    s, t = (x - j)[:, None], (y - i)[:, None]

    def at(r: NDArray[np.int64], c: NDArray[np.int64]) -> NDArray[Any]:
        return np.asarray(pixels[r % height, c % width])

    mixed = (at(i, j) * (1 - s) + at(i, j + 1) * s) * (1 - t) + (at(i + 1, j) * (1 - s) + at(i + 1, j + 1) * s) * t
    return np.asarray(mixed)


def _shaded(given: Mesh) -> Mesh:
    """The mesh with normals: smooth over vertices that coincide, but flat at vertices where faces meet at a crease."""
    _, first, same = np.unique(given.positions, axis=0, return_index=True, return_inverse=True)
    welded = same.reshape(-1)[given.faces]
    smooth = _mesh.vertex_normals(given.positions[first], welded)
    flat = _mesh.face_normals(given.positions, given.faces)
    with np.errstate(invalid="ignore"):
        apart = np.einsum("fk,fck->fc", flat, smooth[welded]) < math.cos(_CREASE / 2)
    creased = np.zeros(len(smooth), bool)
    creased[welded[apart]] = True
    normals = np.nan_to_num(smooth[same.reshape(-1)], nan=0.0)
    corners = creased[welded]
    if not corners.any():
        return Mesh(given.positions, given.faces, normals, given.uvs, given.colors)
    # Each corner at a creased vertex gets a vertex of its own.
    faces = given.faces.copy()
    old = faces[corners]
    faces[corners] = np.arange(len(given.positions), len(given.positions) + len(old), dtype=np.int32)
    own = np.nan_to_num(np.broadcast_to(flat[:, None], (*faces.shape, 3))[corners], nan=0.0)

    def extend(a: Floats | None) -> Floats | None:
        return None if a is None else np.concatenate([a, a[old]])

    return Mesh(
        np.concatenate([given.positions, given.positions[old]]),
        faces,
        np.concatenate([normals, own]),
        extend(given.uvs),
        extend(given.colors),
    )
