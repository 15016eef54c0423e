"""All light paths, with their error."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import DTypeLike, NDArray

from .. import _arrays
from .._kernels import pathtrace as _kernels
from ..accel import BVH
from ._common import Size, lens_camera, picture_size
from ._copies import Sharing
from ._world import World
from .estimate import PILOT, Film, Traced, rounds
from .filters import PixelFilter, pixel_filter

if TYPE_CHECKING:
    from ..scene import Scene

__all__ = ["Traced", "path_trace", "progressive"]

Strategy: TypeAlias = Literal["uniform", "bsdf", "light", "mis"]
Sampler: TypeAlias = Literal["sobol", "independent", "stratified", "latin_hypercube", "multi_jittered", "r2", "halton"]
LightSelection: TypeAlias = Literal["auto", "all", "power", "tree"]
_STRATEGIES, _SAMPLERS, _SELECTIONS = get_args(Strategy), get_args(Sampler), get_args(LightSelection)


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
    clamp: float | None = None,
    instances: Sharing = "auto",
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
        Each square of 8 × 8 pixels stops once the standard error of its pixels (root mean square over them and their
        channels) is this fraction of its mean radiance (of a twentieth of the picture's, if it is darker), asked after
        32, 64, 128 … samples. See Notes for its bias.
    strategy : {"mis", "light", "bsdf", "uniform"}
        How light is looked for: by directions evenly over the hemisphere, by those of the material, by asking lights,
        or by the material and the lights, weighed by the power heuristic. All agree in the mean. Beams (point and
        directional lights) are asked in each, since no direction finds them; by "light", only mirrors and the sky are
        left to directions.
    roulette : int
        Reflections before paths may end by chance, with the probability that they carry little; `max_depth` or more
        for never.
    sampler : {"sobol", "independent", "stratified", "latin_hypercube", "multi_jittered", "r2", "halton"}
        Where random numbers come from; see `shadelab.sampling`. "stratified", "latin_hypercube" and "multi_jittered"
        points are sets of a size: the `samples` of a run from `start` are one, and so is each round of `target_error`
        and of `progressive`, stratified for itself and independent of the others.
    light_selection : {"auto", "all", "power", "tree"}
        Which lights a surface asks: all, or one drawn by its power, or one by a tree of bounds of what each may bring
        there. "auto" asks all at the first surface if they are at most four, and later one by its power; of more, or
        of more than four emitting faces, one by the tree.
    filter : PixelFilter or its name
        Of the pixels: where samples lie.
    clamp : float, optional
        Samples whose largest channel exceeds this are scaled down to it. Biased; by how much is measured: `removed`.
        None clamps nothing.
    instances : {"auto", "flat", "shared"}
        Meshes that stand in several places are copied to each, or kept once and traced by two levels. "auto" shares
        them where that is quicker or spares a gigabyte; a `bvh` given is of the flattened scene. See Notes.
    bvh : BVH, optional
        Of the flattened scene, in `dtype`: of the same vertices and faces; built if None.
    dtype : float32 or float64
        Of the computation; sums are in double.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Returns
    -------
    Traced
        Radiance (H, W, 3), the variance of that mean, the number of samples of each pixel, the number of outliers among
        them, and what `clamp` took away.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    Unbiased up to `max_depth`, without `clamp` and `target_error`. Samples take the same time within a tenth, from 128²
    to 2048² pixels and from one to 4,096 of each, and memory does not grow with them.
    `variance` is that of independent samples: of scrambled points an upper bound as a rule, so two seeds tell more.
    Lights of some size are seen from the side that shines, stop there what meets them, other lights' and the sky's
    light too, and are not there from behind; surfaces have two sides. (`shadelab.render` draws no lights.) The camera's
    `near` and `far` cut nothing off: paths start at the eye. Light that comes evenly from everywhere (background,
    `AmbientLight`, an environment of one colour) is left to directions whatever the strategy: asking for it too took a
    bunny 1.6 to 2.6 times as long to the same error. Of a panorama each surface draws two directions, and looks along
    the one kept by what it would bring. No firefly is clamped: caustics from narrow mirrors converge slowly, and
    `variance` shows where, and `outliers` how often one sample outweighed all before it.

    What is made of the scene (arrays, a hierarchy: some 200 bytes a face) is kept for the next picture of it, until
    another scene is traced or this one is gone, here and by `aovs`, `whitted` and `distribution`. Changes to its arrays
    are seen, by hashes of them (0.3 ms a megabyte).

    Stopping at `target_error` is biased: a square that by chance has met no bright path yet thinks itself done.
    Measured over ten pictures of 24 × 16: a floor under an area light, none to 0.05 % at targets of 0.1 and 0.03; the
    same floor under a small panel that only the material's directions look for (one in hundreds finds it), −2.5 % ±
    0.5 % at targets of 0.3 and 0.1. `outliers` are a warning there. Samples whose number is given in advance have no
    such bias.

    With a lens (`Camera.aperture`) each sample has its point of it, and with a camera that moves its own time. Where
    things move (`Instance.transform_end`), the scene is traced at up to 64 moments of the shutter a run, each with its
    hierarchy refitted, which all pixels share: their errors are then alike, and fast edges show steps; further runs by
    `start` add moments.

    A mesh kept once takes 1.6 KB a place, and its flattened copies 190 bytes a face while they are built; but rays
    through two levels take 2.4 times as long (0.2 to 0.6 µs more each), and a face takes 0.5 to 0.8 µs to flatten and
    build. So "auto" shares where more than 250,000 faces and three a sample are spared, or five million. Kept
    once are instances of the same `Mesh` object that do not move, emit nothing, are not flat, and have normals of their
    own or matrices that keep angles; the others are flattened. The picture is the flattened one but for rounding.

    Fails to find light that only a mirror chain leads to (point lights seen in mirrors).

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
    prepared = _prepare(
        scene,
        size,
        samples,
        max_depth,
        seed,
        start=start,
        strategy=strategy,
        roulette=roulette,
        sampler=sampler,
        light_selection=light_selection,
        filter=filter,
        clamp=clamp,
        instances=instances,
        bvh=bvh,
        dtype=dtype,
        progress=progress,
    )
    if target_error is None:
        return prepared.whole()
    *_, last = prepared.rounds(PILOT, _arrays.number("target_error", target_error, above=0.0))
    return last


def progressive(
    scene: Scene,
    size: Size = (1280, 720),
    samples: int = 4096,
    max_depth: int = 8,
    seed: int = 0,
    *,
    first: int = 1,
    target_error: float | None = None,
    **options: Any,
) -> Iterator[Traced]:
    """Pictures that get better: an iterator of frames with `first`, twice, four times … as many samples.

    Parameters
    ----------
    scene, size, max_depth, seed
        As in `path_trace`.
    samples : int
        Of each pixel, in the last frame.
    first : int
        Of each pixel, in the first frame.
    target_error : float, optional
        As in `path_trace`: later frames refine the tiles that need it, and the last comes when none does.
    **options
        All others of `path_trace`: `start`, `strategy`, `filter`, `clamp`, `progress` …; progress counts anew for each
        frame.

    Returns
    -------
    iterator of Traced
        Each frame holds all samples so far; stop whenever it is good enough. Frames are the user's own arrays.

    Raises
    ------
    TypeError, ValueError
        At once, if an argument is out of its domain.

    Notes
    -----
    The last frame is `path_trace`'s picture but for rounding if the sampler is a sequence; of points in sets
    ("stratified", "latin_hypercube", "multi_jittered") each round is a set of its own. All frames
    together cost as much, and memory does not grow with samples. Leaving the loop at a frame that looks good biases the
    picture as `target_error` does.

    Examples
    --------
    >>> from shadelab import mesh, scene
    >>> ball = scene.Scene(mesh.icosphere(2), background=(1.0, 1.0, 1.0))
    >>> [int(frame.samples.max()) for frame in progressive(ball, (8, 8), samples=10)]
    [1, 2, 4, 8, 10]
    """
    first = _arrays.count("first", first, 1)
    if target_error is not None:
        target_error = _arrays.number("target_error", target_error, above=0.0)
    return _prepare(scene, size, samples, max_depth, seed, **options).rounds(first, target_error)


class _Prepared:
    """A scene ready to be traced, round by round."""

    def __init__(self, world: World, size: Size, start: int, samples: int, seed: int) -> None:
        self.world, self.size, self.start, self.samples, self.seed = world, size, start, samples, seed
        self.depths: tuple[int, int] = (0, 0)
        self.names: tuple[str, str, str] = ("", "", "")
        self.filter: tuple[str, float, float] = ("box", 0.5, 1.0)
        self.clamp = math.inf
        self.progress: Any = None

    def film(self) -> Film:
        return Film((self.size[1], self.size[0]), self.world.dtype, math.isfinite(self.clamp))

    def whole(self) -> Traced:
        """All samples at once."""
        parts = self.parts(self.start, self.samples, None)
        first = next(parts)
        if first.samples[0, 0] == self.samples:
            # Nothing to merge, which would cost as much as a tenth of a picture of one sample.
            return first
        film = self.film()
        for part in (first, *parts):
            film.add(part)
        return film.picture()

    def rounds(self, first: int, target: float | None) -> Iterator[Traced]:
        return rounds(self.parts, self.film(), self.start, self.samples, first, target)

    def parts(self, start: int, samples: int, pixels: NDArray[np.int32] | None) -> Iterator[Traced]:
        """Samples of the picture, or of the pixels listed in one row, by the moments at which they see the scene."""
        dtype, size = self.world.dtype, self.size
        shape = (size[1], size[0]) if pixels is None else (1, len(pixels))
        for moment in self.world.moments(start, samples, self.seed):
            mean, variance = (np.empty((*shape, 3), dtype) for _ in range(2))
            # By `fill`, since `full` takes as long as a hundred paths where caches are cold.
            outliers, counted = np.empty(shape, np.int32), np.empty(shape, np.int32)
            counted.fill(moment.samples)
            removed = np.empty((*shape, 3), dtype) if math.isfinite(self.clamp) else None
            out = [mean.reshape(-1, 3), variance.reshape(-1, 3), outliers.reshape(-1)]
            counts = (size[0], moment.samples, moment.start, *self.depths, self.seed)
            _kernels.path_trace(
                self.world.given(moment),
                (lens_camera(self.world.scene.camera, size, moment.shutter), self.filter),
                (counts, self.names, self.clamp, (start, samples)),
                pixels,
                [*out, None if removed is None else removed.reshape(-1, 3)],
                self.progress,
            )
            yield Traced(mean, variance, counted, outliers, removed)


def _prepare(
    scene: Scene,
    size: Size,
    samples: int,
    max_depth: int,
    seed: int,
    *,
    start: int = 0,
    strategy: Strategy = "mis",
    roulette: int = 1,
    sampler: Sampler = "sobol",
    light_selection: LightSelection = "auto",
    filter: PixelFilter | str = "box",
    clamp: float | None = None,
    instances: Sharing = "auto",
    bvh: BVH | None = None,
    dtype: DTypeLike = np.float32,
    progress: bool | Callable[[int, int], object] | None = None,
) -> _Prepared:
    size = picture_size(size)
    samples = _arrays.count("samples", samples, 1, 1 << 24)
    depth = _arrays.count("max_depth", max_depth, 0, 1 << 16)
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    start = _arrays.count("start", start, 0, 2**32 - 1 - samples)
    names = (
        _arrays.choice("strategy", strategy, _STRATEGIES),
        _arrays.choice("sampler", sampler, _SAMPLERS),
        _arrays.choice("light_selection", light_selection, _SELECTIONS),
    )
    roulette = _arrays.count("roulette", roulette, 0, 1 << 16)
    kernel_filter = pixel_filter(filter)._kernel()
    limit = math.inf if clamp is None else _arrays.number("clamp", clamp, above=0.0)
    rays = size[0] * size[1] * samples
    world = World(scene, bvh, _arrays.precision("dtype", dtype), instances, rays, all_directions=True)
    made = _Prepared(world, size, start, samples, seed)
    made.depths, made.names, made.filter, made.clamp = (depth, roulette), names, kernel_filter, limit
    made.progress = _arrays.progress_callback(progress, "path trace")
    return made
