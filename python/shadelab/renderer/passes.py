"""Passes and plans: what a frame is made of, in order, and why."""

from __future__ import annotations

import html
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ._facts import checked_size

__all__ = ["LeftOut", "Pass", "Plan", "Shading"]


@dataclass(frozen=True)
class Pass:
    """One step of a frame: what it does, why the scene requires it, and with which settings."""

    name: str
    reason: str
    settings: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, value in (("name", self.name), ("reason", self.reason)):
            if not isinstance(value, str):
                raise TypeError(f"{name}: expected a string, got {type(value).__name__}")
        if not isinstance(self.settings, Mapping):
            raise TypeError(f"settings: expected a mapping, got {type(self.settings).__name__}")
        lights = self.settings.get("lights", ())
        if not isinstance(lights, list | tuple) or not all(isinstance(i, int) and i >= 0 for i in lights):
            raise TypeError(f"settings: expected indices as lights, got {lights!r}")


@dataclass(frozen=True)
class LeftOut:
    """A pass that the scene does not require, and why."""

    name: str
    reason: str


@dataclass(frozen=True)
class Shading:
    """How a material is shaded, and how far that is off."""

    material: str
    """Its name, or that of its model."""
    model: Any
    """What is evaluated: a model of `shadelab.brdf`, the material's own or a simpler one."""
    kind: str
    """The model's name."""
    method: str
    """For light from areas: see `shadelab.renderer.shade`."""
    samples: int
    error: float
    """Root mean square over where the material is seen, over its mean radiance; NaN if it is not in view.

    Measured for the plan, beside the material itself under many samples."""
    reason: str
    by_light: tuple[tuple[str, int], ...] = ()
    """Method and samples for each light of the direct pass, where they differ; empty: the same for all."""


@dataclass(frozen=True)
class Plan:
    """The passes of a frame in order, and what was left out."""

    passes: tuple[Pass, ...]
    left_out: tuple[LeftOut, ...]
    size: tuple[int, int]
    lights: int | None = None
    """How many lights the scene has that it was made for; None if it does not say."""
    shading: tuple[Shading, ...] = ()
    """Of each material of the flattened scene; empty: all by themselves, by samples."""

    def __post_init__(self) -> None:
        for name, kind in (("passes", Pass), ("left_out", LeftOut), ("shading", Shading)):
            items = getattr(self, name)
            if not isinstance(items, list | tuple):
                raise TypeError(f"{name}: expected a sequence of {kind.__name__}, got {type(items).__name__}")
            for item in items:
                if not isinstance(item, kind):
                    raise TypeError(f"{name}: expected a sequence of {kind.__name__}, got {type(item).__name__} in it")
            object.__setattr__(self, name, tuple(items))
        if self.lights is not None and not isinstance(self.lights, int):
            raise TypeError(f"lights: expected a count or None, got {type(self.lights).__name__}")
        object.__setattr__(self, "size", checked_size(self.size))

    def find(self, name: str) -> Pass | None:
        """The pass of a name, None if it was left out.

        Parameters
        ----------
        name : str
            As `Pass.name`.

        Returns
        -------
        Pass or None
        """
        return next((p for p in self.passes if p.name == name), None)

    def __str__(self) -> str:
        width = max((len(name) for name in [p.name for p in self.passes] + [x.name for x in self.left_out]), default=0)
        lines = [f"{self.size[0]} x {self.size[1]}, {len(self.passes)} passes"]
        for number, p in enumerate(self.passes, 1):
            settings = ", ".join(f"{k}={v!r}" for k, v in p.settings.items())
            lines.append(f"{number:3}. {p.name:{width}}  {p.reason}" + (f" ({settings})" if settings else ""))
        lines += [f"  *  {self._about(x)}  {x.reason}" for x in self.shading]
        lines += [f"  -  {x.name:{width}}  left out: {x.reason}" for x in self.left_out]
        return "\n".join(lines)

    @staticmethod
    def _about(shading: Shading) -> str:
        how = "" if shading.kind == "diffuse" and shading.method != "point" else shading.method.replace("_", " ")
        if how == "sampling":
            how = f"{shading.samples} samples" if shading.samples else ""
        if shading.by_light:
            each = [f"{n} samples" if m == "sampling" and n else m.replace("_", " ") for m, n in shading.by_light]
            how = "by light: " + " / ".join("exact" if x == "sampling" else x for x in each)
        error = "" if math.isnan(shading.error) else f", error {shading.error:.1%}"
        return f"{shading.material}: {shading.kind}" + (f", {how}" if how else "") + error

    def _repr_html_(self) -> str:
        rows = []
        for number, p in enumerate(self.passes, 1):
            settings = ", ".join(f"{k}={v!r}" for k, v in p.settings.items())
            rows.append((str(number), p.name, p.reason, settings))
        rows += [("*", x.material, x.reason, self._about(x)) for x in self.shading]
        rows += [("–", x.name, f"left out: {x.reason}", "") for x in self.left_out]
        body = "".join("<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in row) + "</tr>" for row in rows)
        head = "<tr><th></th><th>pass</th><th>reason</th><th>settings</th></tr>"
        return f"<table><thead>{head}</thead><tbody>{body}</tbody></table>"
