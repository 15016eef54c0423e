"""Scenes: meshes with materials, placed in the world, under lights, before a camera; loading and saving.

World space is right-handed, y up. Colours and radiances are linear, sRGB primaries.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _arrays, brdf, transform
from . import mesh as _mesh
from ._arrays import Floats
from ._camera import Camera, Vector, _triple
from ._models import load, load_mesh
from ._pictures import load_image, save_image
from .mesh import Mesh

if TYPE_CHECKING:
    from .environment import Environment

__all__ = [
    "Camera",
    "Instance",
    "Material",
    "Scene",
    "SceneArrays",
    "default",
    "load",
    "load_image",
    "load_mesh",
    "save_image",
]


@dataclass(frozen=True)
class Material:
    """A metallic-roughness material.

    Parameters
    ----------
    base_color : three floats in [0, 1]
        Linear; the reflectance of a dielectric's body, or of a metal at normal incidence.
    metallic : float in [0, 1]
    roughness : float in [0, 1]
        The artist's; the width of the microfacet distribution is its square.
    emission : three floats in [0, 1e30]
        Radiance that the surface gives off, in W/(m² sr).
    name : str
    specular : float in [0, 1]
        Strength of the dielectric's mirrors; 0 leaves Lambert's diffuser.

    Raises
    ------
    TypeError, ValueError
        If a number is out of its domain.

    Examples
    --------
    >>> Material((0.9, 0.1, 0.1), roughness=0.3).metallic
    0.0
    """

    base_color: Vector = (0.8, 0.8, 0.8)
    metallic: float = 0.0
    roughness: float = 0.5
    emission: Vector = (0.0, 0.0, 0.0)
    name: str = ""
    specular: float = 1.0

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "base_color", _triple("base_color", self.base_color, 0, 1))
        set_(self, "metallic", _arrays.number("metallic", self.metallic, 0, 1))
        set_(self, "roughness", _arrays.number("roughness", self.roughness, 0, 1))
        set_(self, "specular", _arrays.number("specular", self.specular, 0, 1))
        set_(self, "emission", _triple("emission", self.emission, 0, 1e30))

    def _model(self) -> brdf.MetallicRoughness:
        return brdf.MetallicRoughness(self.base_color, self.metallic, self.roughness, self.specular)


def _affine(name: str, matrix: Any) -> Floats:
    m = np.eye(4) if matrix is None else _arrays.matrices(name, matrix, 4, np.float64)
    if m.shape != (4, 4) or not np.isfinite(m).all() or not np.array_equal(m[3], [0, 0, 0, 1]):
        raise ValueError(f"{name}: expected one finite affine matrix (4, 4), whose last row is 0, 0, 0, 1")
    return m


@dataclass(frozen=True, eq=False)
class Instance:
    """A mesh placed in the world.

    Parameters
    ----------
    mesh : Mesh
    transform : array_like, shape (4, 4)
        An affine matrix from the mesh's space to the world; None leaves it where it is.
    materials : Material or a model of `shadelab.brdf`, or sequence of them
        What `Mesh.material_ids` index.
    transform_end : array_like, shape (4, 4), optional
        The matrix at time 1, if the mesh moves; `transform` is that at time 0. Vertices go straight from one to the
        other at even speed, so a large turn is to be given in parts.

    Raises
    ------
    TypeError, ValueError
        If a matrix is not finite and affine, or the mesh asks for a material that is not there.

    Examples
    --------
    >>> from shadelab.mesh import box
    >>> Instance(box(), transform.translate([0, 1, 0])).world().bounds[:, 1]
    array([0.5, 1.5])
    """

    mesh: Mesh
    transform: Any = None
    materials: Any = field(default_factory=lambda: (Material(),))
    transform_end: Any = None

    def __post_init__(self) -> None:
        if not isinstance(self.mesh, Mesh):
            raise TypeError(f"mesh: expected a Mesh, got {type(self.mesh).__name__}")
        given = self.materials
        try:
            materials = (given,) if isinstance(given, Material | brdf.Model) else tuple(given)
        except TypeError:
            materials = ()
        if not materials or not all(isinstance(material, Material | brdf.Model) for material in materials):
            raise TypeError("materials: expected one Material, or model of shadelab.brdf, or more")
        for material in materials:
            if isinstance(material, brdf.Model):
                material._row()
        object.__setattr__(self, "materials", materials)
        self._check_ids()
        object.__setattr__(self, "transform", _affine("transform", self.transform))
        if self.transform_end is not None:
            object.__setattr__(self, "transform_end", _affine("transform_end", self.transform_end))

    def _check_ids(self) -> None:
        """Also before the mesh is used: its ids may have been written to."""
        ids, count = self.mesh.material_ids, len(self.materials)
        if ids is not None and ids.size and (int(ids.max()) >= count or int(ids.min()) < 0):
            face = int(np.argmax((ids >= count) | (ids < 0)))
            raise ValueError(f"materials: face {face} of the mesh asks for material {int(ids[face])} of {count}")

    def world(self, time: float = 0.0) -> Mesh:
        """The mesh in world space, at a time in [0, 1]."""
        if self.transform_end is None:
            return self.mesh.transformed(self.transform)
        return self.mesh.transformed((1 - time) * self.transform + time * self.transform_end)


class SceneArrays(NamedTuple):
    """A scene as arrays in world space: what renderers work on."""

    positions: Floats
    """(V, 3)"""
    faces: NDArray[np.int32]
    """(F, 3), counter-clockwise seen from outside."""
    normals: Floats
    """(V, 3) unit shading normals; zero at vertices of no solid face."""
    colors: Floats | None
    """(V, 3) linear factors of the base colour, or None if all are one."""
    uvs: Floats | None
    """(V, 2), or None if no mesh has any; zero for those that have none."""
    material_ids: NDArray[np.int32]
    """(F,) rows of the tables of materials."""
    instance_ids: NDArray[np.int32]
    """(F,)"""
    materials: tuple[Material | brdf.Model, ...]
    base_color: Floats
    """(M, 3); of models of `shadelab.brdf` these are of the metallic-roughness material that comes nearest."""
    metallic: Floats
    """(M,)"""
    roughness: Floats
    """(M,)"""
    emission: Floats
    """(M, 3)"""
    specular: Floats
    """(M,)"""
    kinds: NDArray[np.int32]
    """(M,) kinds of the reflection models."""
    rows: Floats
    """(M, N) their parameters, as kernels read them."""


@dataclass(frozen=True, eq=False)
class Scene:
    """Things in the world under lights, before a camera.

    Parameters
    ----------
    instances : sequence of Instance or Mesh, or one of them
        A mesh alone stands where it is, of the default material.
    lights : light, or sequence of lights
        Of `shadelab.light`.
    camera : Camera, optional
        None fits one to the scene.
    background : three floats in [0, 1e30]
        Radiance from everywhere that is not hit, in W/(m² sr).
    environment : Environment, optional
        A panorama of that radiance instead; see `shadelab.environment`.

    Raises
    ------
    TypeError, ValueError
        If something is not an instance or mesh or light, no mesh has a face and there is no camera, or both a
        background and an environment are given.

    Examples
    --------
    >>> from shadelab.mesh import icosphere
    >>> Scene(icosphere()).bounds
    array([[-1., -1., -1.],
           [ 1.,  1.,  1.]])
    """

    instances: Any
    lights: Any = ()
    camera: Any = None
    background: Vector = (0.0, 0.0, 0.0)
    environment: Environment | None = None

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        if not isinstance(self.instances, Instance | Mesh | Iterable):
            raise TypeError(f"instances: expected Instance or Mesh, or several, got {type(self.instances).__name__}")
        try:
            given = [self.instances] if isinstance(self.instances, Instance | Mesh) else list(self.instances)
        except TypeError:
            raise TypeError("instances: expected Instance or Mesh, or several, got no sequence") from None
        for thing in given:
            if not isinstance(thing, Instance | Mesh):
                raise TypeError(f"instances: expected Instance or Mesh, got {type(thing).__name__}")
        set_(self, "instances", tuple(thing if isinstance(thing, Instance) else Instance(thing) for thing in given))
        lights = tuple(self.lights) if isinstance(self.lights, Sequence) else (self.lights,)
        for light in lights:
            # Lights are known by what they emit, so that a user's own kind can join.
            if not any(hasattr(light, n) for n in ("radiance", "intensity", "irradiance")):
                raise TypeError(f"lights: expected lights, got {type(light).__name__}")
        set_(self, "lights", lights)
        set_(self, "background", _triple("background", self.background, 0, 1e30))
        if self.environment is not None:
            from .environment import Environment

            if not isinstance(self.environment, Environment):
                raise TypeError(f"environment: expected an Environment, got {type(self.environment).__name__}")
            if any(self.background):
                raise ValueError("background: expected none beside an environment, got both")
        if self.camera is None:
            set_(self, "camera", fit_camera(self.bounds))
        elif not isinstance(self.camera, Camera):
            raise TypeError(f"camera: expected a Camera, got {type(self.camera).__name__}")

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The lowest and the highest corner of the box around everything, shape (2, 3).

        Raises
        ------
        ValueError
            If no mesh has a face.
        """
        boxes = [i.world().bounds for i in self.instances if len(i.mesh.faces)]
        if not boxes:
            raise ValueError("instances: expected at least one face in the scene")
        return np.stack([np.min([b[0] for b in boxes], 0), np.max([b[1] for b in boxes], 0)]).astype(np.float64)

    @property
    def moves(self) -> bool:
        """Whether any instance is elsewhere at time 1 than at time 0."""
        return any(
            i.transform_end is not None and not np.array_equal(i.transform, i.transform_end) for i in self.instances
        )

    def flatten(self, dtype: DTypeLike = np.float32, time: float = 0.0) -> SceneArrays:
        """All instances as one set of arrays in world space.

        Parameters
        ----------
        dtype : data type
            float32 or float64.
        time : float in [0, 1]
            At which moving instances stand where they then are.

        Returns
        -------
        SceneArrays
            Vertices and faces of the instances one after the other; a table of the distinct materials.

        Raises
        ------
        TypeError
            If the data type is neither.
        """
        dtype, time = _arrays.precision("dtype", dtype), _arrays.number("time", time, 0, 1)
        worlds = [i.world(time).astype(dtype) for i in self.instances]
        starts = np.cumsum([0] + [len(w.positions) for w in worlds])
        table: dict[Material | brdf.Model, int] = {}
        ids, normals = [], []
        for instance, world in zip(self.instances, worlds, strict=True):
            rows = np.array([table.setdefault(m, len(table)) for m in instance.materials], np.int32)
            own = world.material_ids
            # Ids may have been written to since the instance was made.
            instance._check_ids()
            ids.append(rows[own] if own is not None else np.full(len(world.faces), rows[0], np.int32))
            shading = world.normals
            if shading is None:
                shading = np.nan_to_num(_mesh.vertex_normals(world.positions, world.faces), nan=0.0)
            normals.append(shading)
        materials = tuple(table) or (Material(),)
        counts = [len(w.faces) for w in worlds]
        return SceneArrays(
            _join([w.positions for w in worlds], (0, 3), dtype),
            _join([w.faces + np.int32(s) for w, s in zip(worlds, starts, strict=False)], (0, 3), np.int32),
            _join(normals, (0, 3), dtype),
            _optional([w.colors for w in worlds], worlds, 3, 1, dtype),
            _optional([w.uvs for w in worlds], worlds, 2, 0, dtype),
            _join(ids, (0,), np.int32),
            np.repeat(np.arange(len(worlds), dtype=np.int32), counts),
            materials,
            **_tables(materials, dtype),
        )


