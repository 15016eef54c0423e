"""shadelab: the laboratory of real-time rendering for NumPy."""

from __future__ import annotations

from . import geometry

__all__ = ["geometry"]
