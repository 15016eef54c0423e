"""All light paths, with their error."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias, get_args

import numpy as np
from numpy.typing import DTypeLike, NDArray

from .. import _arrays, light
from .._arrays import Floats
from .._kernels import pathtrace as _kernels
from ..accel import BVH
from ._common import Estimate, Size, check_bvh, lens_camera, merge, picture_size, surface_offset
from .filters import PixelFilter, pixel_filter

if TYPE_CHECKING:
    from ..scene import Scene

__all__ = ["Traced", "path_trace"]

Strategy: TypeAlias = Literal["uniform", "bsdf", "light", "mis"]
Sampler: TypeAlias = Literal["sobol", "independent", "stratified", "latin_hypercube", "multi_jittered", "r2", "halton"]
LightSelection: TypeAlias = Literal["auto", "all", "power", "tree"]


class Traced(NamedTuple):
    """A path-traced picture."""

    radiance: Floats
    """Mean of the samples, (H, W, 3), in W/(m² sr)."""
    variance: Floats
    """Variance of that mean, (H, W, 3)."""
    samples: int
    """How many samples each pixel has."""

    def merge(self, other: Traced) -> Traced:
        """One estimate of this run and another over different samples (by `start` or by seed)."""
        return Traced(*merge(Estimate(*self), Estimate(*other)))


def path_trace(
    scene: Scene,
    size: Size = (1280, 720),
    samples: int = 64,
    max_depth: int = 8,
    seed: int = 0,
    *,
    start: int = 0,
    target_error: float | None = None,
    strategy: Strategy = "mis",
    roulette: int = 1,
    sampler: Sampler = "sobol",
    light_selection: LightSelection = "auto",
    filter: PixelFilter | str = "box",
    bvh: BVH | None = None,
    dtype: DTypeLike = np.float32,
    progress: bool | Callable[[int, int], object] | None = None,
) -> Traced:
    """The exact picture of a scene, up to noise: all light paths, by chance.

    Parameters
    ----------
    scene : Scene
        Of `shadelab.scene`.
    size : (width, height)
    samples : int
        Of each pixel; the most of them if `target_error` is given.
    max_depth : int
        The most reflections of a path: 0 shows emission alone, 1 direct light.
    seed : int
        The same seed gives the same bits whatever the threads; different ones are independent.
    start : int
        Index of the first sample, for going on where a run ended: `merge` the results.
    target_error : float, optional
        Stops once the picture's standard error (root mean square over pixels and channels) is this fraction of its
        mean radiance, asked after 16, 32, 64 … samples.
    strategy : {"mis", "light", "bsdf", "uniform"}
        How light is looked for: by directions evenly over the hemisphere, by those of the material, by asking lights,
        or by the material and the lights, weighed by the power heuristic. All agree in the mean. Beams (point and
        directional lights) are asked in each, since no direction finds them; by "light", only mirrors and the sky are
        left to directions.
    roulette : int
        Reflections before paths may end by chance, with the probability that they carry little; `max_depth` or more
        for never.
    sampler : {"sobol", "independent", "stratified", "latin_hypercube", "multi_jittered", "r2", "halton"}
        Where random numbers come from; see `shadelab.sampling`. Those with a grid plan `start + samples` of them.
    light_selection : {"auto", "all", "power", "tree"}
        Which lights a surface asks: all, or one drawn by its power, or one by a tree of bounds of what each may bring
        there. "auto" asks all at the first surface if they are at most four, and later one by its power; of more, or
        of more than four emitting faces, one by the tree.
    filter : PixelFilter or its name
        Of the pixels: where samples lie.
    bvh : BVH, optional
        Of the flattened scene, in `dtype`: of the same vertices and faces; built if None.
    dtype : float32 or float64
        Of the computation; sums are in double.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Returns
    -------
    Traced
        Radiance (H, W, 3), the variance of that mean, the number of samples.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    Unbiased up to `max_depth`. Time is the same for every sample, whatever their number, and memory does not grow with
    it. `variance` is that of independent samples: of scrambled points an upper bound as a rule, so two seeds tell more.
    Rectangles are seen from the side that shines, stop what meets it, and are not there from behind;
    surfaces have two sides. (`shadelab.render` draws no lights.) The camera's `near` and `far` cut nothing off:
    paths start at the eye. No firefly is clamped: caustics from narrow mirrors converge slowly, and `variance` shows
    where. Fails to find light that only a mirror chain leads to (point lights seen in mirrors).

    References
    ----------
    J. T. Kajiya, *The rendering equation*, 1986.
    E. Veach, *Robust Monte Carlo methods for light transport simulation*, 1997.

    Examples
    --------
    >>> from shadelab import mesh, scene
    >>> ball = scene.Scene(mesh.icosphere(2), background=(1.0, 1.0, 1.0))
    >>> path_trace(ball, (8, 8), samples=4).radiance.shape
    (8, 8, 3)
    """
    width, height = picture_size(size)
    samples = _arrays.count("samples", samples, 1, 1 << 24)
    max_depth = _arrays.count("max_depth", max_depth, 0, 1 << 16)
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    start = _arrays.count("start", start, 0, 2**32 - 1 - samples)
    if target_error is not None:
        target_error = _arrays.number("target_error", target_error, above=0.0)
    precision = np.dtype(dtype)
    if precision not in (np.dtype(np.float32), np.dtype(np.float64)):
        raise TypeError(f"dtype: expected float32 or float64, got {precision}")
    call = _arrays.progress_callback(progress, "path trace")
    names = (
        _arrays.choice("strategy", strategy, get_args(Strategy)),
        _arrays.choice("sampler", sampler, get_args(Sampler)),
        _arrays.choice("light_selection", light_selection, get_args(LightSelection)),
    )
    depths = max_depth, _arrays.count("roulette", roulette, 0, 1 << 16)
    trace = _tracer(scene, (width, height), depths, seed, names, pixel_filter(filter), bvh, precision)
    if target_error is None:
        return trace(start, samples, call)
    result = Traced(np.zeros((height, width, 3), precision), np.zeros((height, width, 3), precision), 0)
    while result.samples < samples:
        # Twice as many each time, so that the checks cost little.
        count = min(max(16, result.samples), samples - result.samples)
        result = result.merge(trace(start + result.samples, count, call))
        mean = float(result.radiance.mean(dtype=np.float64))
        if float(result.variance.mean(dtype=np.float64)) <= (target_error * mean) ** 2:
            break
    return result


def _tracer(
    scene: Scene,
    size: Size,
    depths: tuple[int, int],
    seed: int,
    names: tuple[str, str, str],
    pixels: PixelFilter,
    bvh: BVH | None,
    dtype: np.dtype[Any],
) -> Callable[[int, int, Any], Traced]:
    """A function of (start, samples, progress) that renders the scene."""
    arrays = scene.flatten(dtype)
    if bvh is None:
        bvh = BVH(arrays.positions, arrays.faces)
    else:
        check_bvh(bvh)
        own, mine = (bvh._positions, bvh._faces), (arrays.positions, arrays.faces)
        if own[0].dtype != dtype or not all(np.array_equal(a, b) for a, b in zip(own, mine, strict=True)):
            raise ValueError(f"bvh: expected one of the flattened scene in {dtype}")
    _arrays.warn_if_coarse(arrays.positions, dtype, 4)
    mesh = (arrays.positions, arrays.faces, arrays.normals, arrays.material_ids)
    tables = (arrays.kinds, arrays.rows, arrays.emission)
    flat = [np.require(a, requirements=["C", "A"]) for a in (*mesh, *tables)]
    view = lens_camera(scene.camera, size), pixels._kernel()
    sky = None if scene.environment is None else scene.environment._panorama(dtype)
    surroundings = (tuple(float(c) for c in scene.background), surface_offset(arrays.positions), sky)
    lights = light._table("lights", scene.lights)
    tree = bvh._tree

    def trace(start: int, samples: int, progress: Any) -> Traced:
        mean, variance = (np.empty((size[1], size[0], 3), dtype) for _ in range(2))
        options = ((size[0], samples, start, *depths, seed), names, np.inf)
        out: tuple[NDArray[Any] | None, ...] = (mean.reshape(-1, 3), variance.reshape(-1, 3), None, None)
        _kernels.path_trace(
            tree, flat[:4], arrays.colors, flat[4:], lights, surroundings, view, options, None, out, progress
        )
        return Traced(mean, variance, samples)

    return trace
