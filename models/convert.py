"""Turn PyTorch weights of a mobile classification network into an ONNX feature extractor.

EfficientNet-Lite0 and MobileNetV2 have one plan: a 3x3 stem, stages of inverted residual blocks
(1x1 expansion, depthwise convolution, 1x1 projection, and a shortcut around all but the first block
of a stage), and a 1x1 head. Every convolution is followed by a batch normalisation, which is folded
into it. A state dict lists them in the order of execution, so the plan only has to add what the
shapes of the weights do not say: strides, padding and where a stage ends.

Input:  "image"     float32 [N,3,224,224], normalised as the network's manifest says
Output: "embedding" float32 [N,1280], global average of the head
        "feat_s16"  float32 [N,channels,14,14], end of the last stage at stride 16

The same weights give the same bytes whatever the version of onnx, for the manifest pins them.
"""
import dataclasses

import numpy as np
from onnx import TensorProto, checker, helper, numpy_helper

INPUT_SIZE = 224
STRIDE_16_STAGE = 5


def tensorflow_padding(kernel, stride):
    """"SAME" padding, odd pixel last, for the even sizes that every stride meets from 224 down."""
    total = kernel - stride
    return total // 2, total - total // 2


def torch_padding(kernel, _stride):
    return kernel // 2, kernel // 2


@dataclasses.dataclass(frozen=True)
class Plan:
    stages: tuple  # (blocks, stride of the first block) for each stage
    padding: callable  # kernel, stride -> pixels before, pixels after
    epsilon: float  # of the batch normalisations
    stride_16_channels: int


PLANS = {
    "efficientnet_lite0": Plan(((1, 1), (2, 2), (2, 2), (3, 2), (3, 1), (4, 2), (1, 1)),
                               tensorflow_padding, 1e-3, 112),
    "mobilenet_v2": Plan(((1, 1), (2, 2), (3, 2), (4, 2), (3, 1), (3, 2), (1, 1)),
                         torch_padding, 1e-5, 96),
}


def folded_convolutions(state, epsilon):
    """Yield (weight, bias) of each convolution with its batch normalisation, in order."""
    names = list(state)
    for i, name in enumerate(names):
        if state[name].ndim != 4:
            continue
        # Double precision, and only operations that IEEE 754 rounds alike on every machine.
        weight, gamma, beta, mean, variance = (state[n].astype(np.float64) for n in names[i:i + 5])
        scale = gamma / np.sqrt(variance + epsilon)
        weight, bias = weight * scale[:, None, None, None], beta - mean * scale
        yield weight.astype("<f4"), bias.astype("<f4")


class Graph:
    """ONNX nodes and constants under construction; values are known by name."""

    def __init__(self, plan, convolutions):
        self.plan, self.convolutions = plan, convolutions
        self.nodes, self.constants = [], []
        self.zero, self.six = (self.constant(name, np.array(value, "<f4"))
                               for name, value in (("zero", 0), ("six", 6)))

    def constant(self, name, array):
        self.constants.append(numpy_helper.from_array(array, name))
        return name

    def node(self, kind, inputs, output=None, **attributes):
        output = output or f"{kind.lower()}{len(self.nodes)}"
        self.nodes.append(helper.make_node(kind, inputs, [output], **attributes))
        return output

    def convolution(self, x, weight, bias, stride=1):
        depthwise = weight.shape[1] == 1
        kernel = weight.shape[2]
        before, after = self.plan.padding(kernel, stride)
        prefix = f"layer{len(self.nodes)}"
        return self.node("Conv", [x, self.constant(f"{prefix}_weight", weight),
                                  self.constant(f"{prefix}_bias", bias)],
                         kernel_shape=[kernel, kernel], strides=[stride, stride],
                         pads=[before, before, after, after],
                         group=weight.shape[0] if depthwise else 1)

    def activated_convolution(self, x, weight, bias, stride=1):
        return self.node("Clip", [self.convolution(x, weight, bias, stride), self.zero, self.six])

    def inverted_residual(self, x, stride=1, shortcut=False, output=None):
        weight, bias = next(self.convolutions)
        y = x
        if weight.shape[1] != 1:  # the very first block starts with its depthwise convolution
            y = self.activated_convolution(y, weight, bias)
            weight, bias = next(self.convolutions)
        y = self.activated_convolution(y, weight, bias, stride)
        y = self.convolution(y, *next(self.convolutions))
        return self.node("Add", [y, x], output) if shortcut else y


def build_graph(plan, state):
    graph = Graph(plan, folded_convolutions(state, plan.epsilon))
    x = graph.activated_convolution("image", *next(graph.convolutions), stride=2)
    for stage, (blocks, stride) in enumerate(plan.stages, start=1):
        x = graph.inverted_residual(x, stride)
        for block in range(2, blocks + 1):
            is_tap = (stage, block) == (STRIDE_16_STAGE, blocks)
            x = graph.inverted_residual(x, shortcut=True, output="feat_s16" if is_tap else None)
    x = graph.activated_convolution(x, *next(graph.convolutions))
    graph.node("Flatten", [graph.node("GlobalAveragePool", [x])], output="embedding", axis=1)
    return graph


def convert(name, state):
    """Return the ONNX file of network `name` with the weights `state`, as bytes."""
    plan = PLANS[name]
    graph = build_graph(plan, state)

    def value(value_name, *shape):
        return helper.make_tensor_value_info(value_name, TensorProto.FLOAT, ["N", *shape])

    side = INPUT_SIZE // 16
    model = helper.make_model(
        helper.make_graph(graph.nodes, name, [value("image", 3, INPUT_SIZE, INPUT_SIZE)],
                          [value("embedding", 1280),
                           value("feat_s16", plan.stride_16_channels, side, side)],
                          graph.constants),
        opset_imports=[helper.make_opsetid("", 13)], ir_version=8, producer_name="vdna")
    checker.check_model(model, full_check=True)
    return model.SerializeToString(deterministic=True)
