"""Frames: a picture with what it was made of."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from .. import _arrays, color
from .._arrays import Floats
from .passes import Plan

__all__ = ["Frame"]


@dataclass(frozen=True, eq=False)
class Frame:
    """A picture with what it was made of. Arrays are (H, W) or (H, W, 3), row 0 at the top."""

    radiance: Floats
    """Linear radiance towards the eye, W/(m² sr)."""
    depth: Floats
    """Distance along the camera's axis; infinite where nothing is seen."""
    position: Floats
    """Points seen, in the world; NaN where nothing is seen."""
    normal: Floats
    """Shading normals, towards the eye; NaN where nothing is seen."""
    face: NDArray[np.int32]
    """Faces seen; -1 where nothing is seen."""
    lit: tuple[Floats, ...]
    """For each light of the scene the lit fraction: 1 where nothing is seen or the plan looks for no shadow."""
    times: Mapping[str, float]
    """Seconds by pass."""
    plan: Plan

    def __repr__(self) -> str:
        height, width = self.face.shape
        return f"Frame({width} × {height}, {len(self.lit)} lights, passes {', '.join(self.times)})"

    def display(self, exposure: float | None = None, tone_map: str = "aces") -> NDArray[np.uint8]:
        """The picture for a screen: exposed, tone-mapped, sRGB-encoded.

        Parameters
        ----------
        exposure : float, optional
            What radiance is multiplied by; by default what brings the 98th percentile of the luminance to 0.8.
        tone_map : str
            A method of `shadelab.color.tone_map`.

        Returns
        -------
        ndarray of uint8, shape (H, W, 3)

        Raises
        ------
        ValueError
            If the exposure is not positive or there is no such tone map.
        """
        return displayed(self.radiance, exposure, tone_map)

    def save(self, path: str | Path) -> None:
        """Write the picture: PNG as `display` shows it, EXR and HDR as radiance.

        Parameters
        ----------
        path : path
            Ends in .png, .exr or .hdr.

        Raises
        ------
        ImportError
            If the extra `io` is missing.
        OSError, ValueError
            If the file cannot be written, or has another ending.
        """
        from .. import scene

        path = _arrays.path("path", path)
        if path.suffix.lower() == ".png":
            path.write_bytes(self._repr_png_())
        else:
            scene.save_image(path, self.radiance)

    def _repr_png_(self) -> bytes:
        """The displayed picture as a PNG file, which Jupyter shows."""
        return png(self.display())


def displayed(radiance: Floats, exposure: float | None = None, tone_map: str = "aces") -> NDArray[np.uint8]:
    """Any radiance as `Frame.display` shows that of a frame."""
    if exposure is None:
        bright = color.luminance(radiance)
        peak = float(np.quantile(bright[np.isfinite(bright)], 0.98)) if bright.size else 0.0
        factor = 0.8 / peak if peak > 0 else 1.0
    else:
        factor = _arrays.number("exposure", exposure, above=0.0)
    _arrays.choice("tone_map", tone_map, get_args(color.ToneMap))
    mapped = color.tone_map(radiance * np.float32(factor), tone_map)  # type: ignore[arg-type]
    encoded = color.encode_transfer(np.clip(np.nan_to_num(mapped), 0, 1))
    return np.asarray(encoded * 255 + 0.5, np.uint8)


def png(pixels: NDArray[np.uint8]) -> bytes:
    """A PNG file (ISO/IEC 15948) of three channels."""
    height, width = pixels.shape[:2]
    # Each row begins with its filter: 0, none.
    rows = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], axis=1)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body
