"""Meshes that stand in a scene many times, kept once: what is traced by two levels, and when that pays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .. import mesh as _mesh
from ..accel import BVH
from ..accel.instances import InstancedBVH

if TYPE_CHECKING:
    from ..mesh import Mesh
    from ..scene import Instance, Scene, SceneArrays

Sharing: TypeAlias = Literal["auto", "flat", "shared"]
Given: TypeAlias = tuple[Any, list[NDArray[np.int32]]]
"""The tree of two levels; the first face and the first slot of each copy, slots."""

# Building is over before it counts for fewer spared faces than these; rays through two levels cost a sample what
# building costs so many faces; and so many faces flattened take about a gigabyte.
_FEW, _A_SAMPLE, _MOST = 250_000, 3, 5_000_000
# Matrices whose determinant is a smaller part of the product of their rows' lengths are not turned round.
_FLAT = 1e-6
# Largest over least stretch, less one, of matrices that keep angles.
_SIMILAR = 1e-9


def shareable(scene: Scene, sharing: Sharing, samples: int) -> list[int]:
    """The numbers of the instances that are to be traced as copies: those of meshes that stand in several places.

    Of `samples` in all the pictures.
    """
    instances: Sequence[Instance] = getattr(scene, "instances", ())
    if sharing == "flat" or len({id(i.mesh) for i in instances}) == len(instances):
        return []
    matrices = np.array([i.transform for i in instances], np.float64).reshape(-1, 4, 4)[:, :3, :3]
    lengths = np.linalg.norm(matrices, axis=-1)
    with np.errstate(all="ignore"):
        solid = np.abs(np.linalg.det(matrices)) > _FLAT * lengths.prod(-1)
        gram = matrices.transpose(0, 2, 1) @ matrices
        scale = np.trace(gram, axis1=1, axis2=2)[:, None, None] / 3
        similar = (np.abs(gram - scale * np.eye(3)) <= _SIMILAR * scale).all((1, 2))
    places: dict[int, list[int]] = {}
    for k, instance in enumerate(instances):
        moves = instance.transform_end is not None
        glows = any(any(getattr(m, "emission", ())) for m in instance.materials)
        # Normals that come from vertices are those of the world: they are carried over only if angles are kept.
        carries = instance.mesh.normals is not None or similar[k]
        if solid[k] and carries and not moves and not glows and len(instance.mesh.faces):
            places.setdefault(id(instance.mesh), []).append(k)
    several = [numbers for numbers in places.values() if len(numbers) > 1]
    spared = sum((len(numbers) - 1) * len(instances[numbers[0]].mesh.faces) for numbers in several)
    if sharing == "auto" and spared < max(_FEW, min(_A_SAMPLE * samples, _MOST)):
        return []
    return sorted(k for numbers in several for k in numbers)


class Copies:
    """Copies of meshes, and what the rest of the scene needs to know of them."""

    def __init__(self, scene: Scene, numbers: Sequence[int], dtype: np.dtype[Any]) -> None:
        chosen = set(numbers)
        self.rest = replace(scene, instances=tuple(i for k, i in enumerate(scene.instances) if k not in chosen))
        self.dtype = dtype
        self.numbers = np.array(numbers, np.int32)
        self._instances = [scene.instances[k] for k in numbers]
        for instance in self._instances:
            instance._check_ids()
        distinct = {id(i.mesh): i.mesh for i in self._instances}
        self._order = {key: k for k, key in enumerate(distinct)}
        self._meshes = [_single(m, dtype) for m in distinct.values()]
        trees = [BVH(m.positions, m.faces) for m in self._meshes]
        self._which = np.array([self._order[id(i.mesh)] for i in self._instances], np.int32)
        matrices = np.stack([i.transform for i in self._instances])
        self._tree = InstancedBVH([trees[k] for k in self._which], matrices)
        self.corners = self._corners(matrices)
        self._joined: tuple[SceneArrays, tuple[SceneArrays, Given]] | None = None

    def _corners(self, matrices: NDArray[np.float64]) -> NDArray[Any]:
        """Of the boxes of all copies, in the world: (8 N, 3)."""
        pick = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, 8).T
        boxes = np.stack([np.asarray(m.bounds, np.float64)[pick, np.arange(3)] for m in self._meshes])[self._which]
        placed = np.einsum("nij,nkj->nki", matrices[:, :3, :3], boxes) + matrices[:, None, :3, 3]
        return placed.reshape(-1, 3).astype(self.dtype)

    def join(self, arrays: SceneArrays) -> tuple[SceneArrays, Given]:
        """The arrays of the rest, those of the meshes behind them in their own space; copies as kernels take them."""
        joined = self._joined
        if joined is None or joined[0] is not arrays:
            # One store, since other threads may trace the same scene at other moments.
            joined = self._joined = arrays, self._join(arrays)
        return joined[1]

    def _join(self, arrays: SceneArrays) -> tuple[SceneArrays, Given]:
        from ..scene import _tables

        rows: dict[Any, int] = {m: k for k, m in enumerate(arrays.materials)}
        begin: dict[Any, int] = {}
        slots: list[int] = []
        for instance in self._instances:
            if instance.materials not in begin:
                begin[instance.materials] = len(slots)
                slots += [rows.setdefault(m, len(rows)) for m in instance.materials]
        first_slot = np.array([begin[i.materials] for i in self._instances], np.int32)
        faces = np.cumsum([len(arrays.faces)] + [len(m.faces) for m in self._meshes])
        vertices = np.cumsum([len(arrays.positions)] + [len(m.positions) for m in self._meshes])
        ids = [np.zeros(len(m.faces), np.int32) if m.material_ids is None else m.material_ids for m in self._meshes]
        colors = arrays.colors
        if colors is not None or any(m.colors is not None for m in self._meshes):
            parts = [np.ones((len(arrays.positions), 3)) if colors is None else colors]
            parts += [np.ones((len(m.positions), 3)) if m.colors is None else m.colors for m in self._meshes]
            colors = np.concatenate(parts).astype(self.dtype)
        joined = arrays._replace(
            positions=np.concatenate([arrays.positions, *(m.positions for m in self._meshes)]),
            faces=np.concatenate(
                [arrays.faces, *(m.faces + np.int32(v) for m, v in zip(self._meshes, vertices, strict=False))]
            ),
            normals=np.concatenate([arrays.normals, *(m.normals for m in self._meshes)]),
            colors=colors,
            material_ids=np.concatenate([arrays.material_ids, *ids]),
            materials=tuple(rows),
            **_tables(tuple(rows), self.dtype),
        )
        first_face = faces[:-1].astype(np.int32)[self._which]
        return joined, (self._tree._tree, [first_face, first_slot, np.array(slots, np.int32)])


def _single(mesh: Mesh, dtype: np.dtype[Any]) -> Mesh:
    """A mesh in the precision of the picture, with normals, of arrays of its own: the user may write to theirs."""
    positions, faces = np.array(mesh.positions, dtype, order="C"), mesh.faces.copy()
    normals = mesh.normals
    if normals is None:
        normals = np.nan_to_num(_mesh.vertex_normals(positions, faces), nan=0.0)
    others = {name: None if (a := getattr(mesh, name)) is None else a.copy() for name in ("colors", "material_ids")}
    return replace(mesh, positions=positions, faces=faces, normals=normals.astype(dtype), uvs=None, **others)
