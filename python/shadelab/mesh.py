"""The triangle mesh: normals and primitives. Faces are counter-clockwise seen from outside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _arrays, transform
from ._arrays import Floats
from ._kernels import mesh as _kernels

__all__ = ["Mesh", "box", "face_normals", "icosphere", "plane", "torus", "vertex_normals"]


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh: validated arrays.

    Parameters
    ----------
    positions : array_like, shape (V, 3)
        Their precision is that of the mesh.
    faces : array_like of integers, shape (F, 3)
        Indices of vertices, counter-clockwise seen from outside. Held as int32.
    normals : array_like, shape (V, 3), optional
        Shading normals, of unit length; None shades by `vertex_normals`. Where one is not finite or zero, as
        `vertex_normals` may leave them, that of the face takes its place.
    uvs : array_like, shape (V, 2), optional
        Texture coordinates; (0, 0) is the bottom left corner.
    colors : array_like, shape (V, 3), optional
        Linear base colours in [0, 1], which multiply those of the material.
    material_ids : array_like of integers, shape (F,), optional
        Which of an instance's materials each face has; None means the first.

    Raises
    ------
    TypeError
        If an array is not of numbers, or indices are not integers.
    ValueError
        If a shape does not fit, a position, texture coordinate or colour is not finite, or an index is out of range:
        the first is named.

    Examples
    --------
    >>> m = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> m.triangles.shape, m.positions.dtype
    ((1, 3, 3), dtype('float64'))
    """

    positions: Floats
    faces: NDArray[np.int32]
    normals: Floats | None = None
    uvs: Floats | None = None
    colors: Floats | None = None
    material_ids: NDArray[np.int32] | None = None

    def __post_init__(self) -> None:
        positions = _rows("positions", self.positions, 3)
        _finite("positions", positions)
        count = len(positions)
        set_ = object.__setattr__
        set_(self, "positions", positions)
        set_(self, "faces", _arrays.indices("faces", self.faces, 3, count).reshape(-1, 3))
        for name, width in (("normals", 3), ("uvs", 2), ("colors", 3)):
            value = getattr(self, name)
            if value is not None:
                array = _rows(name, value, width, positions.dtype)
                if len(array) != count:
                    raise ValueError(f"{name}: expected shape ({count}, {width}), got {array.shape}")
                if name != "normals":
                    _finite(name, array)
                if name == "colors":
                    _in_unit(name, array)
                set_(self, name, array)
        if self.material_ids is not None:
            ids = _arrays.indices("material_ids", self.material_ids)
            if ids.shape != (len(self.faces),):
                raise ValueError(f"material_ids: expected shape ({len(self.faces)},), got {ids.shape}")
            set_(self, "material_ids", ids)

    def __repr__(self) -> str:
        extras = [n for n in ("normals", "uvs", "colors", "material_ids") if getattr(self, n) is not None]
        with_ = f" with {', '.join(extras)}" if extras else ""
        return f"Mesh({len(self.positions)} vertices, {len(self.faces)} faces, {self.dtype}{with_})"

    @property
    def dtype(self) -> np.dtype[Any]:
        """float32 or float64."""
        return cast("np.dtype[Any]", self.positions.dtype)

    @property
    def triangles(self) -> Floats:
        """The corners of each face, shape (F, 3, 3)."""
        return self.positions[self.faces]

    @property
    def bounds(self) -> Floats:
        """The lowest and the highest corner of the box around all faces, shape (2, 3).

        Raises
        ------
        ValueError
            If there is no face.
        """
        if not len(self.faces):
            raise ValueError("bounds: the mesh has no faces")
        used = self.positions[np.unique(self.faces)]
        return np.stack([used.min(0), used.max(0)])

    def astype(self, dtype: DTypeLike) -> Mesh:
        """The mesh in another precision: float32 or float64."""
        target = np.dtype(dtype)
        if target not in (np.dtype(np.float32), np.dtype(np.float64)):
            raise TypeError(f"dtype: expected float32 or float64, got {target}")

        def convert(a: Floats | None) -> Floats | None:
            return None if a is None else a.astype(target)

        return self._with(
            positions=self.positions.astype(target),
            normals=convert(self.normals),
            uvs=convert(self.uvs),
            colors=convert(self.colors),
        )

    def _with(self, positions: Floats, **others: Any) -> Mesh:
        """The mesh with arrays that fit it, but that positions may overflow; checking all took most of a flattening."""
        _finite("positions", positions)
        made = object.__new__(Mesh)
        made.__dict__.update(self.__dict__, positions=positions, **others)
        return made

    def transformed(self, matrix: ArrayLike) -> Mesh:
        """The mesh through an affine matrix (4, 4). A mirroring turns faces round, so that outside stays outside."""
        m = _arrays.matrices("matrix", matrix, 4, np.float64)
        if m.ndim != 2:
            raise ValueError(f"matrix: expected shape (4, 4), got {m.shape}")
        mirrored = np.linalg.det(m[:3, :3]) < 0
        positions = transform.transform_points(self.positions, m)
        faces = np.ascontiguousarray(self.faces[:, ::-1]) if mirrored else self.faces
        normals = None if self.normals is None else transform.transform_normals(self.normals, m)
        if normals is not None and not np.isfinite(normals).all():
            # A flattening leaves no inverse: what is left of the faces tells the normals.
            lost = ~np.isfinite(normals).all(-1)
            left = vertex_normals(positions, faces)[lost]
            normals[lost] = np.where(np.isfinite(left).all(-1, keepdims=True), left, 0.0)
        return self._with(positions=positions, normals=normals, faces=faces)


