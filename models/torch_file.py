"""Read the weights in a PyTorch file into numpy arrays, without PyTorch.

Only the older of the two containers (before PyTorch 1.6) is read; the networks we fetch use it. It
is a run of pickles (magic number, protocol, system, state dict, storage keys) and then, for each
key, the number of elements and the elements themselves, little-endian.

A pickle may name any function and have it called. Here only what a state dict needs is let through.
"""
import collections
import pickle

import numpy as np

MAGIC = 0x1950A86A20F9469CFC6C
PROTOCOL = 1001
DTYPES = {"FloatStorage": np.dtype("<f4"), "LongStorage": np.dtype("<i8")}


class Storage:
    """A flat array of elements; its bytes follow behind the pickles."""

    def __init__(self, dtype, count):
        self.dtype, self.count, self.elements = dtype, count, np.empty(0, dtype)


class Tensor:
    """A view of a storage, as pickled: offset, shape and stride count elements."""

    def __init__(self, storage, offset, shape, stride, *_):
        self.storage, self.offset, self.shape, self.stride = storage, offset, shape, stride

    def array(self):
        elements = self.storage.elements
        last = self.offset + sum(step * (size - 1) for step, size in zip(self.stride, self.shape))
        if min(self.offset, *self.stride, 0) < 0 or last >= len(elements):
            raise ValueError(f"a tensor of shape {self.shape} reaches out of its storage")
        strides = [step * elements.itemsize for step in self.stride]
        return np.lib.stride_tricks.as_strided(elements[self.offset:], self.shape, strides)


class StateDictUnpickler(pickle.Unpickler):
    def __init__(self, file):
        super().__init__(file)
        self.storages = {}

    def find_class(self, module, name):
        if (module, name) == ("collections", "OrderedDict"):
            return collections.OrderedDict
        if (module, name) == ("torch._utils", "_rebuild_tensor_v2"):
            return Tensor
        if module == "torch" and name in DTYPES:
            return DTYPES[name]
        raise pickle.UnpicklingError(f"{module}.{name} has no place in a state dict")

    def persistent_load(self, reference):
        _, dtype, key, _, count = reference[:5]
        return self.storages.setdefault(key, Storage(dtype, count))


def read_state_dict(file):
    """Return {name: array} in the order of the file, which is the order of the layers."""
    if (StateDictUnpickler(file).load(), StateDictUnpickler(file).load()) != (MAGIC, PROTOCOL):
        raise ValueError("not a PyTorch file of the container used before PyTorch 1.6")
    StateDictUnpickler(file).load()  # the sizes of C types on the machine that wrote the file

    unpickler = StateDictUnpickler(file)
    tensors = unpickler.load()
    for key in StateDictUnpickler(file).load():
        storage = unpickler.storages[key]
        count = int.from_bytes(file.read(8), "little")
        if count != storage.count:
            raise ValueError(f"storage {key} has {count} elements, its tensors say {storage.count}")
        storage.elements = np.frombuffer(file.read(count * storage.dtype.itemsize), storage.dtype)
    return {name: tensor.array() for name, tensor in tensors.items()}
