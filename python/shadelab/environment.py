"""Light from all around: panoramas, looked up and drawn from by importance."""

from __future__ import annotations

import math
import os
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from . import _arrays
from ._arrays import Floats
from ._kernels import environment as _kernels
from ._pictures import load_image

__all__ = ["Environment", "EnvironmentSample"]


class EnvironmentSample(NamedTuple):
    """Directions drawn from an environment."""

    wi: Floats
    """Unit directions to where light comes from, (..., 3)."""
    radiance: Floats
    """From there, (..., 3)."""
    pdf: Floats
    """Density per solid angle."""


class Environment:
    """Radiance from every direction, as an equirectangular panorama.

    Parameters
    ----------
    radiance : array_like, shape (H, W, 3) or (H, W)
        Linear, in W/(m² sr): +y up, row 0 the top; the centre column looks along −z, left to right turns to +x. Its
        precision governs.
    rotation : float
        Turns the panorama about +y, counter-clockwise seen from above, in radians.
    scale : float
        By which radiance is multiplied.

    Raises
    ------
    TypeError, ValueError
        If the picture is not real or of another shape, or a pixel is negative or not finite.

    Notes
    -----
    Between the centres of pixels radiance is bilinear; it goes round the seam, and is constant from the outer rows'
    centres to the poles. Directions are drawn with a density in proportion to the bilinear interpolation of luminance
    times sin θ, so that the ratio of radiance to density varies by no more than the sine within a pixel (half a row at
    the poles). A black panorama is drawn from evenly. About 40 bytes a pixel in single precision.

    References
    ----------
    M. Pharr, W. Jakob, G. Humphreys, *Physically Based Rendering*, 3rd edition, 2016, sections 13.6.7 and 14.2.4.

    Examples
    --------
    >>> sky = np.zeros((4, 8, 3))
    >>> sky[:2] = 1.0
    >>> Environment(sky).eval([[0.0, 1, 0], [0.0, -1, 0], [1.0, 0, 0]])[:, 0]
    array([1. , 0. , 0.5])
    """

    def __init__(self, radiance: ArrayLike, *, rotation: float = 0.0, scale: float = 1.0) -> None:
        array = _arrays.image("radiance", radiance)
        if array.ndim == 2:
            array = np.repeat(array[..., None], 3, -1)
        if array.shape[-1] != 3 or not array.size:
            raise ValueError(f"radiance: expected shape (H, W, 3) or (H, W), got {array.shape}")
        self._rotation = _arrays.number("rotation", rotation)
        self._scale = _arrays.number("scale", scale, 0)
        array = array * array.dtype.type(self._scale)
        bad = ~(np.isfinite(array) & (array >= 0)).all(-1)
        if bad.any():
            i, j = (int(k) for k in np.argwhere(bad)[0])
            raise ValueError(f"radiance: expected finite values from zero on, got {array[i, j].tolist()} at ({i}, {j})")
        array.flags.writeable = False
        self._radiance: Floats = array
        self._held: dict[Any, Any] = {}

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, rotation: float = 0.0, scale: float = 1.0) -> Environment:
        """An environment from a picture file.

        Parameters
        ----------
        path : path
            ``.hdr``, ``.exr`` or ``.png``; see `shadelab.scene.load_image`.
        rotation, scale : float
            As of the constructor.

        Returns
        -------
        Environment

        Raises
        ------
        FileNotFoundError, ImportError, ValueError
            If the file is not there, cannot be read, or has a negative or non-finite pixel.
        """
        picture = load_image(path)
        return cls(picture if picture.ndim == 2 else picture[..., :3], rotation=rotation, scale=scale)

    def __repr__(self) -> str:
        height, width = self._radiance.shape[:2]
        return f"Environment({width} × {height}, {self.dtype}, rotation={self._rotation:g})"

    @property
    def radiance(self) -> Floats:
        """The panorama after scaling, (H, W, 3), read-only."""
        return self._radiance

    @property
    def rotation(self) -> float:
        """About +y, in radians."""
        return self._rotation

    @property
    def dtype(self) -> np.dtype[Any]:
        """The precision of the panorama."""
        return self._radiance.dtype

    @property
    def power(self) -> float:
        """The luminance of radiance, integrated over all directions with the sines of the pixels' centres."""
        return float(_kernels.power(self._panorama(self.dtype)))

    def _panorama(self, dtype: DTypeLike) -> Any:
        """The kernels' own in a precision, made once."""
        key = np.dtype(dtype)
        if key not in self._held:
            array = np.require(self._radiance, key, ["C", "A"])
            self._held[key] = _kernels.panorama(array, array.shape[1], self._rotation)
        return self._held[key]

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_held": {}}

    def directions(self) -> Floats:
        """The unit directions that the centres of the pixels stand for.

        Returns
        -------
        ndarray, shape (H, W, 3)
        """
        height, width = self._radiance.shape[:2]
        polar = math.pi * (np.arange(height) + 0.5)[:, None] / height
        azimuth = 2 * math.pi * ((np.arange(width) + 0.5) / width - 0.5) - self._rotation
        sine = np.sin(polar)
        y = np.broadcast_to(np.cos(polar), (height, width))
        return np.stack([sine * np.sin(azimuth), y, -sine * np.cos(azimuth)], -1).astype(self.dtype)

    def _look(self, directions: ArrayLike) -> tuple[Floats, Floats]:
        flat = _arrays.vectors("directions", directions, 3, self.dtype)
        radiance, pdf = np.empty_like(flat), np.empty(flat.shape[:-1], self.dtype)
        out = [radiance.reshape(-1, 3), pdf.reshape(-1)]
        _kernels.look(self._panorama(self.dtype), flat.reshape(-1, 3), out)
        return radiance, pdf

    def eval(self, directions: ArrayLike) -> Floats:
        """The radiance from directions.

        Parameters
        ----------
        directions : array_like, shape (..., 3)
            Unit vectors to where light comes from.

        Returns
        -------
        ndarray, shape (..., 3)
            W/(m² sr), in the panorama's precision.

        Raises
        ------
        TypeError, ValueError
            If `directions` is not real or of the wrong shape.
        """
        return self._look(directions)[0]

    def pdf(self, directions: ArrayLike) -> Floats:
        """The density of `sample` per solid angle.

        Parameters
        ----------
        directions : array_like, shape (..., 3)
            Unit vectors.

        Returns
        -------
        ndarray, shape (...)

        Raises
        ------
        TypeError, ValueError
            If `directions` is not real or of the wrong shape.
        """
        return self._look(directions)[1]

    def sample(self, u: ArrayLike) -> EnvironmentSample:
        """Directions drawn in proportion to luminance.

        Parameters
        ----------
        u : array_like, shape (..., 2)
            In [0, 1); the first goes along rows, the second down. Strata stay together.

        Returns
        -------
        EnvironmentSample
            Directions, radiance from there, densities.

        Raises
        ------
        TypeError, ValueError
            If `u` is not real or of the wrong shape.

        Examples
        --------
        >>> wi, radiance, pdf = Environment(np.ones((32, 64, 3))).sample(np.full((1, 2), 0.25))
        >>> float(pdf[0] * 4 * np.pi) > 0.9
        True
        """
        flat = _arrays.vectors("u", u, 2, self.dtype)
        lead = flat.shape[:-1]
        wi, radiance = np.empty((*lead, 3), self.dtype), np.empty((*lead, 3), self.dtype)
        pdf = np.empty(lead, self.dtype)
        out = [wi.reshape(-1, 3), radiance.reshape(-1, 3), pdf.reshape(-1)]
        _kernels.sample(self._panorama(self.dtype), flat.reshape(-1, 2), out)
        return EnvironmentSample(wi, radiance, pdf)
