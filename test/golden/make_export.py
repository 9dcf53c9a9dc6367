#!/usr/bin/env python3
"""Write the expectations of test_export.py: names of tensors and outputs of networks, from PyTorch.

    python3 -m venv VENV && VENV/bin/pip install torch==1.12.1 torchvision==0.13.1 'numpy<2'
    VENV/bin/python test/golden/make_export.py          (Python 3.10; writes export.json and *.pth)

Our exporters are not used. The ResNets are torchvision's, cut and extended as the authors of
CosPlace do; the transformers are torchvision's with the tensors renamed as in DINO and Mugs. The
files *.pth are written by PyTorch in the shape of full training checkpoints: of CosPlace in today's
container, of Mugs in the older one, with teacher, student and entries that are no weights.

Tolerance of the test: 1e-4 of the largest value of an output. Summation order makes 1e-6 to 1e-5.
"""
import argparse
import collections
import json
import pathlib

import numpy as np
import torch
from torch import nn
from torchvision.models import resnet, vision_transformer

from export_cases import CASES, PICTURES, picture, sampled, tensor

HERE = pathlib.Path(__file__).parent
MEAN, STD = ([0.485, 0.456, 0.406], [0.229, 0.224, 0.225])


class L2Norm(nn.Module):
    def forward(self, x):
        return nn.functional.normalize(x, p=2.0, dim=1)


class GeneralisedMean(nn.Module):
    def __init__(self):
        super().__init__()
        self.p = nn.Parameter(torch.ones(1) * 3)

    def forward(self, x):
        pooled = nn.functional.avg_pool2d(x.clamp(min=1e-6).pow(self.p), x.shape[-2:])
        return pooled.pow(1 / self.p)


class CosPlace(nn.Module):
    def __init__(self, parts, channels, dimensions):
        super().__init__()
        self.backbone = nn.Sequential(*parts)
        self.aggregation = nn.Sequential(L2Norm(), GeneralisedMean(), nn.Flatten(),
                                         nn.Linear(channels, dimensions), L2Norm())

    def forward(self, x):
        return {"embedding": self.aggregation(self.backbone(x))}

    def places(self):
        """Yield (output, module) of all taps within the network."""
        for layer in range(1, 5):
            *blocks, last = self.backbone[layer + 3]
            for number, block in enumerate(blocks, start=1):
                yield f"layer{layer}_block{number:02}", block
            yield f"layer{layer}", last

    def tensor_names(self):
        return {name: name for name in self.state_dict()}


def cosplace_resnet101():
    return CosPlace(list(resnet.resnet101().children())[:-2], 2048, 128)


def tiny_cosplace():
    """ResNet18's kind of block: narrow, and each layer of a different width and depth."""
    def layer(inside, outside, blocks, stride):
        shortcut = nn.Sequential(resnet.conv1x1(inside, outside, stride), nn.BatchNorm2d(outside))
        first = resnet.BasicBlock(inside, outside, stride, shortcut if inside != outside else None)
        others = [resnet.BasicBlock(outside, outside) for _ in range(1, blocks)]
        return nn.Sequential(first, *others)

    stem = [nn.Conv2d(3, 4, 7, 2, 3, bias=False), nn.BatchNorm2d(4), nn.ReLU(),
            nn.MaxPool2d(3, 2, 1)]
    layers = [layer(4, 4, 1, 1), layer(4, 6, 2, 2), layer(6, 8, 1, 2), layer(8, 10, 1, 2)]
    return CosPlace(stem + layers, 10, 5)


class Transformer(vision_transformer.VisionTransformer):
    """Gives all tokens, as DINO can, instead of torchvision's classes."""

    def forward(self, x):
        x = self._process_input(x)
        x = torch.cat([self.class_token.expand(len(x), -1, -1), x], dim=1)
        tokens = self.encoder(x)
        return {"embedding": tokens[:, 0], "tokens": tokens}

    def places(self):
        for number, block in enumerate(self.encoder.layers, start=1):
            yield f"block{number:02}", block

    def tensor_names(self):
        """DINO's names of the tensors, and torchvision's, in DINO's order."""
        parts = [("norm1", "ln_1"), ("attn.qkv", "self_attention.in_proj_"),
                 ("attn.proj", "self_attention.out_proj"), ("norm2", "ln_2"),
                 ("mlp.fc1", "mlp.0"), ("mlp.fc2", "mlp.3")]
        layers = [("patch_embed.proj", "conv_proj")]
        for i in range(len(self.encoder.layers)):
            layers += [(f"blocks.{i}.{theirs}", f"encoder.layers.encoder_layer_{i}.{ours}")
                       for theirs, ours in parts]
        layers.append(("norm", "encoder.ln"))
        names = {"cls_token": "class_token", "pos_embed": "encoder.pos_embedding"}
        for theirs, ours in layers:
            for kind in ("weight", "bias"):
                names[f"{theirs}.{kind}"] = ours + ("" if ours.endswith("_") else ".") + kind
        return names


