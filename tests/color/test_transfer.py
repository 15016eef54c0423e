"""Transfer functions: the standard's values, round trips, a peer."""

import colour
import numpy as np
import pytest
import shadelab as sl

DTYPES = [np.float32, np.float64]


@pytest.mark.parametrize("dtype", DTYPES)
def test_agrees_with_colour_science(dtype):
    x = np.linspace(0, 1, 10001).astype(dtype)
    eps = np.finfo(dtype).eps
    # Both round the same constants; the power costs a few ulp, and float32 input is the peer's input as well.
    assert np.abs(sl.color.encode_transfer(x) - colour.models.eotf_inverse_sRGB(x.astype(float))).max() < 4 * eps
    assert np.abs(sl.color.decode_transfer(x) - colour.models.eotf_sRGB(x.astype(float))).max() < 8 * eps


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("kind", ["srgb", "gamma"])
def test_round_trip_returns_the_signal(dtype, kind):
    x = np.linspace(-4, 4, 20001).astype(dtype)
    back = sl.color.encode_transfer(sl.color.decode_transfer(x, kind), kind)
    # 4e-8: where the standard's two pieces meet with a jump, the other piece may answer.
    assert np.abs(back - x).max() < 16 * np.finfo(dtype).eps * 4 + (4e-8 if kind == "srgb" else 0)
    assert back.dtype == dtype


def test_is_odd_monotone_and_keeps_nan_in_its_place():
    x = np.array([-2.0, -0.5, -0.0, 0.0, 0.5, 2.0, np.inf, np.nan])
    y = sl.color.encode_transfer(x)
    assert np.array_equal(y[:2], -y[[5, 4]]) and np.signbit(y[2]) and y[6] == np.inf and np.isnan(y[7])
    ramp = sl.color.encode_transfer(np.linspace(0, 2, 100001))
    assert (np.diff(ramp) > 0).all()


def test_eight_bit_codes_survive_the_round_trip():
    codes = np.arange(256)
    back = sl.color.encode_transfer(sl.color.decode_transfer((codes / 255).astype(np.float32)))
    assert np.array_equal(np.rint(back * 255), codes)


def test_out_and_layouts():
    x = np.random.default_rng(0).random((6, 5, 3))
    out = np.empty((3, 5, 6))
    assert sl.color.encode_transfer(x.T, out=out) is out
    assert np.array_equal(out, sl.color.encode_transfer(np.ascontiguousarray(x.T)))
    assert sl.color.encode_transfer(np.empty((0, 3))).shape == (0, 3)


def test_bad_arguments_are_named():
    with pytest.raises(TypeError, match=r"values: .* divide 8-bit codes by 255"):
        sl.color.decode_transfer(np.zeros((2, 2), np.uint8))
    with pytest.raises(ValueError, match="kind: expected one of"):
        sl.color.encode_transfer([0.5], "rec2020")
    with pytest.raises(ValueError, match="gamma: expected"):
        sl.color.encode_transfer([0.5], "gamma", gamma=0)


@pytest.mark.parametrize("dtype", DTYPES)
def test_white_is_white(dtype):
    one = np.ones(1, dtype)
    assert sl.color.encode_transfer(one) == 1 and sl.color.decode_transfer(one) == 1
