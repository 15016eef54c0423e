"""How the shadow of a light is found."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .. import _arrays, light, shadow
from ._buffers import g_buffer
from ._facts import RESOLUTIONS, Facts, beyond_one_map, outline, resolution_for, too_close, widest_penumbra
from .passes import LeftOut, Pass

# Rays of each pixel into the hemisphere, and the most towards a light.
_OCCLUSION, _RAYS = 32, 4096
_EDGES = "what is off is its edges, by the map's texels"
_TECHNIQUES = (
    "hard", "pcf", "pcss", "variance", "exponential_variance", "moment", "variance_soft", "ray_traced",
)  # fmt: skip


def picked(evidence: Any, max_error: float | None, budget_ms: float | None) -> tuple[str, dict[str, Any], str]:
    """Technique, settings and reason, as a study measured them."""
    bounds = {"max_error": max_error, "budget_ms": budget_ms}
    asked = {k: _arrays.number(k, v, above=0.0) for k, v in bounds.items() if v is not None}
    if not asked:
        raise ValueError("evidence: expected max_error or budget_ms beside it")
    if not callable(getattr(evidence, "pick", None)):
        raise TypeError(f"evidence: expected the result of a study, got {type(evidence).__name__}")
    choice = evidence.pick(**asked)
    if choice is None:
        raise ValueError(f"evidence: nothing that was measured keeps {asked}")
    if choice.technique not in _TECHNIQUES:
        raise ValueError(f"evidence: expected a technique among {', '.join(_TECHNIQUES)}, got {choice.technique!r}")
    wanted = " and ".join(f"{k} {v:g}" for k, v in asked.items())
    unit, scale = getattr(choice, "unit", ("ms", 1.0))
    if unit != "ms" and budget_ms is not None:
        raise ValueError(f"budget_ms: expected evidence that was judged by time, got a study of {unit}")
    price = f"{choice.ms:.3g} ms"
    if unit != "ms":
        price += f" and {choice.cost_interval.value * scale:.3g} {unit}"
    reason = f"measured: error {choice.error:.3g} in {price}, the choice for {wanted}"
    return choice.technique, dict(choice.knobs), reason


# How many pixels a texel may cover where a view is nearest before one map is no longer enough, the largest map, and the
# most cascades. What filters read about a receiver must lie in its map.
_COARSEST, _LARGEST, _MOST, _BORDER = 4.0, RESOLUTIONS[-1], 6, 8
_LOOK = (96, 54)


def seen_depths(arrays: Any, camera: Any) -> tuple[float, float] | None:
    """The least and the greatest depth of what a camera sees; None if it sees nothing."""
    seen = g_buffer(arrays, camera, _LOOK)
    if not len(seen.points):
        return None
    forward = -np.asarray(camera.view(), np.float64)[2]
    depth = seen.points @ forward[:3] + forward[3]
    return float(depth.min()), float(depth.max())


def parted(facts: Facts, view: tuple[float, float] | None, slope: float) -> tuple[dict[str, Any], str]:
    """Cascades for parallel light where one map's texels are too large for a view; else one map's resolution, and why.

    `slope` is how far a corner of the picture is aside at unit depth.
    """
    least = resolution_for(facts)
    if view is None or not view[0] > 0.0:
        return {"resolution": least}, "one map serves what is in view"
    nearest, farthest = view

    def wide(resolution: int) -> float:
        # A map reaches two texels beyond what it is fitted to.
        return facts.extent / (resolution - 4) / (nearest * facts.pixel)

    resolution = next((r for r in RESOLUTIONS if r >= least and wide(r) <= _COARSEST), _LARGEST)
    whole = wide(resolution)
    if whole <= _COARSEST:
        said = (
            f"the texels of one map of {resolution}² are at most {whole:.2g} pixels wide where a small picture of the"
        )
        return {"resolution": resolution}, f"{said} view is nearest"
    # What is nearer than the look showed still lies in the first part.
    near, far = nearest / 2.0, farthest * 1.1

    def widest(count: int) -> float:
        splits = shadow.cascade_splits(near, far, count, method="logarithmic")
        n, f = splits[:-1], splits[1:]
        middle = np.minimum(f, (n + f) * (1.0 + slope * slope) / 2.0)
        radius = np.sqrt(np.maximum((f - middle) ** 2 + (f * slope) ** 2, (middle - n) ** 2 + (n * slope) ** 2))
        texels = 2.0 * radius * (1.0 + 1.0 / 64.0) / (_LARGEST - 2 * _BORDER - 1)
        return float((texels / (np.maximum(n, nearest) * facts.pixel)).max())

    counts = range(2, _MOST + 1)
    count = next((c for c in counts if widest(c) <= _COARSEST), min(counts, key=widest))
    if widest(count) > 0.5 * whole:
        why = f"parts of the view would need texels as large as those of one map of {_LARGEST}²"
        return {"resolution": _LARGEST}, why
    reason = f"in {count} parts by distance: texels at most {widest(count):.2g} pixels wide, {whole:.2g} in one map"
    return {"resolution": _LARGEST, "cascades": count, "near": near, "far": far}, reason


def _rays(soft: bool, bounds: Mapping[str, float]) -> tuple[int, str]:
    """How many rays a receiver, and the error that is expected of them.

    The mean of n independent answers 0 or 1 has a deviation of at most 1/(2 √n); strata only lessen it.
    """
    if not soft:
        return 1, "one ray is exact for a light without extent"
    bound = bounds.get("max_error")
    wanted = 16 if bound is None else math.ceil(0.25 / max(bound, 1e-9) ** 2 * (1.0 - 1e-9))
    samples = min(max(wanted, 16), _RAYS)
    said = (
        f"expected error at most {0.5 / math.sqrt(samples):.2g}, the noise of {samples} rays half of which are hidden"
    )
    if wanted > samples:
        said += f"; max_error {bound:g} is not kept: it would take {wanted} rays"
    if "budget_ms" in bounds:
        said += "; budget_ms is not kept: no time was measured for rays here"
    return samples, said


def shadow_passes(
    lamp: Any,
    suffix: str,
    facts: Facts,
    measured: tuple[str, dict[str, Any], str] | None,
    bounds: Mapping[str, float],
    view: Callable[[], tuple[dict[str, Any], str]],
) -> tuple[list[Pass], list[LeftOut]]:
    """How the shadow of one light is found, for a light that reaches something.

    `bounds` are max_error and budget_ms as far as they are asked for; `view` gives cascades, or one map's resolution.
    """
    if facts.unshadowed:
        return [], [LeftOut(f"shadow{suffix}", facts.unshadowed)]
    if isinstance(lamp, light.AmbientLight):
        why = "it comes from everywhere: rays find what hides some of it, its occlusion"
        none = LeftOut(f"shadow map{suffix}", "no map sees what comes from everywhere")
        return [Pass(f"shadow{suffix}", why, {"technique": "ray_traced", "samples": _OCCLUSION})], [none]
    left_out: list[LeftOut] = []
    settings: dict[str, Any] = {}
    width, footprint = 0.0, facts.nearest * facts.pixel
    beyond = beyond_one_map(lamp, facts)
    soft = outline(lamp) is not None
    if soft:
        width = widest_penumbra(lamp, facts)
    if not soft:
        technique, reason = "hard", f"the light has no extent: its shadows have no penumbra; {_EDGES}"
        left_out.append(LeftOut(f"penumbra{suffix}", "no area light: a hard shadow suffices"))
    elif width < footprint:
        technique = "hard"
        reason = f"penumbrae are at most {width:.2g} wide, less than a pixel ({footprint:.2g}); {_EDGES}"
        left_out.append(LeftOut(f"penumbra{suffix}", "narrower than a pixel: a hard shadow suffices"))
    elif measured is not None:
        technique, settings, reason = measured
    elif beyond:
        technique, reason = "ray_traced", ""
    elif close := too_close(lamp, facts):
        samples, expected = _rays(soft, bounds)
        technique, settings, reason = "ray_traced", {"samples": samples}, f"{close}; {expected}"
    elif bounds:
        raise ValueError("evidence: expected the result of a study beside max_error or budget_ms, for soft shadows")
    else:
        technique, settings = "pcss", {"blocker_samples": 16, "filter_samples": 32}
        known = math.isfinite(width) and footprint > 0
        reason = "an area light, with penumbrae " + (
            f"of at most {width / footprint:.0f} pixels" if known else "that nothing bounds"
        )
        reason += "; its error is not measured: a study's evidence tells it"

    settings = dict(settings)
    resolution = settings.pop("resolution", None)
    if beyond and not (soft and measured is not None and technique == "ray_traced"):
        samples, expected = _rays(soft, bounds)
        technique, settings, reason = "ray_traced", {"samples": samples}, f"{beyond}; {expected}"
    if technique == "ray_traced":
        left_out.append(LeftOut(f"shadow map{suffix}", "rays need none"))
        return [Pass(f"shadow{suffix}", reason, {"technique": technique, **settings})], left_out
    if isinstance(lamp, light.DirectionalLight):
        parts, why = view()
        if "cascades" in parts:
            return [
                Pass(f"shadow map{suffix}", f"what the light sees, {why}", parts),
                Pass(f"shadow{suffix}", reason, {"technique": technique, **settings}),
            ], left_out
        left_out.append(LeftOut(f"cascades{suffix}", why))
        resolution, why = parts["resolution"], "texels small enough for the nearest in view, if the resolution allows"
    elif resolution is None:
        resolution, why = resolution_for(facts), "texels of a pixel at the scene's middle, if the resolution allows"
    else:
        why = "the resolution that was measured"
    return [
        Pass(f"shadow map{suffix}", f"what the light sees; {why}", {"resolution": int(resolution)}),
        Pass(f"shadow{suffix}", reason, {"technique": technique, **settings}),
    ], left_out