def mugs_vitb16():
    return Transformer(224, 16, num_layers=12, num_heads=12, hidden_dim=768, mlp_dim=3072)


def tiny_mugs():
    return Transformer(32, 8, num_layers=2, num_heads=1, hidden_dim=64, mlp_dim=24)


def fill(network, half):
    """Give the network its random weights. Return them under the original names."""
    own = network.state_dict()
    state = collections.OrderedDict()
    for name, own_name in network.tensor_names().items():
        values = torch.from_numpy(tensor(name, tuple(own[own_name].shape)))
        state[name] = values.half() if half else values
        own[own_name].copy_(state[name])
    return state


def prepared(case):
    pictures = np.stack([picture(number, *CASES[case]) for number in range(PICTURES)])
    normalised = (pictures / 255.0 - np.array(MEAN)) / np.array(STD)
    return torch.from_numpy(normalised.astype(np.float32).transpose(0, 3, 1, 2))


def outputs_of(network, x):
    """Return {output: the values kept of it for each picture, as text}."""
    kept = {}

    def keep(name):
        return lambda _module, _inputs, output: kept.update({name: output})

    for name, module in network.places():
        module.register_forward_hook(keep(name))
    kept.update(network(x))

    def text(name, values):
        values = values.numpy().ravel() if name == "embedding" else sampled(values)
        return " ".join(f"{value:.7g}" for value in values)

    return {name: [text(name, values) for values in pictures] for name, pictures in kept.items()}


def save_tiny_cosplace(state):
    """As trained on several devices, with a weight that is a transposed view."""
    view = state["aggregation.3.weight"]
    state["aggregation.3.weight"] = view.t().contiguous().t()
    state = collections.OrderedDict((f"module.{name}", values) for name, values in state.items())
    torch.save({"epoch_num": 49, "model_state_dict": state, "best_val_recall1": np.float64(0.5)},
               HERE / "tiny_cosplace.pth")


def save_tiny_mugs(state):
    teacher = collections.OrderedDict((f"backbone.{name}", v) for name, v in state.items())
    teacher["backbone.relation_blocks.0.norm1.weight"] = torch.ones(64)
    teacher["instance_head.projector.0.weight"] = torch.ones(2, 64)
    student = {f"module.backbone.{name}": values.new_zeros(1) for name, values in state.items()}
    options = argparse.Namespace(arch="vit_tiny", output_dir=pathlib.PurePosixPath("out"))
    optimizer = {"state": {0: {"step": 3}}, "param_groups": [{"lr": np.float64(1e-3)}]}
    torch.save({"student": student, "teacher": teacher, "student_mem": None, "epoch": 400,
                "optimizer": optimizer, "args": options}, HERE / "tiny_mugs.pth",
               _use_new_zipfile_serialization=False)


@torch.no_grad()
def main():
    golden = {}
    for case, make in (("cosplace_resnet101_128", cosplace_resnet101), ("mugs_vitb16", mugs_vitb16),
                       ("tiny_cosplace", tiny_cosplace), ("tiny_mugs", tiny_mugs)):
        network = make().eval()
        state = fill(network, half=case == "tiny_mugs")
        shapes = {name: " ".join(map(str, values.shape)) for name, values in state.items()}
        golden[case] = {"tensors": shapes, "outputs": outputs_of(network, prepared(case))}
        save = {"tiny_cosplace": save_tiny_cosplace, "tiny_mugs": save_tiny_mugs}.get(case)
        if save:
            save(state)
    (HERE / "export.json").write_text(json.dumps(golden, indent=1) + "\n")


if __name__ == "__main__":
    main()
