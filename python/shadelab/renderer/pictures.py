"""Pictures: the passes of a plan, run over a scene."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from .. import _arrays, light
from .._arrays import Floats
from ..accel import BVH
from ._buffers import Seen, above_horizon, g_buffer
from ._charts import chart_of, lit_by
from ._facts import check_scene, checked_size, outline
from ._frequency import Coarse
from .frames import Frame
from .passes import Plan, Shading
from .plans import decided
from .shading import shade

__all__ = ["render"]


class _Clock:
    """Times passes and tells the caller how far the frame is."""

    def __init__(self, total: int, tell: Callable[[int, int], object] | None) -> None:
        self.times: dict[str, float] = {}
        self._total, self._tell, self._since = total, tell, time.perf_counter()

    def done(self, name: str) -> None:
        now = time.perf_counter()
        self.times[name] = now - self._since
        self._since = now
        if self._tell is not None:
            self._tell(len(self.times), self._total)


def render(
    scene: Any,
    plan: Plan | None = None,
    size: tuple[int, int] | None = None,
    *,
    seed: int = 0,
    progress: bool | Callable[[int, int], object] | None = None,
) -> Frame:
    """A picture of a scene, by the passes of a plan.

    Parameters
    ----------
    scene : Scene
        What is rendered, in float32.
    plan : Plan, optional
        The passes; by default `plan(scene, size)`.
    size : (int, int), optional
        Width and height in pixels; by default those of the plan, or 1280 x 720.
    seed : int
        Of the noise in filters and samples: the same seed gives the same bits.
    progress : bool or callable, optional
        True shows a bar; a callable gets (done, total) in passes.

    Returns
    -------
    Frame
        Radiance, G-buffer, lit fractions and the time of each pass; shows itself in Jupyter.

    Raises
    ------
    TypeError, ValueError
        If the plan does not fit the scene or the size, or an argument is out of range.

    Notes
    -----
    Direct light is what would arrive with nothing in between (`shade`, by the models and methods that the plan chose
    for each material, or by the materials themselves if it names none) times the lit fraction that the plan's technique
    finds, plus the background's or a panorama's light as if nothing hid it, plus emission. No light is reflected twice,
    and what passes a body ends at its far side. Lights themselves are not seen, though `shadelab.pathtrace.path_trace`
    shows those with an area: the plan lists those in view as left out. Ambient light is seen where nothing else is, and
    what hides some of it is found by rays, as by the path tracer. Where a light is wholly visible the result is that of
    `path_trace` with one bounce (`max_depth=1`) within the errors that `Plan.shading` states.

    Examples
    --------
    >>> import shadelab as sl
    >>> frame = sl.render(sl.scene.default(), size=(64, 36))
    >>> frame.radiance.shape, [name for name in frame.times]  # doctest: +NORMALIZE_WHITESPACE
    ((36, 64, 3), ['g-buffer', 'shadow map', 'shadow', 'direct light', 'ambient'])
    """
    check_scene(scene)
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    chosen = decided(scene, checked_size((1280, 720) if size is None else size), None) if plan is None else plan
    _check_plan(chosen, scene, size)
    tell = _arrays.progress_callback(progress, "render")
    clock = _Clock(len(chosen.passes), tell)
    background = np.asarray(scene.background, np.float32)
    lamps = list(scene.lights)
    arrays = scene.flatten(np.float32)
    _arrays.warn_if_coarse(arrays.positions, np.float32, 3)
    if chosen.find("g-buffer") is None:
        return _empty_frame(chosen, _sky(scene, chosen.size), len(lamps), clock)

    if chosen.shading and len(chosen.shading) != len(arrays.materials):
        known, here = len(chosen.shading), len(arrays.materials)
        raise ValueError(f"plan: made for another scene, with {known} materials instead of {here}")
    seen = g_buffer(arrays, scene.camera, chosen.size)
    clock.done("g-buffer")
    radiance = np.zeros_like(seen.points)
    eye = np.asarray(scene.camera.eye, np.float32)
    fractions: dict[int, Floats] = {}
    chart, bvh = None, None
    for p in chosen.passes[1:]:
        kind, index = _split(p.name, lamps)
        if kind == "bvh":
            bvh = BVH(arrays.positions, arrays.faces)
        elif kind == "shadow map":
            chart = chart_of(p.settings, arrays, lamps[index], scene.camera, chosen.size, seen.points)
        elif kind == "shadow":
            seeded = p.settings.get("technique") in ("pcf", "pcss", "ray_traced") and "seed" not in p.settings
            how = {**p.settings, "seed": seed} if seeded else p.settings
            fractions[index] = lit_by(how, lamps[index], seen.points, seen.geometric, chart, bvh)
        elif kind == "direct light":
            for i in p.settings["lights"]:
                if outline(lamps[i]) is not None:
                    fraction = fractions.setdefault(i, np.ones(len(seen.points), np.float32))
                    fraction *= above_horizon(lamps[i], seen)
            frequency = p.settings.get("frequency", "phong")
            if frequency == "phong":
                fraction_of = [fractions.get(i) for i in p.settings["lights"]]
                reaching = [lamps[i] for i in p.settings["lights"]]
                radiance += _shaded(seen, arrays, eye, reaching, fraction_of, p.settings, seed, chosen.shading)
                clock.done(p.name)
                continue
            coarse = Coarse(seen, arrays, eye, frequency)
            for at, i in enumerate(p.settings["lights"]):
                ways = tuple(replace(w, by_light=w.by_light[at : at + 1]) for w in chosen.shading)
                few = _shaded(coarse.receivers, arrays, eye, [lamps[i]], [None], p.settings, seed, ways)
                radiance += coarse.spread(few) * (fractions[i][:, None] if i in fractions else 1)
        elif kind == "environment":
            radiance += _shaded(seen, arrays, eye, [], [], p.settings, seed, (), scene.environment)
        elif kind == "ambient":
            shares = p.settings.get("reflectances")
            if shares is None and "samples" in p.settings:
                even = [light.AmbientLight(scene.background)]
                radiance += _shaded(seen, arrays, eye, even, [None], p.settings, seed)
            else:
                base = (arrays.base_color if shares is None else np.asarray(shares, np.float32))[seen.material]
                radiance += (base if seen.colors is None else base * seen.colors) * background
        elif kind == "emission":
            radiance += arrays.emission[seen.material]
        else:
            raise ValueError(f"plan: there is no pass {p.name!r}")
        clock.done(p.name)

    picture = _sky(scene, chosen.size)
    picture[seen.covered] = radiance
    forward = -np.asarray(scene.camera.view())[2].astype(np.float64)
    depth = (seen.points @ forward[:3] + forward[3]).astype(np.float32)
    ones = np.ones(len(seen.points), np.float32)
    lit = tuple(seen.spread(fractions.get(i, ones), 1.0) for i in range(len(lamps)))
    return Frame(
        picture,
        seen.spread(depth, np.inf),
        seen.spread(seen.points, np.nan),
        seen.spread(seen.shading, np.nan),
        seen.face,
        lit,
        clock.times,
        chosen,
    )


def _check_plan(chosen: Any, scene: Any, size: Any) -> None:
    if not isinstance(chosen, Plan):
        raise TypeError(f"plan: expected a Plan, got {type(chosen).__name__}")
    if size is not None and checked_size(size) != tuple(chosen.size):
        raise ValueError(f"plan: made for another size, {tuple(chosen.size)}, than {tuple(size)}")
    lights = len(scene.lights)
    if chosen.lights is not None and chosen.lights != lights:
        raise ValueError(f"plan: made for another scene, with {chosen.lights} lights instead of {lights}")
    for p in chosen.passes:
        wanted = p.settings.get("lights", (0,) if p.name in ("shadow map", "shadow") else ())
        if max(wanted, default=-1) >= lights:
            raise ValueError(f"plan: made for another scene, whose light {max(wanted)} this one does not have")


def _split(name: str, lamps: list[Any]) -> tuple[str, int]:
    """The kind of a pass, and the light that it is for."""
    kind, _, last = name.rpartition(" ")
    if not last.isdigit():
        return name, 0
    if int(last) >= len(lamps):
        raise ValueError(f"plan: pass {name!r} is for a light that the scene does not have")
    return kind, int(last)


def _shaded(
    seen: Seen,
    arrays: Any,
    eye: Floats,
    lamps: list[Any],
    lit: list[Floats | None],
    settings: Mapping[str, Any],
    seed: int,
    ways: tuple[Shading, ...] = (),
    environment: Any = None,
) -> Floats:
    """What lights send to the eye by all that is seen, its materials by themselves or as a plan has them."""
    # Lights for which every material has the same method as for others go together.
    groups: dict[Any, list[int]] = {}
    for i in range(len(lamps)):
        how = tuple(way.by_light[i] if way.by_light else (way.method, way.samples) for way in ways)
        groups.setdefault(how, []).append(i)
    total: Any = 0.0
    for number, (how, members) in enumerate((groups or {tuple((w.method, w.samples) for w in ways): []}).items()):
        total = total + shade(
            seen.points,
            seen.shading,
            [way.model for way in ways] or arrays.materials,
            [lamps[i] for i in members],
            eye=eye,
            material_ids=seen.material,
            colors=seen.colors,
            geometric_normals=seen.geometric,
            inside=seen.inside,
            lit=[lit[i] for i in members],
            environment=environment if number == 0 else None,
            method=[method for method, _ in how] or "sampling",
            samples=[samples for _, samples in how] or settings["samples"],
            seed=(seed + number) % 2**64,
        )
    return np.asarray(total)


def _sky(scene: Any, size: tuple[int, int]) -> Floats:
    """The picture of what is behind everything."""
    ambient = [lamp.radiance for lamp in scene.lights if isinstance(lamp, light.AmbientLight)]
    even = np.sum([scene.background, *ambient], 0).astype(np.float32)
    if scene.environment is None:
        return np.broadcast_to(even, (size[1], size[0], 3)).copy()
    seen = scene.environment.eval(scene.camera.rays(size, dtype=np.float32)[1])
    return np.ascontiguousarray(seen + even, np.float32)


def _empty_frame(chosen: Plan, picture: Floats, lights: int, clock: _Clock) -> Frame:
    width, height = chosen.size
    nothing = np.full((height, width, 3), np.nan, np.float32)
    clock.done("background")
    return Frame(
        picture,
        np.full((height, width), np.inf, np.float32),
        nothing,
        nothing.copy(),
        np.full((height, width), -1, np.int32),
        tuple(np.ones((height, width), np.float32) for _ in range(lights)),
        clock.times,
        chosen,
    )
