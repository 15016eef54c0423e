"""A study's report: one page that opens offline, and beside it the pictures and figures."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .records import CaseRecord, Choice, NothingQualifies, setting_text

if TYPE_CHECKING:
    from .results import Study

__all__ = ["CaseStrip", "Picture", "shown", "write"]

EMBEDDED_WIDTH = 640
"""Pixels: wider pictures are halved and so on for the page; the files beside it keep every pixel."""

SHOWN = 8
"""Settings whose pictures a report shows, at most."""

Array = NDArray[Any]


@dataclass(frozen=True)
class Picture:
    """A picture of the strip: what it shows, the file beside the page, and its data for the page itself."""

    caption: str
    file: str
    data: str
    alt: str


@dataclass(frozen=True)
class CaseStrip:
    """The pictures of one case: a row for the reference, one for each setting shown; and the scale of the maps."""

    case: CaseRecord
    rows: tuple[tuple[str, tuple[Picture, ...]], ...]
    scale: float


def write(study: Study, directory: Path, *, max_error: float | None = None, budget_ms: float | None = None) -> Path:
    """Write the report into a directory, which is made if need be; the page's path is returned."""
    from . import page

    directory.mkdir(parents=True, exist_ok=True)
    choice, refusal = _choice(study, max_error, budget_ms)
    study.to_csv(directory / "figures.csv")
    study.to_json(directory / "figures.json")
    study.plot().savefig(directory / "front.png", dpi=150)
    strips = list(_strips(study, directory, choice)) if study.pictures is not None else []
    path = directory / "index.html"
    path.write_text(page.html_page(study, strips, choice, refusal), encoding="utf-8")
    return path


def _choice(study: Study, max_error: float | None, budget_ms: float | None) -> tuple[Choice | None, str]:
    """The choice, if one was asked for; or why there is none."""
    if max_error is None and budget_ms is None:
        return None, ""
    try:
        return study.pick(max_error=max_error, budget_ms=budget_ms), ""
    except NothingQualifies as error:
        return None, str(error)


def shown(study: Study, choice: Choice | None) -> list[tuple[str, dict[str, Any]]]:
    """The settings whose pictures are shown: each technique's best (few of other elements all), the choice."""
    settings = study.best() if study.settings.get("element", "pixel") == "pixel" else study.few()
    if choice is not None and (choice.technique, choice.knobs) not in settings:
        at = next(i for i, s in enumerate(settings) if s[0] == choice.technique)
        settings.insert(at, (choice.technique, choice.knobs))
    return settings[:SHOWN]


def _strips(study: Study, directory: Path, choice: Choice | None) -> Iterator[CaseStrip]:
    """Make and save the pictures of each case, one case at a time."""
    assert study.pictures is not None
    wanted = shown(study, choice)
    for case in study.cases:
        made = study.pictures(case.key, wanted)
        if made["display"] is None:
            return
        yield _strip(case, made, wanted, directory)


def _strip(
    case: CaseRecord, made: dict[str, Any], wanted: list[tuple[str, dict[str, Any]]], directory: Path
) -> CaseStrip:
    folder = f"pictures/{_slug(case.name)}"
    (directory / folder).mkdir(parents=True, exist_ok=True)

    def keep(picture: Array, name: str, caption: str, alt: str) -> Picture:
        file = f"{folder}/{name}.png"
        image = _image(picture)
        image.save(directory / file, compress_level=1)
        return Picture(caption, file, _embedded(image), alt)

    def keep_values(values: Array, name: str) -> None:
        from .. import scene

        scene.save_image(directory / folder / f"{name}.exr", np.ascontiguousarray(values, np.float32))

    reference, mask = made["reference"], made["mask"]
    keep_values(reference, "reference")
    picture = made["display"](reference)
    first = [keep(picture, "reference", "reference", f"{case.name}: reference")]
    if not mask.all():
        outline = picture.copy()
        outline[mask] = (outline[mask] * 0.4 + np.array([0, 158, 115]) * 0.6).astype(np.uint8)
        about = f"the mask covers {case.mask_share:.1%} of the picture"
        first.append(keep(outline, "mask", f"mask (green): {about}", f"{case.name}: mask"))
    rows: list[tuple[str, tuple[Picture, ...]]] = [("reference", tuple(first))]
    # One scale for all maps of a case, so that they compare: nearly the largest error under the mask.
    residuals = {s: _flat(made["residual"](v)) for s, v in made["values"].items()}
    magnitudes = [np.abs(r[mask]) for r in residuals.values() if mask.any()]
    scale = max((float(np.quantile(m[np.isfinite(m)], 0.99)) for m in magnitudes if np.isfinite(m).any()), default=0.0)
    scale = scale or 1.0
    for technique, knobs in wanted:
        key = (technique, tuple(knobs.items()))
        if key not in made["values"]:
            continue
        value, text = made["values"][key], setting_text(technique, knobs)
        name = _slug(text)
        keep_values(value, name)
        row = [
            keep(made["display"](value), name, text, f"{case.name}: {text}"),
            keep(_diverging(residuals[key] / scale, mask), f"{name}-difference", "difference", f"{text}: difference"),
        ]
        for title, measure in made["also"].items():
            errors = measure(value)
            if np.ndim(errors) == 2:
                caption = f"{title} {float(np.mean(errors)):.3g}"
                row.append(keep(_magma(errors), f"{name}-{_slug(title)}", caption, f"{text}: {title}"))
        rows.append((text, tuple(row)))
    return CaseStrip(case, tuple(rows), scale)


def _slug(text: str) -> str:
    return re.sub(r"[^a-z0-9.]+", "-", text.lower()).strip("-") or "case"


def _flat(residual: Array) -> Array:
    """A residual as one map."""
    return residual if residual.ndim == 2 else np.asarray(residual.mean(-1))


def _image(picture: Array) -> Any:
    try:
        from PIL import Image
    except ImportError as error:
        raise ImportError("reports need Pillow: pip install 'shadelab[study]'") from error
    return Image.fromarray(np.ascontiguousarray(picture, np.uint8))


def _embedded(image: Any) -> str:
    """A picture as a data URI: WebP, a tenth of PNG's size and hardly to be told apart, or JPEG where it is missing."""
    from PIL import features

    while image.width > EMBEDDED_WIDTH:
        image = image.reduce(2)
    kind = "webp" if features.check("webp") else "jpeg"
    file = io.BytesIO()
    image.save(file, kind, quality=88)
    return f"data:image/{kind};base64,{base64.b64encode(file.getvalue()).decode('ascii')}"


def _diverging(signed: Array, mask: Array) -> Array:
    """A map of signed errors in −1 … 1: white where there is none, blue too dark, red too bright, paler off the mask.

    What is not finite is black.
    """
    stops = np.array([[5, 48, 97], [67, 147, 195], [247, 247, 247], [214, 96, 77], [103, 0, 31]], float)
    t = (np.clip(np.nan_to_num(signed, nan=0.0), -1, 1) + 1) * 2
    colors = np.stack([np.interp(t, range(5), stops[:, c]) for c in range(3)], -1)
    colors[~mask] = 0.55 * colors[~mask] + 0.45 * 247
    colors[~np.isfinite(signed)] = 0
    return (colors + 0.5).astype(np.uint8)


def _magma(errors: Array) -> Array:
    from matplotlib import colormaps

    return np.asarray((colormaps["magma"](np.clip(errors, 0, 1))[..., :3] * 255 + 0.5).astype(np.uint8))
