"""Our library in this process: the Python package on the libvdna.so of a build, and
libvdna_bench.so with the loops of the bench and the C ABIs that the package does not have."""
import ctypes
import os
import shutil
import sys
from ctypes import byref, c_double, c_size_t, c_uint32, c_uint64, c_void_p
from pathlib import Path

from bare import runtime_of

ROOT = Path(__file__).resolve().parents[2]


class Library:
    """The parts of a build that are timed in-process."""

    def __init__(self, build):
        self.vdna = import_package(build)
        os.environ.setdefault("VDNA_ONNXRUNTIME", runtime_of(build))  # none is beside this Python
        self._bench = ctypes.CDLL(str(build / "test" / "bench" / "libvdna_bench.so"))
        self._bench.bench_read.restype = c_uint64
        self._bench.bench_read.argtypes = [c_void_p, c_size_t, c_size_t]
        self._bench.bench_emd_neuron_major.restype = c_double
        self._bench.bench_emd_neuron_major.argtypes = [c_void_p, c_void_p, *[c_uint32] * 4]
        self._bench.bench_hist_add.argtypes = [c_void_p, c_void_p, c_size_t]
        self.has_baseline = hasattr(self._bench, "vdna_frechet")
        self.has_backbone = hasattr(self._bench, "vdna_backbone_run")

    def read(self, *arrays, times=1):
        """Merely read arrays."""
        for array in arrays:
            self._bench.bench_read(array.ctypes.data, array.nbytes // 8, times)

    def hist_add(self, histogram, taps, frames):
        """Count the frame `taps` (activations.Taps) `times` times."""
        self._require(self._bench.bench_hist_add(byref(histogram._hist), taps.array, frames))

    def increment(self, counts, cells, times):
        """Add one to each of the cells, given as indices, `times` times."""
        self._bench.bench_increment(c_void_p(counts.ctypes.data), c_void_p(cells.ctypes.data),
                                    c_size_t(cells.size), c_size_t(times))

    def window(self, ranges, taps, capacity):
        """A window of frames like `taps`: a function that adds them so many times."""
        import numpy as np
        bench, tap = self._bench, taps.array
        bench.bench_window_size.restype = c_size_t
        shape = tap, ranges.ctypes.data_as(c_void_p), c_uint32(capacity)
        mem = np.zeros(bench.bench_window_size(*shape) // 8 + 1, np.int64)
        address = mem.ctypes.data_as(c_void_p)
        self._require(bench.bench_window_init(*shape, address, c_size_t(mem.nbytes)))

        def add(frames, _keep=(mem, ranges, taps)):
            self._require(bench.bench_window_add(address, tap, c_size_t(frames)))
        return add

    def emd_neuron_major(self, p, q, mass_p, mass_q):
        """Distance of counts laid out [neurons][bins]."""
        return self._bench.bench_emd_neuron_major(p.ctypes.data, q.ctypes.data, *p.shape, mass_p,
                                                  mass_q)

    def frechet(self, a, b):
        """Frechet distance of two sets of embeddings, float32 [frames][dim]."""
        distance = c_double()
        self._require(self._bench.vdna_frechet(
            a.ctypes.data_as(c_void_p), c_uint32(len(a)), b.ctypes.data_as(c_void_p),
            c_uint32(len(b)), c_uint32(a.shape[1]), byref(distance)))
        return distance.value

    def open_backbone(self, manifest, threads):
        """A network, ready to run."""
        return Backbone(self._bench, manifest, threads)

    def decoder(self):
        """A function that decodes the bytes of a JPEG."""
        bench, decoder = self._bench, c_void_p()
        self._require(bench.bench_decoder_open(byref(decoder)))
        return lambda jpeg: self._require(bench.bench_decode(decoder, jpeg, c_size_t(len(jpeg))))

    def preparation(self, side, reduced):
        """A function that makes the input of a network, side x side, of the bytes of a JPEG."""
        bench = self._bench
        bench.bench_preparation_open.restype = c_void_p
        preparation = c_void_p(bench.bench_preparation_open(c_uint32(side), c_uint32(reduced)))
        return lambda jpeg: self._require(bench.bench_prepare(preparation, jpeg,
                                                              c_size_t(len(jpeg))))

    def health(self, rgb, width, height):
        """Measure and judge a picture, bytes of packed RGB."""
        self._require(self._bench.bench_health(rgb, c_uint32(width), c_uint32(height)))

    @staticmethod
    def _require(status):
        if status != 0:
            raise RuntimeError(f"the library said {status}")


class Backbone:
    """A network of vdna/backbone.h."""

    def __init__(self, library, manifest, threads):
        self._library, self._handle = library, c_void_p()
        self._error, self._us = ctypes.create_string_buffer(512), (c_uint32 * 3)()
        self._require(library.bench_backbone_open(
            str(manifest).encode(), c_uint32(threads), self._error, byref(self._handle)))

    def run(self, data, width=0, height=0, pixelformat=0):
        """Run one picture: bytes of a file, or of packed pixels.

        returns: microseconds of decoding, resizing and inference"""
        self._require(self._library.bench_backbone_run(
            self._handle, data, c_size_t(len(data)), c_uint32(width), c_uint32(height),
            c_uint32(pixelformat), self._error, self._us))
        return tuple(self._us)

    def close(self):
        self._library.vdna_backbone_close(self._handle)

    def _require(self, status):
        if status != 0:
            raise RuntimeError(self._error.value.decode())


def import_package(build):
    """Import lib/python with the library of this build, as in its wheel."""
    folder = build / "test" / "bench" / "python"
    shutil.rmtree(folder, ignore_errors=True)
    package = folder / "libvdna"
    package.mkdir(parents=True)
    for source in (ROOT / "lib" / "python" / "src" / "libvdna").iterdir():
        (package / source.name).symlink_to(source)
    (package / "libvdna.so").symlink_to(build / "lib" / "libvdna.so")
    sys.path.insert(0, str(folder))
    sys.dont_write_bytecode = True
    import libvdna
    return libvdna
