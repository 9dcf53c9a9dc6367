"""Turn a checkpoint of the DINO family of vision transformers (Mugs, DINO) into an ONNX network.

The picture is cut into patches; each becomes a token, and a class token is put before them. Blocks
of attention and perceptron follow, and a last layer normalisation. Depth, width and the size of
picture and patch follow from the shapes; the width of an attention head does not, and is 64 from
ViT-S to ViT-L.

Input:  "image"     float32 [N,3,side,side], ImageNet mean and deviation; the side is the one that
                    the network has positions for
Output: "embedding" float32 [N,width], the class token
        "tokens"    float32 [N,tokens,width], class token and patches; both after the last norm
        and, with `every_block`, "block01"..: float32 [N,tokens,width], as outputs of the block
"""
import math

import numpy as np

from graph import SAMPLES_NEURONS, Graph
from torch_file import CheckpointError

KIND = "ViT"
LANDMARK = "cls_token"
WHOLE = "blocks"
DEFAULT_TAP = "tokens"
HEAD_WIDTH = 64
WIDEST = 1024  # of ViT-L; ViT-H has other heads
EPSILON = 1e-6


class TransformerGraph(Graph):
    """A graph with the parts of a transformer, fed from its weights by name."""

    def __init__(self, weights, width, size):
        super().__init__(17, size)
        self.weights, self.width = weights, width

    def layer_norm(self, x, name, output=None):
        scale, bias = (self.constant(f"{name}.{part}",
                                     self.weights.take(f"{name}.{part}", self.width))
                       for part in ("weight", "bias"))
        return self.node("LayerNormalization", [x, scale, bias], output, axis=-1, epsilon=EPSILON)

    def product(self, x, name, weight, bias):
        """x times `weight`, which is [out][in] as PyTorch has it, plus `bias`."""
        y = self.node("MatMul", [x, self.constant(f"{name}.weight", weight.T)])
        return self.node("Add", [y, self.constant(f"{name}.bias", bias)])

    def linear(self, x, name, inside, outside):
        return self.product(x, name, self.weights.take(f"{name}.weight", outside, inside),
                            self.weights.take(f"{name}.bias", outside))

    def attention(self, x, name):
        width, heads = self.width, self.width // HEAD_WIDTH
        weight = self.weights.take(f"{name}.qkv.weight", 3 * width, width)
        bias = (self.weights.take(f"{name}.qkv.bias", 3 * width)
                if f"{name}.qkv.bias" in self.weights else np.zeros(3 * width))
        # Scaling the queries scales all products of queries and keys.
        weight[:width] /= math.sqrt(HEAD_WIDTH)
        bias[:width] /= math.sqrt(HEAD_WIDTH)

        def split_heads(part, permutation):
            rows = slice(part * width, (part + 1) * width)
            y = self.product(x, f"{name}.{'qkv'[part]}", weight[rows], bias[rows])
            return self.node("Transpose", [self.node("Reshape", [y, "heads_apart"])],
                             perm=permutation)

        query, key, value = (split_heads(0, [0, 2, 1, 3]), split_heads(1, [0, 2, 3, 1]),
                             split_heads(2, [0, 2, 1, 3]))
        shares = self.node("Softmax", [self.node("MatMul", [query, key])], axis=-1)
        y = self.node("Transpose", [self.node("MatMul", [shares, value])], perm=[0, 2, 1, 3])
        return self.linear(self.node("Reshape", [y, "heads_joined"]), f"{name}.proj", width, width)

    def gelu(self, x):
        """The exact GELU, in the form that ONNX Runtime recognises and computes in one pass."""
        share = self.node("Erf", [self.node("Div", [x, "sqrt2"])])
        return self.node("Mul", [self.node("Mul", [x, self.node("Add", [share, "one"])]), "half"])

    def perceptron(self, x, name):
        weight = self.weights.take(f"{name}.fc1.weight", None, self.width)
        x = self.product(x, f"{name}.fc1", weight,
                         self.weights.take(f"{name}.fc1.bias", len(weight)))
        return self.linear(self.gelu(x), f"{name}.fc2", len(weight), self.width)

    def block(self, x, name, output):
        x = self.node("Add", [x, self.attention(self.layer_norm(x, f"{name}.norm1"),
                                                f"{name}.attn")])
        y = self.perceptron(self.layer_norm(x, f"{name}.norm2"), f"{name}.mlp")
        return self.node("Add", [x, y], output)