def _tables(materials: Sequence[Material | brdf.Model], dtype: DTypeLike) -> dict[str, NDArray[Any]]:
    """The tables of materials among `SceneArrays`."""
    models = [m._model() if isinstance(m, Material) else m for m in materials]
    seen = [m._stand_in() for m in models]
    return {
        "base_color": np.array([m.base_color for m in seen], dtype),
        "metallic": np.array([m.metallic for m in seen], dtype),
        "roughness": np.array([m.roughness for m in seen], dtype),
        "emission": np.array([getattr(m, "emission", (0.0, 0.0, 0.0)) for m in materials], dtype),
        "specular": np.array([m.specular for m in seen], dtype),
        "kinds": np.array([m._number() for m in models], np.int32),
        "rows": np.array([m._row() for m in models], dtype),
    }


def _join(parts: Sequence[NDArray[Any]], empty: tuple[int, ...], dtype: DTypeLike) -> NDArray[Any]:
    return np.concatenate(parts).astype(dtype, copy=False) if parts else np.empty(empty, dtype)


def _optional(
    parts: Sequence[Floats | None], worlds: Sequence[Mesh], width: int, fill: float, dtype: DTypeLike
) -> Floats | None:
    if all(p is None for p in parts):
        return None
    filled = [np.full((len(w.positions), width), fill) if p is None else p for p, w in zip(parts, worlds, strict=True)]
    return np.concatenate(filled).astype(dtype)


