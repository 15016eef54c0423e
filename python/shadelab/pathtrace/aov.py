"""What the camera sees beside light."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from .. import _arrays, brdf
from .._arrays import Floats
from .._kernels import pathtrace as _kernels
from ..accel import BVH
from ._common import Size, lens_camera, picture_size
from ._copies import Sharing
from ._world import Moment, World
from .filters import FilterName, PixelFilter, pixel_filter

if TYPE_CHECKING:
    from ..scene import Scene

__all__ = ["AOVs", "aovs"]


class AOVs(NamedTuple):
    """Pictures of what is seen, (H, W) or (H, W, n); zeros and −1 where nothing is."""

    albedo: Floats
    """(H, W, 3) base colour, linear; one for glass."""
    normal: Floats
    """(H, W, 3) shading normal in the world, as the mesh has it; a mean of several is shorter than one."""
    depth: Floats
    """Along the camera's axis; infinite where nothing is."""
    position: Floats
    """(H, W, 3) in the world."""
    coverage: Floats
    """Part of the pixel's samples that meet something."""
    face: NDArray[np.int32]
    """Of the flattened scene."""
    instance: NDArray[np.int32]
    """Of `Scene.instances`."""
    material: NDArray[np.int32]
    """Of `SceneArrays.materials`."""
    motion: Floats
    """(H, W, 2) pixels to the right and down that what is seen goes from time 0 to time 1."""


def aovs(
    scene: Scene,
    size: Size = (1280, 720),
    samples: int = 0,
    *,
    filter: FilterName | PixelFilter = "box",
    seed: int = 0,
    start: int = 0,
    instances: Sharing = "auto",
    bvh: BVH | None = None,
    dtype: DTypeLike = np.float32,
    progress: bool | Callable[[int, int], object] | None = None,
) -> AOVs:
    """What the camera sees beside light: albedo, normal, depth, position, identity and motion of each pixel.

    Parameters
    ----------
    scene : Scene
        Of `shadelab.scene`.
    size : (width, height)
    samples : int
        Of each pixel, over its filter, the lens and the time that the shutter is open; 0 looks through the pixels'
        centres from the middle of the lens, at time 0.
    filter : str or PixelFilter
        See `PixelFilter`.
    seed, start, instances, bvh, dtype, progress
        As in `path_trace`.

    Returns
    -------
    AOVs
        Albedo, normal and coverage are means over all samples, depth and position over those that meet something.
        Face, instance, material and motion are of the pixel's centre at time 0, whatever `samples`.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    Sums are in double. Motion is zero to the bit where nothing moves; the sky moves as its direction does. It is not
    finite for what comes to lie in the plane of the moved eye.

    References
    ----------
    T. Saito, T. Takahashi, *Comprehensible rendering of 3-D shapes*, 1990.

    Examples
    --------
    >>> from shadelab import mesh, scene
    >>> ball = scene.Scene(mesh.icosphere(2), camera=scene.Camera((0, 0, 4), (0, 0, 0), fov_y=0.3))
    >>> seen = aovs(ball, (3, 3))
    >>> seen.depth.round(1)[1], seen.coverage[0]
    (array([3.1, 3. , 3.1], dtype=float32), array([1., 1., 1.], dtype=float32))
    """
    size = picture_size(size)
    samples = _arrays.count("samples", samples, 0, 1 << 24)
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    start = _arrays.count("start", start, 0, 2**32 - 1 - samples)
    kernel_filter = pixel_filter(filter)._kernel()
    world = World(scene, bvh, _arrays.precision("dtype", dtype), instances, size[0] * size[1] * (samples + 1))
    call = _arrays.progress_callback(progress, "aovs")
    moved = world.at(1.0)[0].positions if scene.moves else None
    # What passes through glass keeps its colour.
    arrays = world.all_arrays(world.arrays)
    clear = [isinstance(m, brdf.Dielectric | brdf.RoughDielectric) for m in arrays.materials]
    albedo = np.where(np.array(clear)[:, None], world.dtype.type(1), arrays.base_color)
    numbers = world.numbers()

    def look(moment: Moment) -> AOVs:
        out = _empty(size, world.dtype)
        order: list[NDArray[Any]] = [out.coverage, out.albedo, out.normal, out.depth, out.position]
        order += [out.face, out.instance, out.material, out.motion]
        _kernels.aovs(
            world.given(moment),
            [*numbers.instances, albedo],
            moved,
            (lens_camera(scene.camera, size, moment.shutter), kernel_filter),
            (size[0], moment.samples, moment.start, seed),
            [x.reshape(-1, x.shape[2]) if x.ndim == 3 else x.reshape(-1) for x in order],
            call,
        )
        numbers.flattened(out.face, out.instance, out.material)
        return out

    if not scene.moves or samples == 0:
        return look(Moment(start, samples, world.arrays, world.bvh, None))
    return _mean([(m.samples, look(m)) for m in world.moments(start, samples, seed)], look, world)


def _empty(size: Size, dtype: np.dtype[Any]) -> AOVs:
    shape = (size[1], size[0])
    albedo, normal, depth, position, coverage = (np.empty(shape + t, dtype) for t in ((3,), (3,), (), (3,), ()))
    face, instance, material = (np.empty(shape, np.int32) for _ in range(3))
    return AOVs(albedo, normal, depth, position, coverage, face, instance, material, np.empty((*shape, 2), dtype))


def _mean(parts: list[tuple[int, AOVs]], look: Callable[[Moment], AOVs], world: World) -> AOVs:
    """The means of pictures at several moments, with identity and motion at time 0."""
    centre = look(Moment(0, 0, world.arrays, world.bvh, None))
    total = sum(count for count, _ in parts)
    coverage = np.sum([count * p.coverage.astype(np.float64) for count, p in parts], 0)

    def over_all(name: str) -> Floats:
        return (np.sum([n * getattr(p, name).astype(np.float64) for n, p in parts], 0) / total).astype(world.dtype)

    def over_hits(name: str) -> Floats:
        sums = np.zeros(getattr(centre, name).shape)
        for count, p in parts:
            value, weight = getattr(p, name).astype(np.float64), count * p.coverage.astype(np.float64)
            weight = weight[..., None] if value.ndim == 3 else weight
            sums = sums + np.where(weight > 0, value, 0.0) * weight
        weight = coverage[..., None] if np.ndim(sums) == 3 else coverage
        return (sums / np.where(weight > 0, weight, 1.0)).astype(world.dtype)

    depth = np.where(coverage > 0, over_hits("depth"), np.inf).astype(world.dtype)
    return centre._replace(
        albedo=over_all("albedo"),
        normal=over_all("normal"),
        depth=depth,
        position=over_hits("position"),
        coverage=(coverage / total).astype(world.dtype),
    )
