"""How the shadow of a light is found."""

from __future__ import annotations

import inspect
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .. import _arrays, light, shadow
from ._facts import RESOLUTIONS, Facts, beyond_one_map, flat, outline, resolution_for, too_close, widest_penumbra
from ._options import Option, chosen, least_rays, of_rays, price_of, priced, sharp, soft, virtual
from ._trials import OfLight, Trial
from .passes import LeftOut, Pass

# Rays of each pixel into the hemisphere, where no bound asks for fewer or more.
_OCCLUSION = 32
# The most rays towards a light whose penumbrae are narrower than a pixel.
_SHARP_RAYS = 64
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
    if choice is not None and getattr(choice, "technique", None) not in _TECHNIQUES:
        # The question measures more than pictures are rendered by.
        choice = evidence.pick(**asked, techniques=_TECHNIQUES)
    if choice is None:
        raise ValueError(f"evidence: nothing that was measured keeps {asked}")
    lacks = [name for name in ("technique", "knobs", "error", "ms") if getattr(choice, name, None) is None]
    if lacks or not isinstance(choice.knobs, Mapping):
        raise TypeError(f"evidence: expected a choice with technique, knobs, error and ms, got {choice!r}")
    if not (choice.error >= 0 and choice.ms >= 0):
        raise ValueError(f"evidence: expected an error and a time, got {choice.error} and {choice.ms} ms")
    if choice.technique not in _TECHNIQUES:
        raise ValueError(f"evidence: expected a technique among {', '.join(_TECHNIQUES)}, got {choice.technique!r}")
    strange = [k for k in choice.knobs if k not in _knobs_of(choice.technique)]
    if strange:
        raise ValueError(f"evidence: expected knobs of {choice.technique} and its map, got {', '.join(strange)}")
    wanted = " and ".join(f"{k} {v:g}" for k, v in asked.items())
    unit, scale = getattr(choice, "unit", ("ms", 1.0))
    if unit != "ms" and budget_ms is not None:
        raise ValueError(f"budget_ms: expected evidence that was judged by time, got a study of {unit}")
    price = f"{choice.ms:.3g} ms"
    if unit != "ms":
        price += f" and {choice.cost_interval.value * scale:.3g} {unit}"
    # Those of a study have names and sizes; others may call something else so.
    cases = getattr(evidence, "cases", ())
    cases = [c for c in cases if hasattr(c, "name") and hasattr(c, "size")] if isinstance(cases, Sequence) else []
    where = "; ".join(f"{c.name} at {c.size[0]} × {c.size[1]}" for c in cases[:2])
    where += f" and {len(cases) - 2} more" if len(cases) > 2 else ""
    reason = f"measured{f' on {where}' if where else ''}: error {choice.error:.3g} in {price}, the choice for {wanted}"
    return choice.technique, dict(choice.knobs), reason


def _knobs_of(technique: str) -> set[str]:
    """What can be set of a technique, and of the maps that it looks up in."""
    of_lookup = set(inspect.signature(getattr(shadow, technique)).parameters)
    if technique == "ray_traced":
        return of_lookup
    of_moments = {"kind", *shadow.moments._OF_MAP} if technique in shadow.moments._OF_MOMENTS else set()
    return of_lookup | of_moments | {"resolution", *_OF_MAP}


# Knobs of studies that belong to the map, as `shadow_map` calls them.
_OF_MAP = {"surface": "surface", "stored_bits": "bits"}

# How many pixels a texel may cover where a view is nearest before one map is no longer enough, the largest map, and the
# most cascades. What filters read about a receiver must lie in its map.
_COARSEST, _LARGEST, _MOST, _BORDER = 4.0, RESOLUTIONS[-1], 6, 8
# Whole maps of which pages are drawn, and the sides of cubes.
_VIRTUAL, _CUBES = (4096, 8192, 16384), (512, 1024, 2048)


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


def shadow_passes(
    lamp: Any,
    suffix: str,
    facts: Facts,
    measured: tuple[str, dict[str, Any], str] | None,
    bounds: Mapping[str, float],
    trial: Trial,
    built: bool,
) -> tuple[list[Pass], list[LeftOut]]:
    """How the shadow of one light is found, for a light that reaches something.

    `bounds` are max_error and budget_ms of this light's shadow as far as they are asked for; `built` tells whether
    there is a tree for rays already.
    """
    if facts.unshadowed:
        return [], [LeftOut(f"shadow{suffix}", facts.unshadowed)]
    price = price_of(lamp, trial.receivers, len(facts.faces), built)
    if isinstance(lamp, light.AmbientLight):
        where = OfLight(trial, lamp)
        found = chosen(priced(of_rays(least_rays(bounds, _OCCLUSION)), price), where, bounds)
        why = f"it comes from everywhere: rays find what hides some of it, its occlusion; {found.told}"
        none = LeftOut(f"shadow map{suffix}", "no map sees what comes from everywhere")
        return [Pass(f"shadow{suffix}", why, dict(found.option.how))], [none]
    left_out: list[LeftOut] = []
    beyond, footprint = beyond_one_map(lamp, facts), facts.nearest * facts.pixel
    wide = outline(lamp) is not None
    if not wide:
        reason = "the light has no extent: its shadows have no penumbra"
        left_out.append(LeftOut(f"penumbra{suffix}", "no area light: a hard shadow suffices"))
    elif (width := widest_penumbra(lamp, facts)) < footprint:
        wide = False
        reason = f"penumbrae are at most {width:.2g} wide, less than a pixel ({footprint:.2g})"
        left_out.append(LeftOut(f"penumbra{suffix}", "narrower than a pixel: a hard shadow suffices"))
    elif measured is not None and not (beyond and measured[0] != "ray_traced"):
        return _as_measured(suffix, measured, facts)
    else:
        reason = ""
    where = OfLight(trial, lamp, bounds.get("max_error", 1.0) < 0.05)
    charts, why = _charts(lamp, facts, beyond, wide, where, bounds)
    # One ray is exact for what has no extent.
    sharpest = charts if bounds else charts[:1], bool(bounds), 1 if outline(lamp) is None else _SHARP_RAYS
    if not wide:
        pairs = sharp(*sharpest) or of_rays(1, 1)
    elif not charts:
        pairs = of_rays(least_rays(bounds))
        reason = why
    else:
        alike = where.penumbrae(charts[0]) if where.edges else None
        reason = _widths(alike, width, footprint)
        if alike is not None and alike[2] < 1.0:
            left_out.append(LeftOut(f"penumbra{suffix}", "narrower than a pixel: a hard shadow suffices"))
            pairs = sharp(*sharpest)
        else:
            pairs = soft(charts, where, alike, least_rays(bounds))
    found = chosen(priced(pairs, price), where, bounds)
    if found.option.chart is not None and found.option.chart != charts[0]:
        why = "of the maps that were tried, the one that the error or the budget asks for"
    elif isinstance(lamp, light.DirectionalLight) and "cascades" not in charts[0]:
        left_out.append(LeftOut(f"cascades{suffix}", why))
        why = "texels small enough for the nearest in view, if the resolution allows"
    return _passes(suffix, found.option, f"{reason}; {found.told}", why, left_out)


