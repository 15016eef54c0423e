"""Extremes of `geometry`, a file for each kind of test."""

from . import boxes, nearest, overlap, polygons, spheres, triangles

__all__ = ["boxes", "nearest", "overlap", "polygons", "spheres", "triangles"]
