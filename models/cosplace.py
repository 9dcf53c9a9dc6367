"""Turn a CosPlace checkpoint (place recognition on a ResNet) into an ONNX network.

The ResNet ends with layer4. Its channels are L2-normalised at each pixel, pooled by a generalised
mean whose power is learned, brought to the width of the descriptor, and L2-normalised again. In the
checkpoint the ResNet is a sequence, so its parts have numbers: 0 and 1 are the stem, 4 to 7 are
layer1 to layer4. Depth, widths and the kind of block follow from the tensors present.

Input:  "image"           float32 [N,3,height,width], ImageNet mean and deviation
Output: "embedding"       float32 [N,width of the descriptor], of length 1
        "layer1".."layer4" and, with `every_block`, "layer1_block01"..: float32 [N,channels,h,w]
"""
import numpy as np

from graph import NEURONS_SAMPLES, SAMPLES_NEURONS, Graph, fold_batch_norm
from torch_file import CheckpointError

KIND = "CosPlace ResNet"
LANDMARK = "aggregation.1.p"
WHOLE = "backbone"
DEFAULT_TAP = "embedding"
DEFAULT_SIZE = (224, 224)
STRIDE = 32  # pixels of the picture to a pixel of layer4
BATCH_NORM_EPSILON = 1e-5
POOLING_FLOOR = 1e-6
LENGTH_FLOOR = 1e-12
FIRST_LAYER = 4
KERNELS = {2: (3, 3), 3: (1, 3, 1)}  # of a block, by the number of its convolutions


class ResNetGraph(Graph):
    """A graph with the parts of a ResNet, fed from its weights by name."""

    def __init__(self, weights, size):
        super().__init__(17, size)
        self.weights = weights
        self.depth = 2  # as in ResNet101: layers with weights, stem and descriptor included

    def normalised_convolution(self, x, names, channels, kernel, stride=1):
        """`names`: of the convolution and its batch normalisation. Return (value, channels)."""
        convolution, norm = names
        weight = self.weights.take(f"{convolution}.weight", None, channels, kernel, kernel)
        parts = [self.weights.take(f"{norm}.{part}", len(weight))
                 for part in ("weight", "bias", "running_mean", "running_var")]
        folded = fold_batch_norm(weight, *parts, BATCH_NORM_EPSILON)
        return self.convolution(x, *folded, stride), len(weight)

    def residual_block(self, x, name, channels, stride, output):
        """Add block `name`, its result called `output`. Return its channels."""
        kernels = KERNELS[3 if f"{name}.conv3.weight" in self.weights else 2]
        y, width = x, channels
        for i, kernel in enumerate(kernels, start=1):
            # The first convolution with a kernel above 1x1 is the strided one.
            step = stride if i == kernels.index(3) + 1 else 1
            y = self.node("Relu", [y]) if i > 1 else y
            self.depth += 1
            y, width = self.normalised_convolution(y, (f"{name}.conv{i}", f"{name}.bn{i}"), width,
                                                   kernel, step)
        shortcut = x
        if f"{name}.downsample.0.weight" in self.weights:
            shortcut, _ = self.normalised_convolution(
                x, (f"{name}.downsample.0", f"{name}.downsample.1"), channels, 1, stride)
        self.node("Relu", [self.node("Add", [y, shortcut])], output)
        return width

    def l2_normalise(self, x, output=None):
        length = self.node("ReduceL2", [x], axes=[1], keepdims=1)
        return self.node("Div", [x, self.node("Max", [length, "length_floor"])], output)

    def generalised_mean(self, x):
        power = self.weights.take("aggregation.1.p", 1)
        x = self.node("Max", [x, self.constant("pooling_floor", np.array(POOLING_FLOOR))])
        x = self.node("Pow", [x, self.constant("power", power)])
        x = self.node("GlobalAveragePool", [x])
        return self.node("Pow", [x, self.constant("root", 1 / power)])


def add_stem(graph):
    """Add the stem, before layer1. Return (value, channels)."""
    x, channels = graph.normalised_convolution(graph.image(), ("backbone.0", "backbone.1"), 3, 7,
                                               stride=2)
    x = graph.node("MaxPool", [graph.node("Relu", [x])], kernel_shape=[3, 3], strides=[2, 2],
                   pads=[1, 1, 1, 1])
    return x, channels


def add_layer(graph, x, channels, layer, every_block):
    """Add `layer`, 1 to 4, and its outputs. Return (value, channels)."""
    place = f"backbone.{FIRST_LAYER + layer - 1}"
    height, width = (side // 2 ** (layer + 1) for side in graph.size)
    blocks = max(1, graph.weights.count(place + ".{}.conv1.weight"))  # without: an error names it
    for block in range(1, blocks + 1):
        output = f"layer{layer}" if block == blocks else f"layer{layer}_block{block:02}"
        stride = 2 if block == 1 and layer > 1 else 1
        channels = graph.residual_block(x, f"{place}.{block - 1}", channels, stride, output)
        if block == blocks or every_block:
            graph.output(output, [channels, height, width], NEURONS_SAMPLES)
        x = output
    return x, channels


def add_descriptor(graph, x, channels):
    """Add the part after layer4."""
    graph.constant("length_floor", np.array(LENGTH_FLOOR))
    x = graph.generalised_mean(graph.l2_normalise(x))
    weight = graph.weights.take("aggregation.3.weight", None, channels)
    bias = graph.weights.take("aggregation.3.bias", len(weight))
    x = graph.node("Gemm", [graph.node("Flatten", [x], axis=1),
                            graph.constant("descriptor_weight", weight),
                            graph.constant("descriptor_bias", bias)], transB=1)
    graph.l2_normalise(x, "embedding")
    graph.output("embedding", [len(weight)], SAMPLES_NEURONS)
    return len(weight)


def build(weights, size, every_block):
    """Return the network as a Graph; `size` is (height, width), None = DEFAULT_SIZE."""
    size = size or DEFAULT_SIZE
    if any(side % STRIDE for side in size):
        raise CheckpointError("needs pictures of multiples of {} pixels, found --size {}x{}".format(
            STRIDE, *size))
    graph = ResNetGraph(weights, size)
    x, channels = add_stem(graph)
    for layer in range(1, 5):
        x, channels = add_layer(graph, x, channels, layer, every_block)
    dimensions = add_descriptor(graph, x, channels)
    graph.name = f"cosplace_resnet{graph.depth}_{dimensions}"
    return graph
