"""Light of many wavelengths: colours that mix as light does, and glass that parts them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays, brdf
from .._arrays import Floats
from ..accel import BVH
from ._common import Size
from .estimate import Traced
from .paths import path_trace

if TYPE_CHECKING:
    from ..scene import Scene

__all__ = ["Spectrum", "spectral"]

# Centres, and inverse deviations below and above them, of the lobes of the matching functions: Wyman and others' fit.
_LOBES = (
    ((0.362, 442.0, 0.0624, 0.0374), (1.056, 599.8, 0.0264, 0.0323), (-0.065, 501.1, 0.0490, 0.0382)),
    ((0.821, 568.8, 0.0213, 0.0247), (0.286, 530.9, 0.0613, 0.0322)),
    ((1.217, 437.0, 0.0845, 0.0278), (0.681, 459.0, 0.0385, 0.0725)),
)
# From CIE XYZ to linear light of sRGB's primaries (IEC 61966-2-1).
_TO_RGB = np.array(
    [[3.2404542, -1.5371385, -0.4985314], [-0.9692660, 1.8760108, 0.0415560], [0.0556434, -0.2040259, 1.0572252]]
)
_COLORS = {"radiance", "intensity", "irradiance", "base_color", "emission"}


def _matching(wavelengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """The CIE's matching functions of 1931 at wavelengths in nanometres, (n, 3)."""
    columns = []
    for lobes in _LOBES:
        column = np.zeros(wavelengths.shape)
        for height, centre, below, above in lobes:
            off = wavelengths - centre
            column += height * np.exp(-0.5 * (off * np.where(off < 0, below, above)) ** 2)
        columns.append(column)
    return np.stack(columns, -1)


class Spectrum(NamedTuple):
    """A picture of many wavelengths."""

    wavelengths: NDArray[np.float64]
    """(n,), in nanometres, increasing."""
    radiance: Floats
    """(H, W, n), in W/(m² sr nm) if that is the unit of what shines."""
    variance: Floats
    """Of those means, (H, W, n), were samples independent."""
    samples: NDArray[np.int32]
    """(H, W, n)"""

    def xyz(self) -> Floats:
        """The colour that an eye sees, (H, W, 3): CIE XYZ of 1931.

        Scaled so that radiance 1 of every wavelength has luminance 1. Integrals are sums over what each wavelength
        stands for: up to the middles between it and its neighbours, and as far beyond the outer two.

        Returns
        -------
        ndarray, shape (H, W, 3)
        """
        w = self.wavelengths
        middles = (w[1:] + w[:-1]) / 2
        ends = [[w[0] - 0.5], [w[0] + 0.5]] if len(w) == 1 else [[2 * w[0] - middles[0]], [2 * w[-1] - middles[-1]]]
        widths = np.diff(np.concatenate([ends[0], middles, ends[1]]))
        weights = _matching(w) * widths[:, None]
        luminance = float(weights[:, 1].sum())
        weights /= luminance if luminance > 0 else 1.0
        return (self.radiance.astype(np.float64) @ weights).astype(self.radiance.dtype)

    def rgb(self, white: ArrayLike | None = None) -> Floats:
        """Linear light of sRGB's primaries, (H, W, 3); negative in colours that they cannot mix.

        Parameters
        ----------
        white : array_like, shape (n,) or (), optional
            Radiance that is to be white: 1 in each channel. None leaves colours as they are: even light is reddish
            beside daylight.

        Returns
        -------
        ndarray, shape (H, W, 3)

        Raises
        ------
        ValueError
            If `white` is not of one number or of one each wavelength, or some channel of it is not positive.
        """
        picture = self.xyz().astype(np.float64) @ _TO_RGB.T
        if white is not None:
            given = np.asarray(_arrays.floats("white", white), np.float64)
            if given.shape not in ((), self.wavelengths.shape):
                raise ValueError(f"white: expected shape {self.wavelengths.shape}, got {given.shape}")
            even = np.broadcast_to(given, self.wavelengths.shape)[None, None]
            target = (self._replace(radiance=even).xyz() @ _TO_RGB.T)[0, 0]
            if not (target > 0).all():
                raise ValueError(f"white: expected light of all three primaries, got {target.round(4).tolist()}")
            picture = picture / target
        return picture.astype(self.radiance.dtype)


