"""Unit vectors in two numbers."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels

__all__ = ["octahedral_decode", "octahedral_encode"]


def octahedral_encode(
    directions: ArrayLike, bits: int | None = None, *, rounding: Literal["precise", "nearest"] = "precise"
) -> NDArray[Any]:
    """Encode directions as points of the square [-1, 1]², by unfolding the octahedron around the sphere.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Directions of any length.
    bits : int, optional
        Quantise each of the two numbers to a signed normalised integer (snorm) of 2 to 24 bits, as G-buffers do.
    rounding : {"precise", "nearest"}
        With `bits`: of the four codes around the point, the one whose direction is nearest; or the nearest code.

    Returns
    -------
    ndarray, shape (..., 2)
        Points of the square in the precision of the directions; or codes in [-(2^(bits-1) - 1), 2^(bits-1) - 1], as
        int8, int16 or int32.

    Raises
    ------
    TypeError, ValueError
        If the directions are not real or not of three components, or an option is out of its domain.

    Notes
    -----
    No length, NaN and infinity give NaN; as codes, -2^(bits-1), which snorm leaves unused. Without `bits`, decoding
    gives the direction back to 3 machine epsilons. With them, the largest and the mean angle between a direction and
    what is decoded, in degrees, over 4 million directions:

    ====  ================  ================  =====================
    bits  precise: largest  precise: mean     nearest: largest, mean
    ====  ================  ================  =====================
    6     2.608             1.289             3.893, 1.379
    8     0.6347            0.3147            0.9532, 0.3369
    10    0.1581            0.0782            0.2359, 0.0837
    12    0.0394            0.01953           0.05927, 0.0209
    14    0.00987           0.00488           0.01478, 0.00522
    16    0.002469          0.00122           0.003686, 0.001306
    ====  ================  ================  =====================

    Computed in the precision of the directions: float32 holds these figures up to 16 bits.

    References
    ----------
    Q. Meyer et al., *On Floating-Point Normal Vectors*, EGSR 2010. Z. Cigolle et al., *A Survey of Efficient
    Representations for Independent Unit Vectors*, JCGT 3(2), 2014.

    Examples
    --------
    >>> octahedral_encode([[0, 0, 1.0], [1, 1, 0], [0, 0.6, -0.8]])
    array([[0.        , 0.        ],
           [0.5       , 0.5       ],
           [0.57142857, 1.        ]])
    >>> octahedral_encode([0.6, 0, 0.8], bits=8)
    array([54,  0], dtype=int8)
    """
    _arrays.choice("rounding", rounding, ("precise", "nearest"))
    given = {"directions": (directions, 3)}
    if bits is None:
        return _arrays.elementwise(_kernels.octahedral_encode, given, [2])[0]
    n = _arrays.count("bits", bits, 2, 24)
    scale = float(2 ** (n - 1) - 1)
    (codes,) = _arrays.elementwise(_kernels.octahedral_quantize, given, [(2, np.int32)], rounding == "precise", scale)
    return codes.astype(np.int8 if n <= 8 else np.int16 if n <= 16 else np.int32, copy=False)


def octahedral_decode(codes: ArrayLike, bits: int | None = None, *, dtype: DTypeLike = np.float32) -> Floats:
    """Decode the unit vectors of `octahedral_encode`.

    Parameters
    ----------
    codes : array_like, shape (..., 2)
        Points of the square, or with `bits` integers.
    bits : int, optional
        Bits of each integer, 2 to 24.
    dtype : {float32, float64}
        Precision in which integers are decoded; points of the square are in their own.

    Returns
    -------
    ndarray, shape (..., 3)
        Unit vectors; NaN for points outside the square, and for the codes that snorm leaves unused.

    Raises
    ------
    TypeError, ValueError
        If the codes are not of two components, are integers without `bits` or numbers with fractions with them, or
        `bits` or `dtype` is out of its domain.

    Notes
    -----
    Every point of the square has a direction; its border folds onto itself, so that few directions have two codes.
    The length is 1 to 2 machine epsilons.

    References
    ----------
    Z. Cigolle et al., *A Survey of Efficient Representations for Independent Unit Vectors*, JCGT 3(2), 2014.

    Examples
    --------
    >>> octahedral_decode([[0, 0], [127, 127]], bits=8)
    array([[ 0.,  0.,  1.],
           [ 0.,  0., -1.]], dtype=float32)
    """
    array, kind = _arrays.array("codes", codes), _arrays.precision("dtype", dtype)
    if bits is None:
        if array.dtype.kind in "iub" and isinstance(codes, np.ndarray):
            raise TypeError(f"codes: expected bits= with integers, got dtype {array.dtype}")
        return _arrays.elementwise(_kernels.octahedral_decode, {"codes": (codes, 2)}, [3], 1.0)[0]
    if array.dtype.kind not in "iu":
        raise TypeError(f"codes: expected integers with bits=, got dtype {array.dtype}")
    scale = float(2 ** (_arrays.count("bits", bits, 2, 24) - 1) - 1)
    given = {"codes": (_arrays.floats("codes", array, kind), 2)}
    return _arrays.elementwise(_kernels.octahedral_decode, given, [3], scale)[0]
