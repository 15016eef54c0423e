"""Morton order, and the radix tree over it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import accel as _kernels

__all__ = ["RadixTree", "morton_decode", "morton_encode", "radix_tree"]


class RadixTree(NamedTuple):
    """A binary radix tree over n sorted codes: n - 1 inner nodes, of which the first is the root.

    Inner node `i` holds the codes `first[i]` to `last[i]`. Children below n - 1 are inner nodes; the child n - 1 + k is
    the leaf of code `k`.
    """

    first: NDArray[np.int32]
    last: NDArray[np.int32]
    left: NDArray[np.int32]
    right: NDArray[np.int32]
    parent: NDArray[np.int32]
    """Of inner nodes, then of leaves, (2 n - 1,); -1 at the root."""


def morton_encode(
    points: ArrayLike, bits: int = 63, *, lower: ArrayLike | None = None, upper: ArrayLike | None = None
) -> NDArray[Any]:
    """Morton codes: the bits of three cell numbers, interleaved, x lowest.

    Parameters
    ----------
    points : array_like, shape (..., 3)
        Cell numbers, if integers; else points, whose cells divide the box from `lower` to `upper`.
    bits : {30, 63}
        Ten or twenty-one bits an axis.
    lower, upper : array_like, shape (3,), optional
        The box of the cells; that of all points together, if not given. Not for cell numbers.

    Returns
    -------
    ndarray of uint32 or uint64, shape (...)
        Order along the curve is the order of these numbers.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, a cell number is out of range, a point is not finite or
        outside the box, or the box is empty.

    Notes
    -----
    Points on the upper side of the box belong to the last cell. An axis without extent has one cell. Cells are computed
    in double precision: a point within a rounding unit of a border may fall to either side. About 15 ns a
    point and thread, and as much again to find the box of all points.

    References
    ----------
    G. M. Morton, *A Computer Oriented Geodetic Data Base and a New Technique in File Sequencing*, IBM, 1966.

    Examples
    --------
    >>> morton_encode([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [3, 0, 0]], 30)
    array([0, 1, 2, 4, 9], dtype=uint32)
    >>> morton_encode([[0.1, 0.1, 0.9]], 30, lower=[0, 0, 0], upper=[1, 1, 1])
    array([613271772], dtype=uint32)
    """
    side = 1 << _axis_bits(bits)
    array = _arrays.array("points", points)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"points: expected shape (..., 3), got {array.shape}")
    if array.dtype.kind in "iu" and array.size:
        if lower is not None or upper is not None:
            raise ValueError(f"{'lower' if lower is not None else 'upper'}: cell numbers have no box")
        if array.min() < 0 or array.max() >= side:
            raise ValueError(f"points: expected cell numbers in [0, {side}), got {array.min()} to {array.max()}")
        cells = array.astype(np.uint64)
        codes = np.empty(array.shape[:-1], np.uint64)
        _kernels.morton_encode(np.ascontiguousarray(cells).reshape(-1, 3), codes.reshape(-1))
    else:
        codes = _encode(_arrays.floats("points", array).reshape(-1, 3), side, lower, upper).reshape(array.shape[:-1])
    return codes.astype(np.uint32) if bits == 30 else codes


def _axis_bits(bits: int) -> int:
    if _arrays.count("bits", bits) not in (30, 63):
        raise ValueError(f"bits: expected 30 or 63, got {bits}")
    return bits // 3


def _encode(p: Floats, side: int, lower: ArrayLike | None, upper: ArrayLike | None) -> NDArray[np.uint64]:
    corners = [None if c is None else _corner(n, c) for n, c in (("lower", lower), ("upper", upper))]
    codes = np.empty(len(p), np.uint64)
    if not len(p):
        return codes
    # Column by column: extremes along the short axis of an array are slow.
    least, most = (
        np.array([extreme(p[:, k]) for k in range(3)], np.float64) if c is None else c
        for c, extreme in zip(corners, (np.min, np.max), strict=True)
    )
    finite = bool(np.isfinite(least).all() and np.isfinite(most).all())
    if finite and (least > most).any():
        raise ValueError(f"upper: expected at least lower, {least.tolist()}, got {most.tolist()}")
    outside = _kernels.morton_encode_points(p, least.tolist(), most.tolist(), side, codes) if finite else 0
    if outside is not None:
        bad = p[~np.isfinite(p).all(-1)]
        if len(bad):
            raise ValueError(f"points: expected finite points, got {bad[0].tolist()}")
        raise ValueError(f"points: expected points between lower and upper, got {p[outside].tolist()}")
    return codes


def _corner(name: str, value: ArrayLike) -> Floats:
    corner = _arrays.vectors(name, value, 3, np.float64)
    if corner.shape != (3,) or not np.isfinite(corner).all():
        raise ValueError(f"{name}: expected three finite numbers, got {corner.tolist()}")
    return corner


def morton_decode(
    codes: ArrayLike, bits: int = 63, *, lower: ArrayLike | None = None, upper: ArrayLike | None = None
) -> NDArray[Any]:
    """The cells of Morton codes, or their centres.

    Parameters
    ----------
    codes : array_like of int, shape (...)
    bits : {30, 63}
        Ten or twenty-one bits an axis.
    lower, upper : array_like, shape (3,), optional
        The box that the cells divide. With both, centres of cells are returned.

    Returns
    -------
    ndarray of uint32 or uint64, or of float64, shape (..., 3)
        Cell numbers; or points within half a cell of those that were encoded.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or shape, or a code is out of range; if one of `lower` and `upper` is missing.

    Examples
    --------
    >>> morton_decode([0, 1, 2, 4, 9], 30)
    array([[0, 0, 0],
           [1, 0, 0],
           [0, 1, 0],
           [0, 0, 1],
           [3, 0, 0]], dtype=uint32)
    """
    side = 1 << _axis_bits(bits)
    array = _arrays.array("codes", codes)
    if array.dtype.kind not in "iu" and array.size:
        raise TypeError(f"codes: expected integers, got dtype {array.dtype}")
    if array.size and (array.min() < 0 or int(array.max()) >= 1 << bits):
        raise ValueError(f"codes: expected codes in [0, 2**{bits}), got {array.min()} to {array.max()}")
    corners = [None if c is None else _corner(n, c) for n, c in (("lower", lower), ("upper", upper))]
    if (lower is None) != (upper is None):
        raise ValueError("lower, upper: expected both corners of the box, or none")
    cells = np.empty((*array.shape, 3), np.uint64)
    _kernels.morton_decode(np.ascontiguousarray(array.astype(np.uint64)).reshape(-1), cells.reshape(-1, 3))
    least, most = corners
    if least is None or most is None:
        return cells.astype(np.uint32) if bits == 30 else cells
    weight = (cells + 0.5) / side
    return (1 - weight) * least + weight * most


def radix_tree(codes: ArrayLike) -> RadixTree:
    """The binary radix tree over sorted codes: every inner node is a common prefix, found without the others.

    Parameters
    ----------
    codes : array_like of int, shape (n,)
        In rising order, not negative; equal codes are told apart by their places. At least two.

    Returns
    -------
    RadixTree
        Arrays of n - 1 inner nodes, and the parents of all nodes.

    Raises
    ------
    TypeError, ValueError
        If the codes are not integers, not a list of at least two, negative, or not sorted.

    Notes
    -----
    Nodes are found in parallel, each in time logarithmic in what it holds: about 100 ns a node and thread.
    `BVH(method="lbvh")` cuts intervals of codes at the same places, without storing the tree.

    References
    ----------
    T. Karras, *Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees*, High-Performance Graphics,
    2012.

    Examples
    --------
    >>> tree = radix_tree([1, 2, 4, 5, 19, 24, 25, 30])
    >>> tree.left.tolist(), tree.right.tolist()
    ([3, 7, 9, 1, 11, 6, 12], [4, 8, 10, 2, 5, 14, 13])
    """
    array = _arrays.array("codes", codes)
    if array.dtype.kind not in "iu":
        raise TypeError(f"codes: expected integers, got dtype {array.dtype}")
    if array.ndim != 1 or not 2 <= array.size < 2**30:
        raise ValueError(f"codes: expected shape (n,) with n at least 2, got {array.shape}")
    if array[0] < 0 or (array[1:] < array[:-1]).any():
        raise ValueError("codes: expected numbers that are not negative, in rising order")
    n = array.size
    nodes = np.empty((n - 1, 4), np.int32)
    _kernels.radix_tree(np.ascontiguousarray(array.astype(np.uint64)), nodes)
    first, last, left, right = (np.ascontiguousarray(column) for column in nodes.T)
    parent = np.full(2 * n - 1, -1, np.int32)
    parent[left] = parent[right] = np.arange(n - 1, dtype=np.int32)
    return RadixTree(first, last, left, right, parent)
