"""Plans: the shortest list of passes that a scene requires."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np

from .. import _arrays
from ._facts import brightness, check_scene, checked_size, depths_before, facts_of, flat, outline, unlit
from ._frequency import FREQUENCIES
from ._materials import DEFAULT_ERROR, places, reflectances, shadings
from ._shadows import picked, shadow_passes
from ._trials import Trial
from .passes import LeftOut, Pass, Plan, Shading

__all__ = ["plan"]


def plan(
    scene: Any,
    size: tuple[int, int] = (1280, 720),
    *,
    max_error: float | None = None,
    budget_ms: float | None = None,
    evidence: Any = None,
    frequency: Literal["flat", "gouraud", "phong"] = "phong",
) -> Plan:
    """The shortest list of passes that a scene requires, each with its reason.

    Parameters
    ----------
    scene : Scene
        What is to be rendered.
    size : (int, int)
        Width and height in pixels: what is smaller than a pixel is not worth a pass.
    max_error, budget_ms : float, optional
        Bounds that the shadow of every light must keep (0.1 for wide penumbrae by itself), and the shading of every
        material (0.02 by itself), as measured here. `max_error` is the error of a light's direct light where its shadow
        has edges, relative to what would arrive with nothing in between; and of a material, relative to its mean
        radiance. `budget_ms` is the time of all shadows, shared evenly by the lights, and that of all shading, on one
        thread, for which the least error is sought.
    evidence : object, optional
        What a study found of soft shadows, which then chooses for area lights by the bounds: anything whose
        ``pick(max_error=…)`` or ``pick(budget_ms=…)`` returns an object with `technique`, `knobs`, `error` and `ms`.
    frequency : {"phong", "gouraud", "flat"}
        Where direct light is worked out: at every pixel with the interpolated normal; at vertices, and interpolated
        between them; or once a face, at its middle. Shadows are those of pixels in either case.

    Returns
    -------
    Plan
        Passes in order, and what was left out and why. Prints as text, shows as a table in Jupyter.

    Raises
    ------
    TypeError, ValueError
        If a size or bound is out of range, evidence comes without a bound, or nothing that it measured keeps it.

    Notes
    -----
    Decided by necessity: no pass without surfaces, lights, or something that can stand between them (one plane and
    one convex body shade nothing); no map for a light that emits nothing or faces away; no penumbra for lights without
    extent or where similar triangles bound it below a pixel on every receiver, however tilted; no cascades where the
    texels of one map of at most 2048² are at most 4 pixels wide in the nearest that is seen, else as many (up to 6, of
    equal ratio) as bring them there; pages of a map of up to 16384² where light that is not parallel asks for them, and
    six maps around a light within the scene. Bounds are on the safe side: a pass may be there without need, never
    missing with need.

    Shadows are tried, not guessed at. A small picture of the view (14,400 pixels) is asked by 16 rays each where a
    light's shadow has edges. There (1,024 places) and elsewhere (512) what would find the shadow stands beside 256
    rays, or 1,024 for bounds below 0.05: one comparison with maps of several resolutions, cascades, cubes and pages;
    filters as wide as penumbrae where these are alike; those that look for the width, by comparisons and by moments; 1
    to 4,096 rays. The cheapest that keeps the bound is taken, or the best that the budget allows. The pass tells the
    error that is expected (root mean square over edges and a 60th of the picture's height around, with three standard
    errors added), what it costs, and which bounds are not kept, if they are beyond all. Thin shadows that fall between
    the pixels of the small picture are missed. Where no map sees what hides a light (surfaces nearer to it than it is
    wide; two sides), there are rays, which take the place of evidence as well.

    Materials are tried, not guessed at: where a small picture shows them (128 places each), under the scene's lights
    without obstacles, cheaper models (a diffuser; metallic-roughness; one without compensation) and cheaper ways to
    light from areas (as points; one representative point; transformed cosines; few samples) stand beside the material
    itself under 1,024 samples, and the first that keeps the bound is taken; `Plan.shading` tells which, why, and how
    far it is off. The ambient pass takes one reflectance for a material if that keeps the bound, else samples. Times
    are those of one machine and rank well elsewhere: the same scene has the same plan each time. Costs 50 ms per
    100 000 triangles, 20 ms a material where area lights shine, and 50 to 300 ms for each light's shadow.

    References
    ----------
    H. Gouraud, *Continuous shading of curved surfaces*, 1971.
    B. T. Phong, *Illumination for computer generated pictures*, 1975.
    E. Eisemann, M. Schwarz, U. Assarsson, M. Wimmer, *Real-Time Shadows*, 2011.

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
    bounds = {"max_error": max_error, "budget_ms": budget_ms}
    bounds = {k: _arrays.number(k, v, above=0.0) for k, v in bounds.items() if v is not None}
    _arrays.choice("frequency", frequency, FREQUENCIES)
    measured = picked(evidence, max_error, budget_ms) if evidence is not None else None
    _arrays.warn_if_coarse(scene.flatten(np.float32).positions, np.float32, 3)
    return decided(scene, size, measured, **bounds, frequency=frequency)


