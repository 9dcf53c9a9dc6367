"""Read the tensors in a PyTorch file into numpy arrays, without PyTorch.

Two containers are in use. Since PyTorch 1.6 it is a zip archive with one pickle, and one member for
the elements of each storage. Before, it was a sequence of pickles (magic number, protocol, system,
saved object, storage keys), then the number of elements and the elements of each key. Elements are
little-endian.

A pickle can call any function. This reader admits only those that a state dict needs.
"""
import collections
import math
import pickle
import zipfile

import numpy as np

MAGIC = 0x1950A86A20F9469CFC6C
PROTOCOL = 1001
DTYPES = {f"{name}Storage": np.dtype(code) for name, code in (
    ("Double", "<f8"), ("Float", "<f4"), ("Half", "<f2"), ("Long", "<i8"), ("Int", "<i4"),
    ("Short", "<i2"), ("Char", "<i1"), ("Byte", "<u1"), ("Bool", "?"))}


class CheckpointError(Exception):
    """A difference between a checkpoint and the expected one."""


class Storage:
    """A flat array of elements. The container sets `load`, which returns their bytes. They are read
    on demand, because a training checkpoint is several times its network."""

    def __init__(self, dtype, count):
        self.dtype, self.count, self.load = dtype, count, bytes


class Tensor:
    """A view of a storage, as pickled: offset, shape and stride count elements."""

    def __init__(self, storage, offset, shape, stride, *_):
        self.storage, self.offset, self.shape, self.stride = storage, offset, shape, stride

    def array(self):
        elements = np.frombuffer(self.storage.load(), self.storage.dtype)
        last = self.offset + sum(step * (size - 1) for step, size in zip(self.stride, self.shape))
        # A stride of 0 repeats elements; weights never do, and copies could fill the memory.
        if (min(self.offset, *self.stride, 0) < 0 or last >= len(elements)
                or math.prod(self.shape) > len(elements)):
            raise ValueError(f"a tensor of shape {self.shape} reaches out of its storage")
        strides = [step * elements.itemsize for step in self.stride]
        return np.lib.stride_tricks.as_strided(elements[self.offset:], self.shape, strides)


def parameter(tensor, *_):
    """A parameter of a network: a tensor that training changes."""
    return tensor


class StateDictUnpickler(pickle.Unpickler):
    """Refuses anything that has no place in a state dict."""

    ALLOWED = {
        ("collections", "OrderedDict"): collections.OrderedDict,
        ("torch._utils", "_rebuild_tensor_v2"): Tensor,
        ("torch._utils", "_rebuild_parameter"): parameter,
        **{("torch", name): dtype for name, dtype in DTYPES.items()},
    }

    def __init__(self, file):
        super().__init__(file)
        self.storages = {}

    def find_class(self, module, name):
        if (module, name) not in self.ALLOWED:
            raise pickle.UnpicklingError(f"{module}.{name} has no place in a state dict")
        return self.ALLOWED[module, name]

    def persistent_load(self, reference):
        _, dtype, key, _, count = reference[:5]
        return self.storages.setdefault(key, Storage(dtype, count))


class Inert:
    """Stands in for any class or function, and ignores anything a pickle does with it."""

    def __new__(cls, *_, **__):
        return super().__new__(cls)

    def ignore(self, *_):
        pass

    __init__ = __setstate__ = __setitem__ = append = extend = add = ignore


class CheckpointUnpickler(StateDictUnpickler):
    """Lets a training checkpoint through, with its options and the state of its optimiser inert."""

    def find_class(self, module, name):
        return self.ALLOWED.get((module, name), Inert)


def load_zip(file, unpickler_class):
    archive = zipfile.ZipFile(file)
    [pickled] = [name for name in archive.namelist() if name.endswith("/data.pkl")]
    unpickler = unpickler_class(archive.open(pickled))
    saved = unpickler.load()

    def loader(member, size):
        # PyTorch does not compress, so no member is larger than the file.
        if (member.compress_type, member.file_size) != (zipfile.ZIP_STORED, size):
            raise ValueError(f"{member.filename} is not {size} plain bytes, as its tensors say")
        return lambda: archive.read(member)

    for key, storage in unpickler.storages.items():
        member = archive.getinfo(f"{pickled.removesuffix('.pkl')}/{key}")
        storage.load = loader(member, storage.count * storage.dtype.itemsize)
    return saved


def load_run_of_pickles(file, unpickler_class):
    if (StateDictUnpickler(file).load(), StateDictUnpickler(file).load()) != (MAGIC, PROTOCOL):
        raise ValueError("not a PyTorch file: neither a zip archive nor the container used before "
                         "PyTorch 1.6")
    StateDictUnpickler(file).load()  # the sizes of C types on the machine that wrote the file
    unpickler = unpickler_class(file)
    saved = unpickler.load()

    def loader(offset, size):
        def load():
            file.seek(offset)
            return file.read(size)
        return load

    for key in StateDictUnpickler(file).load():
        storage = unpickler.storages[key]
        count = int.from_bytes(file.read(8), "little")
        if count != storage.count:
            raise ValueError(f"storage {key} has {count} elements, its tensors say {storage.count}")
        size = count * storage.dtype.itemsize
        storage.load = loader(file.tell(), size)
        file.seek(size, 1)
    return saved


def load(file, unpickler_class):
    is_zip = file.read(4) == b"PK\3\4"
    file.seek(0)
    return (load_zip if is_zip else load_run_of_pickles)(file, unpickler_class)


def read_state_dict(file):
    """Return {name: array} in the order of the file, which is the order of the layers."""
    return {name: tensor.array() for name, tensor in load(file, StateDictUnpickler).items()}


def read_checkpoint(file):
    """Return the saved object, with a Tensor for each tensor; these need `file` to stay open."""
    try:
        return load(file, CheckpointUnpickler)
    except Exception as error:  # a damaged pickle may raise anything, says the pickle module
        raise CheckpointError(f"cannot be read as a PyTorch checkpoint: {error}; expected a file "
                              "that torch.save() wrote") from error
