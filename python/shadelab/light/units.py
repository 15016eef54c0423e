"""What lights send, in radiometric and photometric units."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from ..color import luminance
from .kinds import (
    AmbientLight,
    DirectionalLight,
    DiskLight,
    Light,
    PointLight,
    PolygonLight,
    RectLight,
    SphereLight,
    SpotLight,
)

__all__ = ["flux", "intensity", "photometric", "radiometric", "with_flux"]

Kind = TypeVar("Kind", PointLight, SpotLight, RectLight, DiskLight, SphereLight, PolygonLight)


def flux(light: Light) -> NDArray[np.float64]:
    """The power that a light sends in all directions, in W per channel.

    Parameters
    ----------
    light : light
        With a place: not directional or ambient.

    Returns
    -------
    ndarray, shape (3,)
        4π I of a point; of a spot its cone's share; π A L of each side that radiates.

    Raises
    ------
    TypeError
        If `light` has no flux: it is infinite.

    Notes
    -----
    With `photometric`, lumens.

    Examples
    --------
    >>> (flux(SphereLight((0, 0, 0), 1.0)) / np.pi**2).round(12)
    array([4., 4., 4.])
    """
    if isinstance(light, PointLight):
        return np.multiply(light.intensity, 4 * math.pi)
    if isinstance(light, SpotLight):
        # 2π (1 − cos) of the inner cone, and half of the ring: the cubic is even about its middle.
        depths = (2 * math.sin(a / 2) ** 2 for a in (light.inner_angle, light.outer_angle))
        return np.multiply(light.intensity, math.pi * sum(depths))
    if isinstance(light, RectLight | DiskLight | SphereLight | PolygonLight):
        sides = 2 if getattr(light, "two_sided", False) else 1
        return np.multiply(_mean(light), math.pi * light.area * sides)
    raise TypeError(f"light: expected a light with a place, whose flux is finite, got {type(light).__name__}")


def _mean(light: Any) -> Any:
    """The radiance of an area light over its area."""
    return light.mean_radiance if isinstance(light, RectLight) else light.radiance


def intensity(light: Light, directions: ArrayLike) -> Floats:
    """The radiant intensity of a light, in W/sr per channel, as of a point that is far away.

    Parameters
    ----------
    light : light
        With a place: not directional or ambient.
    directions : array_like, shape (..., 3)
        Unit, from the light.

    Returns
    -------
    ndarray, shape (..., 3)
        L A cos θ of flat lights, L π r² of a sphere.

    Raises
    ------
    TypeError, ValueError
        If `light` has no intensity, or `directions` is not real or of the wrong shape.

    Notes
    -----
    With `photometric`, candela.

    Examples
    --------
    >>> intensity(RectLight((0, 0, 0), (0, 0, 2), (3, 0, 0)), [0.0, 1.0, 0.0])
    array([6., 6., 6.])
    """
    w = _arrays.vectors("directions", directions)
    # What is infinite is no direction.
    w = np.where(np.isfinite(w).all(-1, keepdims=True), w, np.nan).astype(w.dtype)
    ones = w[..., 0] * 0 + 1
    share: Any
    if isinstance(light, PointLight):
        share, color = ones, light.intensity
    elif isinstance(light, SpotLight):
        axis = _unit(light.direction)
        inner, outer = (2 * math.sin(a / 2) ** 2 for a in (light.inner_angle, light.outer_angle))
        off = ((w - axis) ** 2).sum(-1) / 2
        t = np.clip((outer - off) / (outer - inner), 0, 1) if outer > inner else off <= inner
        share, color = t * t * (3 - 2 * t) * ones, light.intensity
    elif isinstance(light, RectLight | DiskLight | PolygonLight):
        axis = _unit(light.normal)
        cosine = w @ axis
        share, color = light.area * (np.abs(cosine) if light.two_sided else np.maximum(cosine, 0)), _mean(light)
    elif isinstance(light, SphereLight):
        share, color = ones * math.pi * light.radius**2, light.radiance
    else:
        raise TypeError(f"light: expected a light with a place, got {type(light).__name__}")
    with np.errstate(invalid="ignore", over="ignore"):
        result: Floats = (np.asarray(share)[..., None] * np.asarray(color)).astype(w.dtype)
    return result


def _unit(direction: Sequence[float]) -> NDArray[np.float64]:
    """Of any length: squares of the largest and the least leave the range of numbers."""
    scaled = np.asarray(direction, np.float64) / np.max(np.abs(direction))
    return np.asarray(scaled / np.linalg.norm(scaled))


def with_flux(light: Kind, watts: ArrayLike) -> Kind:
    """A light of the same shape that sends a given flux.

    Parameters
    ----------
    light : light
        With a place; its colour does not count.
    watts : array_like, shape (3,) or ()
        Per channel. From lumens: ``radiometric(lumens)``.

    Returns
    -------
    light

    Raises
    ------
    TypeError, ValueError
        If `light` has no flux or none at all (a spot of angle zero), or `watts` is negative.

    Examples
    --------
    >>> bulb = with_flux(PointLight((0, 2, 0)), radiometric(800.0))
    >>> float(photometric(flux(bulb)).round(9))
    800.0
    """
    given = _arrays.floats("watts", watts, np.float64)
    if given.shape not in ((), (3,)):
        raise ValueError(f"watts: expected a number or three, got shape {given.shape}")
    if not (np.isfinite(given).all() and (given >= 0).all() and (given <= 1e30).all()):
        raise ValueError(f"watts: expected numbers in [0, 1e30], got {given.tolist()}")
    wanted = np.broadcast_to(given, (3,))
    name = "intensity" if isinstance(light, PointLight | SpotLight) else "radiance"
    changes: dict[str, Any] = {name: (1.0, 1.0, 1.0)}
    placed = isinstance(light, Light) and not isinstance(light, DirectionalLight | AmbientLight)
    unit = flux(dataclasses.replace(light, **changes)) if placed else None
    if unit is None:
        raise TypeError(f"light: expected a light with a place, got {type(light).__name__}")
    if not min(unit) > 0:
        raise ValueError("light: expected one that can send a flux, got a spot of angle zero or a black picture")
    changes = {name: tuple((wanted / unit).tolist())}
    return dataclasses.replace(light, **changes)


def photometric(values: ArrayLike, *, efficacy: float = 683.0) -> Floats:
    """From radiometric quantities to photometric ones.

    Parameters
    ----------
    values : array_like, shape (..., 3)
        Any radiometric quantity per channel of linear sRGB: W, W/sr, W/m², W/(m² sr).
    efficacy : float
        Luminous efficacy in lm/W of the light that white stands for. 683 where channels are weighed by the eye's
        response as colours are; 179 for watts of white daylight over the visible range.

    Returns
    -------
    ndarray, shape (...)
        Lumen, candela, lux, candela per m².

    Raises
    ------
    TypeError, ValueError
        If `values` is not real or of the wrong shape, or `efficacy` is not positive.

    Notes
    -----
    The candela is defined by 683 lm/W at 540 THz, a wavelength of 555 nm, where the eye is the most sensitive. Candela
    is lumen per steradian; candela per m² is luminance, whose radiometric fellow is radiance.

    References
    ----------
    BIPM, *The International System of Units*, 9th edition, 2019.

    Examples
    --------
    >>> float(photometric([1.0, 1.0, 1.0]))
    683.0
    """
    k = _arrays.number("efficacy", efficacy, above=0)
    with np.errstate(over="ignore", invalid="ignore"):
        result: Floats = np.asarray(luminance(_arrays.vectors("values", values))) * k
    return result


def radiometric(values: ArrayLike, color: ArrayLike = (1.0, 1.0, 1.0), *, efficacy: float = 683.0) -> Floats:
    """From photometric quantities to radiometric ones of a given colour: the inverse of `photometric`.

    Parameters
    ----------
    values : array_like, shape (...)
        Lumen, candela, lux or candela per m².
    color : array_like, shape (..., 3)
        Linear sRGB, of any brightness but zero.
    efficacy : float
        In lm/W; as of `photometric`.

    Returns
    -------
    ndarray, shape (..., 3)

    Raises
    ------
    TypeError, ValueError
        If an argument is not real or of the wrong shape, `color` is black, or `efficacy` is not positive.

    Examples
    --------
    >>> radiometric(683.0)
    array([1., 1., 1.])
    """
    k = _arrays.number("efficacy", efficacy, above=0)
    dtype = _arrays.result_dtype(values=values)
    tint = _arrays.vectors("color", color, 3, dtype)
    bright = np.asarray(luminance(tint))
    if not (bright > 0).all():
        raise ValueError("color: expected a colour that is not black")
    given = _arrays.floats("values", values, dtype)
    try:
        np.broadcast_shapes(given.shape, bright.shape)
    except ValueError:
        raise ValueError(f"color: shape {tint.shape} does not broadcast with values {given.shape}") from None
    with np.errstate(over="ignore", invalid="ignore"):
        result: Floats = (given / (k * bright))[..., None] * tint
    return result
