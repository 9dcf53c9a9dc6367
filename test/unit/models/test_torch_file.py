"""Tests of models/torch_file.py. A stand-in for PyTorch is pickled to make the files."""
import io
import pickle
import struct
import sys
import types
import unittest
from collections import OrderedDict
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "models"))
from torch_file import MAGIC, PROTOCOL, read_state_dict  # noqa: E402


def _rebuild_tensor_v2():
    """Stands for a tensor, under the name that PyTorch pickles."""


class FloatStorage:
    """Stands for float elements, under the name that PyTorch pickles."""


_rebuild_tensor_v2.__module__ = "torch._utils"
FloatStorage.__module__ = "torch"
sys.modules["torch"] = types.SimpleNamespace(FloatStorage=FloatStorage)
sys.modules["torch._utils"] = types.SimpleNamespace(_rebuild_tensor_v2=_rebuild_tensor_v2)


class Storage:
    def __init__(self, key, elements):
        self.key, self.elements = key, elements


class Tensor:
    def __init__(self, storage, offset, shape, stride):
        self.view = (storage, offset, shape, stride)

    def __reduce__(self):
        return _rebuild_tensor_v2, self.view


class Pickler(pickle.Pickler):
    def persistent_id(self, value):
        if isinstance(value, Storage):
            return "storage", FloatStorage, value.key, "cpu", len(value.elements)
        return None


def torch_file(state, storages, magic=MAGIC, protocol=PROTOCOL):
    file = io.BytesIO()
    for value in (magic, protocol, {}, state, [storage.key for storage in storages]):
        Pickler(file, protocol=2).dump(value)
    for storage in storages:
        count = len(storage.elements)
        file.write(struct.pack(f"<q{count}f", count, *storage.elements))
    file.seek(0)
    return file


class TorchFile(unittest.TestCase):
    def test_tensors_keep_names_order_shapes_and_values(self):
        storage = Storage("7", [0, 1, 2, 3, 4, 5, 6])
        state = OrderedDict(second=Tensor(storage, 1, (2, 3), (3, 1)),
                            first=Tensor(storage, 0, (3, 2), (1, 3)))
        read = read_state_dict(torch_file(state, [storage]))
        self.assertEqual(list(read), ["second", "first"])
        np.testing.assert_array_equal(read["second"], [[1, 2, 3], [4, 5, 6]])
        np.testing.assert_array_equal(read["first"], [[0, 3], [1, 4], [2, 5]])

    def test_a_pickle_that_names_another_function_is_refused(self):
        with self.assertRaisesRegex(pickle.UnpicklingError, "print"):
            read_state_dict(torch_file(OrderedDict(weight=print), []))

    def test_a_magic_that_names_a_function_is_refused_too(self):
        with self.assertRaisesRegex(pickle.UnpicklingError, "print"):
            read_state_dict(torch_file(OrderedDict(), [], magic=print))

    def test_another_container_is_refused(self):
        with self.assertRaisesRegex(ValueError, "not a PyTorch file"):
            read_state_dict(torch_file(OrderedDict(), [], protocol=1002))

    def test_a_view_beyond_its_storage_is_refused(self):
        storage = Storage("0", [1, 2, 3])
        with self.assertRaisesRegex(ValueError, "reaches out of its storage"):
            read_state_dict(torch_file({"weight": Tensor(storage, 1, (3,), (1,))}, [storage]))

    def test_a_storage_without_bytes_is_refused(self):
        storage = Storage("0", [1, 2, 3])
        with self.assertRaisesRegex(ValueError, "reaches out of its storage"):
            read_state_dict(torch_file({"weight": Tensor(storage, 0, (3,), (1,))}, []))

    def test_a_storage_of_another_length_than_announced_is_refused(self):
        storage = Storage("0", [1, 2, 3])
        whole = torch_file({"weight": Tensor(storage, 0, (3,), (1,))}, [storage]).getvalue()
        wrong = whole.replace(struct.pack("<q", 3), struct.pack("<q", 2))
        with self.assertRaisesRegex(ValueError, "storage 0 has 2 elements"):
            read_state_dict(io.BytesIO(wrong))


if __name__ == "__main__":
    unittest.main()
