"""The questions that shadelab asks of itself: one file each, found by its name; `question()` in it makes it."""

from __future__ import annotations

import importlib
import pkgutil

from ..question import Question

__all__ = ["find", "questions"]


def questions() -> list[str]:
    """The names of all questions, as `run` and the command line take them.

    Returns
    -------
    list of str
    """
    return sorted(m.name.replace("_", " ") for m in pkgutil.iter_modules(__path__) if not m.name.startswith("_"))


def find(name: str) -> Question:
    """A question by its name.

    Parameters
    ----------
    name : str
        As `questions` has it; hyphens and underscores count as spaces.

    Returns
    -------
    Question

    Raises
    ------
    TypeError
        If the name is not a string.
    ValueError
        If there is none of that name.
    """
    if not isinstance(name, str):
        raise TypeError(f"question: expected a name, got {type(name).__name__}")
    plain = name.strip().lower().replace("-", " ").replace("_", " ")
    if plain not in questions():
        raise ValueError(f"question: expected one of {', '.join(map(repr, questions()))}, got {name!r}")
    module = importlib.import_module(f"{__name__}.{plain.replace(' ', '_')}")
    made: Question = module.question()
    return made
