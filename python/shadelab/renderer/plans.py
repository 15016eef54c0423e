"""Plans: the shortest list of passes that a scene requires."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .. import _arrays, light
from ._facts import brightness, check_scene, checked_size, corners_of, facts_of, rect_depths, unlit
from ._shadows import picked, shadow_passes
from .passes import LeftOut, Pass, Plan

__all__ = ["plan"]


def plan(
    scene: Any,
    size: tuple[int, int] = (1280, 720),
    *,
    max_error: float | None = None,
    budget_ms: float | None = None,
    evidence: Any = None,
) -> Plan:
    """The shortest list of passes that a scene requires, each with its reason.

    Parameters
    ----------
    scene : Scene
        What is to be rendered.
    size : (int, int)
        Width and height in pixels: what is smaller than a pixel is not worth a pass.
    max_error, budget_ms : float, optional
        Bounds that the shadow technique of area lights must keep, as measured in `evidence`.
    evidence : object, optional
        What a study found: anything whose ``pick(max_error=…)`` or ``pick(budget_ms=…)`` returns an object with
        `technique`, `knobs`, `error` and `ms`.

    Returns
    -------
    Plan
        Passes in order, and what was left out and why. Prints as text, shows as a table in Jupyter.

    Raises
    ------
    TypeError, ValueError
        If a size or bound is out of range, a bound comes without evidence, or no measured candidate keeps it.

    Notes
    -----
    Decided by necessity: no pass without surfaces, lights, or something that can stand between them (one plane and
    one convex body shade nothing); no map for a light that emits nothing or faces away; no penumbra for lights without
    extent or where similar triangles bound it below a pixel. Bounds are on the safe side: a pass may be there without
    need, never missing with need. Costs a few milliseconds a 100 000 triangles.

    Examples
    --------
    >>> from shadelab.mesh import box
    >>> from shadelab.light import PointLight
    >>> from shadelab.scene import Scene
    >>> print("; ".join(p.name for p in plan(Scene([box()], [PointLight((0, 5, 0), (9, 9, 9))])).passes))
    g-buffer; direct light
    """
    check_scene(scene)
    size = checked_size(size)
    if evidence is None and not (max_error is None and budget_ms is None):
        raise ValueError("evidence: expected the result of a study beside max_error or budget_ms")
    measured = picked(evidence, max_error, budget_ms) if evidence is not None else None
    _arrays.warn_if_coarse(scene.flatten(np.float32).positions, np.float32, 3)
    return decided(scene, size, measured)


def decided(scene: Any, size: tuple[int, int], measured: tuple[str, dict[str, Any], str] | None) -> Plan:
    facts = facts_of(scene, size)
    passes: list[Pass] = []
    left_out: list[LeftOut] = []
    lamps = list(scene.lights)
    if not len(facts.faces):
        left_out += [LeftOut(n, "the scene has no surfaces") for n in ("g-buffer", "shadow", "direct light", "ambient")]
        passes.append(Pass("background", "all that is seen"))
        left_out += light_surfaces(scene, size)
        return Plan(tuple(passes), tuple(left_out), size, len(lamps))

    passes.append(Pass("g-buffer", "which surface each pixel sees: everything else is done once a pixel"))
    reaching = []
    traced = False
    for i, lamp in enumerate(lamps):
        suffix = f" {i}" if len(lamps) > 1 else ""
        dark = unlit(lamp, facts)
        if dark:
            left_out += [LeftOut(f"{n}{suffix}", dark) for n in ("shadow map", "direct light")]
            continue
        reaching.append(i)
        more, less = shadow_passes(lamp, suffix, facts, measured)
        if not traced and any(p.settings.get("technique") == "ray_traced" for p in more):
            passes.append(Pass("bvh", "shadow rays are traced in it"))
            traced = True
        passes += more
        left_out += less
    if reaching:
        count = "a light reaches" if len(reaching) == 1 else f"{len(reaching)} lights reach"
        passes.append(Pass("direct light", f"{count} the scene", {"lights": tuple(reaching), "samples": 16}))
    elif not lamps:
        left_out.append(LeftOut("direct light", "the scene has no lights"))
    left_out += light_surfaces(scene, size)
    passes, left_out = surroundings(scene, passes, left_out)
    left_out.append(LeftOut("tone map", "a matter of display: the frame stays linear"))
    return Plan(tuple(passes), tuple(left_out), size, len(lamps))


def light_surfaces(scene: Any, size: tuple[int, int]) -> list[LeftOut]:
    """The rectangular lights that may be in view: they shine, but no pass draws them."""
    camera, several = scene.camera, len(scene.lights) > 1
    eye, view = np.asarray(camera.eye, np.float64), np.asarray(camera.view(), np.float64)
    up = math.tan(float(camera.fov_y) / 2.0)
    aside = up * size[0] / size[1]
    found = []
    for i, lamp in enumerate(scene.lights):
        if not isinstance(lamp, light.RectLight) or brightness(lamp) == 0.0:
            continue
        if not lamp.two_sided and rect_depths(lamp, eye[None])[0] <= 0.0:
            continue
        x, y, z = view[:3, :3] @ np.array(corners_of(lamp)).T + view[:3, 3:]
        # Out of view if all corners are beyond one of the picture's sides.
        sides = (-z, x - aside * z, -x - aside * z, y - up * z, -y - up * z)
        if all((s > 0.0).any() for s in sides):
            suffix = f" {i}" if several else ""
            found.append(LeftOut(f"light surface{suffix}", "it is in view, but no pass draws lights: path_trace does"))
    return found


def surroundings(scene: Any, passes: list[Pass], left_out: list[LeftOut]) -> tuple[list[Pass], list[LeftOut]]:
    if np.max(scene.background) > 0:
        passes.append(Pass("ambient", "the background shines on everything; nothing hides it from anything here"))
    else:
        left_out.append(LeftOut("ambient", "the background is black"))
    if np.max(scene.flatten(np.float32).emission, initial=0.0) > 0:
        passes.append(Pass("emission", "some materials shine"))
    else:
        left_out.append(LeftOut("emission", "no material shines"))
    return passes, left_out
