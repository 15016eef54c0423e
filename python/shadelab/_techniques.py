"""What there is: gathered from the public faces and their docstrings."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import re
from collections.abc import Iterable
from typing import Any

__all__ = ["chapters", "listing", "references", "techniques"]


def chapters() -> list[str]:
    """The chapters that there are, in the order in which the package's docstring introduces them."""
    import shadelab

    there = [m.name for m in pkgutil.iter_modules(shadelab.__path__) if not m.name.startswith("_")]
    introduced = [n for n in re.findall(r"^(\w+)$", shadelab.__doc__ or "", re.M) if n in there]
    return introduced + [n for n in there if n not in introduced]


def techniques(chapter: str) -> list[tuple[str, str, list[str]]]:
    """A chapter's public functions and classes: name, first line of the docstring, sources."""
    module = importlib.import_module(f"shadelab.{chapter}")
    found = []
    for name in getattr(module, "__all__", ()):
        thing: Any = getattr(module, name)
        if inspect.isfunction(thing) or inspect.isclass(thing):
            text = inspect.getdoc(thing) or ""
            summary = " ".join(text.split("\n\n", 1)[0].split())
            found.append((name, summary, references(text)))
    return found


def references(text: str) -> list[str]:
    """The entries of a docstring's References section, each in one line."""
    section = re.search(r"^References\n-+\n(.*?)(?=^\w[^\n]*\n-{3,}$|\Z)", text, re.M | re.S)
    if not section:
        return []
    # Entries stand apart by blank lines, by numbers in brackets, or by the indent of their further lines.
    entries = re.split(r"\n\s*\n|\n(?=\S)", section.group(1).strip())
    plain = (" ".join(re.sub(r"^\.\. \[\d+\]\s*|^\[\d+\]\s*|^[-*] ", "", e.strip()).split()) for e in entries)
    return [e for e in plain if e]


def listing(names: Iterable[str]) -> str:
    """The techniques of some chapters as text."""
    lines: list[str] = []
    for chapter in names:
        about = (importlib.import_module(f"shadelab.{chapter}").__doc__ or "").split("\n\n", 1)[0]
        lines.append(f"{chapter}: {' '.join(about.split())}")
        found = techniques(chapter)
        width = max((len(name) for name, _, _ in found), default=0)
        for name, summary, sources in found:
            lines.append(f"  {name:{width}}  {summary}")
            lines += [f"  {'':{width}}    {source}" for source in sources]
        lines.append("")
    return "\n".join(lines).rstrip()
