"""The question of pixel filters: its reference is the low-pass that it says, and filters rank as their spectra do."""

import numpy as np
import pytest
from scipy.special import sici
from shadelab import study
from shadelab.pathtrace import PixelFilter
from shadelab.study import Case
from shadelab.study.questions import pixel_filters

FAST = {"size": (96, 96), "rounds": 1, "patience": 0.0, "causes": False}


def test_the_edges_reference_is_the_sine_integral():
    case = Case("leaning edge", "", pixel_filters._SCENES["leaning edge"], "edge", (48, 32), np.dtype(np.float32), 0)
    inputs = pixel_filters._setup(case)
    x = np.linspace(-60, 60, 41)
    assert np.abs(pixel_filters._sine_integral(x) - sici(x)[0]).max() < 1e-12
    assert inputs.ideal.min() < -0.05 and inputs.ideal.max() > 1.05 and inputs.judged.any()


def test_a_filter_leaves_of_a_wave_what_its_spectrum_says():
    """At 0.75 cycles a pixel, the mean over the filter is the filter's Fourier transform there."""
    inputs = pixel_filters._setup(
        Case("zone plate", "", pixel_filters._SCENES["zone plate"], "above", (64, 64), np.dtype(np.float32), 0)
    )
    assert not inputs.judged[32, 32] and inputs.judged[0, 0] and (inputs.ideal[inputs.judged] == 0.5).all()
    u = (np.arange(4096) + 0.5) / 4096
    for f, wanted in ((PixelFilter("box"), np.sinc(0.75)), (PixelFilter("tent"), np.sinc(0.75) ** 2)):
        assert np.cos(2 * np.pi * 0.75 * f.sample(u)).mean() == pytest.approx(wanted, abs=1e-5)


def test_it_runs_whole_and_ranks_as_expected():
    result = study.run("pixel filters", **FAST)
    assert len(result.cases) == 5
    records = [r for r in result.records if r.scene == "zone plate" and r.knobs["samples"] == 64]
    error = {(r.technique, r.knobs["radius"], r.view): r.error.value for r in records}
    held, leaked = "what the grid holds", "what it cannot"
    assert error["gaussian", 2.0, leaked] < error["box", 0.5, leaked]
    assert error["gaussian", 2.0, held] > error["box", 0.5, held]
    with pytest.raises(ValueError, match="or takes a Pattern"):
        study.run("pixel filters", 3, **FAST)
