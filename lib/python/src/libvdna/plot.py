"""Drawings of rankings, differences and histograms, with matplotlib: pip install 'libvdna[plot]'.

Each function draws into `ax`, or into a new figure, and returns the axes:

    libvdna.plot.ranking(libvdna.rank(live, dna), names).figure.savefig("ranking.png")
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional, Sequence

import numpy as np

from .distance import RankEntry, emd_mean
from .histogram import HistogramView

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["differences", "neuron", "ranking"]


def ranking(
    entries: Sequence[RankEntry], names: Sequence[str], ax: Optional[Axes] = None
) -> Axes:
    """A bar for each candidate, the nearest at the top.

    entries: what rank() returns
    names: of the candidates, in the order in which rank() got them
    """
    ax = _axes(ax)
    labels = [names[entry.candidate] for entry in entries]
    bars = ax.barh(range(len(entries)), [entry.distance_bins for entry in entries])
    ax.bar_label(bars, fmt="%.2f", padding=3)
    ax.set_yticks(range(len(entries)), labels)
    ax.invert_yaxis()
    ax.set_xlabel("distance / bins")
    return ax


def differences(
    histograms: Sequence[HistogramView], names: Sequence[str], ax: Optional[Axes] = None
) -> Axes:
    """The distance of each histogram to each other one, as a matrix.

    VdnaError: MISMATCH if they do not compare, EMPTY or OVERFLOW as emd_mean()
    """
    _check_names(names, len(histograms))
    matrix = np.zeros((len(histograms), len(histograms)))
    for i, one in enumerate(histograms):
        for j, other in enumerate(histograms[:i]):
            matrix[i, j] = matrix[j, i] = emd_mean(one, other)
    ax = _axes(ax)
    image = ax.imshow(matrix)
    ax.figure.colorbar(image, ax=ax, label="distance / bins")
    ax.set_xticks(range(len(names)), names, rotation=90)
    ax.set_yticks(range(len(names)), names)
    return ax


def neuron(
    histograms: Sequence[HistogramView],
    index: int,
    names: Sequence[str],
    ax: Optional[Axes] = None,
) -> Axes:
    """The histogram of one neuron in each of several Visual DNAs, as shares of its samples."""
    _check_names(names, len(histograms))
    for histogram in histograms:
        if not 0 <= index < histogram.neurons:
            raise IndexError(f"neuron {index}, expected 0 to {histogram.neurons - 1}")
    ax = _axes(ax)
    for histogram, name in zip(histograms, names):
        counts = histogram.counts[:, index]
        lo, hi = histogram.range[index].tolist()
        edges = np.linspace(lo, hi, histogram.bins + 1)
        ax.stairs(counts / max(1, int(histogram.mass[index])), edges, label=name)
    ax.set_xlabel(f"activation of neuron {index}")
    ax.set_ylabel("share of samples")
    ax.legend()
    return ax


def _check_names(names: Sequence[str], count: int) -> None:
    if len(names) != count:
        raise ValueError(f"there are {len(names)} names, expected one for each of {count} histograms")


def _axes(ax: Optional[Axes]) -> Axes:
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError:
        raise ImportError(
            "libvdna.plot needs matplotlib, which is not installed: pip install matplotlib"
        ) from None
    return pyplot.subplots(layout="constrained")[1]
