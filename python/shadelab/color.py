"""Colour: transfer functions, luminance, tone mapping.

Values are linear and scene-referred unless a function says otherwise, with sRGB (Rec. 709) primaries and white D65.
"""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._arrays import Floats
from ._kernels import color as _kernels

__all__ = ["decode_transfer", "encode_transfer", "luminance", "tone_map"]

Transfer: TypeAlias = Literal["srgb", "gamma"]
ToneMap: TypeAlias = Literal["clip", "reinhard", "reinhard_extended", "aces"]


def _light(name: str, values: ArrayLike) -> Floats:
    """Radiometric values of any shape; integer codes are refused, since their scale would be a guess."""
    if getattr(values, "dtype", None) is not None and values.dtype.kind in "iub":  # type: ignore[union-attr]
        raise TypeError(f"{name}: expected floating-point values, got integers; divide 8-bit codes by 255.0 first")
    return _arrays.floats(name, values)


def _transfer(name: str, curve: str, exponent: float, values: ArrayLike, out: NDArray[Any] | None) -> Floats:
    x = _light(name, values)
    result = _arrays.output("out", out, x.shape, x.dtype)
    _kernels.transfer(curve, exponent, x, result)
    return result


def encode_transfer(
    values: ArrayLike, kind: Transfer = "srgb", *, gamma: float = 2.2, out: NDArray[Any] | None = None
) -> Floats:
    """Linear light to an encoded signal.

    Parameters
    ----------
    values : array_like, any shape
        Linear light; 1 is the display's white.
    kind : {"srgb", "gamma"}
        The piecewise sRGB curve, or a pure power 1/`gamma`.
    gamma : float
        The exponent of "gamma", positive.
    out : ndarray, optional
        Where to write, of the result's shape and dtype.

    Returns
    -------
    ndarray
        The signal, of the shape and precision of `values`; black 0, white 1.

    Raises
    ------
    TypeError, ValueError
        If `values` are not floating-point, `kind` is unknown, or `gamma` is not positive.

    Notes
    -----
    Negative light mirrors, light beyond one continues the curve, NaN stays. Within 5 ulp of the exact curve up to 1e6
    (0.6 ulp where it is a line). The two pieces of sRGB meet with a jump of 3e-8, which the standard's rounded
    constants make. About 4 ns a value and thread in float32.

    References
    ----------
    IEC 61966-2-1:1999, *Default RGB colour space: sRGB*.

    Examples
    --------
    >>> encode_transfer([0.0, 0.5, 1.0]).round(6)
    array([0.      , 0.735357, 1.      ])
    """
    _arrays.choice("kind", kind, ("srgb", "gamma"))
    exponent = 1.0 / _arrays.number("gamma", gamma, above=0.0)
    return _transfer("values", "encode_srgb" if kind == "srgb" else "power", exponent, values, out)


def decode_transfer(
    values: ArrayLike, kind: Transfer = "srgb", *, gamma: float = 2.2, out: NDArray[Any] | None = None
) -> Floats:
    """An encoded signal back to linear light: the inverse of `encode_transfer`.

    Parameters
    ----------
    values : array_like, any shape
        The signal; 8-bit codes divided by 255.
    kind : {"srgb", "gamma"}
        The piecewise sRGB curve, or a pure power `gamma`.
    gamma : float
        The exponent of "gamma", positive.
    out : ndarray, optional
        Where to write, of the result's shape and dtype.

    Returns
    -------
    ndarray
        Linear light, of the shape and precision of `values`.

    Raises
    ------
    TypeError, ValueError
        If `values` are not floating-point, `kind` is unknown, or `gamma` is not positive.

    Notes
    -----
    Negative values mirror, values beyond one continue the curve, NaN stays. Within 8 ulp of the exact curve up to 1e6.
    A signal within 4e-8 of the join of the two pieces may come back from a round trip on the other piece. About 4 ns
    a value and thread in float32.

    References
    ----------
    IEC 61966-2-1:1999, *Default RGB colour space: sRGB*.

    Examples
    --------
    >>> decode_transfer([0.0, 0.5, 1.0]).round(6)
    array([0.      , 0.214041, 1.      ])
    """
    _arrays.choice("kind", kind, ("srgb", "gamma"))
    exponent = _arrays.number("gamma", gamma, above=0.0)
    return _transfer("values", "decode_srgb" if kind == "srgb" else "power", exponent, values, out)


def tone_map(
    values: ArrayLike,
    method: ToneMap = "reinhard",
    *,
    exposure: float = 0.0,
    white: float = 4.0,
    out: NDArray[Any] | None = None,
) -> Floats:
    """Scene radiance to display light in [0, 1], channel by channel; `encode_transfer` comes after it.

    Parameters
    ----------
    values : array_like, any shape
        Linear scene-referred values.
    method : {"reinhard", "clip", "reinhard_extended", "aces"}
        x/(1 + x); cut at one; Reinhard's curve that reaches one at `white`; Narkowicz's fit of the ACES transforms.
    exposure : float
        Stops: values are multiplied by 2**exposure first. From -100 to 100.
    white : float
        For "reinhard_extended": the least (exposed) value that becomes white, positive.
    out : ndarray, optional
        Where to write, of the result's shape and dtype.

    Returns
    -------
    ndarray
        Linear display light in [0, 1], of the shape and precision of `values`.

    Raises
    ------
    TypeError, ValueError
        If `values` are not floating-point, `method` is unknown, or a knob is out of its domain.

    Notes
    -----
    Negative values become 0, infinity becomes the curve's limit, NaN stays NaN. Mapping channels one by one shifts
    the hue of bright saturated colours towards white. The ACES fit is within about 0.02 of the transforms it was
    fitted to and differs from the full ACES, which works in wider primaries. Errors: 4 ulp. About 0.5 ns a value and
    thread in float32.

    References
    ----------
    E. Reinhard, M. Stark, P. Shirley, J. Ferwerda, *Photographic Tone Reproduction for Digital Images*, 2002.
    K. Narkowicz, *ACES Filmic Tone Mapping Curve*, 2015.

    Examples
    --------
    >>> tone_map([0.0, 1.0, float("inf")])
    array([0. , 0.5, 1. ])
    """
    _arrays.choice("method", method, ("clip", "reinhard", "reinhard_extended", "aces"))
    scale = 2.0 ** _arrays.number("exposure", exposure, -100, 100)
    white = _arrays.number("white", white, above=0.0)
    x = _light("values", values)
    result = _arrays.output("out", out, x.shape, x.dtype)
    _kernels.tone_map(method, white, scale, x, result)
    return result


def luminance(rgb: ArrayLike, *, out: NDArray[Any] | None = None) -> Floats:
    """Relative luminance of linear RGB with sRGB primaries.

    Parameters
    ----------
    rgb : array_like, shape (..., 3)
        Linear values.
    out : ndarray, optional
        Where to write, of the result's shape and dtype.

    Returns
    -------
    ndarray, shape (...)
        0.2126 R + 0.7152 G + 0.0722 B, in the unit of `rgb`.

    Raises
    ------
    TypeError, ValueError
        If `rgb` is not floating-point, or not of three components.

    Notes
    -----
    Within 2 ulp of the largest term. Encoded signals give luma, not luminance: decode them first. About 1 ns a colour.

    References
    ----------
    Rec. ITU-R BT.709-6, 2015.

    Examples
    --------
    >>> luminance([1.0, 1.0, 1.0]).item()
    1.0
    """
    x = _arrays.vectors("rgb", _light("rgb", rgb))
    result = _arrays.output("out", out, x.shape[:-1], x.dtype)
    _kernels.luminance(x, result)
    return result
