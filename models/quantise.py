#!/usr/bin/python3
"""Turn an fp32 network into an int8 one: ONNX file and manifest, for `vdna ... --backbone OUT.toml`.

Convolutional networks become static: the ranges of their activations are taken from pictures, which
`vdna model inputs` prepares as the robot will. Transformers become dynamic and need no pictures:
the range of an activation is found as it is computed.

Rounding the weights of a convolution shifts the mean of its output. Its bias is corrected for that;
for MobileNetV2 this is most of the error of rounding weights.

The first call makes a virtual environment in build/quantise for ONNX Runtime's quantiser; nothing
else of the project uses it.
"""
import argparse
import hashlib
import json
import logging
import os
import re
import subprocess
import sys
import tempfile
import tomllib
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ENVIRONMENT = ROOT / "build" / "quantise"
PACKAGES = ("onnxruntime==1.28.0", "onnx==1.23.2")

# Layers of a convolutional network that become int8. Everything else stays in fp32, above all the
# layers that make the embedding: pooled in int8, its numbers would have only some hundred values.
# Clip and Relu are listed because a convolution must be rounded over the range after its
# activation, not before.
STATIC_LAYERS = ["Conv", "Clip", "Relu", "Add", "MaxPool"]
WEIGHT_MAX = 127


class QuantiseError(Exception):
    """An error with a file, and its remedy."""


def parsed():
    parser = argparse.ArgumentParser(prog="quantise.py", description=__doc__.partition("\n")[0],
                                     epilog="See models/README.md, int8.")
    parser.add_argument("manifest", type=Path, help="NAME.toml of the fp32 network")
    parser.add_argument("--pictures", nargs="+", metavar="SOURCE", default=[],
                        help="folders, videos or LCM logs like those the robot will see; one or "
                        "two hundred pictures suffice. A transformer needs none")
    parser.add_argument("--every", type=int, default=1, metavar="N",
                        help="use every N-th picture only")
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="OUT.toml",
                        help="manifest to write; the network becomes OUT.onnx beside it")
    parser.add_argument("--vdna", type=Path, default=ROOT / "build" / "bin" / "vdna",
                        help="program that prepares the pictures (default: build/bin/vdna)")
    options = parser.parse_args()
    if options.out.suffix != ".toml" or not re.fullmatch(r"[A-Za-z0-9_.-]{1,63}", options.out.stem):
        parser.error(f"--out {options.out}: expected NAME.toml, NAME of letters, digits, _, - and .")
    return options


def enter_environment():
    """Restart in the virtual environment, unless this is it."""
    if Path(sys.prefix) == ENVIRONMENT:
        return
    python, stamp = ENVIRONMENT / "bin" / "python", ENVIRONMENT / "packages"
    if not stamp.exists() or stamp.read_text() != " ".join(PACKAGES):
        print(f"installing {' '.join(PACKAGES)} in {ENVIRONMENT} ...", flush=True)
        venv.create(ENVIRONMENT, clear=True, with_pip=True)
        if subprocess.run([python, "-m", "pip", "install", "--quiet", "--only-binary=:all:",
                           "--disable-pip-version-check", *PACKAGES]).returncode != 0:
            raise QuantiseError(f"pip cannot install {' '.join(PACKAGES)}: check the network, free "
                                "disk space and pip's settings")
        stamp.write_text(" ".join(PACKAGES))
    os.execv(python, [str(python), *sys.argv])


def read_network(path):
    """Return (text of the manifest, the manifest, the network)."""
    import onnx
    text = path.read_text()
    manifest = tomllib.loads(text)
    if manifest.get("precision", "fp32") != "fp32":
        raise QuantiseError(f"{path}: is {manifest['precision']}, expected the fp32 network")
    model = path.parent / manifest["model"]
    data = model.read_bytes()
    found = hashlib.sha256(data).hexdigest()
    if found != manifest["sha256"]:
        raise QuantiseError(f"{model}: its SHA-256 is {found}, the manifest expects "
                            f"{manifest['sha256']}")
    network = onnx.load_from_string(data)
    for node in network.graph.node:
        node.name = node.output[0]  # made unique: ONNX requires no names of nodes
    return text, manifest, network


def is_transformer(model):
    kinds = [node.op_type for node in model.graph.node]
    return kinds.count("MatMul") > kinds.count("Conv")


def prepared(options, folder):
    """Return the network's input for each picture, [pictures][3][height][width]."""
    import numpy as np
    if not options.pictures:
        raise QuantiseError(f"{options.manifest}: a convolutional network; name pictures with "
                            "--pictures")
    file = folder / "inputs.npy"
    if subprocess.run([options.vdna, "model", "inputs", options.manifest, *options.pictures,
                       "--every", str(options.every), "--npy", file]).returncode != 0:
        raise QuantiseError("the pictures could not be prepared")
    return np.load(file, mmap_mode="r")


def mean_inputs(model, inputs):
    """Return the mean of each input channel of a convolution: {weight: [channels]}."""
    import numpy as np
    import onnxruntime
    from onnx import ModelProto, TensorProto, helper
    measured = ModelProto()
    measured.CopyFrom(model)
    del measured.graph.output[:]
    weights = []
    for node in [node for node in model.graph.node if node.op_type == "Conv"]:
        name = f"mean of {node.name}"
        measured.graph.node.append(helper.make_node("GlobalAveragePool", [node.input[0]], [name]))
        measured.graph.output.append(helper.make_tensor_value_info(name, TensorProto.FLOAT, None))
        weights.append(node.input[1])
    session = onnxruntime.InferenceSession(measured.SerializeToString())
    name = model.graph.input[0].name
    sums = sum(np.array([mean.ravel() for mean in session.run(None, {name: picture[None]})], object)
               for picture in inputs)
    return dict(zip(weights, sums / len(inputs)))