def _rows(name: str, value: ArrayLike, width: int, dtype: DTypeLike | None = None) -> Floats:
    array = _arrays.floats(name, value, dtype)
    if array.size == 0:
        array = array.reshape(0, width)
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"{name}: expected shape (V, {width}), got {array.shape}")
    return array


def _finite(name: str, array: Floats) -> None:
    bad = ~np.isfinite(array)
    if bad.any():
        row = int(np.argwhere(bad)[0][0])
        raise ValueError(f"{name}: vertex {row} is not finite: {array[row].tolist()}")


def _in_unit(name: str, array: Floats) -> None:
    # Rounding may pass the ends.
    bad = (array < -1e-5) | (array > 1 + 1e-5)
    if bad.any():
        row = int(np.argwhere(bad)[0][0])
        raise ValueError(f"{name}: vertex {row} is not in [0, 1]: {array[row].tolist()}")


def _checked(positions: ArrayLike, faces: ArrayLike) -> tuple[Floats, NDArray[np.int32]]:
    p = _rows("positions", positions, 3)
    return p, _arrays.indices("faces", faces, 3, len(p)).reshape(-1, 3)


def face_normals(positions: ArrayLike, faces: ArrayLike, *, out: NDArray[Any] | None = None) -> Floats:
    """The unit normal of each face, by the right-hand rule.

    Parameters
    ----------
    positions : array_like, shape (V, 3)
    faces : array_like of integers, shape (F, 3)
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray, shape (F, 3)
        NaN where a face has no area.

    Raises
    ------
    TypeError, ValueError
        If an argument is of the wrong type or shape, or an index out of range.

    Notes
    -----
    Any scale: edges are brought to unit size first. The error is about a rounding unit times the ratio of the second
    shortest edge to the face's height. About 5 ns a face and thread.

    Examples
    --------
    >>> face_normals([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]) + 0.0
    array([[0., 0., 1.]])
    """
    p, f = _checked(positions, faces)
    result = _arrays.output("out", out, (len(f), 3), p.dtype)
    _kernels.face_normals(p, f, result)
    return result


def vertex_normals(
    positions: ArrayLike,
    faces: ArrayLike,
    *,
    weights: Literal["angle", "area", "uniform"] = "angle",
    out: NDArray[Any] | None = None,
) -> Floats:
    """Unit normals of vertices: weighted means of the normals of the faces around each.

    Parameters
    ----------
    positions : array_like, shape (V, 3)
    faces : array_like of integers, shape (F, 3)
    weights : {"angle", "area", "uniform"}
        By the angle of each face's corner at the vertex, which does not depend on how a flat region is cut into
        triangles; by the face's area; or all alike.
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray, shape (V, 3)
        NaN at a vertex without a face of some area, and where normals cancel.

    Raises
    ------
    TypeError, ValueError
        If an argument is of the wrong type or shape, or an index out of range.

    Notes
    -----
    Sums are taken in double precision in the order of the faces, so that the result does not depend on threads.
    About 30 ns a face.

    References
    ----------
    G. Thürmer, C. Wüthrich, *Computing vertex normals from polygonal facets*, 1998.

    Examples
    --------
    >>> cube = box()
    >>> bool(np.allclose(vertex_normals(cube.positions, cube.faces), cube.normals))
    True
    """
    p, f = _checked(positions, faces)
    _arrays.choice("weights", weights, ("angle", "area", "uniform"))
    result = _arrays.output("out", out, (len(p), 3), p.dtype)
    _kernels.vertex_normals(p, f, weights, result)
    return result


