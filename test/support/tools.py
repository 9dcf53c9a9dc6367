"""Other languages' tools, for tests that run them: a missing one skips the test (exit code 77)."""

import hashlib
import re
import shutil
import subprocess
import sys

# What package managers say when they cannot reach their registry.
OFFLINE = re.compile(
    "NewConnectionError|Name or service not known|Temporary failure in name resolution"
    "|Network is unreachable|ConnectTimeout|Unknown host|Connect timed out|Connection refused"
)


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)


def require_tool(path, name, remedy="./dev test --all installs it"):
    """Skip the test if CMake has not found the tool."""
    if path.endswith("-NOTFOUND"):
        skip(f"no {name}; {remedy}")


def run(*command, fetches=False, **options):
    """Run a command to its end and give what it printed; its failure is ours."""
    command = [str(part) for part in command]
    done = subprocess.run(
        command, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False, **options
    )
    if done.returncode == 0:
        return done.stdout
    print(f"{' '.join(command)}\nexited with {done.returncode}\n{done.stdout}{done.stderr}")
    if fetches and OFFLINE.search(done.stdout + done.stderr):
        skip("a package is missing, and its registry cannot be reached")
    sys.exit(1)


def fresh(folder):
    """The folder, empty."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def virtual_environment(folder, *packages):
    """The programs of a virtual environment with these Python packages; made once."""
    stamp = folder / hashlib.sha256(" ".join(packages).encode()).hexdigest()
    if not stamp.exists():
        made = subprocess.run(
            [sys.executable, "-m", "venv", "--clear", folder],
            text=True,
            capture_output=True,
            check=False,
        )
        if made.returncode != 0:
            skip(
                f"cannot make a virtual environment; on Debian, install python3-venv\n{made.stdout}"
            )
        run(folder / "bin/pip", "install", "--quiet", *packages, fetches=True)
        stamp.touch()
    return folder / "bin"
