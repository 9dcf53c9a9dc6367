"""The network of tiny_network.onnx with a manifest, for tests that need a network and not its answers."""

import hashlib
import shutil
from pathlib import Path

MODEL = Path(__file__).with_name("tiny_network.onnx")
SHA256 = hashlib.sha256(MODEL.read_bytes()).hexdigest()

MANIFEST = """name = "tiny"
model = "tiny_network.onnx"
sha256 = "{sha256}"
source = "test/support"
licence = "MIT"

[input]
name = "image"
width = 2
height = 2
colour = "RGB"
mean = [0, 0, 0]
std = [1, 1, 1]
resize = "stretch"
interpolation = "area"
{taps}
[embedding]
output = "mean"
l2_normalise = false
"""


def write_tiny_network(folder, *taps):
    """Write the network into a folder; taps: (output, layout) of each. Returns the manifest's path."""
    folder = Path(folder)
    shutil.copy(MODEL, folder)
    manifest = folder / "tiny.toml"
    manifest.write_text(MANIFEST.format(sha256=SHA256, taps="".join(
        f'\n[[taps]]\noutput = "{output}"\nlayout = "{layout}"\n' for output, layout in taps)),
        encoding="ascii")
    return manifest