def spectral(
    scene: Callable[[float], Scene],
    size: Size = (1280, 720),
    samples: int = 16,
    max_depth: int = 8,
    seed: int = 0,
    *,
    wavelengths: ArrayLike = 30,
    low: float = 390.0,
    high: float = 720.0,
    start: int = 0,
    progress: bool | Callable[[int, int], object] | None = None,
    **options: Any,
) -> Spectrum:
    """All light paths at many wavelengths: reflectances, lights and refractive indices may depend on them as they like.

    Parameters
    ----------
    scene : callable
        From a wavelength in nanometres to the `Scene` as it is there: of its colours and radiances the first channel
        counts.
    size : (width, height)
    samples : int
        Of each pixel at each wavelength.
    max_depth, seed
        As in `path_trace`.
    wavelengths : int or array_like, shape (n,)
        How many: one in each of so many equal parts of [`low`, `high`], all shifted by one random number of `seed`, so
        that integrals over wavelengths have no bias. Or the wavelengths themselves, increasing.
    low, high : float
        Nanometres. Beyond the default ones lies 0.015 % of luminance.
    start : int
        Index of the first sample.
    progress : bool or callable, optional
        True for a bar, or called with (done, total), of pictures.
    **options
        All others of `path_trace`: `strategy`, `filter`, `dtype` … (but `bvh`).

    Returns
    -------
    Spectrum
        Radiance of each pixel at each wavelength, with its variance; `xyz` and `rgb` are what an eye makes of it.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain, or `scene` gives something else than scenes.

    Notes
    -----
    As exact as `path_trace`, a wavelength at a time: nothing is a band's mean, so light reflected twice is
    multiplied at each wavelength, where three channels multiply means (metamers part, saturated colours stay bright).
    Three wavelengths, a third of the range apart, go along one path where nothing but colours differs between
    their scenes (as their hero's companions do; they share its directions); so n wavelengths take a third of n
    pictures. Where anything else does (the index of a glass: dispersion; roughness, textures, environments) each takes
    a picture of its own. All pixels share the wavelengths: too few show as steps in fringes and bands in rainbows, not
    as noise. Samples of different wavelengths are different parts of one sequence, so their errors make up for each
    other in sums, and show as coloured noise. Time is that of the pictures, and of flattening each scene; memory is
    some 50 bytes a pixel and wavelength in float64, some 30 in float32.

    Matching functions are a fit, at most 0.014, 0.008 and 0.022 away from those of x, y and z (whose peaks are 1.06, 1
    and 1.78), and 0.004, 0.002 and 0.002 in the mean.

    References
    ----------
    A. Wilkie, S. Nawaz, M. Droske, A. Weidlich, J. Hanika, *Hero wavelength spectral sampling*, 2014.
    C. Wyman, P.-P. Sloan, P. Shirley, *Simple analytic approximations to the CIE XYZ color matching functions*, 2013.

    Examples
    --------
    A glass ball in even light, whose index falls with the wavelength (Cauchy's formula, dense flint).

    >>> from shadelab import brdf, mesh, scene
    >>> def flint(wavelength):
    ...     glass = brdf.Dielectric(1.7 + 13000 / wavelength**2)
    ...     return scene.Scene(scene.Instance(mesh.icosphere(3), materials=glass), background=(1, 1, 1))
    >>> picture = spectral(flint, (8, 8), 4, wavelengths=[450.0, 550.0, 650.0])
    >>> picture.radiance.shape, picture.rgb().shape
    ((8, 8, 3), (8, 8, 3))
    """
    if not callable(scene):
        raise TypeError(f"scene: expected a callable, from a wavelength to a Scene, got {type(scene).__name__}")
    if "bvh" in options:
        raise TypeError("bvh: expected none, one is built for all wavelengths whose surfaces are alike")
    samples = _arrays.count("samples", samples, 1, 1 << 24)
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    w = _wavelengths(wavelengths, low, high, seed)
    count = len(w)
    start = _arrays.count("start", start, 0, 2**32 - 1 - samples * count)
    call = _arrays.progress_callback(progress, "spectral")
    found: list[Traced | None] = [None] * count
    # A third of the range apart: (0, n / 3, 2 n / 3) and so on.
    stride = -(-count // 3)
    worlds = _Worlds(options)
    done = 0
    for k in range(stride):
        group = [i for i in range(k, count, stride)]
        scenes = [_scene(scene, float(w[i])) for i in group]
        for numbers, world in _merged(group, scenes):
            first = start + samples * done
            bvh = worlds.hierarchy(world)
            traced = path_trace(world, size, samples, max_depth, seed, start=first, bvh=bvh, **options)
            for channel, i in enumerate(numbers):
                found[i] = traced._replace(
                    radiance=traced.radiance[..., channel].copy(), variance=traced.variance[..., channel].copy()
                )
            done += len(numbers)
            if call is not None:
                call(done, count)
    pictures = [p for p in found if p is not None]
    columns = [np.stack([getattr(p, name) for p in pictures], -1) for name in ("radiance", "variance", "samples")]
    return Spectrum(w, *columns)


def _wavelengths(given: ArrayLike, low: float, high: float, seed: int) -> NDArray[np.float64]:
    if isinstance(given, int | np.integer):
        n = _arrays.count("wavelengths", given, 1, 1 << 16)
        low, high = _arrays.number("low", low, above=0), _arrays.number("high", high)
        if not low < high:
            raise ValueError(f"low: expected a number below high, got {low:g} and {high:g}")
        shift = np.random.Generator(np.random.Philox(key=[seed, n])).random()
        return np.asarray(low + (np.arange(n) + shift) * ((high - low) / n))
    w = np.asarray(_arrays.floats("wavelengths", given), np.float64)
    if w.ndim != 1 or not w.size or not np.isfinite(w).all() or not (w > 0).all() or not (np.diff(w) > 0).all():
        raise ValueError("wavelengths: expected a number, or increasing positive nanometres of shape (n,)")
    return w


def _scene(of: Callable[[float], Scene], wavelength: float) -> Scene:
    from ..scene import Scene

    made = of(wavelength)
    if not isinstance(made, Scene):
        raise TypeError(f"scene: expected a Scene at {wavelength:g} nm, got {type(made).__name__}")
    return made


class _Worlds:
    """Hierarchies, built anew only where surfaces differ from the last."""

    def __init__(self, options: dict[str, Any]) -> None:
        self.dtype = _arrays.precision("dtype", options.get("dtype", np.float32))
        self.flat = options.get("instances", "auto") == "flat"
        self.last: Any = None

    def hierarchy(self, scene: Scene) -> Any:
        # What stands in several places may be traced as copies, which have hierarchies of their own.
        if not self.flat and len({id(i.mesh) for i in scene.instances}) < len(scene.instances):
            return None
        arrays, last = scene.flatten(self.dtype), self.last
        if last is None or not (
            np.array_equal(arrays.positions, last.positions) and np.array_equal(arrays.faces, last.faces)
        ):
            self.last = BVH(arrays.positions, arrays.faces)
        return self.last


def _merged(group: list[int], scenes: list[Scene]) -> list[tuple[list[int], Scene]]:
    """One scene whose channels are those wavelengths', if colours alone differ; else each for itself."""
    if len(scenes) > 1:
        whole = _scenes_as_one([*scenes, scenes[-1]][:3])
        if whole is not None:
            return [(group, whole)]
    return [([i], s) for i, s in zip(group, scenes, strict=True)]


def _scenes_as_one(scenes: list[Scene]) -> Scene | None:
    first = scenes[0]
    if any(s.environment is not first.environment for s in scenes) or first.environment is not None:
        return None
    if any(s.camera != first.camera or len(s.instances) != len(first.instances) for s in scenes):
        return None
    instances = []
    for things in zip(*(s.instances for s in scenes), strict=True):
        one = things[0]
        same = all(
            _same_mesh(t.mesh, one.mesh)
            and _is_grey(t.mesh.colors)
            and np.array_equal(t.transform, one.transform)
            and _same(t.transform_end, one.transform_end)
            and len(t.materials) == len(one.materials)
            for t in things
        )
        materials = [_as_one(m) for m in zip(*(t.materials for t in things), strict=True)] if same else [None]
        if any(m is None for m in materials):
            return None
        instances.append(replace(one, materials=tuple(materials)))
    if any(len(s.lights) != len(first.lights) for s in scenes):
        return None
    lights = [_as_one(several) for several in zip(*(s.lights for s in scenes), strict=True)]
    if any(lamp is None for lamp in lights):
        return None
    red, green, blue = (float(s.background[0]) for s in scenes)
    return replace(first, instances=tuple(instances), lights=tuple(lights), background=(red, green, blue))


def _same(a: Any, b: Any) -> bool:
    return a is b or (a is not None and b is not None and np.array_equal(a, b))


def _is_grey(colors: Any) -> bool:
    return colors is None or bool((colors == colors[:, :1]).all())


def _same_mesh(a: Any, b: Any) -> bool:
    names = ("positions", "faces", "normals", "uvs", "colors", "material_ids")
    return a is b or all(_same(getattr(a, n), getattr(b, n)) for n in names)


def _as_one(things: Sequence[Any]) -> Any:
    """A material or light whose channels are those of several; None if anything but colours differs."""
    one: Any = things[0]
    if any(type(t) is not type(one) for t in things) or not is_dataclass(one):
        return None
    if isinstance(one, brdf.Principled | brdf.SpecularGlossiness):
        # Of their channels they take luminances and maxima: one does not stand for itself.
        return None
    if getattr(one, "texture", None) is not None:
        # Of its colours the first channel counts, which a merged scene would not show.
        return None
    changes: dict[str, Any] = {}
    for f in fields(one):
        values = [getattr(t, f.name) for t in things]
        color = f.metadata.get("core") == 3 if isinstance(one, brdf.Model) else f.name in _COLORS
        if color:
            changes[f.name] = tuple(float(v[0]) for v in values)
        elif not all(v is values[0] or _equal(v, values[0]) for v in values):
            return None
    made: Any = replace(one, **changes)  # type: ignore[type-var]
    return made


def _equal(a: Any, b: Any) -> bool:
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return type(a) is type(b) and np.array_equal(a, b)
    return type(a) is type(b) and bool(a == b)
