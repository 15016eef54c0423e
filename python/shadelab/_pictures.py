"""Pictures from and to files: PNG (sRGB), OpenEXR and Radiance HDR (linear). Public through `shadelab.scene`."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, color

__all__ = ["load_image", "save_image"]

_FORMATS = (".png", ".exr", ".hdr")


def save_image(path: str | os.PathLike[str], image: ArrayLike) -> None:
    """Write a picture; the suffix of the path says how.

    Parameters
    ----------
    path : path
        ``.png`` (sRGB transfer, 8 bits; values outside [0, 1] are clipped, not exposed and tone-mapped as `Frame.save`
        does), ``.exr`` (float32, linear), or ``.hdr`` (Radiance RGBE, linear, three channels).
    image : array_like, shape (H, W) or (H, W, C) with C = 1, 3, 4
        Linear values, row 0 the top; a fourth channel is alpha, and the others are premultiplied by it. An array of
        uint8 is a picture already encoded, and goes to PNG as it is.

    Returns
    -------
    None

    Raises
    ------
    ImportError
        If Pillow or OpenEXR is not installed (``pip install 'shadelab[io]'``).
    TypeError, ValueError
        If the picture's type or shape or the suffix is not one of these, or a value cannot be held (NaN in PNG or
        HDR, negative or infinite in HDR).
    OSError
        If the file cannot be written.

    Notes
    -----
    A PNG keeps straight alpha, an EXR premultiplied alpha, as their standards say; HDR drops it. RGBE keeps 8 bits of
    the largest channel.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "grey.hdr"
    >>> save_image(path, np.full((2, 2, 3), 0.5))
    >>> load_image(path)[0, 0]
    array([0.5, 0.5, 0.5], dtype=float32)
    """
    path = _arrays.path("path", path)
    suffix = _suffix(path)
    array = _arrays.array("image", image)
    if array.dtype == np.uint8 and suffix == ".png":
        if array.ndim not in (2, 3):
            raise ValueError(f"image: expected shape (H, W) or (H, W, C), got {array.shape}")
        pixels = array
    else:
        pixels = _arrays.image("image", image)
    channels = 1 if pixels.ndim == 2 else pixels.shape[-1]
    if channels not in (1, 3, 4) or not pixels.size:
        raise ValueError(f"image: expected 1, 3 or 4 channels and at least one pixel, got shape {pixels.shape}")
    pixels = pixels.reshape(*pixels.shape[:2], channels)
    if suffix == ".png":
        _write_png(path, pixels)
    elif suffix == ".exr":
        _write_exr(path, pixels.astype(np.float32))
    else:
        with path.open("wb") as file:
            _write_hdr(file, pixels)


def load_image(path: str | os.PathLike[str]) -> NDArray[np.float32]:
    """Read a picture as linear values.

    Parameters
    ----------
    path : path
        ``.png`` (decoded from sRGB), ``.exr`` or ``.hdr``.

    Returns
    -------
    ndarray of float32, shape (H, W) or (H, W, 3) or (H, W, 4)
        Row 0 is the top. Colours are premultiplied by a fourth channel, alpha.

    Raises
    ------
    ImportError
        If Pillow or OpenEXR is not installed (``pip install 'shadelab[io]'``).
    FileNotFoundError
        If there is no such file.
    ValueError
        If the suffix is unknown or the file is broken.

    Examples
    --------
    >>> load_image("picture.webp")
    Traceback (most recent call last):
    ValueError: picture.webp: unknown format '.webp'; expected one of .png, .exr, .hdr
    """
    path = _arrays.path("path", path)
    suffix = _suffix(path)
    if not path.is_file():
        raise FileNotFoundError(f"{path}: no such file")
    read = {".png": _read_png, ".exr": _read_exr, ".hdr": _read_hdr}[suffix]
    try:
        return read(path)
    except ImportError:
        raise
    # Whatever a decoder stumbles over in a broken file is the file's error.
    except Exception as error:
        reason = str(error).strip().split("\n")[0] or type(error).__name__
        raise ValueError(f"{path}: cannot be read as {suffix[1:].upper()}: {reason}") from error


def _suffix(path: Path) -> str:
    suffix = path.suffix.lower()
    if suffix not in _FORMATS:
        raise ValueError(f"{path}: unknown format {path.suffix!r}; expected one of {', '.join(_FORMATS)}")
    return suffix


def _pillow() -> Any:
    try:
        from PIL import Image
    except ImportError:
        raise ImportError("PNG needs Pillow: pip install 'shadelab[io]'") from None
    return Image


def _openexr() -> Any:
    try:
        import OpenEXR
    except ImportError:
        raise ImportError("EXR needs OpenEXR: pip install 'shadelab[io]'") from None
    return OpenEXR


def _write_png(path: Path, pixels: NDArray[Any]) -> None:
    pillow = _pillow()
    if pixels.dtype != np.uint8:
        if np.isnan(pixels).any():
            raise ValueError("image: a PNG cannot hold NaN")
        colors, alpha = pixels[..., :3], pixels[..., 3:].clip(0, 1)
        if alpha.size:
            colors = np.divide(colors, alpha, out=np.zeros_like(colors), where=alpha > 0)
        encoded = color.encode_transfer(np.ascontiguousarray(colors.clip(0, 1)), "srgb")
        pixels = np.rint(np.concatenate([encoded, alpha], -1) * 255).astype(np.uint8)
    pillow.fromarray(pixels[..., 0] if pixels.shape[-1] == 1 else np.ascontiguousarray(pixels)).save(path, format="PNG")


def _read_png(path: Path) -> NDArray[np.float32]:
    with _pillow().open(path, formats=["PNG"]) as file:
        # 16-bit grey keeps its bits; palettes and the like become colours.
        deep = file.mode.startswith("I")
        grey = deep or file.mode in ("L", "1")
        mode = "L" if grey else "RGBA" if "A" in file.mode or "transparency" in file.info else "RGB"
        raw = np.asarray(file if deep else file.convert(mode), np.float32) / (65535 if deep else 255)
    if grey:
        return np.asarray(color.decode_transfer(raw, "srgb"), np.float32)
    colors = color.decode_transfer(np.ascontiguousarray(raw[..., :3]), "srgb")
    alpha = raw[..., 3:]
    return np.concatenate([colors * alpha, alpha], -1) if alpha.size else np.asarray(colors, np.float32)


def _write_exr(path: Path, pixels: NDArray[np.float32]) -> None:
    openexr = _openexr()
    if not path.parent.is_dir():
        raise FileNotFoundError(f"{path.parent}: no such directory")
    name = {1: "Y", 3: "RGB", 4: "RGBA"}[pixels.shape[-1]]
    data = np.ascontiguousarray(pixels[..., 0] if name == "Y" else pixels)
    header = {"compression": openexr.ZIP_COMPRESSION, "type": openexr.scanlineimage}
    with openexr.File(header, {name: data}) as file:
        file.write(os.fspath(path))


def _read_exr(path: Path) -> NDArray[np.float32]:
    with _openexr().File(os.fspath(path)) as file:
        channels = {name: np.asarray(channel.pixels, np.float32) for name, channel in file.channels().items()}
    for name in ("RGBA", "RGB"):
        if name in channels:
            return channels[name]
    if {"R", "G", "B"} <= channels.keys():
        return np.stack([channels[c] for c in "RGBA" if c in channels], -1)
    if len(channels) == 1:
        return next(iter(channels.values()))
    raise ValueError(f"expected channels R, G, B or one channel, got {', '.join(sorted(channels))}")


def _write_hdr(file: BinaryIO, pixels: NDArray[Any]) -> None:
    """Radiance's picture format: a common exponent for three mantissas of eight bits, uncompressed.

    G. Ward, *Real pixels*, in Graphics Gems II, 1991.
    """
    values = np.repeat(pixels, 3, -1) if pixels.shape[-1] == 1 else pixels[..., :3]
    if not (np.isfinite(values).all() and (values >= 0).all()):
        raise ValueError("image: HDR holds finite values from zero on")
    largest = values.max(-1).astype(np.float64)
    _, exponent = np.frexp(largest)
    # Rounding may carry the largest mantissa to 256: then the next exponent.
    exponent += np.rint(np.ldexp(largest, 8 - exponent)) > 255
    # Below 2^-127 there is no exponent left: black. The format ends below 2^127.
    if (exponent > 127).any():
        raise ValueError("image: HDR holds values below 1.7e38")
    mantissas = np.rint(np.ldexp(values.astype(np.float64), 8 - exponent[..., None]))
    encoded = np.concatenate([mantissas, exponent[..., None] + 128], -1)
    encoded[(largest == 0) | (exponent < -127)] = 0
    height, width = values.shape[:2]
    file.write(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode())
    file.write(encoded.astype(np.uint8).tobytes())


def _read_hdr(path: Path) -> NDArray[np.float32]:
    data = path.read_bytes()
    head, _, rest = data.partition(b"\n\n")
    if not head.startswith((b"#?RADIANCE", b"#?RGBE")) or b"32-bit_rle_xyze" in head:
        raise ValueError("not a Radiance picture of RGBE values")
    line, _, body = rest.partition(b"\n")
    words = line.split()
    if len(words) != 4 or words[0] != b"-Y" or words[2] != b"+X":
        raise ValueError(f"expected rows from the top and columns from the left, got {line[:40]!r}")
    height, width = int(words[1]), int(words[3])
    if height <= 0 or width <= 0:
        raise ValueError(f"expected a positive size, got {line[:40]!r}")
    rgbe = _hdr_rows(body, height, width)
    scale = np.where(rgbe[..., 3:] > 0, np.ldexp(np.float32(1), rgbe[..., 3:].astype(np.int32) - 136), np.float32(0))
    return np.asarray(rgbe[..., :3] * scale, np.float32)


def _hdr_rows(body: bytes, height: int, width: int) -> NDArray[np.uint8]:
    """Flat pixels, or rows of four run-length encoded components."""
    raw = np.frombuffer(body, np.uint8)
    compressed = 8 <= width < 32768 and raw[:2].tolist() == [2, 2] and raw.size >= 4 and raw[2] < 128
    if not compressed:
        if raw.size < height * width * 4:
            raise ValueError("the picture ends early")
        return raw[: height * width * 4].reshape(height, width, 4)
    rows = np.empty((height, 4, width), np.uint8)
    at = 0
    for row in rows:
        if body[at : at + 4] != bytes([2, 2, width >> 8, width & 255]):
            raise ValueError("a row does not begin where one should")
        at += 4
        for component in row:
            filled = 0
            while filled < width:
                count, at = body[at], at + 1
                run = count > 128
                count -= 128 if run else 0
                if count == 0 or filled + count > width or at >= len(body):
                    raise ValueError("a run does not fit its row")
                component[filled : filled + count] = body[at] if run else raw[at : at + count]
                at += 1 if run else count
                filled += count
    return rows.swapaxes(1, 2)