def patch_grid(weights):
    """Return (width of a token, pixels along a patch, patches along the picture)."""
    projection = weights.take("patch_embed.proj.weight", None, 3, None, None)
    width, _, patch, patch_width = projection.shape
    if patch != patch_width or width not in range(HEAD_WIDTH, WIDEST + 1, HEAD_WIDTH):
        raise CheckpointError(f"'patch_embed.proj.weight' makes {width} numbers of {patch}x"
                              f"{patch_width} pixels, expected a multiple of {HEAD_WIDTH} up to "
                              f"{WIDEST}, of a square")
    tokens = weights.take("pos_embed", 1, None, width).shape[1]
    along = math.isqrt(tokens - 1)
    if along * along != tokens - 1:
        raise CheckpointError(f"'pos_embed' has {tokens} positions, expected a square number and "
                              "one for the class token")
    return width, patch, along


def add_tokens(graph, patch, along):
    """Add everything before the blocks. Return the value."""
    weights, width, tokens = graph.weights, graph.width, along * along + 1
    x = graph.convolution(graph.image(),
                          weights.take("patch_embed.proj.weight", width, 3, patch, patch),
                          weights.take("patch_embed.proj.bias", width), stride=patch, pads=(0, 0))
    x = graph.node("Reshape", [x, graph.constant("patches", np.array([0, width, tokens - 1]))])
    x = graph.node("Transpose", [x], perm=[0, 2, 1])
    # The class token is the same for all pictures: a row of zeros, to which it is added together
    # with its position.
    position = weights.take("pos_embed", 1, tokens, width)
    position[0, 0] += weights.take("cls_token", 1, 1, width)[0, 0]
    x = graph.node("Pad", [x, graph.constant("row_before", np.array([0, 1, 0, 0, 0, 0]))])
    return graph.node("Add", [x, graph.constant("position", position)])


def build(weights, size, every_block):
    """Return the network as a Graph; `size` is None or the one that its positions are for."""
    width, patch, along = patch_grid(weights)
    tokens, side = along * along + 1, along * patch
    if size not in (None, (side, side)):
        raise CheckpointError("has positions for pictures of {0}x{0} pixels only, found --size "
                              "{1}x{2}; leave --size out".format(side, *size))
    graph = TransformerGraph(weights, width, (side, side))
    for constant, value in (("sqrt2", math.sqrt(2)), ("one", 1.0), ("half", 0.5),
                            ("heads_apart", [0, tokens, width // HEAD_WIDTH, HEAD_WIDTH]),
                            ("heads_joined", [0, tokens, width])):
        graph.constant(constant, np.array(value))

    x = add_tokens(graph, patch, along)
    blocks = max(1, weights.count("blocks.{}.norm1.weight"))  # without: an error names it
    for block in range(1, blocks + 1):
        x = graph.block(x, f"blocks.{block - 1}", f"block{block:02}")
        if every_block:
            graph.output(x, [tokens, width], SAMPLES_NEURONS)
    x = graph.layer_norm(x, "norm", "tokens")
    graph.output(x, [tokens, width], SAMPLES_NEURONS)
    graph.node("Gather", [x, graph.constant("class_token", np.array(0))], "embedding", axis=1)
    graph.output("embedding", [width], SAMPLES_NEURONS)
    graph.name = f"vit_{width}x{blocks}_patch{patch}"
    return graph
