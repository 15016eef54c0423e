"""What the centres of pixels see, and how the lights alone show it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from .._kernels import pathtrace as _kernels
from ..accel import BVH, Hit
from ..accel.instances import InstancedBVH, InstanceHit
from ._common import Size, check_camera, picture_size, pinhole
from .estimate import Traced
from .recursive import whitted

if TYPE_CHECKING:
    from ..scene import Camera, Scene

__all__ = ["ray_cast"]


@overload
def ray_cast(scene: BVH, camera: Camera, size: Size = ..., **options: Any) -> Hit: ...
@overload
def ray_cast(scene: InstancedBVH, camera: Camera, size: Size = ..., **options: Any) -> InstanceHit: ...
@overload
def ray_cast(scene: Scene, camera: Camera | None = ..., size: Size = ..., **options: Any) -> Traced: ...
def ray_cast(
    scene: Scene | BVH | InstancedBVH, camera: Camera | None = None, size: Size = (1280, 720), **options: Any
) -> Traced | Hit | InstanceHit:
    """What the centre of each pixel sees: of a scene lit by its lights alone, of a hierarchy the face.

    Parameters
    ----------
    scene : Scene, BVH or InstancedBVH
        Of `shadelab.scene`, or a mesh or copies of meshes; the precision of these governs.
    camera : Camera, optional
        Of `shadelab.scene`; None is the scene's own.
    size : (width, height)
    **options
        Of a scene, those of `whitted` but `max_depth`: `samples`, `seed`, `filter`, `instances`, `dtype` …

    Returns
    -------
    Traced, Hit or InstanceHit
        Of a scene the picture: emission, and light from the lights, once reflected, with sharp shadows. Else pictures
        (H, W): `t`, the distance from the eye, and `face`, `u`, `v` (and `instance`); see `shadelab.accel.Hit`.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    Of a BVH as fast as `BVH.closest_hit` without the arrays of rays. Rays lie within 4 rounding units of their true
    direction. The picture is that of `whitted` at depth 0: mirrors and glass show nothing but the lights' own
    highlights, which none of smooth ones have, area lights shine from their middle.

    References
    ----------
    A. Appel, *Some techniques for shading machine renderings of solids*, 1968.

    Examples
    --------
    >>> from shadelab import light, mesh
    >>> from shadelab.scene import Camera, Scene
    >>> bvh = BVH([[-1.0, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> ray_cast(bvh, Camera((0, 0, 2), (0, 0, 0)), (3, 3)).face
    array([[-1,  0, -1],
           [-1,  0, -1],
           [ 0,  0,  0]], dtype=int32)
    >>> lamp = light.PointLight((0, 3, 3), (20, 20, 20))
    >>> ray_cast(Scene(mesh.icosphere(2), lamp), size=(16, 9)).radiance.shape
    (9, 16, 3)
    """
    if not isinstance(scene, BVH | InstancedBVH):
        if not callable(getattr(scene, "flatten", None)) or isinstance(scene, np.ndarray):
            raise TypeError(f"scene: expected a Scene, BVH or InstancedBVH, got {type(scene).__name__}")
        if camera is not None:
            check_camera(camera)
            scene = replace(scene, camera=camera)
        if "max_depth" in options:
            raise TypeError("max_depth: expected none, a ray that is cast is reflected once")
        return whitted(scene, size, max_depth=0, **options)
    if options:
        raise TypeError(f"{next(iter(options))}: expected with a scene alone")
    camera = check_camera(camera)
    width, height = picture_size(size)
    if isinstance(scene, InstancedBVH):
        return scene.closest_hit(*camera.rays((width, height), dtype=scene.dtype))
    dtype = scene._positions.dtype
    t, u, v = (np.empty((height, width), dtype) for _ in range(3))
    face = np.empty((height, width), np.int32)
    _kernels.ray_cast(scene._tree, pinhole(camera, (width, height)), width, [a.reshape(-1) for a in (t, face, u, v)])
    return Hit(t, face, u, v)