def rounded(weight):
    """Return the weights of a convolution as the quantiser rounds them: per channel."""
    import numpy as np
    scale = np.abs(weight).max(axis=(1, 2, 3), keepdims=True) / WEIGHT_MAX
    scale[scale == 0] = 1
    return np.round(weight / scale) * scale


def correct_biases(model, inputs):
    """Subtract from each bias the shift of the mean that rounding the weights will cause."""
    from onnx import numpy_helper
    constants = {constant.name: constant for constant in model.graph.initializer}
    means = mean_inputs(model, inputs)
    for node in model.graph.node:
        if node.op_type != "Conv" or len(node.input) < 3:
            continue
        weight, bias = (numpy_helper.to_array(constants[name]) for name in node.input[1:3])
        mean = means[node.input[1]].astype("f8")
        change = (rounded(weight) - weight).sum(axis=(2, 3))  # [out][in of the group]
        groups = len(mean) // weight.shape[1]
        shift = (change.reshape(groups, -1, weight.shape[1])
                 * mean.reshape(groups, 1, -1)).sum(axis=2).ravel()
        constants[node.input[2]].CopyFrom(
            numpy_helper.from_array((bias - shift).astype(bias.dtype), node.input[2]))


def stem(model):
    """Return the names of the first convolution and its successors: a few percent of the work, on
    pixels that 8 bits with another zero would round a second time."""
    first = next(node for node in model.graph.node if node.op_type == "Conv")
    return [first.name] + [node.name for node in model.graph.node
                           if first.output[0] in node.input and node.op_type in ("Clip", "Relu")]


def quantise_static(model, inputs, out):
    from onnxruntime.quantization import (CalibrationDataReader, CalibrationMethod, QuantFormat,
                                          QuantType, quantize_static)

    class Reader(CalibrationDataReader):
        def __init__(self):
            self.rest = iter(inputs)

        def get_next(self):
            picture = next(self.rest, None)
            return None if picture is None else {model.graph.input[0].name: picture[None]}

    correct_biases(model, inputs)
    quantize_static(model, out, Reader(), quant_format=QuantFormat.QDQ, per_channel=True,
                    activation_type=QuantType.QUInt8, weight_type=QuantType.QInt8,
                    op_types_to_quantize=STATIC_LAYERS, nodes_to_exclude=stem(model),
                    calibrate_method=CalibrationMethod.MinMax,
                    # One odd picture must not coarsen the steps of all others.
                    extra_options={"CalibMovingAverage": True})
    return f"static, calibrated with {len(inputs)} pictures, biases corrected"


def quantise_dynamic(model, out):
    from onnxruntime.quantization import QuantType, quantize_dynamic
    quantize_dynamic(model, out, op_types_to_quantize=["MatMul"], per_channel=True,
                     weight_type=QuantType.QInt8)
    return "dynamic"


def manifest_text(text, name, data, original, method):
    """Return the manifest of the original with its changes."""
    head, bracket, rest = text.partition("\n[")
    for key, value in (("name", name), ("model", f"{name}.onnx"),
                       ("sha256", hashlib.sha256(data).hexdigest())):
        head, count = re.subn(rf"^{key} *=.*$", f"{key} = {json.dumps(value)}", head, flags=re.M)
        if count != 1:
            raise QuantiseError(f"the manifest has '{key}' {count} times before its first section, "
                                "expected it once")
    # The numbers of the original are others; `vdna model golden` needs a processor that runs int8.
    rest = re.sub(r"\n\[golden\].*?(?=\n\[|\Z)", "", rest, flags=re.S)
    comment = re.compile(r"\A(#.*\n)*")
    head = comment.sub(f"# Made by models/quantise.py from {original['name']}.\n", head)
    return (f'{head.rstrip()}\nprecision = "int8"\n\n[quantised]\n'
            f'from_sha256 = "{original["sha256"]}"\nmethod = {json.dumps(method)}\n{bracket}{rest}')


def quantise(options):
    import onnxruntime
    logging.disable(logging.WARNING)  # the quantiser's advice to fuse what we export fused
    text, manifest, model = read_network(options.manifest)
    with tempfile.TemporaryDirectory(prefix="vdna-quantise-") as folder:
        out = Path(folder, "int8.onnx")
        method = (quantise_dynamic(model, out) if is_transformer(model) else
                  quantise_static(model, prepared(options, Path(folder)), out))
        data = out.read_bytes()
    method += f", onnxruntime {onnxruntime.__version__}"
    options.out.parent.mkdir(parents=True, exist_ok=True)
    network = options.out.with_suffix(".onnx")
    network.write_bytes(data)
    options.out.write_text(manifest_text(text, options.out.stem, data, manifest, method))
    print(f"{network}: {len(data) / 1e6:.1f} MB, {method}\n"
          f"{options.out}: compare it with `vdna model check {options.manifest} {options.out} "
          "DATASET`")


def main():
    options = parsed()
    try:
        enter_environment()
        quantise(options)
    except QuantiseError as error:
        sys.exit(f"models/quantise.py: {error}")
    except OSError as error:
        sys.exit(f"models/quantise.py: {error.filename}: {error.strerror}")


if __name__ == "__main__":
    main()
