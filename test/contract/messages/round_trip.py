"""round_trip.py SAMPLES OUT: decode each sample, encode it again. The generated packages are in
$PYTHONPATH.
"""
import importlib
import sys
from pathlib import Path

SAMPLES, OUT = map(Path, sys.argv[1:])
for sample in SAMPLES.iterdir():
    package, name = sample.name.split(".")
    message = getattr(importlib.import_module(package), name).decode(sample.read_bytes())
    # An array of booleans that lcm-gen 1.3 decoded is an iterator.
    for member in message.__slots__:
        if isinstance(getattr(message, member), map):
            setattr(message, member, list(getattr(message, member)))
    (OUT / sample.name).write_bytes(message.encode())
