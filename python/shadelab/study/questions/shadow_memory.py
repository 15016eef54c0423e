"""Shadow memory: what bytes buy, over techniques, formats and resolutions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import shadow
from ..question import Candidate, Mask, MonteCarlo, Question
from ._fields import field_counters, field_lit
from ._shadow_scenes import own_camera
from ._visibility import BREAKING, display, line, lit_error, spread
from .soft_shadows import (
    _MASK_ABOUT,
    Inputs,
    _area_light,
    _counters,
    _filtered,
    _hard,
    _maps,
    _moment_maps,
    _pcss,
    _penumbrae,
    _setup,
)

__all__ = ["question"]

Array = NDArray[Any]


def _estimate(inputs: Inputs, samples: int, seed: int, start: int, where: Array | None) -> Array:
    """Lit fractions by rays; further samples are further, independent sets."""
    wanted = slice(None) if where is None else where[inputs.covered]
    stream = (seed * 0x9E3779B97F4A7C15 + start) % (1 << 64)
    lit = np.zeros((len(inputs.lights), len(inputs.points)), inputs.points.dtype)
    left, done = samples, 0
    while left:
        n = min(left, 4096)
        for k, light in enumerate(inputs.lights):
            lit[k, wanted] += n * shadow.ray_traced(
                inputs.bvh,
                inputs.points[wanted],
                inputs.geometric[wanted],
                light,
                n,
                seed=(stream + done) % (1 << 64),
            )
        left, done = left - n, done + n
    return spread(inputs, lit / samples)


_ABOUT = """What stays in memory for an area light's shadow: a map of depths, a map of moments beside it (in 16 bits, in
floats, as a table of double sums), a field of distances, or the tree that rays are traced in. What error does each
leave for its bytes, where it matters, in and beside penumbrae? Left and low is better: the axis
is megabytes, not time."""

_METRIC = """Root mean square, over the mask, of the lit fraction's difference from rays without number."""

_RESOLUTIONS = (128, 256, 512, 1024, 2048)


def _stored(name: str, title: str, about: str, **fixed: Any) -> Candidate:
    knobs = {"resolution": _RESOLUTIONS} | {k: (v,) for k, v in fixed.items()}
    return Candidate(title, _filtered(name), knobs, _moment_maps(name), _counters(name), _area_light, about=about)


def _stored_pcss(inputs: Inputs, maps: list[Any], resolution: int, stored_bits: int, **knobs: int) -> Array:
    return _pcss(inputs, maps, resolution, **knobs)


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "shadow memory",
        BREAKING,
        MonteCarlo(_estimate, first=64, most=1 << 12),
        lit_error(_METRIC),
        [
            Candidate(
                "hard",
                _hard,
                {"resolution": _RESOLUTIONS},
                _maps,
                _counters("hard"),
                about="Four bytes a texel, and no penumbra however many there are.",
            ),
            Candidate(
                "pcss",
                _pcss,
                {"resolution": _RESOLUTIONS, "blocker_samples": (16,), "filter_samples": (32,)},
                _maps,
                _counters("pcss"),
                _area_light,
                True,
                "Four bytes a texel; the filter is as wide as blockers ask for, and its noise is that of 32 taps.",
            ),
            Candidate(
                "pcss, 16 bits",
                _stored_pcss,
                {"resolution": _RESOLUTIONS, "stored_bits": (16,), "blocker_samples": (16,), "filter_samples": (32,)},
                _maps,
                _counters("pcss"),
                _area_light,
                True,
                "The same on depths in 16 bits: two bytes a texel.",
            ),
            _stored(
                "variance_soft",
                "moments as mips, 16 bits",
                "Four powers in 16 bits each, and a third for mips, beside the depths.",
                kind="moment",
                filter="mip",
                bits=16,
            ),
            _stored(
                "variance_soft",
                "moments as mips",
                "Four powers in single precision, and a third for mips, beside the depths.",
                kind="moment",
                filter="mip",
            ),
            _stored(
                "variance_soft",
                "moments as a table",
                "Four powers summed in double precision, beside the depths: boxes of any width, for 32 bytes a texel.",
                kind="moment",
                filter="summed_area",
            ),
            Candidate(
                "distance_field",
                field_lit,
                {"field_resolution": (16, 32, 48)},
                counters=field_counters,
                about="Four bytes a node, for all lights together; what is thinner than a cell is lost. Built once a "
                "scene and not counted in ms.",
            ),
            Candidate(
                "ray_traced",
                lambda inputs, prepared, samples, seed: np.stack(
                    [
                        shadow.ray_traced(inputs.bvh, inputs.points, inputs.geometric, l, samples=samples, seed=seed)
                        for l in inputs.lights
                    ]
                ),
                {"samples": (4, 16)},
                counters=_counters("ray_traced"),
                seeded=True,
                about="The tree's bytes, for all lights together.",
            ),
        ],
        Mask("penumbrae and a 60th of the height around", _penumbrae, line(_MASK_ABOUT), "no pixel is in penumbra"),
        setup=_setup,
        views=own_camera,
        compose=spread,
        display=display,
        size=(320, 180),
        about=line(_ABOUT),
        max_error=0.12,
        cost="bytes",
    )
