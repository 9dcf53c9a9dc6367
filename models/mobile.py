"""Turn PyTorch weights of a mobile classification network into an ONNX feature extractor.

EfficientNet-Lite0 and MobileNetV2 have one plan: a 3x3 stem, stages of inverted residual blocks
(1x1 expansion, depthwise convolution, 1x1 projection, and a shortcut around all but the first block
of a stage), and a 1x1 head. Every convolution is followed by a batch normalisation, which is folded
into it. A state dict lists them in the order of execution, so the plan adds only the facts missing
from the shapes: strides, padding and the ends of stages.

Input:  "image"     float32 [N,3,224,224], normalised as the network's manifest says
Output: "embedding" float32 [N,1280], global average of the head
        "feat_s16"  float32 [N,channels,14,14], end of the last stage at stride 16
"""
import dataclasses

import numpy as np

from graph import NEURONS_SAMPLES, SAMPLES_NEURONS, Graph, fold_batch_norm

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
        if state[name].ndim == 4:
            yield fold_batch_norm(*(state[n].astype(np.float64) for n in names[i:i + 5]), epsilon)


class MobileGraph(Graph):
    """A graph that takes its convolutions one after the other."""

    def __init__(self, name, plan, convolutions):
        super().__init__(13, (INPUT_SIZE, INPUT_SIZE), name)
        self.plan, self.convolutions = plan, convolutions
        self.zero, self.six = (self.constant(constant, np.array(value, "<f4"))
                               for constant, value in (("zero", 0), ("six", 6)))

    def linear_convolution(self, x, weight, bias, stride=1):
        depthwise = weight.shape[1] == 1
        return self.convolution(x, weight, bias, stride,
                                self.plan.padding(weight.shape[2], stride),
                                group=weight.shape[0] if depthwise else 1)

    def activated_convolution(self, x, weight, bias, stride=1):
        y = self.linear_convolution(x, weight, bias, stride)
        return self.node("Clip", [y, self.zero, self.six])

    def inverted_residual(self, x, stride=1, shortcut=False, output=None):
        weight, bias = next(self.convolutions)
        y = x
        if weight.shape[1] != 1:  # the very first block starts with its depthwise convolution
            y = self.activated_convolution(y, weight, bias)
            weight, bias = next(self.convolutions)
        y = self.activated_convolution(y, weight, bias, stride)
        y = self.linear_convolution(y, *next(self.convolutions))
        return self.node("Add", [y, x], output) if shortcut else y


def convert(name, state):
    """Return the ONNX file of network `name` with the weights `state`, as bytes."""
    plan = PLANS[name]
    graph = MobileGraph(name, plan, folded_convolutions(state, plan.epsilon))
    x = graph.activated_convolution(graph.image(), *next(graph.convolutions), stride=2)
    for stage, (blocks, stride) in enumerate(plan.stages, start=1):
        x = graph.inverted_residual(x, stride)
        for block in range(2, blocks + 1):
            is_tap = (stage, block) == (STRIDE_16_STAGE, blocks)
            x = graph.inverted_residual(x, shortcut=True, output="feat_s16" if is_tap else None)
    x = graph.activated_convolution(x, *next(graph.convolutions))
    graph.node("Flatten", [graph.node("GlobalAveragePool", [x])], output="embedding", axis=1)

    graph.output("embedding", [1280], SAMPLES_NEURONS)
    graph.output("feat_s16", [plan.stride_16_channels, INPUT_SIZE // 16, INPUT_SIZE // 16],
                 NEURONS_SAMPLES)
    return graph.serialised()
