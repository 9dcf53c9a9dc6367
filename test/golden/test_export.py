"""Tests of models/export.py: its ONNX files against PyTorch, and its refusals.

export.json and tiny_*.pth are by PyTorch (make_export.py). The networks of full size get their
weights from a generator, because a repository is no place for a checkpoint of 350 MB.
"""
import contextlib
import io
import json
import os
import pickle
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import numpy as np
    import onnx.checker
except ImportError as missing:
    print(f"skipped: {missing}; install python3-numpy and python3-onnx")
    sys.exit(77)

HERE = Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(HERE.parents[1] / "models"))
import export  # noqa: E402
from export_cases import CASES, PICTURES, picture, sampled, tensor  # noqa: E402
from torch_file import MAGIC, PROTOCOL, CheckpointError, Tensor, read_checkpoint  # noqa: E402

EXPORT_CHECK = os.environ["VDNA_EXPORT_CHECK"]
GOLDEN = json.loads((HERE / "export.json").read_text())
TOLERANCE = 1e-4  # of the largest value of an output
BINS, LOW, HIGH = 50, -1.0, 2.0  # some activations lie beyond, some on edges


class Generated(Tensor):
    """A tensor whose elements are made on demand."""

    def __init__(self, name, shape):
        self.name, self.shape = name, shape

    def array(self):
        return tensor(self.name, self.shape)


def generated_checkpoint(case):
    return {name: Generated(name, tuple(map(int, shape.split())))
            for name, shape in GOLDEN[case]["tensors"].items()}


def quietly(function, *arguments):
    """Return the function's output."""
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        function(*arguments)
    return printed.getvalue()


def export_generated(kind, case, folder):
    options = export.parsed([kind, "generated", str(folder), "--name", case, "--taps", "all"])
    network, _ = export.build(options, generated_checkpoint(case))
    quietly(export.write, network, options, "generated")


def export_file(kind, case, folder, *more):
    quietly(export.main, [kind, str(HERE / f"{case}.pth"), str(folder), "--name", case,
                          "--taps", "all", *more])


class Outputs:
    """A network's outputs for the pictures of its case, by export_check."""

    def __init__(self, manifest, case, folder):
        pictures = []
        for number in range(PICTURES):
            pictures.append(folder / f"{number}.rgb")
            pictures[-1].write_bytes(picture(number, *CASES[case]).tobytes())
        command = [EXPORT_CHECK, manifest, str(BINS), str(LOW), str(HIGH), *pictures]
        head, _, rest = subprocess.run(command, check=True, capture_output=True).stdout.partition(
            b"\n")
        dimensions, taps = head.decode().split(" ")
        self.taps = [(name, int(neurons), int(samples)) for name, neurons, samples in
                     (tap.split(":") for tap in taps.split(","))]
        self.neurons = sum(neurons for _, neurons, _ in self.taps)
        sizes = [int(dimensions)] + [neurons * samples for _, neurons, samples in self.taps]
        floats = np.frombuffer(rest, np.float32, PICTURES * sum(sizes))
        self.embeddings, *self.values = np.split(
            floats.reshape(PICTURES, -1), np.cumsum(sizes)[:-1], axis=1)
        self.counts = np.frombuffer(rest, np.uint32, offset=floats.nbytes).reshape(
            BINS, self.neurons)


def with_all_taps(text):
    head, taps = re.split(r"^(?=#?\[\[taps\]\]$)", text, maxsplit=1, flags=re.M)
    return head + re.sub(r"^#", "", taps, flags=re.M)


def recounted(outputs, is_map):
    """Return the histogram of all taps by NumPy: [bins][neurons]."""
    columns = []
    for (name, neurons, samples), values in zip(outputs.taps, outputs.values):
        by_neuron = (values.reshape(PICTURES, neurons, samples).transpose(1, 0, 2) if is_map(name)
                     else values.reshape(PICTURES * samples, neurons).T)
        clipped = np.clip(by_neuron.reshape(neurons, -1).astype(np.float64), LOW, HIGH)
        place = (clipped - (LOW + HIGH) / 2) / ((HIGH - LOW) / 2)
        bins = np.minimum(BINS - 1, np.floor((place + 1) * BINS / 2)).astype(int)
        flat = np.bincount((np.arange(neurons)[:, None] * BINS + bins).ravel(),
                           minlength=neurons * BINS)
        columns.append(flat.reshape(neurons, BINS).T)
    return np.hstack(columns)


