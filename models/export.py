#!/usr/bin/python3
"""Turn a PyTorch checkpoint of one of the paper's networks into ONNX and a manifest for vdna.

Needs numpy and onnx, not PyTorch, and runs no code from the checkpoint.
"""
import argparse
import hashlib
import re
import sys
from pathlib import Path

import cosplace
import vit
from manifest import manifest
from torch_file import CheckpointError, read_checkpoint
from weights import Weights

NETWORKS = {"cosplace": cosplace, "vit": vit}


def size(text):
    found = re.fullmatch(r"([1-9]\d{0,3})x([1-9]\d{0,3})", text)
    if not found:
        raise argparse.ArgumentTypeError(f"'{text}' is not HEIGHTxWIDTH in pixels, like 480x640")
    return int(found[1]), int(found[2])


def plain_name(text):
    if not re.fullmatch(r"[A-Za-z0-9_.-]{1,63}", text):
        raise argparse.ArgumentTypeError(f"'{text}' is not 1 to 63 letters, digits, _, - and .")
    return text


def parsed(arguments):
    parser = argparse.ArgumentParser(prog="export.py", description=__doc__.partition("\n")[0],
                                     epilog="See models/README.md, The paper's networks.")
    parser.add_argument("network", choices=NETWORKS, help="cosplace: a ResNet with CosPlace's "
                        "aggregation; vit: a vision transformer of DINO's family, such as Mugs")
    parser.add_argument("checkpoint", type=Path, help="PyTorch file with a state dict")
    parser.add_argument("folder", type=Path, help="folder for NAME.onnx and NAME.toml")
    parser.add_argument("--name", type=plain_name, help="default: from kind, depth and width")
    parser.add_argument("--size", type=size, metavar="HEIGHTxWIDTH",
                        help="of the pictures; default: 224x224, or for vit the size of its "
                        "positions")
    parser.add_argument("--taps", choices=("last", "all"), default="last",
                        help="outputs besides the embedding: last (default) gives vit's tokens or "
                        "cosplace's layer1 to layer4; all gives every block as well")
    parser.add_argument("--source", help="for the manifest; default: file and SHA-256")
    parser.add_argument("--licence", default="unknown", help="for the manifest; default: unknown")
    return parser.parse_args(arguments)


def build(options, checkpoint):
    """Return (the network as a Graph, {part of the checkpoint that is not used: tensors in it})."""
    kind = NETWORKS[options.network]
    weights = Weights(checkpoint, kind.LANDMARK, kind.KIND)
    network = kind.build(weights, options.size, options.taps == "all")
    return network, {weights.prefix + part: count
                     for part, count in weights.left(kind.WHOLE).items()}


def write(network, options, source):
    """Write the network and its manifest, and say so."""
    name = options.name or network.name
    tap = NETWORKS[options.network].DEFAULT_TAP
    data = network.serialised()
    options.folder.mkdir(parents=True, exist_ok=True)
    model, text = (options.folder / f"{name}{suffix}" for suffix in (".onnx", ".toml"))
    model.write_bytes(data)
    text.write_text(manifest(network, tap, name=name, model=model.name, source=source,
                             licence=options.licence, sha256=hashlib.sha256(data).hexdigest()))
    print(f"{model}: {len(data) / 1e6:.1f} MB, outputs {', '.join(network.outputs)}\n"
          f"{text}: tap {tap}")


def main(arguments=None):
    options = parsed(arguments)
    try:
        with options.checkpoint.open("rb") as file:
            digest = hashlib.file_digest(file, "sha256").hexdigest()
            file.seek(0)
            network, left = build(options, read_checkpoint(file))
        write(network, options, options.source or f"{options.checkpoint.name}, SHA-256 {digest}")
    except CheckpointError as error:
        sys.exit(f"models/export.py: {options.checkpoint}: {error}")
    except OSError as error:
        sys.exit(f"models/export.py: {error.filename}: {error.strerror}")
    for part, count in left.items():
        print(f"not used: {part} ({count} tensors)")


if __name__ == "__main__":
    main()
