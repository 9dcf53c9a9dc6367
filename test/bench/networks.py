"""The paper's networks with random weights, which are as fast as trained ones: ONNX and manifest.

    networks.py FOLDER NAME KIND CASE HEIGHT WIDTH

Runs in Debian's Python, which has onnx. The weights are those of the exporters' golden test.
"""
import contextlib
import io
import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(ROOT / "models"), str(ROOT / "test" / "golden")]
import export  # noqa: E402
from export_cases import tensor  # noqa: E402
from torch_file import Tensor  # noqa: E402


class Random(Tensor):
    """A tensor whose elements are made on demand."""

    def __init__(self, name, shape):
        self.name, self.shape = name, shape

    def array(self):
        return tensor(self.name, self.shape)


def main():
    folder, name, kind, case, height, width = sys.argv[1:]
    golden = json.loads((ROOT / "test" / "golden" / "export.json").read_text(encoding="utf-8"))
    checkpoint = {name: Random(name, tuple(map(int, shape.split())))
                  for name, shape in golden[case]["tensors"].items()}
    size = [] if kind == "vit" else ["--size", f"{height}x{width}"]
    options = export.parsed([kind, "random", folder, "--name", name, *size])
    network, _ = export.build(options, checkpoint)
    with contextlib.redirect_stdout(io.StringIO()):
        export.write(network, options, "random weights")


if __name__ == "__main__":
    main()
