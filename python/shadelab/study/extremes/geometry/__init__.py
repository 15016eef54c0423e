"""Extremes of `geometry`, a file for each kind of test."""

from . import spheres, triangles

__all__ = ["spheres", "triangles"]