def fit_camera(bounds: ArrayLike, direction: ArrayLike = (0.55, 0.5, 1.0), fov_y: float = math.pi / 5) -> Camera:
    """The camera that sees the sphere around a box from a direction."""
    low, high = np.asarray(bounds, np.float64)
    # Halved first, and by hypot: neither the middle nor the radius overflows where the box itself does not.
    center, radius = low / 2 + high / 2, math.hypot(*(high / 2 - low / 2).tolist())
    radius = radius or 1.0
    if radius > 1e300:
        raise ValueError(f"bounds: expected a box that a camera can stand before, got a radius of {radius:g}")
    away = np.asarray(direction, np.float64)
    eye = center + away / np.linalg.norm(away) * radius / math.sin(fov_y / 2)
    return Camera(tuple(eye.tolist()), tuple(center.tolist()), fov_y=fov_y)


def default() -> Scene:
    """The scene that comes with the library: closed shapes on a ground plane under a rectangular area light.

    A box, a sphere that touches the ground, a tall thin post and a floating torus: shadows begin at contact and far
    from what casts them, and penumbrae range from nothing to wider than the post.

    Returns
    -------
    Scene
        About 13,000 faces within a few metres of the origin, on a ground of 16 by 16, with a camera.

    Examples
    --------
    >>> scene = default()
    >>> len(scene.instances), len(scene.lights)
    (5, 1)
    """
    from .light import RectLight

    def place(x: float, y: float, z: float, axis: Vector = (0.0, 1.0, 0.0), turn: float = 0.0) -> Floats:
        return transform.translate([x, y, z]) @ transform.rotate_axis(axis, turn)

    ground = Material((0.62, 0.6, 0.56), roughness=0.9, name="ground")
    clay = Material((0.72, 0.32, 0.2), roughness=0.7, name="clay")
    ivory = Material((0.85, 0.8, 0.68), roughness=0.35, name="ivory")
    teal = Material((0.12, 0.45, 0.45), roughness=0.5, name="teal")
    slate = Material((0.22, 0.24, 0.3), roughness=0.6, name="slate")
    things = [
        Instance(_mesh.plane(16.0), None, ground),
        Instance(_mesh.box((0.9, 1.1, 0.9)), place(-1.15, 0.55, -0.25, turn=0.5), clay),
        Instance(_mesh.icosphere(4, 0.45), place(0.5, 0.45, 0.75), ivory),
        Instance(_mesh.torus(0.5, 0.16, 96, 40), place(0.35, 1.35, -0.5, (1.0, 0.0, 0.4), 0.9), teal),
        Instance(_mesh.box((0.09, 2.2, 0.09)), place(1.5, 1.1, -0.2, turn=0.3), slate),
    ]
    # A square of 1.2 m that looks at the middle of the ground from 4.6 m away.
    center = np.array([-2.2, 3.8, 1.4])
    axis = -center / np.linalg.norm(center)
    u = np.cross(axis, [0.0, 1.0, 0.0])
    u *= 1.2 / np.linalg.norm(u)
    v = np.cross(axis, u)
    light = RectLight(tuple(center.tolist()), tuple(u.tolist()), tuple(v.tolist()), (46.0, 43.0, 38.0))
    camera = Camera((2.2, 2.7, 5.8), (0.55, 0.55, 0.0), fov_y=math.radians(34))
    return Scene(things, light, camera, background=(0.08, 0.095, 0.12))
