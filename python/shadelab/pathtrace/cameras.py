"""Rays of cameras: through points of the picture, from points of the lens, at times of the shutter."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import pathtrace as _kernels
from ._common import Size, lens_camera, picture_size

if TYPE_CHECKING:
    from ..scene import Camera

__all__ = ["CameraRays", "camera_rays"]


class CameraRays(NamedTuple):
    """Rays of unit direction."""

    origins: Floats
    """(..., 3), on the lens."""
    directions: Floats
    """(..., 3)"""


def camera_rays(
    camera: Camera, size: Size, xy: ArrayLike, lens: ArrayLike = (0.5, 0.5), time: ArrayLike = 0.0
) -> CameraRays:
    """The rays that a camera sends through points of a picture: those that the path tracer draws at random.

    Parameters
    ----------
    camera : Camera
        Of `shadelab.scene`.
    size : (width, height)
    xy : array_like, shape (..., 2)
        Pixels to the right and down from the picture's top left corner; a pixel's centre is at + 0.5.
    lens : array_like, shape (..., 2)
        Points of the unit square, mapped to the lens by concentric squares; its middle is the middle of the lens.
    time : array_like, shape (...)
        Part of the time that the shutter is open, in [0, 1].

    Returns
    -------
    CameraRays
        Origins and unit directions.

    Raises
    ------
    TypeError, ValueError
        If a shape does not fit, or `size` is not of two positive integers.

    Notes
    -----
    All rays through one `xy` meet on the plane of focus, but for rounding. With an aperture of 0 they are those of
    `Camera.rays`, from the eye; with a focus at infinity they are parallel. NaN where an element is NaN or a point is
    beyond the lens' square. Radiance is even over the lens: no vignetting, no cos⁴.

    References
    ----------
    R. L. Cook, T. Porter, L. Carpenter, *Distributed ray tracing*, 1984.
    C. Kolb, D. Mitchell, P. Hanrahan, *A realistic camera model for computer graphics*, 1995, section 3.

    Examples
    --------
    >>> from shadelab.scene import Camera
    >>> camera = Camera((0, 0, 4), (0, 0, 0), aperture=1.0, focus_distance=4.0)
    >>> origins, directions = camera_rays(camera, (4, 4), [2.0, 2.0], [[0.0, 0.5], [1.0, 0.5]])
    >>> (origins + directions * (4 / -directions[:, 2:])).round(9) + 0.0
    array([[0., 0., 0.],
           [0., 0., 0.]])
    """
    given = {"xy": (xy, 2), "lens": (lens, 2), "time": (time, 0)}
    made = lens_camera(camera, picture_size(size))
    return CameraRays(*_arrays.elementwise(_kernels.camera_rays, given, [3, 3], made))
