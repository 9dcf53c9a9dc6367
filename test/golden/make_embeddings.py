#!/usr/bin/env python3
"""Compute the expected embeddings of the golden test without any of the project's code.

    python3 -m venv /tmp/golden && /tmp/golden/bin/pip install onnxruntime==1.28.0 numpy pillow
    /tmp/golden/bin/python make_embeddings.py MODELS     (writes NAME.npy and NAME_grid.npy here)

MODELS is the folder with the ONNX files. Pillow decodes, numpy resizes and normalises, the Python
package of ONNX Runtime runs the network, numpy takes the means of the grid. The numbers of the preprocessing are repeated here from
the publications of the networks: read from the manifests they would prove nothing.

Committed files: Python 3.11, onnxruntime 1.28.0, numpy 2.4.6, Pillow 13.0.0, on x86-64.
Tolerance of the test: 1e-3. Runtimes and processors differ by about 1e-5. Of the mistakes that the
test must catch, linear in place of area interpolation moves an embedding by 0.19, swapped channels
by 1.1, a missing mean by 1.6. Of the grid, cells of the wrong edge or order differ by more than 0.5.
"""
import pathlib
import sys

import numpy as np
import onnxruntime
from PIL import Image

HERE = pathlib.Path(__file__).parent
SIDE = 224
NETWORKS = {  # mean, std; RGB in 0..1
    "efficientnet_lite0": ([127 / 255] * 3, [128 / 255] * 3),
    "mobilenet_v2": ([0.485, 0.456, 0.406], [0.229, 0.224, 0.225]),
}


def shares(source, target):
    """[target][source]: the share of each source pixel in each target pixel, by overlap."""
    edges = np.arange(target + 1) * source / target
    low, high = edges[:-1, None], edges[1:, None]
    pixel = np.arange(source)[None, :]
    overlap = np.clip(np.minimum(high, pixel + 1) - np.maximum(low, pixel), 0, None)
    return overlap / overlap.sum(axis=1, keepdims=True)


def prepared(file, mean, std):
    rgb = np.asarray(Image.open(file).convert("RGB"), dtype=np.float64)
    height, width, _ = rgb.shape
    resized = np.einsum("yj,xi,jic->yxc", shares(height, SIDE), shares(width, SIDE), rgb, optimize=True)
    levels = np.rint(resized).astype(np.uint8)
    normalised = (levels / 255.0 - np.array(mean)) / np.array(std)
    return normalised.astype(np.float32).transpose(2, 0, 1)[None]


def grid_means(feature_map, cells=3):
    """[channels][rows][columns] in one row: each pixel belongs to the cell in which its centre lies,
    which is on no edge for 14 pixels in 3 cells."""
    channels, height, width = feature_map.shape
    rows, columns = ((2 * np.arange(side) + 1) * cells // (2 * side) for side in (height, width))
    means = [[feature_map[:, np.ix_(rows == i, columns == j)[0], np.ix_(rows == i, columns == j)[1]]
              .astype(np.float64).reshape(channels, -1).mean(axis=1) for j in range(cells)]
             for i in range(cells)]
    return np.array(means).transpose(2, 0, 1).reshape(-1).astype(np.float32)


if __name__ == "__main__":
    models = pathlib.Path(sys.argv[1])
    for name, (mean, std) in NETWORKS.items():
        session = onnxruntime.InferenceSession(str(models / f"{name}.onnx"), providers=["CPUExecutionProvider"])
        outputs = [session.run(["embedding", "feat_s16"], {"image": prepared(file, mean, std)})
                   for file in sorted(HERE.glob("picture?.png"))]
        np.save(HERE / f"{name}.npy", np.stack([embedding[0] for embedding, _ in outputs]))
        np.save(HERE / f"{name}_grid.npy", np.stack([grid_means(middle[0]) for _, middle in outputs]))
