"""shadelab: the laboratory of real-time rendering for NumPy.

Every technique of the real-time renderer is a function over arrays and stands beside the exact reference that it
approximates; `shadelab.study` measures what each costs and what it loses. Chapters, from the ground up:

transform
    Model, view, projection, viewport; rotations and quaternions; points through them.
sampling
    Generators, sequences, and warps with their densities.
image
    Pictures: error metrics.
color
    Transfer functions, luminance, tone mapping.
geometry
    Ray tests and barycentrics.
mesh
    The triangle mesh: normals and primitives.
accel
    Structures for ray queries: a watertight BVH, equal to brute force to the bit.
brdf
    Reflection models: evaluation, sampling, density.
light
    Punctual and area lights: irradiance in closed form, sampling, unshadowed radiance.
environment
    Light from all around: panoramas, looked up and drawn from by importance.
scene
    Scenes, cameras, materials, instances; loading and saving.
raster
    The pipeline: coverage, depth, interpolation, G-buffer.
pathtrace
    Ray casting, direct light, path tracing: the references.
shadow
    Shadow maps and their filters, and shadows by rays.
renderer
    The shortest list of passes for a scene, and its picture: `plan` and `render`.
study
    What each technique costs and what it loses: questions, fronts, reports, stability.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from ._runtime import set_threads, simd, simd_level, simd_levels, threads

if TYPE_CHECKING:
    from . import (
        accel,
        brdf,
        color,
        environment,
        geometry,
        image,
        light,
        mesh,
        pathtrace,
        raster,
        renderer,
        sampling,
        scene,
        shadow,
        study,
        transform,
    )
    from .renderer import plan, render
    from .scene import load

__all__ = [
    "accel",
    "brdf",
    "color",
    "environment",
    "geometry",
    "image",
    "light",
    "load",
    "mesh",
    "pathtrace",
    "plan",
    "raster",
    "render",
    "renderer",
    "sampling",
    "scene",
    "set_threads",
    "shadow",
    "simd",
    "simd_level",
    "simd_levels",
    "study",
    "threads",
    "transform",
]


_ELSEWHERE = {"load": "scene", "plan": "renderer", "render": "renderer"}


def __getattr__(name: str) -> Any:
    """Chapters are imported when they are first asked for: an import costs what is used."""
    if name in _ELSEWHERE:
        return getattr(importlib.import_module(f".{_ELSEWHERE[name]}", __name__), name)
    if name in __all__:
        return importlib.import_module(f".{name}", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
