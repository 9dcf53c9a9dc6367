"""The networks, weights and pictures of the exporters' golden test, for test_export.py, which runs
our ONNX files, and for make_export.py, which runs PyTorch.

Weights and pictures are made from bits of the Mersenne Twister with operations that IEEE 754 rounds
alike everywhere, so they need not be committed: the legacy generator of NumPy is frozen.
"""
import math
import zlib

import numpy as np

CASES = {  # name -> height and width
    "cosplace_resnet101_128": (224, 224),
    "mugs_vitb16": (224, 224),
    "tiny_cosplace": (64, 96),
    "tiny_mugs": (32, 32),
}
PICTURES = 2
SAMPLES = 16  # of a tap that is not the embedding


def uniform(text, shape, low, high):
    generator = np.random.RandomState(zlib.crc32(text.encode()))
    return (low + (high - low) * generator.random_sample(shape)).astype(np.float32)


def tensor(name, shape):
    """Return random weights for the tensor of this name, such that activations neither vanish nor
    explode, and no value is a default, like 0 or 1, that an exporter could forget to read."""
    last = name.rpartition(".")[2]
    if last == "num_batches_tracked":
        return np.full(shape, 7, np.int64)
    if last == "p":
        return np.full(shape, 2.7, np.float32)
    if last == "running_var" or (last == "weight" and len(shape) == 1):
        return uniform(name, shape, 0.7, 1.4)
    if last == "weight":
        bound = math.sqrt(3 / math.prod(shape[1:]))  # deviation 1 / sqrt(inputs)
        return uniform(name, shape, -bound, bound)
    return uniform(name, shape, -0.3, 0.3)


def picture(number, height, width):
    """Return RGB bytes: patches of 16x16 pixels with some noise on them."""
    patches = uniform(f"patches {number}", (height // 16, width // 16, 3), 30, 226)
    noise = uniform(f"noise {number}", (height, width, 3), -30, 30)
    return np.rint(patches.repeat(16, 0).repeat(16, 1) + noise).astype(np.uint8)


def sampled(values):
    """Return some values, evenly spread over a tap of one picture but in no row or column alone."""
    flat = np.asarray(values).ravel()
    return flat[np.arange(SAMPLES) * 7919 * 101 % flat.size]