def decided(
    scene: Any,
    size: tuple[int, int],
    measured: tuple[str, dict[str, Any], str] | None,
    *,
    max_error: float | None = None,
    budget_ms: float | None = None,
    frequency: str = "phong",
) -> Plan:
    facts = facts_of(scene, size)
    bounds = {k: v for k, v in (("max_error", max_error), ("budget_ms", budget_ms)) if v is not None}
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
    arrays = scene.flatten(np.float32)
    trial = Trial(arrays, scene.camera, size)
    each = dict(bounds)
    if budget_ms is not None:
        each["budget_ms"] = budget_ms / max(sum(not unlit(lamp, facts) for lamp in lamps), 1)
    for i, lamp in enumerate(lamps):
        suffix = f" {i}" if len(lamps) > 1 else ""
        dark = unlit(lamp, facts)
        if dark:
            left_out += [LeftOut(f"{n}{suffix}", dark) for n in ("shadow map", "direct light")]
            continue
        reaching.append(i)
        more, less = shadow_passes(lamp, suffix, facts, measured, each, trial, traced)
        if not traced and any(p.settings.get("technique") == "ray_traced" for p in more):
            passes.append(Pass("bvh", "shadow rays are traced in it"))
            traced = True
        passes += more
        left_out += less
    chosen: tuple[Shading, ...] = ()
    where = places(arrays, scene.camera, [lamps[i] for i in reaching])
    if reaching:
        count = "a light reaches" if len(reaching) == 1 else f"{len(reaching)} lights reach"
        how: dict[str, Any] = {"lights": tuple(reaching), "samples": 16}
        if frequency != "phong":
            how["frequency"] = frequency
        passes.append(Pass("direct light", f"{count} the scene", how))
        chosen = shadings(arrays, where, max_error, budget_ms, size[0] * size[1])
    elif not lamps:
        left_out.append(LeftOut("direct light", "the scene has no lights"))
    left_out += light_surfaces(scene, size)
    passes, left_out = surroundings(scene, arrays, where, max_error, passes, left_out)
    left_out.append(LeftOut("tone map", "a matter of display: the frame stays linear"))
    return Plan(tuple(passes), tuple(left_out), size, len(lamps), chosen)


def light_surfaces(scene: Any, size: tuple[int, int]) -> list[LeftOut]:
    """The lights with an outline that may be in view: they shine, but no pass draws them."""
    camera, several = scene.camera, len(scene.lights) > 1
    eye, view = np.asarray(camera.eye, np.float64), np.asarray(camera.view(), np.float64)
    up = math.tan(float(camera.fov_y) / 2.0)
    aside = up * size[0] / size[1]
    found = []
    for i, lamp in enumerate(scene.lights):
        corners = outline(lamp)
        if corners is None or brightness(lamp) == 0.0:
            continue
        if flat(lamp) is not None and not lamp.two_sided and depths_before(lamp, eye[None])[0] <= 0.0:
            continue
        x, y, z = view[:3, :3] @ corners.T + view[:3, 3:]
        # Out of view if all corners are beyond one of the picture's sides.
        sides = (-z, x - aside * z, -x - aside * z, y - up * z, -y - up * z)
        if all((s > 0.0).any() for s in sides):
            suffix = f" {i}" if several else ""
            found.append(LeftOut(f"light surface{suffix}", "it is in view, but no pass draws lights: path_trace does"))
    return found


def surroundings(
    scene: Any, arrays: Any, where: Any, max_error: float | None, passes: list[Pass], left_out: list[LeftOut]
) -> tuple[list[Pass], list[LeftOut]]:
    if scene.environment is not None:
        passes.append(Pass("environment", "a panorama shines on everything, as if nothing hid it", {"samples": 64}))
    if np.max(scene.background) > 0:
        bound = DEFAULT_ERROR if max_error is None else max_error
        shares, error = reflectances(arrays, where, scene.background)
        why = "the background shines on everything, as if nothing hid it"
        if error <= bound:
            why += f"; one reflectance for each material, error {error:.1%}"
            passes.append(Pass("ambient", why, {"reflectances": shares}))
        else:
            why += f"; by samples, since one reflectance for a material is off by {error:.1%}"
            passes.append(Pass("ambient", why, {"samples": 64}))
    else:
        left_out.append(LeftOut("ambient", "the background is black"))
    if scene.environment is not None or np.max(scene.background) > 0:
        why = "what hides the sky from surfaces is not looked for, in no bound on the error: "
        left_out.append(LeftOut("ambient occlusion", why + "an AmbientLight is hidden, and path_trace has it for all"))
    left_out.append(LeftOut("indirect light", "surfaces send no light to each other: path_trace has it"))
    if np.max(arrays.emission, initial=0.0) > 0:
        passes.append(Pass("emission", "some materials shine"))
    else:
        left_out.append(LeftOut("emission", "no material shines"))
    return passes, left_out
