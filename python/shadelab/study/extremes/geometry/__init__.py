"""Extremes of `geometry`, a file for each kind of test."""

from . import boxes, nearest, polygons, spheres, triangles

__all__ = ["boxes", "nearest", "polygons", "spheres", "triangles"]
