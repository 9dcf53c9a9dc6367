#!/usr/bin/env python3
"""Write reference_golden.h: distances by the reference implementation of Visual DNA, the package
`vdna`, for test_reference.c.

    python3 -m venv VENV
    VENV/bin/pip install vdna==0.1.1 torch==1.12.1 torchvision==0.13.1 'numpy<2'
    VENV/bin/python test/golden/make_reference.py > test/golden/reference_golden.h   (Python 3.10)

The counts are a formula, so that the file need not hold them. The package divides the counts by
their sum, subtracts, and sums up, all in double. Its rounding error grows with the bins (1000
here), ours does not; hence the tolerance of the test, 1e-12 of the distance.
"""
import textwrap

import torch
from vdna import EMD
from vdna.vdnas.vdna_hist import VDNAHist

NEURONS, BINS = 8, 1000


def count(side, neuron, b):
    noise = (b * 2654435761 + neuron * 40503 + side * 97003) % 2**32 >> 16
    centre = 150 + 90 * neuron + 40 * side * (neuron % 4)
    return noise % 50 if abs(b - centre) < 120 + 10 * neuron else int(noise % 97 == 0)


def dna(side):
    vdna = VDNAHist(BINS)
    vdna.feature_extractor_name, vdna.device = "formula", torch.device("cpu")
    vdna.neurons_list = {"layer": NEURONS}
    vdna.data = {"layer": torch.tensor([[count(side, n, b) for b in range(BINS)]
                                        for n in range(NEURONS)], dtype=torch.int32)}
    # The last neuron is the same on both sides.
    vdna.data["layer"][-1] = torch.tensor([count(0, NEURONS - 1, b) for b in range(BINS)])
    return vdna


def main():
    p, q = dna(0), dna(1)
    distances = EMD(p, q, return_neuron_wise=True)["layer"]
    assert distances.dtype == torch.float64
    print("/* Made by make_reference.py; do not edit. */\n/* clang-format off */")
    print(f"#define NEURONS {NEURONS}\n#define BINS {BINS}\n")
    text = textwrap.fill(", ".join(float(d).hex() for d in distances), 96)
    print(f"static const double golden_emd[] = {{\n{text}}};")
    print(f"static const double golden_mean = {float(EMD(p, q)).hex()};")


if __name__ == "__main__":
    main()
