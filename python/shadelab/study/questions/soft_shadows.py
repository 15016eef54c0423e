"""Soft shadows: how much of an area light each point sees, by shadow maps, their filters, and rays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import color, image, light, pathtrace, renderer, shadow
from ...accel import BVH
from ...scene import Scene
from ..question import Candidate, Case, Mask, Metric, MonteCarlo, Question
from ._fields import field_counters, field_lit
from ._shadow_scenes import SCENES, views

__all__ = ["question"]

Array = NDArray[Any]

MOMENT_BIAS = 3e-7
"""As published for single precision; taken in double as well, where far less would do, so that what the two differ by
is what rounding does."""

_MASK_RAYS = 64
"""Rays that find the penumbrae: a pixel of which some of these are blocked and some pass is in the mask."""

_MASK_REACH = 60
"""The mask reaches a 60th of the picture's height beyond penumbrae: halos and leaks lie beside them."""


_FLOOR = 0.05
"""Where less than this share of the picture's bright light would arrive, errors are taken relative to that share: at a
terminator a relative error is large and means nothing."""


_LEAK, _HARDLY = 0.05, 1e-3
"""What is in full shadow and shows more than this share of the unshadowed light leaks: less is hardly seen. If no more
than that share of a picture is in full shadow, there is no telling."""


@dataclass(frozen=True, eq=False)
class Inputs:
    """What reference and candidates are given: the G-buffer at pixel centres, and the scene to cast shadows.

    `covered` marks the pixels that show a surface; the arrays of receivers hold those alone, row by row. All arrays
    have one precision; those in double are made of the same G-buffer, so that only the techniques differ.
    """

    lights: Sequence[Any]
    caster_positions: Array
    caster_faces: Array
    bvh: BVH
    covered: Array
    points: Array
    geometric: Array
    shading: Array
    base_color: Array
    eye: Array
    unshadowed: Array
    exposure: float
    seed: int
    camera: Any

    def spread(self, values: Array) -> Array:
        """Values of receivers as a picture, zero where there is no surface."""
        picture = np.zeros((*self.covered.shape, *values.shape[1:]), values.dtype)
        picture[self.covered] = values
        return picture


def _setup(case: Case) -> Inputs:
    """The G-buffer by rays through pixel centres, and the light that would arrive with nothing in between."""
    if not isinstance(case.scene, Scene):
        raise TypeError(f"scene: expected {case.scene_name!r} to be a Scene, got {type(case.scene).__name__}")
    arrays = case.scene.flatten(np.float32)
    if not len(arrays.faces):
        raise ValueError(f"scene: expected at least one instance with a face in {case.scene_name!r}")
    if not case.scene.lights:
        raise ValueError(f"scene: expected at least one light in {case.scene_name!r}")
    camera = case.view if case.view is not None else case.scene.camera
    origins, directions = camera.rays(case.size, dtype=np.float32)
    bvh = BVH(arrays.positions, arrays.faces)
    hit = bvh.closest_hit(origins, directions, normals=True)
    covered = hit.face >= 0
    face, u, v = hit.face[covered], hit.u[covered, None], hit.v[covered, None]
    corners = arrays.faces[face]

    # In double the receivers are put onto the same triangles anew: rounded ones would lie under their neighbours.
    u, v = u.astype(case.dtype), v.astype(case.dtype)

    def mixed(values: Array) -> Array:
        a, b, c = (values[corners[:, i]].astype(case.dtype) for i in range(3))
        return (1 - u - v) * a + u * b + v * c

    seen = np.broadcast_to(directions, (*covered.shape, 3))[covered]
    points = mixed(arrays.positions)
    assert hit.normal is not None
    geometric, shading = hit.normal[covered], mixed(arrays.normals)
    shading /= np.maximum(np.linalg.norm(shading, axis=-1, keepdims=True), np.finfo(np.float32).tiny)
    # Both sides of a surface are looked at as its front.
    geometric = np.where(np.einsum("ij,ij->i", geometric, seen)[:, None] > 0, -geometric, geometric)
    shading = np.where(np.einsum("ij,ij->i", shading, geometric)[:, None] < 0, -shading, shading)
    base = arrays.base_color[arrays.material_ids[face]]
    if arrays.colors is not None:
        base = base * mixed(arrays.colors)
    if case.dtype == np.float64:
        bvh = BVH(arrays.positions.astype(np.float64), arrays.faces)
    points, geometric, shading, base = (np.ascontiguousarray(a, case.dtype) for a in (points, geometric, shading, base))
    eye = np.asarray(camera.eye, case.dtype)
    lights = case.scene.lights
    unshadowed = np.stack([light.unshadowed(l, points, shading, base, specular=0.0, eye=eye) for l in lights])
    bright = color.luminance(unshadowed.sum(0))
    exposure = 1.0 / max(float(np.quantile(bright, 0.98)) if bright.size else 0.0, 1e-6)
    positions = arrays.positions.astype(case.dtype)
    return Inputs(
        lights, positions, arrays.faces, bvh, covered, points, geometric, shading, base, eye, unshadowed,
        exposure, case.seed, camera,
    )  # fmt: skip