class AgainstPyTorch(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="vdna-export-")
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)

    def close(self, found, expected, what):
        expected = np.array(expected.split(), np.float64)
        scale = np.abs(expected).max()
        self.assertLess(np.abs(found - expected).max(), TOLERANCE * scale, what)

    def compare(self, case):
        """Compare all outputs, tapped at once, and the histograms of all taps."""
        golden = GOLDEN[case]["outputs"]
        text = (self.folder / f"{case}.toml").read_text()
        manifest = self.folder / "all.toml"
        manifest.write_text(with_all_taps(text))
        outputs = Outputs(manifest, case, self.folder)
        self.assertEqual({name for name, _, _ in outputs.taps}, set(golden))
        for number in range(PICTURES):
            self.close(outputs.embeddings[number], golden["embedding"][number], "embedding")
            for (name, _, _), values in zip(outputs.taps, outputs.values):
                found = values[number]
                self.close(found if name == "embedding" else sampled(found),
                           golden[name][number], f"{name} of picture {number}")
        np.testing.assert_array_equal(
            outputs.counts, recounted(outputs, lambda name: name.startswith("layer")))

    def test_cosplace_resnet101_equals_pytorch_at_every_block(self):
        export_generated("cosplace", "cosplace_resnet101_128", self.folder)
        self.compare("cosplace_resnet101_128")

    def test_mugs_vitb16_equals_pytorch_at_every_block(self):
        export_generated("vit", "mugs_vitb16", self.folder)
        self.compare("mugs_vitb16")

    def test_another_resnet_at_another_size_needs_no_code(self):
        export_file("cosplace", "tiny_cosplace", self.folder, "--size", "64x96")
        self.compare("tiny_cosplace")

    def test_the_teacher_is_taken_from_a_training_checkpoint(self):
        export_file("vit", "tiny_mugs", self.folder)
        self.compare("tiny_mugs")

    def test_manifests_tap_the_last_layer_unless_edited(self):
        for kind, case, size, tap in (("cosplace", "tiny_cosplace", ["--size", "64x96"],
                                       ("embedding", 5, 1)),
                                      ("vit", "tiny_mugs", [], ("tokens", 64, 17))):
            export_file(kind, case, self.folder, *size)
            outputs = Outputs(self.folder / f"{case}.toml", case, self.folder)
            self.assertEqual(outputs.taps, [tap])

    def test_the_same_checkpoint_gives_the_same_bytes_which_pass_the_checker_of_onnx(self):
        for kind, case in (("cosplace", "tiny_cosplace"), ("vit", "tiny_mugs")):
            export_file(kind, case, self.folder)
            model = self.folder / f"{case}.onnx"
            first = model.read_bytes()
            onnx.checker.check_model(onnx.load(model), full_check=True)
            export_file(kind, case, self.folder)
            self.assertEqual(model.read_bytes(), first)


