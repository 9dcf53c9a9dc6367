"""Visual DNAs of the reference implementation, the Python package `vdna`: read and written without
loss.

The package keeps a VDNA in two files, NAME.json with what is known of it and NAME.npz with its
numbers. Those of its distribution "histogram" can be converted; Gaussians hold no counts, and
activation ranges no histogram.

The files do not say where a neuron's bins begin and end: the package normalises activations with
ranges that it keeps with its networks, then bins them over -1..1. So a VDNA that is read has that
range for each neuron, unless the caller knows better. One that is written keeps its ranges under a
key of ours in the JSON, which the package ignores.
"""

from __future__ import annotations

import json
import os
import pathlib
import zipfile
import zlib
from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import shaped
from ._library import VdnaError, version
from .experience import Experience
from .histogram import HistogramView
from .identity import parse_taps

_RANGE_KEY = "libvdna_range"
_INT32_MAX = 2**31 - 1

# What parsing a damaged file may raise.
_DAMAGED = (
    ValueError,
    TypeError,
    KeyError,
    EOFError,
    VdnaError,
    zipfile.BadZipFile,
    zlib.error,
)

# How the package makes its histograms.
_EXTRACTION_SETTINGS = {
    "accumulate_spatial_feats_in_hist": True,
    "accumulate_sample_feats_in_hist": True,
    "normalise_feats": True,
    "hist_range": [-1.0, 1.0],
}


@dataclass(frozen=True)
class ReferenceVdna:
    """A histogram VDNA as the reference package loads and saves it.

    To write a Histogram:

        ReferenceVdna({"block_11": 768}, histogram, histogram.frames, "net").save(path)
    """

    layers: Dict[str, int]
    """Name and number of neurons of each layer, in the order of the histogram's neurons."""
    histogram: HistogramView
    num_images: int
    feature_extractor_name: str
    """The package compares only VDNAs of the same one."""
    metadata: Dict[str, Any] = field(default_factory=dict)
    """All of the .json that was read; what save() does not know better is written back."""

    @classmethod
    def load(
        cls, path: Union[str, "os.PathLike[str]"], range: Optional[ArrayLike] = None
    ) -> ReferenceVdna:
        """Read NAME.json and NAME.npz.

        path: either of them, or NAME without an ending
        range: float32 [neurons][2], where the bins of each neuron begin and end; without it, that
               of the file if we wrote it, else the package's normalised -1..1
        ValueError: the file, and what in it cannot be converted without loss
        OSError: a file cannot be read
        """
        json_path = pathlib.Path(path).with_suffix(".json")
        try:
            metadata = json.loads(json_path.read_text(encoding="utf-8"))
            _check_metadata(metadata)
            counts = _read_counts(json_path.with_suffix(".npz"), metadata)
            layers = {layer: len(rows) for layer, rows in counts.items()}
            if range is None:
                range = metadata.get(_RANGE_KEY) or _hist_range(metadata, layers)
            return cls(
                layers=layers,
                histogram=HistogramView(range, np.concatenate(list(counts.values())).T),
                num_images=metadata["num_images"],
                feature_extractor_name=metadata["feature_extractor_name"],
                metadata=metadata,
            )
        except _DAMAGED as error:
            reason = f"there is no {error}" if isinstance(error, KeyError) else str(error)
            raise ValueError(f"{json_path}: not a VDNA that can be converted: {reason}") from error

    @classmethod
    def from_experience(cls, experience: Experience) -> ReferenceVdna:
        """The Visual DNA of an experience; its taps become layers, its backbone the extractor."""
        return cls(
            layers={tap.name: tap.neurons for tap in parse_taps(experience.taps)},
            histogram=experience.histogram,
            num_images=experience.frames,
            feature_extractor_name=experience.backbone,
        )

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Write NAME.json and NAME.npz, which the package's load_vdna_from_files() reads.

        path: either of them, or NAME without an ending
        ValueError: the package cannot hold it: its counts are int32, and the layers must have all
                    the neurons
        OSError: a file cannot be written
        """
        counts = self.histogram.counts
        if sum(self.layers.values()) != self.histogram.neurons:
            raise ValueError(
                f"the layers have {sum(self.layers.values())} neurons, the histogram"
                f" {self.histogram.neurons}"
            )
        if counts.max() > _INT32_MAX:
            raise ValueError(f"a count is {counts.max()}, the reference package holds int32")

        json_path = pathlib.Path(path).with_suffix(".json")
        splits = np.cumsum(list(self.layers.values()))[:-1]
        with zipfile.ZipFile(json_path.with_suffix(".npz"), "w", zipfile.ZIP_DEFLATED) as archive:
            for layer, rows in zip(self.layers, np.split(counts.T, splits)):
                with archive.open(layer + ".npy", "w", force_zip64=True) as file:
                    np.lib.format.write_array(file, np.ascontiguousarray(rows, np.int32))
        json_path.write_text(json.dumps(self._new_metadata(), indent=4), encoding="utf-8")

    def _new_metadata(self) -> Dict[str, Any]:
        bins = self.histogram.bins
        metadata = {
            **self.metadata,
            "distribution": {"hist_nb_bins": bins},
            "type": "histogram",
            "name": f"histogram-{bins}",
            "num_images": self.num_images,
            "feature_extractor_name": self.feature_extractor_name,
            "neurons_list": self.layers,
        }
        # What the package expects besides.
        metadata.setdefault("vdna_version", f"libvdna {version()}")
        metadata.setdefault("data_settings", {"source": "unknown"})
        metadata.setdefault("extraction_settings", {**_EXTRACTION_SETTINGS, "hist_nb_bins": bins})
        if np.array_equal(self.histogram.range, _hist_range(metadata, self.layers)):
            metadata.pop(_RANGE_KEY, None)
        else:
            metadata[_RANGE_KEY] = self.histogram.range.tolist()
        return metadata


def _hist_range(metadata: Dict[str, Any], layers: Dict[str, int]) -> List[Any]:
    return [metadata["extraction_settings"]["hist_range"]] * sum(layers.values())


def _check_metadata(metadata: Dict[str, Any]) -> None:
    if metadata["type"] != "histogram":
        raise ValueError(f"its type is {metadata['type']!r}, only a 'histogram' has counts")
    if not isinstance(metadata["num_images"], int):
        raise ValueError(f"num_images is {metadata['num_images']!r}, expected an integer")


def _read_counts(
    path: pathlib.Path, metadata: Dict[str, Any]
) -> Dict[str, NDArray[np.integer[Any]]]:
    """The counts of each layer, [neurons][bins], in the order of the file."""
    counts = {}
    with zipfile.ZipFile(path) as archive:
        for name in archive.namelist():
            with archive.open(name) as file:
                array = np.lib.format.read_array(file, allow_pickle=False)
            counts[name[: -len(".npy")]] = array
    expected: Dict[str, int] = metadata["neurons_list"]
    if set(counts) != set(expected):
        raise ValueError(f"the .npz has the layers {sorted(counts)}, expected {sorted(expected)}")
    for layer, array in counts.items():
        shaped(array, (expected[layer], metadata["distribution"]["hist_nb_bins"]), layer)
    return counts
