"""Where shading is done: at faces, at vertices, or at pixels."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import mesh
from .._arrays import Floats
from ._buffers import Seen

FREQUENCIES = ("flat", "gouraud", "phong")


class Coarse:
    """Fewer receivers that stand for those of pixels: the middles of faces, or vertices."""

    def __init__(self, seen: Seen, arrays: Any, eye: Floats, frequency: str) -> None:
        used, self._place = np.unique(seen.face[seen.covered], return_inverse=True)
        faces, material = arrays.faces[used], arrays.material_ids[used]
        geometric = np.nan_to_num(mesh.face_normals(arrays.positions, arrays.faces))[used]
        corners = arrays.positions[faces]
        self._weights: NDArray[Any] | None = None
        if frequency == "flat":
            points, normals = corners.mean(1, dtype=corners.dtype), geometric
            colors = None if arrays.colors is None else arrays.colors[faces].mean(1)
        else:
            # A vertex is shaded once for each material that it bears.
            count = len(arrays.materials)
            keys = faces.astype(np.int64) * count + material[:, None]
            pairs, self._corners = np.unique(keys, return_inverse=True)
            self._corners = self._corners.reshape(-1, 3)
            vertex, material = pairs // count, (pairs % count).astype(np.int32)
            points, normals = arrays.positions[vertex], arrays.normals[vertex]
            colors = None if arrays.colors is None else arrays.colors[vertex]
            u, v = seen.u[:, None], seen.v[:, None]
            self._weights = np.stack([1 - u - v, u, v], 1)
        away = points - eye
        if frequency == "flat":
            inside = np.einsum("ij,ij->i", normals, away) > 0
            normals = np.where(inside[:, None], -normals, normals)
        else:
            # Where a vertex bears a seen face but looks away itself, its normal is brought up to the horizon.
            towards = -away / np.maximum(np.linalg.norm(away, axis=-1, keepdims=True), 1e-30)
            cosine = np.einsum("ij,ij->i", normals, towards)[:, None]
            normals = np.where(cosine < 1e-3, normals + (1e-3 - cosine) * towards, normals)
            normals = normals / np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-30)
            inside = np.zeros(len(points), bool)
        points, normals = (np.ascontiguousarray(x, np.float32) for x in (points, normals))
        self.receivers = replace(
            seen,
            points=points,
            shading=normals,
            geometric=normals,
            inside=inside,
            colors=None if colors is None else np.ascontiguousarray(colors, np.float32),
            material=np.ascontiguousarray(material, np.int32),
        )

    def spread(self, values: Floats) -> Floats:
        """Values of the few as those of pixels: of their face, or between its vertices."""
        if self._weights is None:
            return values[self._place]
        found = np.zeros((len(self._place), values.shape[1]), values.dtype)
        corners = self._corners[self._place]
        for k in range(3):
            found += values[corners[:, k]] * self._weights[:, k]
        return found
