#!/usr/bin/env python3
"""Write tiny_network.onnx: a network whose outputs can be checked by hand.

    /usr/bin/python3 make_tiny_network.py     (committed file: onnx 1.12, Debian's python3-onnx)

Input "image" is [1,3,2,2]; every output is a simple function of it:
    mean       [1,3]      mean of each channel
    map        [1,3,2,2]  the image itself: a convolution's layout
    tokens     [1,4,3]    its pixels, one after the other: a transformer's layout
    logarithm  [1,3]      of `mean`: NaN below zero, minus infinity at zero
    flat       [12]       has no batch axis
    whole      [1,3]      `mean` as int64
"""
import pathlib

import numpy as np
from onnx import TensorProto, checker, helper, numpy_helper, save

nodes = [
    helper.make_node("GlobalAveragePool", ["image"], ["pooled"]),
    helper.make_node("Flatten", ["pooled"], ["mean"]),
    helper.make_node("Identity", ["image"], ["map"]),
    helper.make_node("Reshape", ["image", "three_rows"], ["rows"]),
    helper.make_node("Transpose", ["rows"], ["tokens"], perm=[0, 2, 1]),
    helper.make_node("Log", ["mean"], ["logarithm"]),
    helper.make_node("Reshape", ["image", "one_row"], ["flat"]),
    helper.make_node("Cast", ["mean"], ["whole"], to=TensorProto.INT64),
]


def value(name, shape, kind=TensorProto.FLOAT):
    return helper.make_tensor_value_info(name, kind, shape)


graph = helper.make_graph(
    nodes, "tiny", [value("image", [1, 3, 2, 2])],
    [value("mean", [1, 3]), value("map", [1, 3, 2, 2]), value("tokens", [1, 4, 3]),
     value("logarithm", [1, 3]), value("flat", [12]), value("whole", [1, 3], TensorProto.INT64)],
    [numpy_helper.from_array(np.array([1, 3, 4]), "three_rows"),
     numpy_helper.from_array(np.array([12]), "one_row")])
model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)])
model.ir_version = 8
checker.check_model(model, full_check=True)
save(model, str(pathlib.Path(__file__).parent / "tiny_network.onnx"))
