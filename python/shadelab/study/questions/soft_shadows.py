"""Soft shadows: how much of an area light each point sees, by shadow maps, their filters, and rays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import color, image, pathtrace, renderer, shadow
from ...accel import BVH
from ..question import Candidate, Case, Mask, Metric, MonteCarlo, Question
from ._shadow_scenes import SCENES, views

__all__ = ["question"]

Array = NDArray[Any]

_MASK_RAYS = 256
"""Rays that find the penumbrae: one blocked, or one that passes, of these puts a pixel into the mask."""

_MASK_REACH = 1 / 60
"""How far the mask reaches beyond penumbrae, in heights of the picture: halos and leaks lie beside them."""

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Of linear sRGB."""