def _widths(alike: tuple[float, float, float, float] | None, width: float, footprint: float) -> str:
    if alike is not None:
        return (
            f"an area light, whose penumbrae are {alike[0]:.2g} to {alike[1]:.2g} pixels wide, but for a fifth of them"
        )
    if math.isfinite(width) and footprint > 0:
        return f"an area light, with penumbrae of at most {width / footprint:.0f} pixels"
    return "an area light, with penumbrae that nothing bounds"


def _charts(
    lamp: Any, facts: Facts, beyond: str, wide: bool, where: OfLight, bounds: Mapping[str, float]
) -> tuple[list[Mapping[str, Any]], str]:
    """The maps that may serve, the first of which does if nothing else is asked for; and why that, or why none."""
    bounded, budgeted = bool(bounds), "budget_ms" in bounds
    if beyond:
        if flat(lamp) is not None:
            return [], beyond
        cubes: list[Mapping[str, Any]] = [{"kind": "cube", "resolution": n} for n in _CUBES]
        first = next((c for c in cubes[:-1] if where.texels(c) <= _COARSEST), cubes[-1])
        said = f"{beyond}: six of them do, with texels at most {where.texels(first):.2g} pixels wide"
        return [first, *(c for c in cubes if bounded and c != first)], said
    if wide and (close := too_close(lamp, facts)):
        return [], close
    if isinstance(lamp, light.DirectionalLight):
        depths = where.trial.depths
        view = (float(depths.min()), float(depths.max())) if len(depths) else None
        first_chart, said = parted(facts, view, where.trial.slope)
        parts = "cascades" in first_chart
    else:
        least = resolution_for(facts)
        first_chart, parts = {"resolution": least}, False
        said = "texels of a pixel at the scene's middle, if the resolution allows"
    charts: list[Mapping[str, Any]] = [first_chart]
    if bounded:
        # Wide filters want no fine texels, but a cheap map.
        sides = RESOLUTIONS if not wide or budgeted else (_LARGEST,)
        charts += [{"resolution": n} for n in sides if parts or n != first_chart["resolution"]]
        if parts and first_chart["cascades"] < _MOST:
            charts.append({**first_chart, "cascades": _MOST})
    # Long views, of which the nearest is coarse in the largest map.
    coarse = 0.0 if parts else where.texels({"resolution": _LARGEST})
    if coarse > _COARSEST:
        pages = [virtual(n, wide) for n in _VIRTUAL]
        if wide:
            charts += pages
        else:
            fine = next((p for p, n in zip(pages, _VIRTUAL, strict=True) if coarse * _LARGEST / n <= 1.0), pages[-1])
            charts = [fine, *(pages if bounded else []), *charts]
            said = f"texels of one map of {_LARGEST}² are {coarse:.2g} pixels wide: pages of a larger one"
    return [c for i, c in enumerate(charts) if c not in charts[:i]], said


def _as_measured(
    suffix: str, measured: tuple[str, dict[str, Any], str], facts: Facts
) -> tuple[list[Pass], list[LeftOut]]:
    """As a study has it."""
    technique, settings, reason = measured
    how = {"technique": technique, **settings}
    resolution = how.pop("resolution", None)
    if technique == "ray_traced":
        return _passes(suffix, Option(None, how, 0.0), reason, "", [])
    why = "the resolution that was measured"
    if resolution is None:
        resolution, why = resolution_for(facts), "texels of a pixel at the scene's middle, if the resolution allows"
    chart = {"resolution": int(resolution)} | {_OF_MAP[k]: how.pop(k) for k in list(how) if k in _OF_MAP}
    return _passes(suffix, Option(chart, how, 0.0), reason, why, [])


def _passes(
    suffix: str, option: Option, reason: str, why: str, left_out: list[LeftOut]
) -> tuple[list[Pass], list[LeftOut]]:
    """The passes of an option."""
    lookup = Pass(f"shadow{suffix}", reason, dict(option.how))
    if option.chart is None:
        return [lookup], [*left_out, LeftOut(f"shadow map{suffix}", "rays need none")]
    return [Pass(f"shadow map{suffix}", f"what the light sees; {why}", dict(option.chart)), lookup], left_out
