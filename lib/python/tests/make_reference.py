"""Makes tests/reference/ with the real package, once, in an environment of its own:

    pip install "numpy<2" torch torchvision huggingface-hub scipy tqdm Pillow opencv-python-headless
    pip install --no-deps vdna==0.1.1
    python3 make_reference.py

It runs the package's own binning and writing on a network that is a table: what it gives for a
picture is written in the picture. No activation lies on an edge of a bin, because the package
counts such a value twice when the batch is small.
"""

import json
import pathlib

import numpy as np
import torch
from vdna import EMD
from vdna.networks.feature_extraction_model import FeatureExtractionModel
from vdna.utils.settings import DataSettings, ExtractionSettings, NetworkSettings
from vdna.vdnas import get_vdna

HERE = pathlib.Path(__file__).parent / "reference"
BINS = 20
LAYERS = {"stem": (3, 4), "block/0": (5, 1)}  # name: neurons, samples
RANGE = {"lo": -2.0, "hi": 3.0}  # activations observed in calibration, before the factor 1.2


def activations(name):
    """[frames][neurons][samples] of each layer."""
    random = np.random.default_rng(list(name.encode()))
    shift = 0.0 if name == "summer" else 0.7
    return {
        layer: random.normal(shift, 1.0, (6, neurons, samples)).astype(np.float32)
        for layer, (neurons, samples) in LAYERS.items()
    }


class Table(FeatureExtractionModel):
    def __init__(self, table):
        neurons = {layer: count for layer, (count, _) in LAYERS.items()}
        ranges = {
            f"{key}_per_neuron": {
                layer: {neuron: RANGE[edge] for neuron in range(count)}
                for layer, count in neurons.items()
            }
            for key, edge in (("mins", "lo"), ("maxs", "hi"))
        }
        super().__init__(
            NetworkSettings(neurons_per_layer=neurons, expected_size=(4, 4), name="table"),
            ExtractionSettings(device="cpu", num_workers=0, batch_size=4, verbose=False),
            ranges,
        )
        self.name = "table"
        self.table = table

    def get_features(self, batch):
        frames = (batch[:, 0, 0, 0] * 255).round().long()
        return {
            layer: torch.from_numpy(values)[frames][..., None]
            for layer, values in self.table.items()
        }


def vdna_of(name, distribution):
    table = activations(name)
    pictures = [np.full((4, 4, 3), frame, np.uint8) for frame in range(6)]
    vdna = get_vdna(distribution)
    vdna.fill_vdna(Table(table), DataSettings(source=pictures))
    vdna.save(HERE / f"{name}-{distribution}")
    return vdna, table


def main():
    HERE.mkdir(exist_ok=True)
    summer, summer_table = vdna_of("summer", f"histogram-{BINS}")
    winter, winter_table = vdna_of("winter", f"histogram-{BINS}")
    vdna_of("summer", "gaussian")
    expected = {
        "range": [RANGE["lo"] * 1.2, RANGE["hi"] * 1.2],
        "emd_mean_bins": float(EMD(summer, winter)),
        "emd_bins": {
            layer: distances.tolist()
            for layer, distances in EMD(summer, winter, return_neuron_wise=True).items()
        },
        "activations": {
            "summer": {layer: values.tolist() for layer, values in summer_table.items()},
            "winter": {layer: values.tolist() for layer, values in winter_table.items()},
        },
    }
    (HERE / "expected.json").write_text(json.dumps(expected))


main()
