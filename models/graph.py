"""An ONNX network under construction, shared by all our converters."""
import numpy as np
from onnx import ModelProto, TensorProto, helper, numpy_helper

SAMPLES_NEURONS = "samples_neurons"  # a descriptor, or the tokens of a transformer
NEURONS_SAMPLES = "neurons_samples"  # the feature map of a convolution


def fold_batch_norm(weight, gamma, beta, mean, variance, epsilon):
    """Return (weight, bias) of a convolution with the batch normalisation after it, in float32."""
    # Double precision, and only operations that IEEE 754 rounds identically on every machine.
    scale = gamma / np.sqrt(variance + epsilon)
    return (weight * scale[:, None, None, None]).astype("<f4"), (beta - mean * scale).astype("<f4")


class Graph:
    """Nodes, constants and outputs; values are known by name."""

    def __init__(self, opset, size, name=""):
        self.name = name
        self.size = size  # height and width of a picture
        self.model = ModelProto(ir_version=8, producer_name="vdna")
        self.model.opset_import.append(helper.make_opsetid("", opset))
        self.outputs = {}  # name -> (shape of one picture's, layout)

    def image(self):
        """Add the input, and return it."""
        self.model.graph.input.append(
            helper.make_tensor_value_info("image", TensorProto.FLOAT, ["N", 3, *self.size]))
        return "image"

    def output(self, name, shape, layout):
        self.model.graph.output.append(
            helper.make_tensor_value_info(name, TensorProto.FLOAT, ["N", *shape]))
        self.outputs[name] = (shape, layout)

    def constant(self, name, array):
        """Floats are stored as float32, integers as they are."""
        if array.dtype.kind == "f":
            array = array.astype("<f4")
        self.model.graph.initializer.append(numpy_helper.from_array(array, name))
        return name

    def node(self, kind, inputs, output=None, **attributes):
        output = output or f"{kind.lower()}{len(self.model.graph.node)}"
        self.model.graph.node.append(helper.make_node(kind, inputs, [output], **attributes))
        return output

    def convolution(self, x, weight, bias, stride=1, pads=None, group=1):
        """`pads`: pixels before and after, for both axes; None = half the kernel."""
        kernel = weight.shape[2]
        before, after = pads or (kernel // 2, kernel // 2)
        prefix = f"layer{len(self.model.graph.node)}"
        return self.node("Conv", [x, self.constant(f"{prefix}_weight", weight),
                                  self.constant(f"{prefix}_bias", bias)],
                         kernel_shape=[kernel, kernel], strides=[stride, stride],
                         pads=[before, before, after, after], group=group)

    def serialised(self):
        """Return the ONNX file; the same weights give the same bytes with any version of onnx."""
        self.model.graph.name = self.name
        return self.model.SerializeToString(deterministic=True)
