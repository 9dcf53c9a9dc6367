"""What libvdna.plot draws."""

import sys

import numpy as np
import pytest
from conftest import histogram_of

import libvdna
import libvdna.plot

NAMES = ["winter", "summer"]


@pytest.fixture
def pyplot():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    yield pyplot
    pyplot.close("all")


@pytest.fixture
def histograms(unit_range):
    return [histogram_of([[-0.95, -0.95, 0]], unit_range), histogram_of([[0.95, -0.95, 0]], unit_range)]


def test_the_nearest_is_the_topmost_bar(pyplot, histograms):
    ax = libvdna.plot.ranking(libvdna.rank(histograms[1], histograms), NAMES)
    assert [label.get_text() for label in ax.get_yticklabels()] == ["summer", "winter"]
    assert ax.yaxis_inverted()
    np.testing.assert_allclose([bar.get_width() for bar in ax.patches], [0, 3])  # 9 bins, one neuron of 3
    ax.figure.canvas.draw()


def test_the_matrix_has_all_differences(pyplot, histograms):
    ax = libvdna.plot.differences(histograms, NAMES)
    np.testing.assert_allclose(ax.images[0].get_array(), [[0, 3], [3, 0]])
    assert [label.get_text() for label in ax.get_xticklabels()] == NAMES
    ax.figure.canvas.draw()


def test_a_neuron_is_drawn_over_its_range(pyplot, histograms):
    _, given = pyplot.subplots()
    ax = libvdna.plot.neuron(histograms, 0, NAMES, given)
    assert ax is given
    first, second = (patch.get_data() for patch in ax.patches)
    np.testing.assert_allclose(first.edges, np.linspace(-1, 1, 11))
    np.testing.assert_array_equal(first.values, [1, *[0] * 9])
    np.testing.assert_array_equal(second.values, [*[0] * 9, 1])
    assert [text.get_text() for text in ax.get_legend().get_texts()] == NAMES
    with pytest.raises(IndexError, match="neuron 3, expected 0 to 2"):
        libvdna.plot.neuron(histograms, 3, NAMES)


def test_names_are_one_for_each_histogram(pyplot, histograms):
    for draw in (
        lambda: libvdna.plot.differences(histograms, NAMES[:1]),
        lambda: libvdna.plot.neuron(histograms, 0, NAMES[:1]),
    ):
        with pytest.raises(ValueError, match="1 names, expected one for each of 2"):
            draw()


def test_without_matplotlib_it_says_so(monkeypatch, histograms):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match="needs matplotlib, which is not installed: pip install"):
        libvdna.plot.ranking(libvdna.rank(histograms[0], histograms), NAMES)
