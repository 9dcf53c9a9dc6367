"""Write the manifest that tells vdna how to feed a network and what to read from it."""
import json
import math

from graph import NEURONS_SAMPLES

TEMPLATE = """\
name = {name}
model = {model} # relative to this file
sha256 = "{sha256}"
source = {source}
licence = {licence}

[input]
name = "image"
width = {width}
height = {height}
colour = "RGB"
mean = [123.675, 116.28, 103.53] # of ImageNet, in grey levels 0..255
std = [58.395, 57.12, 57.375]
resize = "stretch" # the whole picture to width x height
interpolation = "area"

[embedding]
output = "embedding"
l2_normalise = false

# Each tap adds its neurons to the histograms; a tap that begins with # is not used.
{taps}"""


def quoted(text):
    """A TOML string; JSON and TOML escape alike."""
    return json.dumps(text, ensure_ascii=False)


def tap_section(name, shape, layout, is_used):
    neurons, samples = shape[-1], math.prod(shape[:-1])
    if layout == NEURONS_SAMPLES:
        neurons, samples = shape[0], math.prod(shape[1:])
    lines = ["[[taps]]",
             f"output = {quoted(name)} # neurons: {neurons}, samples of each: {samples}",
             f"layout = {quoted(layout)}"]
    return "".join(f"{'' if is_used else '#'}{line}\n" for line in lines)


def manifest(network, used_tap, sha256, **texts):
    """Return the manifest of a Graph; `texts` are name, model, source and licence."""
    height, width = network.size
    taps = "\n".join(tap_section(name, shape, layout, name == used_tap)
                     for name, (shape, layout) in network.outputs.items())
    return TEMPLATE.format(sha256=sha256, width=width, height=height, taps=taps,
                           **{key: quoted(text) for key, text in texts.items()})