def _estimate(inputs: Inputs, samples: int, seed: int, start: int, where: Array | None) -> Array:
    """Direct light by the path tracer's estimator at the receivers (of the wanted pixels)."""
    wanted = slice(None) if where is None else where[inputs.covered]
    traced = pathtrace.direct_light(
        inputs.bvh,
        inputs.lights,
        inputs.points[wanted],
        inputs.shading[wanted],
        inputs.base_color[wanted],
        specular=0.0,
        eye=inputs.eye,
        samples=samples,
        start=start,
        seed=seed,
        geometric_normals=inputs.geometric[wanted],
    )
    radiance = np.zeros_like(inputs.points)
    radiance[wanted] = traced.radiance
    return inputs.spread(radiance)


def _compose(inputs: Inputs, lit: Array) -> Array:
    """Radiance: what would arrive unshadowed, times the lit fraction, light by light."""
    given, expected = np.asarray(lit), inputs.unshadowed.shape[:2]
    if given.shape != expected:
        raise ValueError(f"expected lit fractions of shape {expected} (lights, receivers), got {given.shape}")
    if given.dtype.kind not in "fiub":
        raise TypeError(f"expected lit fractions of shape {expected} as numbers, got dtype {given.dtype}")
    return inputs.spread(np.einsum("ln,lnc->nc", given, inputs.unshadowed))


def _residual(value: Array, reference: Array, inputs: Inputs) -> Array:
    """Difference of luminance in units of the unshadowed light, or of a share of the picture's where that is larger."""
    whole = color.luminance(inputs.spread(inputs.unshadowed.sum(0)))
    apart = color.luminance(np.asarray(value) - reference)
    return apart / np.maximum(whole, whole.dtype.type(_FLOOR / inputs.exposure))


def _penumbrae(reference: Array, inputs: Inputs) -> Array:
    """Pixels in or beside a penumbra that would get light."""
    reach = max(1, round(inputs.covered.shape[0] / _MASK_REACH))
    found = np.zeros(inputs.covered.shape, bool)
    for source in inputs.lights:
        lit = _rays(inputs, source, _MASK_RAYS, 0)
        found |= inputs.spread((lit > 0) & (lit < 1))
    return _widened(found, reach) & (inputs.spread(inputs.unshadowed.sum(0)).sum(-1) > 0)


def _widened(mask: Array, reach: int) -> Array:
    """A mask grown by a square of `reach` pixels to every side: rows first, then columns."""
    for axis in (0, 1):
        padded = np.moveaxis(mask, axis, 0)
        grown = padded.copy()
        for step in range(1, reach + 1):
            grown[step:] |= padded[:-step]
            grown[:-step] |= padded[step:]
        mask = np.moveaxis(grown, 0, axis)
    return mask


def _maps(inputs: Inputs, resolution: int, surface: Any = "first", stored_bits: Any = None, **knobs: Any) -> list[Any]:
    """The shadow map of each light, drawn each frame."""
    how: dict[str, Any] = {"receivers": inputs.points, "surface": surface, "bits": stored_bits}
    return [
        shadow.shadow_map(inputs.caster_positions, inputs.caster_faces, l, resolution, **how) for l in inputs.lights
    ]


