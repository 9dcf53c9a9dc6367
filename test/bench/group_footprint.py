"""What a robot must have installed to choose with the default network, and the reference package's
memory: sizes, which no load of the machine changes."""
import importlib.metadata
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from bare import Bare, peak_bytes, runtime_of
from scene import NETWORKS
from selectord import Selectord

NETWORK = "efficientnet_lite0"
CANDIDATES = 3  # as in group_drive's decisions
MIB = 2 ** 20


def run(context):
    """All of the group."""
    manifest = context.scene.manifest(NETWORK)
    package = context.peers.package and context.peers.efficientnet
    yield sizes(f"installed, {NETWORK}", installed(context, manifest, package))
    yield sizes(f"memory, {NETWORK}", memory(context, manifest, package))


def sizes(name, found):
    """found: {program: bytes}, ours first"""
    (_, ours), *others = found.items()
    timed = {"median": ours, "least": ours, "most": ours, "rounds": 1, "waited": 0,
             "peers": {peer: {"median": theirs, "speedup": theirs / ours}
                       for peer, theirs in others}}
    return name, "MiB", 1 / MIB, timed, {}


def installed(context, manifest, package):
    """Programs, networks, and all shared libraries that they load, those of every system included;
    of the package all Python packages that it needs, without Python and CUDA."""
    settings = tomllib.loads(manifest.read_text(encoding="utf-8"))
    network = [manifest, manifest.parent / settings["model"], Path(runtime_of(context.build))]
    found = {"vdna": of_programs([context.build / "bin" / "vdna_selectord", *network]),
             "ONNX Runtime alone": of_programs([context.build / "test" / "bench" / "bare_onnx",
                                                *network])}
    if package:
        found["vdna package"] = of_distributions({"vdna", "efficientnet-lite-pytorch"})
    return found


def of_programs(files):
    """Bytes of files and of the libraries that they load, without debug information."""
    files = {file.resolve() for file in files}
    for file in list(files):
        listed = subprocess.run(["ldd", file], capture_output=True, text=True)
        files |= {Path(path).resolve() for path in re.findall(r"(/\S+) \(0x", listed.stdout)}
    return sum(stripped_bytes(file) for file in files)


def stripped_bytes(file):
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(shutil.copy(file, folder))
        subprocess.run(["strip", copy], capture_output=True)  # no program: stays as it is
        return copy.stat().st_size


def of_distributions(names):
    """Bytes of installed Python packages and of all that they need."""
    pending, known = set(names), {}
    while pending:
        name = re.sub(r"[-_.]+", "-", pending.pop()).lower()
        if name in known or re.match("nvidia|cuda|triton", name):
            continue
        try:
            known[name] = importlib.metadata.distribution(name)
        except importlib.metadata.PackageNotFoundError:
            continue  # only needed elsewhere
        pending |= {re.match(r"[\w.-]+", needed)[0] for needed in known[name].requires or []
                    if "extra ==" not in needed}
    files = {file.locate() for distribution in known.values() for file in distribution.files or []}
    return sum(file.stat().st_size for file in files
               if file.is_file() and not re.search("cuda|nvidia|cudnn", str(file)))


def memory(context, manifest, package):
    """Peaks: the daemon ready with a map, and the others after an inference."""
    with Selectord("--map", context.scene.map(manifest, CANDIDATES), "--backbone",
                   manifest) as daemon:
        found = {"vdna": sum(map(peak_bytes, daemon.pids))}
    with Bare(context.build, manifest) as bare:
        bare.run(1)
        found["ONNX Runtime alone"] = peak_bytes(bare.pid)
    if package:
        _, height, width = NETWORKS[NETWORK]
        done = subprocess.run(
            [sys.executable, Path(__file__).with_name("package.py"), NETWORK, str(height),
             str(width), *context.scene.pictures(3)], stdout=subprocess.PIPE, text=True, check=True)
        found["vdna package"] = int(done.stdout.split()[-1])
    return found
