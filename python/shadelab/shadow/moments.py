"""Maps of moments: powers or exponentials of depth, which may be filtered beforehand."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays, image
from .._kernels import shadow as _kernels
from ._sets import MapSet
from .cascaded import Cascades
from .cubes import CubeShadowMap
from .maps import ShadowMap, _finite

__all__ = ["MomentMap", "MomentMapSet", "moment_map"]

Kind: TypeAlias = Literal["variance", "exponential_variance", "moment"]
Filter: TypeAlias = Literal["none", "gaussian", "mip", "summed_area"]
_KINDS = ("variance", "exponential_variance", "moment")
_FILTERS = ("none", "gaussian", "mip", "summed_area")
# Beyond this exponent the square of an exponential overflows.
_MOST = {np.dtype(np.float32): 42.0, np.dtype(np.float64): 350.0}


@dataclass(frozen=True, eq=False)
class MomentMap:
    """Moments of a shadow map's depths, filtered or ready to be: what `moment_map` gives.

    Parameters
    ----------
    shadow_map : ShadowMap
        The map that the moments were taken of; receivers are found through it.
    kind : {"variance", "exponential_variance", "moment"}
        What is averaged: z and z²; exponentials of z and their squares; z to z⁴.
    filter : {"none", "gaussian", "mip", "summed_area"}
        How moments are averaged: not beyond their neighbours, beforehand, or at the lookup.
    moments : ndarray, shape (h, w, C), (n, C) or (h + 1, w + 1, C)
        The moments; those of all mips one after the other; or their table of sums. float32, float64 or uint16.
    near, far : float
        The depths that are z = -1 and z = 1.
    reduce : int
        Texels of the shadow map in one here, along a side.
    reach : float
        Half the width of the filter that was applied, in texels of the shadow map.
    exponents : (float, float)
        Of the exponentials; the second is 0 where there is but one.
    """

    shadow_map: ShadowMap
    kind: Kind
    filter: Filter
    moments: NDArray[Any]
    near: float
    far: float
    reduce: int = 1
    reach: float = 0.5
    exponents: tuple[float, float] = (0.0, 0.0)

    @property
    def bytes(self) -> int:
        """What the moments occupy."""
        return self.moments.nbytes

    @property
    def channels(self) -> int:
        """Numbers in a texel."""
        return int(self.moments.shape[-1])

    def depth_of(self, z: ArrayLike) -> NDArray[Any]:
        """Depths of z in [-1, 1]."""
        return self.near + (np.asarray(z) + 1.0) * (0.5 * (self.far - self.near))

    def _levels(self) -> list[tuple[int, int, int]]:
        """Where each level begins, its width and its height."""
        if self.filter != "mip":
            height, width = self.moments.shape[:2]
            return [(0, width, height)]
        height, width = (-(-n // self.reduce) for n in self.shadow_map.depth.shape)
        levels, first = [], 0
        while True:
            levels.append((first, width, height))
            first += width * height
            if max(width, height) == 1:
                return levels
            width, height = max(width // 2, 1), max(height // 2, 1)

    def _range(self) -> list[float]:
        return _range(self.near, self.far)


@dataclass(frozen=True, eq=False)
class MomentMapSet:
    """Moments of each of several maps: what `moment_map` gives of cascades and cubes, and looked up as they are.

    Parameters
    ----------
    shadow_map : Cascades or CubeShadowMap
        The set that the moments were taken of.
    maps : tuple of MomentMap
        Those of each of its maps, in order, of one kind and filter.
    """

    shadow_map: MapSet
    maps: tuple[MomentMap, ...]

    @property
    def kind(self) -> Kind:
        """As of each `MomentMap`."""
        return self.maps[0].kind

    @property
    def filter(self) -> Filter:
        """As of each `MomentMap`."""
        return self.maps[0].filter

    @property
    def channels(self) -> int:
        """Numbers in a texel."""
        return self.maps[0].channels

    @property
    def bytes(self) -> int:
        """What the moments of all maps occupy."""
        return sum(m.bytes for m in self.maps)


def _range(near: float, far: float) -> list[float]:
    """The middle, and what depth is multiplied by."""
    return [(near + far) / 2, 2.0 / (far - near)]


@overload
def moment_map(
    shadow_map: ShadowMap,
    kind: Kind = ...,
    *,
    filter: Filter = ...,
    sigma: float | None = ...,
    reduce: int = ...,
    exponents: tuple[float, float] | float | None = ...,
    bits: Literal[16, None] = ...,
    precision: Literal["double", "compensated", "single"] | None = ...,
    receivers: ArrayLike | None = ...,
) -> MomentMap: ...
@overload
def moment_map(
    shadow_map: Cascades | CubeShadowMap,
    kind: Kind = ...,
    *,
    filter: Filter = ...,
    sigma: float | None = ...,
    reduce: int = ...,
    exponents: tuple[float, float] | float | None = ...,
    bits: Literal[16, None] = ...,
    precision: Literal["double", "compensated", "single"] | None = ...,
    receivers: ArrayLike | None = ...,
) -> MomentMapSet: ...
def moment_map(
    shadow_map: ShadowMap | Cascades | CubeShadowMap,
    kind: Kind = "moment",
    *,
    filter: Filter = "gaussian",
    sigma: float | None = None,
    reduce: int = 1,
    exponents: tuple[float, float] | float | None = None,
    bits: Literal[16, None] = None,
    precision: Literal["double", "compensated", "single"] | None = None,
    receivers: ArrayLike | None = None,
) -> MomentMap | MomentMapSet:
    """Take moments of a shadow map's depths, and filter them beforehand.

    Parameters
    ----------
    shadow_map : ShadowMap, Cascades or CubeShadowMap
        The depths; their precision is that of moments. Each map of a set is filtered for itself, so that its border
        should hold the filter.
    kind : {"variance", "exponential_variance", "moment"}
        What is averaged: depth and its square; exponentials of it and their squares; its first four powers.
    filter : {"none", "gaussian", "mip", "summed_area"}
        "gaussian" filters once, for lookups of one width at one texel's price. "mip" and "summed_area" let each lookup
        choose its width: roughly round, or the very box.
    sigma : float, optional
        Standard deviation of the Gaussian in texels of the shadow map, 2 by default; it is cut at three of them. For
        filter "gaussian" alone.
    reduce : int
        Moments are averaged over squares of so many texels of the shadow map first. Where the filter is wide nothing is
        lost by it but cost.
    exponents : (float, float) or float, optional
        Of "exponential_variance": e^(az) and -e^(-bz), or the first alone; (40, 5) by default. At most 42 in single
        precision. In a table of n texels the default is ln(2^p / n) / 4 at most, with p the bits of its sums, 53 or 24:
        beyond, differences of sums lose what is small in them, and planes that are lit before others turn black.
    bits : {None, 16}
        16 stores four powers in 16 bits each, by the transform of Peters et al. (2017).
    precision : {"double", "compensated", "single"}, optional
        Of the sums in a table of "summed_area", "double" by default: see `shadelab.image.summed_area_table`.
    receivers : array_like, shape (..., 3), optional
        Points that will be looked up. Depth then reaches to the farthest of them; by default as far as the map's own,
        and once more as far where a part of the map is empty, since empty texels must lie behind all that is looked up.
        Those that are not finite do not count, nor does an empty batch.

    Returns
    -------
    MomentMap, or MomentMapSet of a set

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type or range, or does not go with the others, or no receiver is finite.

    Notes
    -----
    Moments may be averaged as depths may not: filtering before the lookup equals filtering in it. A filter wide against
    the map blurs the depths of one surface too; see `moment` for what biases then ask. Outside of the map lie the
    nearest texels, but boxes of "summed_area" are cut at its border. Cost: C values a texel, one pass over the depths,
    and that of the filter (`shadelab.image.gaussian_filter`, `mip_chain`, `summed_area_table`).

    References
    ----------
    W. Donnelly, A. Lauritzen, *Variance Shadow Maps*, I3D 2006. A. Lauritzen, M. McCool, *Layered Variance Shadow
    Maps*, GI 2008. C. Peters, R. Klein, *Moment Shadow Mapping*, I3D 2015. C. Peters et al., *Improved Moment Shadow
    Maps for Translucent Occluders, Soft Shadows and Single Scattering*, JCGT 2017.

    Examples
    --------
    >>> import numpy as np
    >>> depth = np.where(np.arange(8) < 4, 2.0, 4.0)[None].repeat(8, 0)
    >>> frame = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
    >>> above = ShadowMap(depth, "perspective", [0, 4, 0], frame, [-1, 1, -1, 1], 2.0, 4.0)
    >>> moment_map(above, filter="none", reduce=8).moments
    array([[[0., 1., 0., 1.]]])
    """
    if isinstance(shadow_map, Cascades | CubeShadowMap):
        knobs: dict[str, Any] = {"filter": filter, "sigma": sigma, "reduce": reduce, "exponents": exponents}
        knobs |= {"bits": bits, "precision": precision, "receivers": receivers}
        return MomentMapSet(shadow_map, tuple(moment_map(m, kind, **knobs) for m in shadow_map.maps))
    if not isinstance(shadow_map, ShadowMap):
        raise TypeError(f"shadow_map: expected a ShadowMap, Cascades or a cube, got {type(shadow_map).__name__}")
    _arrays.choice("kind", kind, _KINDS)
    _arrays.choice("filter", filter, _FILTERS)
    for name, value, goes in (
        ("sigma", sigma, filter == "gaussian"),
        ("precision", precision, filter == "summed_area"),
        ("exponents", exponents, kind == "exponential_variance"),
    ):
        if value is not None and not goes:
            raise ValueError(f"{name}: goes with another kind or filter than {kind!r} and {filter!r}")
    sums = "double" if precision is None else precision
    _arrays.choice("precision", sums, ("double", "compensated", "single"))
    if shadow_map.bits is not None:
        shadow_map = replace(shadow_map, depth=shadow_map.depths(), bits=None)
    depth, dtype = shadow_map.depth, shadow_map.depth.dtype
    square = _arrays.count("reduce", reduce, 1, max(depth.shape))
    wide = 2.0 if sigma is None else _arrays.number("sigma", sigma, 0.0)
    most = _MOST[dtype]
    usual = most
    if filter == "summed_area":
        digits = 53 if sums == "double" else 24
        texels = math.prod(-(-n // square) for n in depth.shape)
        usual = min(most, max((digits * math.log(2.0) - math.log(texels)) / 4.0, 0.25))
    own = (0.0, 0.0)
    if kind == "exponential_variance":
        own = _exponents((min(40.0, usual), min(5.0, usual)) if exponents is None else exponents, most)
    if bits is not None:
        _whole(bits, kind, filter)
    near, far = _depths(shadow_map, receivers)

    channels = 4 if kind == "moment" or own[1] > 0.0 else 2
    height, width = (-(-n // square) for n in depth.shape)
    moments: NDArray[Any] = np.empty((height, width, channels), dtype)
    _kernels.moment_map(depth, (kind, own), _range(near, far), square, moments)
    # Between four texels, one is reached to each side.
    reach = 1.0 * square
    if filter == "gaussian":
        moments = image.gaussian_filter(moments, wide / square, truncate=3.0)
        reach = 0.5 * square + 2.0 * wide
    elif filter == "summed_area":
        moments = image.summed_area_table(moments, precision=sums)
        if not np.isfinite(moments[-1, -1]).all():
            raise ValueError(f"exponents: sums of e^({2 * own[0]:g} z) overflow with precision {sums!r}")
    elif filter == "mip":
        moments = np.concatenate([level.reshape(-1, channels) for level in image.mip_chain(moments)])
    if bits is not None:
        whole = np.empty(moments.shape, np.uint16)
        _kernels.moment_quantize(moments, whole)
        moments = whole
    return MomentMap(shadow_map, kind, filter, moments, near, far, square, reach, own)


def _exponents(value: Any, most: float) -> tuple[float, float]:
    pair = (value,) if np.ndim(value) == 0 else tuple(value)
    if len(pair) not in (1, 2):
        raise ValueError(f"exponents: expected a number or a pair, got {value!r}")
    first, *second = (_arrays.number("exponents", e, high=most, above=0.0) for e in pair)
    return first, second[0] if second else 0.0


def _whole(bits: int, kind: str, filter: str) -> None:
    if isinstance(bits, bool) or not isinstance(bits, int | np.integer) or bits != 16:
        raise ValueError(f"bits: expected 16 or None, got {bits!r}")
    if kind != "moment":
        raise ValueError(f"bits: 16 bits hold four powers, kind 'moment', got kind {kind!r}")
    if filter == "summed_area":
        raise ValueError("bits: a table of sums does not fit into 16 bits")


def _depths(shadow_map: ShadowMap, receivers: ArrayLike | None) -> tuple[float, float]:
    """The depths that are -1 and 1."""
    near, far = shadow_map.near, shadow_map.far
    if receivers is not None:
        points = _finite("receivers", receivers)
        if points is not None:
            seen = (points.astype(np.float64) - shadow_map.position) @ shadow_map.axis
            # A little beyond, so that rounding puts none of them there.
            farthest = float(seen.max())
            far = max(far, farthest + 1e-3 * abs(farthest - near))
    elif np.isinf(shadow_map.depth.max()):
        own = far - near
        far += own if own > 0.0 else max(abs(far), 1e-30)
    if not far > near:
        far = near + max(abs(near) * 1e-3, 1e-30)
    if not math.isfinite(2.0 / (far - near)):
        raise ValueError(f"shadow_map: its depths, from {near:g} to {far:g}, are too close to each other")
    return near, far


_OF_MAP = ("filter", "sigma", "reduce", "exponents", "bits", "precision")
_OF_MOMENTS = ("variance", "exponential_variance", "moment", "variance_soft")


def _prepared(
    technique: str, shadow_map: ShadowMap, receivers: ArrayLike, knobs: dict[str, Any]
) -> tuple[ShadowMap | MomentMap, dict[str, Any]]:
    """What a technique looks up in, made of a shadow map where it must be; and the knobs left for the lookup."""
    if technique not in _OF_MOMENTS:
        return shadow_map, dict(knobs)
    soft = technique == "variance_soft"
    own: dict[str, Any] = {"filter": "mip"} if soft else {}
    own |= {k: v for k, v in knobs.items() if k in _OF_MAP}
    kind: Any = knobs.get("kind", "moment") if soft else technique
    left = {k: v for k, v in knobs.items() if k not in _OF_MAP and k != "kind"}
    return moment_map(shadow_map, kind, receivers=receivers, **own), left
