"""Pictures to files and back: exact where the format is, within its step where it is not; broken files in one line."""

import numpy as np
import pytest
from shadelab.color import encode_transfer
from shadelab.scene import load_image, save_image


def picture(shape, seed=1):
    return np.random.default_rng(seed).uniform(0, 1, shape).astype(np.float32)


@pytest.mark.parametrize("shape", [(5, 7), (5, 7, 3), (5, 7, 4), (1, 1, 3)])
def test_exr_is_exact(shape, tmp_path):
    values = picture(shape) * 1000 - 100
    values.flat[0] = np.inf
    save_image(tmp_path / "a.exr", values)
    got = load_image(tmp_path / "a.exr")
    assert got.shape == shape and got.dtype == np.float32 and np.array_equal(got, values)


@pytest.mark.parametrize("shape", [(5, 7), (5, 7, 3)])
def test_png_is_within_half_a_code_of_srgb(shape, tmp_path):
    values = picture(shape)
    save_image(tmp_path / "a.png", values)
    got = load_image(tmp_path / "a.png")
    assert got.shape == shape
    assert np.abs(encode_transfer(got) - encode_transfer(values)).max() <= 0.5 / 255 + 1e-6
    # What an 8-bit picture holds comes back unchanged.
    save_image(tmp_path / "b.png", got)
    assert np.array_equal(load_image(tmp_path / "b.png"), got)


def test_png_holds_straight_alpha_and_clips(tmp_path):
    from PIL import Image

    values = np.array([[[0.5, 0.25, 0.0, 0.5], [0, 0, 0, 0], [2.0, -1.0, 0.0, 1.0]]], np.float32)
    save_image(tmp_path / "a.png", values)
    codes = np.asarray(Image.open(tmp_path / "a.png"))
    assert codes.tolist() == [[[255, 188, 0, 128], [0, 0, 0, 0], [255, 0, 0, 255]]]
    got = load_image(tmp_path / "a.png")
    assert np.abs(got[0, 0] - values[0, 0]).max() < 0.005 and np.array_equal(got[0, 1], [0, 0, 0, 0])


def test_encoded_pictures_go_to_png_as_they_are(tmp_path):
    from PIL import Image

    codes = np.random.default_rng(2).integers(0, 256, (4, 6, 3), np.uint8)
    save_image(tmp_path / "a.png", codes)
    assert np.array_equal(np.asarray(Image.open(tmp_path / "a.png")), codes)


def test_hdr_keeps_eight_bits_of_the_largest_channel_and_other_readers_agree(tmp_path):
    cv2 = pytest.importorskip("cv2")
    values = picture((40, 50, 3)) * 10.0 ** np.random.default_rng(3).uniform(-30, 30, (40, 50, 1)).astype(np.float32)
    values[0, 0] = 0
    values[0, 1] = [0.9999, 0.5, 0.0]  # rounds up to the next exponent
    path = tmp_path / "a.hdr"
    save_image(path, values)
    got = load_image(path)
    assert (np.abs(got - values) <= values.max(-1, keepdims=True) / 256).all()
    assert np.array_equal(cv2.imread(str(path), cv2.IMREAD_UNCHANGED)[..., ::-1], got)
    # And back: theirs is run-length encoded.
    blocks = np.repeat(np.repeat(picture((4, 5, 3)), 10, 0), 10, 1)
    cv2.imwrite(str(path), np.ascontiguousarray(blocks))
    assert np.array_equal(load_image(path), cv2.imread(str(path), cv2.IMREAD_UNCHANGED)[..., ::-1])


@pytest.mark.parametrize(
    ("name", "values", "error", "match"),
    [
        ("a.jpg", np.zeros((2, 2, 3)), ValueError, "unknown format '.jpg'"),
        ("a.png", np.full((2, 2), np.nan), ValueError, "cannot hold NaN"),
        ("a.png", np.zeros((2, 2, 2)), ValueError, "1, 3 or 4 channels"),
        ("a.png", np.zeros((0, 2, 3)), ValueError, "at least one pixel"),
        ("a.hdr", np.full((2, 2, 3), -1.0), ValueError, "finite values from zero"),
        ("a.exr", np.zeros((2, 2, 3), int), TypeError, "image"),
    ],
)
def test_what_a_file_cannot_hold_is_refused(name, values, error, match, tmp_path):
    with pytest.raises(error, match=match):
        save_image(tmp_path / name, values)


@pytest.mark.parametrize("suffix", ["png", "exr", "hdr"])
def test_a_missing_or_broken_file_gives_one_clear_line(suffix, tmp_path):
    path = tmp_path / f"a.{suffix}"
    with pytest.raises(FileNotFoundError, match="no such file"):
        load_image(path)
    path.write_bytes(b"noise")
    with pytest.raises(ValueError, match=f"a.{suffix}: cannot be read as {suffix.upper()}") as caught:
        load_image(path)
    assert "\n" not in str(caught.value)
    save_image(path, picture((30, 30, 3)))
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(ValueError, match="cannot be read"):
        load_image(path)


def test_pictures_that_are_ragged_or_nowhere_are_named(tmp_path):
    with pytest.raises(ValueError, match="image: "):
        save_image(tmp_path / "a.png", [[0.0], [0.0, 1.0]])
    with pytest.raises(TypeError, match="path: expected a path"):
        save_image(None, np.zeros((2, 2, 3)))