def _primitive(name: str, lengths: Sequence[float], numbers: Sequence[int], uvs: bool, dtype: DTypeLike) -> Mesh:
    vertices, faces = _kernels.counts(name, list(numbers))
    positions, normals = np.empty((vertices, 3), dtype), np.empty((vertices, 3), dtype)
    coordinates = np.empty((vertices, 2), dtype) if uvs else None
    indices = np.empty((faces, 3), np.int32)
    _kernels.primitive(name, list(lengths), list(numbers), positions, normals, coordinates, indices)
    return Mesh(positions, indices, normals, coordinates)


def _lengths(name: str, value: float | Sequence[float], n: int) -> list[float]:
    if np.ndim(value) == 0:
        return [_arrays.number(name, value, above=0)] * n
    numbers = [_arrays.number(name, v, above=0) for v in cast("Sequence[float]", value)]
    if len(numbers) != n:
        raise ValueError(f"{name}: expected one number or {n}, got {len(numbers)}")
    return numbers


def box(size: float | Sequence[float] = 1.0, *, dtype: DTypeLike = np.float64) -> Mesh:
    """An axis-aligned box about the origin, of 24 vertices, so that each side has its own normals and texture.

    Parameters
    ----------
    size : float or sequence of 3 floats
        Edge lengths along x, y, z.
    dtype : data type
        float32 or float64.

    Returns
    -------
    Mesh
        Closed, with normals and texture coordinates.

    Raises
    ------
    TypeError, ValueError
        If a length is not a positive number.

    Examples
    --------
    >>> box((1.0, 2.0, 3.0)).bounds
    array([[-0.5, -1. , -1.5],
           [ 0.5,  1. ,  1.5]])
    """
    return _primitive("box", _lengths("size", size, 3), [], True, dtype)


def plane(size: float | Sequence[float] = 1.0, segments: int = 1, *, dtype: DTypeLike = np.float64) -> Mesh:
    """A square grid in the plane y = 0 about the origin, facing +y.

    Parameters
    ----------
    size : float or sequence of 2 floats
        Lengths along x and z.
    segments : int
        Cells along each side, each of two triangles.
    dtype : data type
        float32 or float64.

    Returns
    -------
    Mesh
        Open, with normals and texture coordinates, (0, 0) at (-x, +z).

    Raises
    ------
    TypeError, ValueError
        If a length is not a positive number, or segments not from 1 to 20000.

    Examples
    --------
    >>> plane(2.0, segments=4)
    Mesh(25 vertices, 32 faces, float64 with normals, uvs)
    """
    return _primitive("plane", _lengths("size", size, 2), [_arrays.count("segments", segments, 1, 20000)], True, dtype)


def icosphere(subdivisions: int = 3, radius: float = 1.0, *, dtype: DTypeLike = np.float64) -> Mesh:
    """A sphere about the origin: an icosahedron, each face cut in four, `subdivisions` times.

    Parameters
    ----------
    subdivisions : int
        0 to 10: 20 · 4**subdivisions faces.
    radius : float
    dtype : data type
        float32 or float64.

    Returns
    -------
    Mesh
        Closed, with exact normals; vertices are on the sphere to a rounding unit.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Examples
    --------
    >>> icosphere(2)
    Mesh(162 vertices, 320 faces, float64 with normals)
    """
    numbers = [_arrays.count("subdivisions", subdivisions, 0, 10)]
    return _primitive("icosphere", [_arrays.number("radius", radius, above=0)], numbers, False, dtype)


def torus(
    radius: float = 1.0, tube: float = 0.4, segments: int = 64, sides: int = 32, *, dtype: DTypeLike = np.float64
) -> Mesh:
    """A torus about the y axis.

    Parameters
    ----------
    radius : float
        From the axis to the centre of the tube.
    tube : float
        Radius of the tube, below `radius`.
    segments, sides : int
        Around the axis and around the tube, 3 to 20000.
    dtype : data type
        float32 or float64.

    Returns
    -------
    Mesh
        Closed, with exact normals.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Examples
    --------
    >>> torus(segments=8, sides=6)
    Mesh(48 vertices, 96 faces, float64 with normals)
    """
    lengths = [_arrays.number("radius", radius, above=0), _arrays.number("tube", tube, above=0, below=radius)]
    numbers = [_arrays.count("segments", segments, 3, 20000), _arrays.count("sides", sides, 3, 20000)]
    return _primitive("torus", lengths, numbers, False, dtype)