class Refusals(unittest.TestCase):
    def refused(self, kind, checkpoint, sentence, *more):
        options = export.parsed([kind, "generated", "nowhere", *more])
        with self.assertRaisesRegex(CheckpointError, f"^{re.escape(sentence)}$"):
            export.build(options, checkpoint)

    def test_a_checkpoint_of_another_network(self):
        self.refused("vit", generated_checkpoint("tiny_cosplace"),
                     "is no ViT checkpoint: found backbone.0.weight, backbone.1.weight, "
                     "backbone.1.bias, ..., expected a tensor 'cls_token' among them")
        self.refused("cosplace", generated_checkpoint("tiny_mugs"),
                     "is no CosPlace ResNet checkpoint: found cls_token, pos_embed, "
                     "patch_embed.proj.weight, ..., expected a tensor 'aggregation.1.p' among them")

    def test_a_checkpoint_without_tensors(self):
        self.refused("vit", {"model": object()},
                     "holds no tensors; expected a state dict: torch.save(model.state_dict(), "
                     "...), not torch.save(model, ...)")

    def test_two_networks_of_which_none_is_the_teacher(self):
        tiny = generated_checkpoint("tiny_mugs")
        self.refused("vit", {"a": tiny, "b": tiny}, "holds several networks of kind ViT, found "
                     "under a., b.; save the one you want alone")

    def test_a_missing_tensor(self):
        checkpoint = generated_checkpoint("tiny_mugs")
        del checkpoint["blocks.1.mlp.fc2.bias"]
        self.refused("vit", checkpoint, "'blocks.1.mlp.fc2.bias' is missing; expected a tensor 64")

    def test_a_tensor_of_another_shape(self):
        checkpoint = generated_checkpoint("tiny_cosplace")
        checkpoint["backbone.5.1.bn2.running_var"] = Generated("running_var", (7,))
        self.refused("cosplace", {"module": checkpoint},
                     "'module.backbone.5.1.bn2.running_var' is 7, expected 6")

    def test_layers_that_we_do_not_compute(self):
        checkpoint = generated_checkpoint("tiny_mugs")
        checkpoint["blocks.0.ls1.gamma"] = Generated("gamma", (64,))
        self.refused("vit", checkpoint, "'blocks.0.ls1.gamma' is unknown; expected a network "
                     "without such layers")

    def test_attention_heads_of_another_width(self):
        checkpoint = generated_checkpoint("tiny_mugs")
        checkpoint["patch_embed.proj.weight"] = Generated("proj.weight", (1280, 3, 14, 14))
        self.refused("vit", checkpoint, "'patch_embed.proj.weight' makes 1280 numbers of 14x14 "
                     "pixels, expected a multiple of 64 up to 1024, of a square")

    def test_weights_that_are_not_finite(self):
        checkpoint = generated_checkpoint("tiny_mugs")
        checkpoint["norm.bias"].array = lambda: np.full(64, np.nan)
        self.refused("vit", checkpoint, "'norm.bias' has a NaN or infinity, expected none")

    def test_sizes_that_the_network_cannot_take(self):
        self.refused("vit", generated_checkpoint("tiny_mugs"),
                     "has positions for pictures of 32x32 pixels only, found --size 224x224; leave "
                     "--size out", "--size", "224x224")
        self.refused("cosplace", generated_checkpoint("tiny_cosplace"),
                     "needs pictures of multiples of 32 pixels, found --size 480x641",
                     "--size", "480x641")

    def test_a_missing_bias_of_the_attention_is_accepted(self):
        checkpoint = generated_checkpoint("tiny_mugs")
        del checkpoint["blocks.0.attn.qkv.bias"]
        network, _ = export.build(export.parsed(["vit", "generated", "nowhere"]), checkpoint)
        self.assertIn("tokens", network.outputs)

    def test_an_unused_head_is_accepted(self):
        checkpoint = generated_checkpoint("tiny_mugs")
        checkpoint["relation_blocks.0.norm1.weight"] = Generated("norm1.weight", (64,))
        _, left = export.build(export.parsed(["vit", "generated", "nowhere"]),
                               {"state_dict": checkpoint})
        self.assertEqual(left, {"state_dict.relation_blocks": 1})

    def test_every_damaged_file_is_refused_in_one_sentence(self):
        for case in ("tiny_mugs", "tiny_cosplace"):
            whole = (HERE / f"{case}.pth").read_bytes()
            for length in range(0, len(whole), len(whole) // 50):
                with self.assertRaises(CheckpointError) as refusal:
                    options = export.parsed(["vit" if case == "tiny_mugs" else "cosplace",
                                             "damaged", "nowhere"])
                    export.build(options, read_checkpoint(io.BytesIO(whole[:length])))
                self.assertNotIn("\n", str(refusal.exception))

    def test_code_in_a_checkpoint_does_not_run(self):
        class Attack:
            def __reduce__(self):
                return print, ("this must not be printed",)

        parts = (MAGIC, PROTOCOL, {}, {"args": Attack()}, [])
        file = io.BytesIO(b"".join(pickle.dumps(part, protocol=2) for part in parts))
        self.assertEqual(quietly(read_checkpoint, file), "")


if __name__ == "__main__":
    unittest.main()
