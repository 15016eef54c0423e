"""The trade between speed and accuracy, measured.

A `Question` says what is asked: on which scenes and views, against which reference, by which metric over which mask,
of which `Candidate` techniques with which knobs. `run` measures every candidate over its knobs' range; the `Study` that
it returns draws the front, picks by an error bound or a budget, and writes a report. Each question of shadelab is one
file in `questions/`; `stability` is the table of accuracy at the extremes.

>>> from shadelab import study
>>> study.questions()
['acceleration', 'area lights', ..., 'soft shadows']
"""

from __future__ import annotations

from . import stability
from .measure import run
from .question import Candidate, Case, External, Mask, Metric, MonteCarlo, Question
from .questions import find, questions
from .records import Choice, NothingQualifies, Record, Summary
from .results import Study

__all__ = [
    "Candidate",
    "Case",
    "Choice",
    "External",
    "Mask",
    "Metric",
    "MonteCarlo",
    "NothingQualifies",
    "Question",
    "Record",
    "Study",
    "Summary",
    "find",
    "questions",
    "run",
    "stability",
]