def _hard(inputs: Inputs, maps: list[Any], resolution: int) -> Array:
    return np.stack([shadow.hard(m, inputs.points, inputs.geometric) for m in maps])


def _pcf(inputs: Inputs, maps: list[Any], resolution: int, samples: int, radius: float, seed: int) -> Array:
    each: dict[str, Any] = {"samples": samples, "radius": radius, "seed": seed}
    return np.stack([shadow.pcf(m, inputs.points, inputs.geometric, **each) for m in maps])


def _pcss(
    inputs: Inputs, maps: list[Any], resolution: int, blocker_samples: int, filter_samples: int, seed: int
) -> Array:
    each: dict[str, Any] = {"blocker_samples": blocker_samples, "filter_samples": filter_samples, "seed": seed}
    return np.stack([shadow.pcss(m, inputs.points, inputs.geometric, **each) for m in maps])


def _moment_maps(technique: str) -> Any:
    """The moment map of each light, drawn and filtered each frame."""

    def prepare(inputs: Inputs, resolution: int, **knobs: Any) -> list[Any]:
        return [shadow._prepared(technique, m, inputs.points, knobs)[0] for m in _maps(inputs, resolution)]

    return prepare


def _pages(inputs: Inputs, resolution: int, border: int = 64, per_pixel: float = 1.0, **knobs: Any) -> list[Any]:
    """Of a large map of each light the pages that the view looks into, so many texels a pixel, drawn each frame."""
    pixel = 2.0 * math.tan(float(inputs.camera.fov_y) / 2.0) / inputs.covered.shape[0] / per_pixel
    how: dict[str, Any] = {"border": border, "eye": inputs.camera.eye, "pixel": pixel}
    mesh = inputs.caster_positions, inputs.caster_faces
    return [shadow.virtual_shadow_map(*mesh, l, inputs.points, resolution, **how) for l in inputs.lights]


def _page_counters(technique: str) -> Any:
    """As `_counters`; what stays resident are pages."""

    def count(
        inputs: Inputs, resolution: int, border: int = 64, per_pixel: float = 1.0, **knobs: Any
    ) -> dict[str, float]:
        cost = shadow.cost(technique, itemsize=inputs.points.itemsize, **knobs)
        resident = sum(m.bytes for m in _pages(inputs, resolution, border, per_pixel))
        return {"taps/px": cost.texel_reads * len(inputs.lights), "rays/px": 0, "bytes": resident}

    return count


def _filtered(technique: str) -> Any:
    """Lookups into moment maps; what is not a knob of the map is one of the lookup."""
    lookup = getattr(shadow, technique)

    def run(inputs: Inputs, maps: list[Any], resolution: int, light_bleeding: float = 0.0, **of_map: Any) -> Array:
        each: dict[str, Any] = {"light_bleeding": light_bleeding}
        if maps[0].kind == "moment" and "bits" not in of_map:
            each["moment_bias"] = MOMENT_BIAS
        return np.stack([lookup(m, inputs.points, inputs.geometric, **each) for m in maps])

    return run


def _ray_traced(inputs: Inputs, prepared: None, samples: int, seed: int) -> Array:
    return np.stack([_rays(inputs, l, samples, seed) for l in inputs.lights])


def _rays(inputs: Inputs, source: Any, samples: int, seed: int) -> Array:
    return shadow.ray_traced(inputs.bvh, inputs.points, inputs.geometric, source, samples=samples, seed=seed)


