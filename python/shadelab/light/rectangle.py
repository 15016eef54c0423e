"""Rectangular lights, even or with a picture."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import light as _kernels
from ._parts import _BRIGHTEST, _LEAST, _MOST, Vector, _freeze, _packed

__all__ = ["RectLight"]

_MOST_TEXELS = 2048


@dataclass(frozen=True)
class RectLight:
    """A rectangle that radiates evenly from its front, the side to which ``cross(edge_u, edge_v)`` points.

    Parameters
    ----------
    center : sequence of 3 floats
    edge_u, edge_v : sequence of 3 floats
        The full edges, perpendicular to each other.
    radiance : sequence of 3 floats
        In W/(m² sr), per channel.
    two_sided : bool
        Whether the back radiates as well.
    texture : array_like, shape (H, W, 3) or (H, W), optional
        A picture by which the radiance is multiplied, up to 2048 texels a side: linear, not negative. Seen from the
        front with `edge_v` up, row 0 is at the top and column 0 at the left.

    Raises
    ------
    TypeError, ValueError
        If a vector is not of three finite numbers, an edge is not of 1e-15 to 1e15 in length, the edges are not
        perpendicular (to 1e-6), a channel is not in [0, 1e30], or a texture holds integers, negative or infinite
        numbers, or is too large.

    Notes
    -----
    With a texture radiance is constant within each texel: what `shadelab.pathtrace` sees, and draws in proportion to
    luminance. `irradiance` sums Lambert's formula over the texels (about 0.2 µs for each that differs from its
    neighbour). Closed forms of reflection (`ltc`, `shade`) take the mean colour that a lobe sees, over a few
    cells of a summed-area table (24 bytes a texel, made once for each light and precision). Over random receivers, as
    a share of the mean, that adds to the error of transformed cosines: nothing to two digits for roughness from 0.5 on
    and for diffusers 0.001 (0.01 before texels of pure noise); 0.003 at roughness 0.25 (0.04), 0.005 at 0.05 (0.1).
    Lit fractions are those of an even light, so that shadows of a picture have no colours.

    A disk or polygon that shows a picture is a rectangle whose texture is black around it, texels at the border weighed
    by how much of them lies within. At 128 texels across, over the same receivers, a disk's irradiance is within 2e-4
    of the mean, and its reflection by transformed cosines is off by 0.014 to 0.027 of the mean (root mean square) for
    roughness 0.1 to 1, where a `DiskLight` is off by 0.006 to 0.014. The black part stops light that meets it, as the
    rest does.

    References
    ----------
    E. Heitz, J. Dupuy, S. Hill, D. Neubelt, *Real-time polygonal-light shading with linearly transformed cosines*,
    2016.

    Examples
    --------
    >>> light = RectLight((0, 2, 0), edge_u=(1, 0, 0), edge_v=(0, 0, 2), radiance=(5, 5, 5))
    >>> light.normal, light.area
    ((0.0, -1.0, 0.0), 2.0)
    >>> RectLight((0, 2, 0), (1, 0, 0), (0, 0, 2), (4, 4, 4), texture=[[0.0, 1.0]]).mean_radiance
    (2.0, 2.0, 2.0)
    """

    center: Vector
    edge_u: Vector
    edge_v: Vector
    radiance: Vector = (1.0, 1.0, 1.0)
    two_sided: bool = False
    texture: Any = field(default=None, repr=False, compare=False)
    # What tells pictures apart where lights are compared, hashed and shown.
    _content: str = field(default="", init=False)

    def __post_init__(self) -> None:
        _freeze(self, "radiance", skip=("texture", "_content"))
        if self.texture is not None:
            texture = _picture(self.texture, max(self.radiance))
            object.__setattr__(self, "texture", texture)
            # Imported here: it takes longer than the rest of the chapter, and few lights show a picture.
            from hashlib import sha256

            object.__setattr__(self, "_content", sha256(texture.tobytes()).hexdigest()[:16] + f" {texture.shape}")
        # By hypot, since squares of what is small are none.
        lengths = [math.hypot(*e) for e in (self.edge_u, self.edge_v)]
        for name, length in zip(("edge_u", "edge_v"), lengths, strict=True):
            if not _LEAST <= length <= _MOST:
                raise ValueError(f"{name}: expected an edge of {_LEAST:g} to {_MOST:g} in length, got {length:g}")
        cosine = float(np.dot(np.divide(self.edge_u, lengths[0]), np.divide(self.edge_v, lengths[1])))
        if abs(cosine) > 1e-6:
            raise ValueError(f"edge_v: expected an edge perpendicular to edge_u, got a cosine of {cosine:g}")

    def _row(self) -> list[float]:
        kind = 2 if self.texture is None else 8
        return [kind, *_packed(self.radiance, self.center, self.edge_u, self.edge_v, self.two_sided)]

    def _shown(self, double: bool) -> Any:
        """The picture of a textured light as kernels hold it."""
        held = _PICTURES.setdefault(self, {})
        if double not in held:
            texels = np.asarray(self.texture * np.asarray(self.radiance), np.float64 if double else np.float32)
            held[double] = _kernels.light_picture(np.ascontiguousarray(texels).reshape(-1, 3), texels.shape[1])
        return held[double]

    @property
    def mean_radiance(self) -> Vector:
        """The radiance over the area, in W/(m² sr)."""
        if self.texture is None:
            return self.radiance
        r, g, b = (self.texture.mean((0, 1), dtype=np.float64) * self.radiance).tolist()
        return r, g, b

    @property
    def normal(self) -> Vector:
        """The unit vector to which the front points."""
        cross = np.cross(np.divide(self.edge_u, np.max(np.abs(self.edge_u))), self.edge_v)
        cross = cross / np.max(np.abs(cross))
        x, y, z = (float(c) + 0.0 for c in cross / np.linalg.norm(cross))
        return x, y, z

    @property
    def area(self) -> float:
        """In m²."""
        return float(np.linalg.norm(self.edge_u) * np.linalg.norm(self.edge_v))

    @property
    def corners(self) -> NDArray[np.float64]:
        """The four corners, (4, 3), counter-clockwise as seen from the front."""
        u, v = np.multiply(self.edge_u, 0.5), np.multiply(self.edge_v, 0.5)
        return np.asarray([self.center - u - v, self.center + u - v, self.center + u + v, self.center - u + v])


_PICTURES: WeakKeyDictionary[RectLight, dict[bool, Any]] = WeakKeyDictionary()


def _picture(texture: Any, scale: float) -> Floats:
    """A light's picture as a read-only array (H, W, 3)."""
    given = _arrays.image("texture", texture)
    if given.ndim == 2 or given.shape[-1] == 1:
        given = np.repeat(given.reshape(*given.shape[:2], 1), 3, -1)
    height, width, channels = given.shape
    if channels != 3 or not (1 <= height <= _MOST_TEXELS and 1 <= width <= _MOST_TEXELS):
        most = f"(H, W, 3) of 1 to {_MOST_TEXELS} a side"
        raise ValueError(f"texture: expected shape {most}, got {np.shape(texture)}")
    if not (given >= 0).all() or not float(given.max()) * scale <= _BRIGHTEST:
        raise ValueError(f"texture: expected finite numbers, not negative, and radiance of at most {_BRIGHTEST:g}")
    array = np.array(given, order="C")
    array.flags.writeable = False
    return array
