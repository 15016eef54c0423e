"""Pictures as arrays: how far two of them differ."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._arrays import Floats
from ._kernels import image as _kernels

__all__ = ["FlipError", "flip_error", "relative_mse", "rmse", "smape"]


def _pair(image: ArrayLike, reference: ArrayLike) -> tuple[Floats, Floats]:
    dtype = _arrays.result_dtype(image=image, reference=reference)
    a, b = _arrays.image("image", image, dtype=dtype), _arrays.image("reference", reference, dtype=dtype)
    if a.shape != b.shape:
        raise ValueError(f"reference: expected the shape of image, {a.shape}, got {b.shape}")
    if a.size == 0:
        raise ValueError(f"image: expected at least one value, got shape {a.shape}")
    return a, b


def _mean(metric: str, image: ArrayLike, reference: ArrayLike, mask: ArrayLike | None, epsilon: float) -> float:
    a, b = _pair(image, reference)
    channels = a.shape[2] if a.ndim == 3 else 1
    chosen: NDArray[Any] | None = None
    if mask is not None:
        chosen = np.require(mask, requirements=["C", "A"])
        if chosen.dtype != bool:
            raise TypeError(f"mask: expected booleans, got dtype {chosen.dtype}")
        if chosen.shape != a.shape[:2]:
            raise ValueError(f"mask: expected shape {a.shape[:2]}, got {chosen.shape}")
        if not chosen.any():
            raise ValueError("mask: selects no pixel")
    return _kernels.mean_error(metric, epsilon, a, b, channels, chosen)


def rmse(image: ArrayLike, reference: ArrayLike, mask: ArrayLike | None = None) -> float:
    """Root mean square error, in the unit of the pictures.

    Parameters
    ----------
    image, reference : array_like, shape (H, W) or (H, W, C)
        Linear values of one shape.
    mask : array_like of bool, shape (H, W), optional
        The pixels that count; all by default.

    Returns
    -------
    float
        The square root of the mean of (image - reference)² over pixels and channels.

    Raises
    ------
    TypeError, ValueError
        If a picture holds integers, shapes differ, or the mask selects no pixel.

    Notes
    -----
    Summed in double with compensation: relative error below 1e-12 at any size. NaN or infinity in a masked pixel
    gives NaN or infinity. Against a noisy reference it contains the reference's own noise. Time: about 1 ns a value.

    References
    ----------
    A. Neumaier, *Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen*, 1974 (the summation).

    Examples
    --------
    >>> rmse([[0.0, 3.0]], [[4.0, 3.0]])
    2.8284271247461903
    """
    return float(np.sqrt(_mean("square", image, reference, mask, 0.0)))


def relative_mse(
    image: ArrayLike, reference: ArrayLike, mask: ArrayLike | None = None, *, epsilon: float = 0.01
) -> float:
    """Mean squared error relative to the reference's square: bright and dark regions count alike.

    Parameters
    ----------
    image, reference : array_like, shape (H, W) or (H, W, C)
        Linear values of one shape.
    mask : array_like of bool, shape (H, W), optional
        The pixels that count; all by default.
    epsilon : float
        Added to the reference's square, in its unit squared, so that black pixels do not dominate. Positive.

    Returns
    -------
    float
        The mean of (image - reference)² / (reference² + epsilon).

    Raises
    ------
    TypeError, ValueError
        If a picture holds integers, shapes differ, the mask selects no pixel, or `epsilon` is not positive.

    Notes
    -----
    Summed as `rmse` is. The value depends on `epsilon` where the reference is below its root. About 1 ns a value.

    References
    ----------
    F. Rousselle, C. Knaus, M. Zwicker, *Adaptive Sampling and Reconstruction using Greedy Error Minimization*, 2011.

    Examples
    --------
    >>> round(relative_mse([[1.1]], [[1.0]], epsilon=1e-9), 6)
    0.01
    """
    epsilon = _arrays.number("epsilon", epsilon, above=0.0)
    return float(_mean("relative_square", image, reference, mask, epsilon))


def smape(image: ArrayLike, reference: ArrayLike, mask: ArrayLike | None = None) -> float:
    """Symmetric mean absolute percentage error, from 0 to 1.

    Parameters
    ----------
    image, reference : array_like, shape (H, W) or (H, W, C)
        Linear values of one shape.
    mask : array_like of bool, shape (H, W), optional
        The pixels that count; all by default.

    Returns
    -------
    float
        The mean of |image - reference| / (|image| + |reference|), 0 where both are 0.

    Raises
    ------
    TypeError, ValueError
        If a picture holds integers, shapes differ, or the mask selects no pixel.

    Notes
    -----
    Summed as `rmse` is. Bounded, so fireflies cannot dominate; black against anything counts fully. About 1 ns a value.

    References
    ----------
    B. E. Flores, *A Pragmatic View of Accuracy Measurement in Forecasting*, 1986.

    Examples
    --------
    >>> smape([[3.0, 0.0]], [[1.0, 0.0]])
    0.25
    """
    return float(_mean("symmetric_relative", image, reference, mask, 0.0))


class FlipError(NamedTuple):
    """The FLIP difference: its mean, and its map."""

    mean: float
    """From 0 (no difference seen) to 1."""
    map: NDArray[np.float32]
    """The error of each pixel, shape (H, W)."""


def flip_error(
    image: ArrayLike,
    reference: ArrayLike,
    *,
    dynamic_range: Literal["hdr", "ldr"] = "hdr",
    pixels_per_degree: float = 67.0,
) -> FlipError:
    """The difference that a person sees when flipping between two pictures, by the FLIP authors' own evaluator.

    Parameters
    ----------
    image, reference : array_like, shape (H, W, 3)
        For "hdr" linear values, not negative; for "ldr" sRGB-encoded values in [0, 1].
    dynamic_range : {"hdr", "ldr"}
        HDR-FLIP takes the largest error over a range of exposures, LDR-FLIP compares display values.
    pixels_per_degree : float
        Of visual angle: 67 is a 0.7 m wide 4K screen seen from 0.7 m. Positive.

    Returns
    -------
    FlipError
        `mean` and `map`.

    Raises
    ------
    ImportError
        If flip-evaluator is missing.
    TypeError, ValueError
        If pictures hold integers, differ in shape, are not finite, or are out of the range named above; for "hdr" also
        if the reference is black (nothing above 1e-6) and `image` is not the same.

    Notes
    -----
    Computed in float32 whatever the input. Cost is far above the other metrics': about 1 µs a pixel for "hdr".

    References
    ----------
    P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild, *FLIP: A Difference
    Evaluator for Alternating Images*, 2020; and *Visualizing Errors in Rendered High Dynamic Range Images*, 2021.

    Examples
    --------
    >>> import numpy as np
    >>> grey = np.full((8, 8, 3), 0.5)
    >>> flip_error(grey, grey).mean
    0.0
    """
    _arrays.choice("dynamic_range", dynamic_range, ("hdr", "ldr"))
    ppd = _arrays.number("pixels_per_degree", pixels_per_degree, above=0.0)
    a, b = _pair(image, reference)
    for name, picture in (("image", a), ("reference", b)):
        _arrays.image(name, picture, 3)
        high = np.inf if dynamic_range == "hdr" else 1.0
        if not np.isfinite(picture).all() or picture.min() < 0 or picture.max() > high:
            expected = "finite values, not negative" if dynamic_range == "hdr" else "values in [0, 1]"
            raise ValueError(f"{name}: expected {expected}, got {picture.min()} to {picture.max()}")
    # Its exposures are found from the reference's brightest and median light, and the evaluator ends the process where
    # there is none.
    if dynamic_range == "hdr" and b.max() < 1e-6:
        if np.array_equal(a, b):
            return FlipError(0.0, np.zeros(a.shape[:2], np.float32))
        raise ValueError(
            f"reference: expected light of at least 1e-6 to choose exposures from, got {b.max():g} at most"
        )
    try:
        import flip_evaluator
    except ImportError:
        raise ImportError("flip_error needs flip-evaluator: pip install 'shadelab[study]'") from None
    error, mean, _ = flip_evaluator.evaluate(
        b.astype(np.float32),
        a.astype(np.float32),
        dynamic_range.upper(),
        applyMagma=False,
        parameters={"ppd": ppd},
    )
    return FlipError(float(mean), np.asarray(error, np.float32).reshape(a.shape[:2]))