def _counters(technique: str) -> Any:
    """Texel reads and rays a pixel, and the bytes that stay resident: the maps, or the tree."""

    def count(
        inputs: Inputs, resolution: int = 0, surface: str = "first", stored_bits: int | None = None, **knobs: Any
    ) -> dict[str, float]:
        cost = shadow.cost(technique, itemsize=inputs.points.itemsize, **knobs)
        lights = len(inputs.lights)
        texel = {None: inputs.points.itemsize, 16: 2}.get(stored_bits, 4)
        resident = lights * resolution**2 * texel if resolution else inputs.bvh.stats().bytes
        if technique in _MOMENTS:
            channels = 2 if knobs.get("kind", technique) == "variance" else 4
            size = (
                8 if knobs.get("filter") == "summed_area" else 2 if knobs.get("bits") == 16 else inputs.points.itemsize
            )
            texels = (-(-resolution // knobs.get("reduce", 1))) ** 2
            resident += round(lights * texels * channels * size * (4 / 3 if knobs.get("filter") == "mip" else 1))
        return {"taps/px": cost.texel_reads * lights, "rays/px": cost.rays * lights, "bytes": resident}

    return count


def _flip(value: Array, reference: Array, inputs: Inputs) -> Array | float:
    """LDR-FLIP of the pictures as shown, in [0, 1]: the difference that one sees when flipping between them."""
    shown = [color.encode_transfer(np.clip(p * inputs.exposure, 0, 1)) for p in (value, reference)]
    try:
        return image.flip_error(*shown, dynamic_range="ldr").map
    except ValueError:
        # FLIP is not defined for a black reference, nor for what is not finite: there is no figure, and no map.
        return math.nan


def _leaks(value: Array, reference: Array, inputs: Inputs) -> float:
    """Light leaks: how many per cent of the pixels in full shadow show more than a twentieth of the unshadowed light.

    In full shadow is what faces a light of which no sample of the reference sees any; no figure where hardly anything
    is (a thousandth of the picture).
    """
    dark = inputs.spread(inputs.unshadowed.sum(0)).sum(-1) > 0
    dark &= (reference == 0).all(-1)
    if dark.sum() < max(1, _HARDLY * dark.size):
        return math.nan
    shown = _residual(value, np.zeros_like(reference), inputs)[dark]
    # What is not finite is no shadow either.
    return 100.0 * float(np.mean(~(shown <= _LEAK)))


def _rmse(value: Array, reference: Array, inputs: Inputs) -> float:
    """Root mean square error of radiance over the whole frame, background included, in W/(m² sr)."""
    return image.rmse(value, reference)


def _display(inputs: Inputs, value: Array) -> Array:
    shown = color.encode_transfer(np.clip(np.nan_to_num(value * inputs.exposure), 0, 1))
    # What is not a number is shown as such, in a colour that no scene has.
    shown[np.isnan(value).any(-1)] = (1, 0, 1)
    return (shown * 255 + 0.5).astype(np.uint8)


def _area_light(inputs: Inputs) -> str | None:
    areas = [isinstance(l, light.RectLight) for l in inputs.lights]
    return None if all(areas) else "it needs area lights, and there are others"


_ABOUT = """A point in a penumbra sees a part of the light. How much is an integral over the light; shadow maps replace
it by a comparison of depths, filters soften that, rays sample it. What does each lose where it matters, in and beside
penumbrae, and what does a frame cost? Geometry per pixel and unshadowed light are given to all alike and not counted;
drawing the shadow map is."""

_METRIC_ABOUT = """Root mean square, over the mask, of the difference of direct radiance (as luminance) from the
reference, divided by the radiance that would be there with nothing in between: 0.02 is 2 % of the unshadowed light.
Where less than a twentieth of the picture's bright light (98th percentile) would arrive, as at terminators, that
twentieth is divided by. Surfaces reflect diffusely alone, since the question is about visibility."""

_MASK_ABOUT = f"""Pixels whose lit fraction is strictly between 0 and 1 (by {_MASK_RAYS} rays), widened by a 60th of the
picture's height to every side so that halos and leaks beside penumbrae count, where any light would arrive."""

_MOMENTS = ("variance", "exponential_variance", "moment", "variance_soft")

_FIXED: Any = {"resolution": (1024,), "reduce": (2,), "sigma": (4.0, 16.0)}

_PCSS_SETTINGS = ((512, 16, 32), (1024, 8, 16), (1024, 16, 32), (1024, 32, 64), (2048, 32, 64))


def _candidates() -> list[Candidate]:
    return [
        Candidate(
            "hard",
            _hard,
            {"resolution": (512, 1024, 2048)},
            _maps,
            _counters("hard"),
            about="One comparison with a shadow map, the scene seen from each light's centre. No penumbra at all.",
        ),
        Candidate(
            "pcf",
            _pcf,
            {"resolution": (1024,), "samples": (16, 64), "radius": (2.0, 8.0, 32.0)},
            _maps,
            _counters("pcf"),
            seeded=True,
            about="Percentage-closer filtering: the share of texels within a fixed radius (in texels) that do not "
            "block. One width of penumbra everywhere, so wrong at contact and far from the blocker.",
        ),
        Candidate(
            "pcss",
            _pcss,
            [{"resolution": r, "blocker_samples": b, "filter_samples": f} for r, b, f in _PCSS_SETTINGS],
            _maps,
            _counters("pcss"),
            domain=_area_light,
            seeded=True,
            about="Percentage-closer soft shadows: filters over the width that the mean depth of the blockers calls "
            "for. Blockers at several depths count as one; what the light's centre does not see cannot block.",
        ),
        Candidate(
            "pcss on pages",
            _pcss,
            {"resolution": (4096, 16384), "blocker_samples": (16,), "filter_samples": (32,)},
            _pages,
            _page_counters("pcss"),
            domain=_area_light,
            seeded=True,
            about="The same in pages of a large map, drawn where the view looks, in texels as fine as its pixels. "
            "Beyond the pages nothing blocks: very wide penumbrae grow too light.",
        ),
        *_of_moments(),
        Candidate(
            "distance_field",
            field_lit,
            {"field_resolution": (16, 48)},
            counters=field_counters,
            domain=_area_light,
            about="Cones towards the light through a field of distances: no noise. What is thinner than a cell of the "
            "field is lost, and penumbrae are as of one blocker. The field is built once for a scene and not counted.",
        ),
        Candidate(
            "ray_traced",
            _ray_traced,
            {"samples": (1, 4, 16, 64)},
            counters=_counters("ray_traced"),
            seeded=True,
            about="Rays to points of the light. Unbiased visibility; noise falls with their number. The tree that they "
            "are traced in is built once for a scene and not counted.",
        ),
    ]


def _of_moments() -> list[Candidate]:
    """Maps that are filtered before the lookup."""
    about = {
        "variance": "A bound from the mean and variance of depth, over a Gaussian of fixed width (in texels). Light "
        "bleeds through blockers at two depths.",
        "exponential_variance": "The same of depths that exponentials have stretched: less light bleeds.",
        "moment": "A bound from four moments of depth: exact for two depths; light bleeds where there are more.",
        "variance_soft": "Filters as wide as the blockers' mean depth calls for, search and filter both by one read of "
        "a table or of mips: no noise, at a cost that does not depend on the penumbra.",
    }
    fixed = [
        Candidate(name, _filtered(name), knobs, _moment_maps(name), _counters(name), about=about[name])
        for name, knobs in (
            ("variance", {**_FIXED, "light_bleeding": (0.0, 0.2)}),
            ("exponential_variance", _FIXED),
            ("moment", _FIXED),
        )
    ]
    soft = [
        {"resolution": 1024, "kind": kind, "filter": filter, "reduce": 2}
        for kind, filter in (("variance", "summed_area"), ("moment", "summed_area"), ("moment", "mip"))
    ]
    name = "variance_soft"
    return [
        *fixed,
        Candidate(
            name, _filtered(name), soft, _moment_maps(name), _counters(name), domain=_area_light, about=about[name]
        ),
    ]


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "soft shadows",
        SCENES,
        MonteCarlo(_estimate, first=16, most=1 << 14),
        Metric("rms error of direct light over unshadowed light", _residual, about=_line(_METRIC_ABOUT)),
        _candidates(),
        Mask("penumbrae and a 60th of the height around", _penumbrae, _line(_MASK_ABOUT), "no pixel is in penumbra"),
        views,
        _setup,
        _compose,
        {"leak %": _leaks, "FLIP": _flip, "rmse": _rmse},
        _display,
        lambda case: renderer.plan(case.scene, size=case.size),
        size=(480, 270),
        about=_line(_ABOUT),
    )


def _line(text: str) -> str:
    return " ".join(text.split())
