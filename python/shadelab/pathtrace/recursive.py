"""Ray tracing before path tracing: Whitted's recursion, and Cook's rays spread over everything."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import DTypeLike

from .. import _arrays
from .._kernels import pathtrace as _kernels
from ..accel import BVH
from ._common import Size, lens_camera, picture_size
from ._copies import Sharing
from ._world import Moment, World
from .estimate import Film, Traced
from .filters import FilterName, PixelFilter, pixel_filter

if TYPE_CHECKING:
    from ..scene import Scene

__all__ = ["distribution", "whitted"]


def whitted(
    scene: Scene,
    size: Size = (1280, 720),
    samples: int = 1,
    max_depth: int = 5,
    seed: int = 0,
    *,
    cutoff: float = 1e-3,
    start: int = 0,
    filter: FilterName | PixelFilter | None = None,
    instances: Sharing = "auto",
    bvh: BVH | None = None,
    dtype: DTypeLike = np.float32,
    progress: bool | Callable[[int, int], object] | None = None,
) -> Traced:
    """Whitted's picture: mirrors and glass by recursion, sharp shadows, no light between diffusers.

    Parameters
    ----------
    scene : Scene
        Of `shadelab.scene`.
    size : (width, height)
    samples : int
        Of each pixel, against jagged edges; nothing else is random.
    max_depth : int
        The most mirrors in a row, up to 64; 0 is plain ray casting with shadows: light from the lights alone.
    seed : int
        Of the samples' places.
    cutoff : float
        Branches that would carry less than this part of what they show are not followed.
    filter : str or PixelFilter, optional
        See `PixelFilter`; None looks through the pixel's centre with one sample, and is the box with more.
    start, instances, bvh, dtype, progress
        As in `path_trace`.

    Returns
    -------
    Traced
        With one sample the variance is not known: infinite.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    Area lights are asked at one point (their middle by their own parametrisation) and so cast sharp shadows;
    emitting faces and panoramas are seen, and shine on nothing. Bodies of glass cast shadows as if they were
    opaque. Smooth conductors, smooth interfaces and `Material` or `MetallicRoughness` (without compensation) of
    roughness 0 are mirrors here; all others, plastic's coat and the other models at roughness 0 among them, show
    the lights alone. In glass each surface sends two rays, so time may double with each of `max_depth`; `cutoff`
    bounds it, at an error of at most its size for each branch left out. Camera rays start at the lens where there
    is one; moving things are seen at times of the shutter, but one sample of each is a noisy lot: see
    `distribution`.

    References
    ----------
    T. Whitted, *An improved illumination model for shaded display*, 1980.
    R. A. Hall, D. P. Greenberg, *A testbed for realistic image synthesis*, 1983 (the cutoff).

    Examples
    --------
    >>> from shadelab import light, mesh, scene
    >>> lamp = light.DirectionalLight((0, 0, -1), irradiance=(np.pi,) * 3)
    >>> matt = scene.Material((0.5, 0.5, 0.5), specular=0.0)
    >>> card = scene.Instance(mesh.box(), materials=matt)
    >>> world = scene.Scene(card, lamp, scene.Camera((0, 0, 3), (0, 0, 0), fov_y=0.2))
    >>> whitted(world, (2, 2)).radiance[0, 0].round(6)
    array([0.5, 0.5, 0.5], dtype=float32)
    """
    samples = _arrays.count("samples", samples, 1, 1 << 24)
    if filter is None:
        filter = PixelFilter("box", 0.5 if samples > 1 else 0.0)
    depth = _arrays.count("max_depth", max_depth, 0, 64)
    cut = _arrays.number("cutoff", cutoff, 0)
    options = (filter, instances, bvh, dtype, progress)
    return _recursion("whitted", scene, size, samples, depth, seed, cut, start, *options)


def distribution(
    scene: Scene,
    size: Size = (1280, 720),
    samples: int = 64,
    max_depth: int = 5,
    seed: int = 0,
    *,
    start: int = 0,
    filter: FilterName | PixelFilter = "box",
    instances: Sharing = "auto",
    bvh: BVH | None = None,
    dtype: DTypeLike = np.float32,
    progress: bool | Callable[[int, int], object] | None = None,
) -> Traced:
    """Cook's picture: gloss, penumbrae, depth of field and motion blur, by rays spread over each.

    Parameters
    ----------
    scene : Scene
        Of `shadelab.scene`.
    size : (width, height)
    samples : int
        Of each pixel.
    max_depth : int
        The most mirrors in a row; 0 is light from the lights alone.
    seed, start, filter, instances, bvh, dtype, progress
        As in `path_trace`.

    Returns
    -------
    Traced

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    Unbiased for what it computes: light from the lights, from emitting faces and panoramas, reflected once by
    anything and before that by mirrors, rough or smooth, up to `max_depth` times. Glossy lobes and lights are both
    drawn from, and weighed by the power heuristic. Light that diffusers send each other is missing, if they are of
    `Diffuse`, `Material` or `MetallicRoughness` without compensation (of other models the diffuse part counts as
    gloss, and sends it on): a closed room is darker than `path_trace` makes it, and shadows without any light are
    black. Samples are independent: the error falls as 1/√samples. Things that move are traced at up to 64 moments a
    run, which all pixels share.

    References
    ----------
    R. L. Cook, T. Porter, L. Carpenter, *Distributed ray tracing*, 1984.

    Examples
    --------
    >>> from shadelab import light, mesh, scene
    >>> lamp = light.RectLight((0, 3, 0), (1, 0, 0), (0, 0, 1), (5, 5, 5))
    >>> distribution(scene.Scene(mesh.icosphere(2), lamp), (8, 8), 4).samples.max()
    np.int32(4)
    """
    depth = _arrays.count("max_depth", max_depth, 0, 1 << 16)
    options = (filter, instances, bvh, dtype, progress)
    return _recursion("distribution", scene, size, samples, depth, seed, 0.0, start, *options)


def _recursion(
    method: str,
    scene: Scene,
    size: Size,
    samples: int,
    max_depth: int,
    seed: int,
    cutoff: float,
    start: int,
    filter: FilterName | PixelFilter,
    instances: Sharing,
    bvh: BVH | None,
    dtype: DTypeLike,
    progress: bool | Callable[[int, int], object] | None,
) -> Traced:
    size = picture_size(size)
    samples = _arrays.count("samples", samples, 1, 1 << 24)
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    start = _arrays.count("start", start, 0, 2**32 - 1 - samples)
    kernel_filter = pixel_filter(filter)._kernel()
    world = World(scene, bvh, _arrays.precision("dtype", dtype), instances, size[0] * size[1] * samples)
    call = _arrays.progress_callback(progress, method)

    def trace(moment: Moment) -> Traced:
        n = size[0] * size[1]
        out: list[Any] = [np.empty((n, 3), world.dtype), np.empty((n, 3), world.dtype), np.empty(n, np.int32)]
        _kernels.recursion(
            method,
            world.given(moment),
            (lens_camera(scene.camera, size, moment.shutter), kernel_filter),
            (size[0], moment.samples, moment.start, max_depth, seed, cutoff),
            out,
            call,
        )
        shape = (size[1], size[0])
        mean, variance, outliers = out
        counts = np.full(shape, moment.samples, np.int32)
        return Traced(mean.reshape(*shape, 3), variance.reshape(*shape, 3), counts, outliers.reshape(shape))

    moments = world.moments(start, samples, seed)
    first = next(moments)
    if first.samples == samples:
        # Nothing to merge.
        return trace(first)
    film = Film((size[1], size[0]), world.dtype, False)
    for moment in (first, *moments):
        film.add(trace(moment))
    return film.picture()
