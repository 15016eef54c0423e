"""What techniques of shadows are off by in the picture that is planned, by rays; and what they cost."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import color, light, shadow
from .._arrays import Floats
from ..accel import BVH
from ._buffers import Seen, above_horizon, g_buffer
from ._charts import chart_of, lit_by
from ._facts import outline

# Pixels of the small picture in which shadows are tried, the rays that find where they have edges, how many places are
# measured, and the rays of their reference, under wide bounds and under narrow ones.
_LOOK, _FINDERS, _PLACES, _REFERENCE = 14400, 16, 1024, (256, 1024)
_NARROW = 0.05
# So many rays are measured; of more the square of the error falls at least as their number grows.
_MEASURED_RAYS = 64
# Edges reach a 60th of the picture's height to both sides. Where less light would arrive than this share of what is
# bright, errors are relative to that.
_REACH, _FLOOR = 60, 0.05
# Of fewer places than _FEW no penumbra is measured. Fewer than _SCARCE lie close together and say little: errors are
# then at least what is usual.
_FEW, _SCARCE, _CALM = 32, 128, 512
# Of events of which none was met in so many trials, that many may be expected with a chance of one in a hundred.
_UNSEEN = 4.6


def extended(lamp: Any) -> bool:
    """Whether a light has penumbrae."""
    return outline(lamp) is not None or isinstance(lamp, light.AmbientLight)


class Trial:
    """The small picture of a view, in which the shadows of its lights are tried."""

    def __init__(self, arrays: Any, camera: Any, size: tuple[int, int]) -> None:
        shrink = min(1.0, math.sqrt(_LOOK / (size[0] * size[1])))
        self.size = max(round(size[0] * shrink), 1), max(round(size[1] * shrink), 1)
        self.arrays, self.camera, self.full = arrays, camera, size

    @functools.cached_property
    def seen(self) -> Seen:
        return g_buffer(self.arrays, self.camera, self.size)

    @functools.cached_property
    def bvh(self) -> BVH:
        return BVH(self.arrays.positions, self.arrays.faces)

    @property
    def receivers(self) -> float:
        """Of the whole picture."""
        return len(self.seen.points) / (self.size[0] * self.size[1]) * self.full[0] * self.full[1]

    @property
    def slope(self) -> float:
        """How far a corner of the picture is aside at unit depth."""
        return math.tan(float(self.camera.fov_y) / 2.0) * math.hypot(1.0, self.full[0] / self.full[1])

    @functools.cached_property
    def depths(self) -> NDArray[np.float64]:
        """Of what is seen, along the view."""
        forward = -np.asarray(self.camera.view(), np.float64)[2]
        return np.asarray(self.seen.points @ forward[:3] + forward[3])

    @functools.cached_property
    def footprints(self) -> NDArray[np.float64]:
        """How wide a pixel of the whole picture is where it shows something."""
        pixel = 2.0 * math.tan(float(self.camera.fov_y) / 2.0) / self.full[1]
        return np.maximum(self.depths * pixel, 1e-300)


class OfLight:
    """Where the shadow of a light has edges, and what rays say there."""

    def __init__(self, trial: Trial, lamp: Any, narrow: bool = True) -> None:
        self.trial, self.lamp = trial, lamp
        seen = trial.seen
        bright = _brightness(lamp, seen, np.asarray(trial.camera.eye, np.float32))
        facing = bright > 0.0
        found = np.asarray(self._rays(slice(None), _FINDERS, 1), np.float64)
        share = _edges(found, facing, seen.covered, trial.full[1])
        at = np.flatnonzero(share)
        self.edges, self.few = len(at) > 0, 0 < len(at) < _SCARCE
        if not self.edges:
            at, share = np.flatnonzero(facing), np.ones(len(facing))
        self.at = at
        if extended(lamp):
            # Elsewhere all are known already.
            rng = np.random.default_rng(len(at))
            self.at = np.sort(rng.choice(at, min(len(at), _PLACES), replace=False))
        floor = _FLOOR * float(np.quantile(bright[facing], 0.98)) if facing.any() else 1.0
        self.weight = np.minimum(bright[self.at] / max(floor, 1e-300), 1.0)
        self.share = share[self.at]
        # Elsewhere all that the finders found is sure.
        calm = np.flatnonzero(facing & (share == 0.0))
        self.calm = calm[:: max(len(calm) // _CALM, 1)]
        self.sure = found[self.calm]
        self.exact = found[self.at]
        if extended(lamp):
            self.exact = np.asarray(self._rays(self.at, _REFERENCE[narrow], 2), np.float64)
        self._charts: dict[Any, Any] = {}

    def _rays(self, at: Any, samples: int, seed: int) -> Any:
        how = {"technique": "ray_traced", "samples": samples, "seed": seed}
        seen = self.trial.seen
        return lit_by(how, self.lamp, seen.points[at], seen.geometric[at], None, self.trial.bvh)

    def chart(self, settings: Mapping[str, Any]) -> Any:
        """A map as the frame would draw it."""
        key = tuple(sorted(settings.items()))
        if key not in self._charts:
            t = self.trial
            self._charts[key] = chart_of(settings, t.arrays, self.lamp, t.camera, t.full, t.seen.points)
        return self._charts[key]

    def expected(self, chart: Mapping[str, Any] | None, how: Mapping[str, Any]) -> float:
        """What a technique is off by: the root mean square over the places of the direct light's error.

        Or over the places elsewhere, if that is more. In units of what would arrive with nothing in between; three
        standard errors of the square are added to it for the places that were not looked at, and some such places where
        lookups are right or wrong.
        """
        soft = extended(self.lamp)
        if not len(self.at) or (chart is None and not soft):
            return 0.0
        more = 1.0
        if chart is None:
            found = self._rays(self.at, min(how["samples"], _MEASURED_RAYS), 3)
            more = max(how["samples"] / _MEASURED_RAYS, 1.0)
        else:
            found = self._mapped(chart, how, self.at)
        square = (self.weight * (found - self.exact)) ** 2
        mean, total = float(np.average(square, weights=self.share)), float(self.share.sum())
        places = total**2 / float((self.share**2).sum())
        above = 3.0 * math.sqrt(float(np.average((square - mean) ** 2, weights=self.share)) / places)
        if how["technique"] == "hard" or (chart is None and how["samples"] == 1) or not soft or (self.few and chart):
            above += _UNSEEN / total
        error = math.sqrt((mean + above) / more)
        if self.few and chart is None:
            # Too few places to learn from: what independent rays are off by over an even penumbra.
            error = max(error, math.sqrt(1.0 / (6.0 * how["samples"])))
        if chart is None or not len(self.calm):
            return error
        # Light that leaks into shadows, or slopes that shade themselves.
        leaks = float(np.mean((self._mapped(chart, how, self.calm) - self.sure) ** 2))
        return max(error, math.sqrt(leaks))

    def _mapped(self, chart: Mapping[str, Any], how: Mapping[str, Any], at: Any) -> NDArray[np.float64]:
        seen = self.trial.seen
        lit = lit_by(how, self.lamp, seen.points[at], seen.geometric[at], self.chart(chart), None, seen.points)
        return np.asarray(lit, np.float64)

    def texels(self, settings: Mapping[str, Any]) -> float:
        """How many pixels a texel is wide, but for the hundredth of what is seen where it is widest."""
        chart, points = self.chart(settings), self.trial.seen.points
        wide = np.zeros(len(points))
        several = chart.maps if isinstance(chart, shadow.MapSet) else (chart,)
        which = chart.index(points) if len(several) > 1 else np.zeros(len(points), np.intp)
        for i, m in enumerate(several):
            far = (points - m.position) @ m.axis if m.projection == "perspective" else np.ones(len(points))
            wide = np.where(which == i, m.texel_size() * np.maximum(far, 0.0), wide)
        return float(np.quantile(wide / self.trial.footprints, 0.99)) if len(points) else 0.0

    def penumbrae(self, settings: Mapping[str, Any]) -> tuple[float, float, float, float] | None:
        """How wide penumbrae are by a map: all but a tenth, a tenth and the widest in pixels, the middle in the world.

        In pixels as they lie on surfaces of any tilt. None if there are hardly any.
        """
        points, normals = self.trial.seen.points[self.at], self.trial.seen.geometric[self.at]
        chart = self.chart(settings)
        found = shadow.pcss(chart, points, normals, full_output=True)
        away = (chart if isinstance(chart, shadow.ShadowMap) else chart.maps[0]).position - points
        tilt = np.abs((away * normals).sum(-1)) / np.maximum(np.linalg.norm(away, axis=-1), 1e-300)
        footprints = self.trial.footprints[self.at] * np.maximum(tilt, 1e-3)
        there = found.penumbra > 0.0
        if there.sum() < _FEW:
            return None
        low, high, most = np.quantile(found.penumbra[there] / footprints[there], [0.1, 0.9, 1.0])
        return float(low), float(high), float(most), float(np.median(found.penumbra[there]))


def _brightness(lamp: Any, seen: Seen, eye: Floats) -> NDArray[np.float64]:
    """The luminance that white surfaces would show in a light with nothing in between."""
    if not len(seen.points):
        return np.zeros(0)
    white = np.ones(3, np.float32)
    lit = light.unshadowed(lamp, seen.points, seen.geometric, white, specular=0.0, eye=eye)
    bright = np.nan_to_num(color.luminance(lit).astype(np.float64))
    return np.where(above_horizon(lamp, seen), bright, 0.0) if outline(lamp) is not None else bright


def _edges(
    lit: NDArray[np.float64], facing: NDArray[np.bool_], covered: NDArray[np.bool_], height: int
) -> NDArray[np.float64]:
    """How much receivers count: 1 in a penumbra, or beside a step of the shadow; less next to these, or not at all.

    So that what is next to them counts as in a picture of some height, where pixels are smaller.
    """
    picture = np.full(covered.shape, np.nan)
    picture[covered] = np.where(facing, lit, np.nan)
    found = (picture > 0.0) & (picture < 1.0)
    for axis in (0, 1):
        # Comparisons with NaN, where nothing is lit, are false.
        step = np.abs(np.diff(picture, axis=axis)) > 0.0
        pad = [(0, 0), (0, 0)]
        for before in (0, 1):
            pad[axis] = (before, 1 - before)
            found |= np.pad(step, pad)
    # Both pixels of a step, and those within reach of them.
    beside = max((1 + max(1, round(height / _REACH))) * covered.shape[0] / height - 1.0, 0.0)
    reach = math.ceil(beside)
    wide = found
    for axis in (0, 1):
        padded = np.moveaxis(wide, axis, 0)
        grown = padded.copy()
        for k in range(1, reach + 1):
            grown[k:] |= padded[:-k]
            grown[:-k] |= padded[k:]
        wide = np.moveaxis(grown, 0, axis)
    share = np.where(found, 1.0, np.where(wide, beside / max(reach, 1), 0.0))
    return np.where(facing, share[covered], 0.0)


# Nanoseconds of a lookup into maps of moments, by filter.
_LOOKED_UP = {"gaussian": 80.0, "mip": 185.0, "summed_area": 280.0}


def milliseconds(
    chart: Mapping[str, Any] | None, how: Mapping[str, Any], receivers: float, faces: int, built: bool, parallel: bool
) -> float:
    """What a technique costs on one thread: its map, or its tree if that is not built, and the lookups of receivers.

    Rays of parallel light keep together, and its map is fitted to the receivers.

    As measured (AVX2, 2.5 GHz, one thread): it ranks; times on other machines differ, ratios hardly.
    """
    technique = how["technique"]
    if chart is None:
        tree = 0.0 if built else 0.5e-3 * faces
        ray = (40.0 + 10.0 * math.log2(max(faces, 2))) * (0.5 if parallel else 1.0)
        return tree + 1e-6 * receivers * how["samples"] * ray
    area, kind = float(chart["resolution"]) ** 2, chart.get("kind", "single")
    count = 6 if kind == "cube" else chart.get("cascades", 1)
    if kind == "virtual":
        drawn, beside = 8.0 + 0.4e-3 * faces + 70e-6 * receivers, 60.0
    elif count > 1:
        drawn, beside = 3.0 + count * (7e-6 * area + 0.3e-3 * faces), 30.0
    else:
        drawn, beside = 4.0 + 7.5e-6 * area + 0.45e-3 * faces, 55.0 if parallel else 0.0
    if technique in ("variance", "exponential_variance", "moment", "variance_soft"):
        filter_ = how.get("filter", "mip" if technique == "variance_soft" else "gaussian")
        passes = 24.0 if filter_ == "gaussian" else 20.0
        drawn += 1e-6 * count * area * (3.3 + passes / how.get("reduce", 1) ** 2)
        each = _LOOKED_UP[filter_]
    elif technique == "hard":
        each = 25.0
    elif technique == "pcf":
        each = 30.0 + 3.2 * how["samples"] * (4.0 if how.get("bilinear") else 1.0)
    else:
        each = 80.0 + 5.5 * (how["blocker_samples"] + how["filter_samples"])
    return drawn + 1e-6 * receivers * (each + beside)
