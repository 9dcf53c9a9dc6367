"""The weights of one network, found in a checkpoint and taken out by name and shape.

People save a state dict bare, under "state_dict" or "model", or with teacher and student side by
side; and wrappers put "module." or "backbone." before each name. So a checkpoint is flattened to
dotted names, and a name that only this kind of network has locates the network.
"""
import numpy as np

from torch_file import CheckpointError, Tensor

# The preferred one of two: the paper's ViT, like every DINO, is the teacher.
PREFERRED = "teacher"


def flattened(value, name=""):
    """Yield (dotted name, tensor) of all tensors in nested dictionaries."""
    if isinstance(value, Tensor):
        yield name, value
    elif isinstance(value, dict):
        for key, inner in value.items():
            yield from flattened(inner, f"{name}.{key}" if name else str(key))


def find_prefix(names, landmark, kind):
    """Return the prefix of `landmark` in the only network of this kind among `names`."""
    if not names:
        raise CheckpointError("holds no tensors; expected a state dict: torch.save("
                              "model.state_dict(), ...), not torch.save(model, ...)")
    prefixes = [name.removesuffix(landmark) for name in names
                if f".{name}".endswith(f".{landmark}")]
    if not prefixes:
        raise CheckpointError(f"is no {kind} checkpoint: found {', '.join(names[:3])}, ..., "
                              f"expected a tensor '{landmark}' among them")
    if len(prefixes) > 1:
        prefixes = [prefix for prefix in prefixes if PREFERRED in prefix.split(".")] or prefixes
    if len(prefixes) > 1:
        raise CheckpointError(f"holds several networks of kind {kind}, found under "
                              f"{', '.join(prefixes)}; save the one you want alone")
    return prefixes[0]


class Weights:
    """Tensors of one network; each is taken once, and what remains can be listed."""

    def __init__(self, checkpoint, landmark, kind):
        try:
            tensors = dict(flattened(checkpoint))
        except RecursionError:
            raise CheckpointError("holds a dictionary within itself") from None
        self.prefix = find_prefix(list(tensors), landmark, kind)
        self.tensors = {name.removeprefix(self.prefix): tensor for name, tensor in tensors.items()
                        if name.startswith(self.prefix)}
        self.taken = set()

    def __contains__(self, name):
        return name in self.tensors

    def take(self, name, *shape):
        """Return tensor `name`, which must have this shape (None: any size), as doubles."""
        expected = "x".join("?" if side is None else str(side) for side in shape)
        if name not in self.tensors:
            raise CheckpointError(f"'{self.prefix}{name}' is missing; expected a tensor {expected}")
        try:
            array = self.tensors[name].array()
        except Exception as error:  # as in read_checkpoint(): the tensor is part of the pickle
            raise CheckpointError(f"'{self.prefix}{name}' cannot be read: {error}") from error
        if len(array.shape) != len(shape) or any(
                side not in (None, found) for side, found in zip(shape, array.shape)):
            found = "x".join(map(str, array.shape)) or "a single number"
            raise CheckpointError(f"'{self.prefix}{name}' is {found}, expected {expected}")
        if not np.isfinite(array).all():
            raise CheckpointError(f"'{self.prefix}{name}' has a NaN or infinity, expected none")
        self.taken.add(name)
        return array.astype(np.float64)

    def count(self, form):
        """Return how many of form.format(0), form.format(1), ... there are."""
        number = 0
        while form.format(number) in self:
            number += 1
        return number

    def left(self, whole):
        """Return the tensors not taken as {first part of the name: number of tensors}. None of part
        `whole` may remain: it would be a kind of layer that we do not compute."""
        left = {}
        for name in self.tensors.keys() - self.taken:
            part, _, rest = name.partition(".")
            if rest.endswith("num_batches_tracked"):  # a counter of the training
                continue
            if part == whole:
                raise CheckpointError(f"'{self.prefix}{name}' is unknown; expected a network "
                                      "without such layers")
            left[part] = left.get(part, 0) + 1
        return dict(sorted(left.items()))
