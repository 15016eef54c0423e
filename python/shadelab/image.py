"""Pictures as arrays: filters, sums over rectangles, pyramids, and how far two pictures differ."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._arrays import Floats
from ._kernels import image as _kernels

__all__ = [
    "FlipError",
    "flip_error",
    "gaussian_filter",
    "mip_chain",
    "relative_mse",
    "rmse",
    "smape",
    "summed_area_table",
]

Border: TypeAlias = Literal["nearest", "reflect", "wrap"]
_MAX_REACH = 4096


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


def _channels(image: ArrayLike) -> tuple[Floats, Floats]:
    """A picture, and the same with an axis of channels."""
    given = _arrays.image("image", image)
    return given, given[..., None] if given.ndim == 2 else given


def gaussian_filter(
    image: ArrayLike,
    sigma: float | tuple[float, float],
    *,
    truncate: float = 4.0,
    border: Border = "nearest",
    out: Floats | None = None,
) -> Floats:
    """Blur by a Gaussian, along rows and then along columns.

    Parameters
    ----------
    image : array_like, shape (H, W) or (H, W, C)
        Linear values. Their precision is that of the sums.
    sigma : float or (float, float)
        Standard deviation in pixels, of both axes or of (across, down); 0 leaves an axis as it is.
    truncate : float
        Weights beyond so many sigma, rounded to whole pixels, are left out, and the others sum to 1.
    border : {"nearest", "reflect", "wrap"}
        What stands for pixels beyond the border: the nearest one, the picture mirrored, or the picture repeated.
    out : ndarray, optional
        The array to write into, not the image itself.

    Returns
    -------
    ndarray, the shape of image

    Raises
    ------
    TypeError, ValueError
        If the picture holds integers, an argument is out of range, or the filter would reach beyond 4096 pixels.

    Notes
    -----
    Within 6 roundings of the largest value of the sum in exact arithmetic. NaN and infinity spread as far as the filter
    reaches. Cost: 2 truncate sigma additions and half as many multiplications a value and axis; the picture is read
    once and written once.

    Examples
    --------
    >>> import numpy as np
    >>> dot = np.zeros((3, 5))
    >>> dot[1, 2] = 1
    >>> gaussian_filter(dot, (1.0, 0.0), truncate=1.0)[1].round(3)
    array([0.   , 0.274, 0.452, 0.274, 0.   ])
    """
    given, pixels = _channels(image)
    pair = (sigma, sigma) if np.ndim(sigma) == 0 else tuple(sigma)  # type: ignore[arg-type]
    if len(pair) != 2:
        raise ValueError(f"sigma: expected a number or a pair, got {sigma!r}")
    sigmas = [_arrays.number("sigma", s, 0.0) for s in pair]
    cut = _arrays.number("truncate", truncate, 0.0)
    if max(sigmas) * cut > _MAX_REACH:
        # Named is what is out of the ordinary.
        name = "truncate" if cut > 10.0 and max(sigmas) * 10.0 <= _MAX_REACH else "sigma"
        raise ValueError(f"{name}: expected a reach of at most {_MAX_REACH} pixels, got {max(sigmas) * cut:g}")
    _arrays.choice("border", border, ("nearest", "reflect", "wrap"))
    result = _arrays.output("out", out, given.shape, given.dtype)
    (pixels,) = _arrays.apart(result, pixels)
    _kernels.gaussian_filter(pixels, sigmas, cut, border, result.reshape(pixels.shape))
    return result


def mip_chain(image: ArrayLike, fold: Literal["mean", "min", "max"] = "mean") -> tuple[Floats, ...]:
    """A picture at half the size, again and again, down to a single pixel.

    Parameters
    ----------
    image : array_like, shape (H, W) or (H, W, C)
        Linear values, at least one.
    fold : {"mean", "min", "max"}
        What a pixel holds of those that it covers.

    Returns
    -------
    tuple of ndarray
        The picture itself, then every level; sides are halved and rounded down, but not below 1.

    Raises
    ------
    TypeError, ValueError
        If the picture holds integers, is empty, or has another shape.

    Notes
    -----
    A side of odd length 2 n + 1 becomes n pixels that cover 2 + 1 / n of the finer ones each, weighted by the share
    that is covered: every level has the mean of the picture. "min" and "max" take all that is touched, so that they are
    bounds. A third more memory than the picture. NaN spreads to all that covers it.

    References
    ----------
    L. Williams, *Pyramidal Parametrics*, SIGGRAPH 1983. S. Guthe, P. Heckbert, *Non-Power-of-Two Mipmapping*, NVIDIA,
    2005.

    Examples
    --------
    >>> [level.shape for level in mip_chain([[1.0, 2, 3], [4, 5, 6]])]
    [(2, 3), (1, 1)]
    >>> mip_chain([[1.0, 2, 3, 4], [5, 6, 7, 8]], "max")[1]
    array([[6., 8.]])
    """
    given, level = _channels(image)
    _arrays.choice("fold", fold, ("mean", "min", "max"))
    if given.size == 0:
        raise ValueError(f"image: expected at least one value, got shape {given.shape}")
    chain = [given]
    while max(level.shape[:2]) > 1:
        height, width, channels = level.shape
        coarse = np.empty((max(height // 2, 1), max(width // 2, 1), channels), given.dtype)
        _kernels.mip_chain(level, fold, coarse)
        chain.append(coarse if given.ndim == 3 else coarse[..., 0])
        level = coarse
    return tuple(chain)


def summed_area_table(
    image: ArrayLike,
    *,
    precision: Literal["double", "compensated", "single"] = "double",
    out: Floats | None = None,
) -> Floats:
    """Sums over all rectangles at once: any sum over a rectangle is then a sum of four entries.

    Parameters
    ----------
    image : array_like, shape (H, W) or (H, W, C)
        Linear values.
    precision : {"double", "compensated", "single"}
        Sums in double, stored so; sums in double, each rounded once to float32; or plain sums in float32.
    out : ndarray, optional
        The array to write into.

    Returns
    -------
    ndarray, shape (H + 1, W + 1) or (H + 1, W + 1, C)
        ``table[i, j]`` is the sum of ``image[:i, :j]``; so the sum of ``image[i:k, j:l]`` is
        ``table[k, l] - table[i, l] - table[k, j] + table[i, j]``.

    Raises
    ------
    TypeError, ValueError
        If the picture holds integers or has another shape.

    Notes
    -----
    Entries grow with the picture, rectangles do not: of a small one, single precision keeps little. For float32 values
    in [0, 1] over 2048² pixels the mean of a 9 x 9 square is off by up to 3e-3 with "compensated", 8e-3 with "single",
    and not at all with "double". NaN or infinity spoils all entries below and to the right. Cost: the picture is read
    once, the table written once; that is all there is to it, so that memory's speed decides: as fast as OpenCV's.

    References
    ----------
    F. Crow, *Summed-Area Tables for Texture Mapping*, SIGGRAPH 1984. J. Hensley et al., *Fast Summed-Area Table
    Generation and its Applications*, Eurographics 2005 (precision).

    Examples
    --------
    >>> table = summed_area_table([[1.0, 2, 3], [4, 5, 6]])
    >>> table[2, 3] - table[0, 3] - table[2, 1] + table[0, 1]
    np.float64(16.0)
    """
    given, pixels = _channels(image)
    wide = _arrays.choice("precision", precision, ("double", "compensated", "single"))
    height, width, channels = pixels.shape
    shape = (height + 1, width + 1, channels)
    result = _arrays.output("out", out, shape[: given.ndim], np.float64 if wide == "double" else np.float32)
    _kernels.summed_area_table(pixels, wide != "single", result.reshape(shape))
    return result
