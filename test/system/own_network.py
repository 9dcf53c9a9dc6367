"""Runs the tests of a module one by one, each in a network namespace of its own.

Real LCM over UDP multicast then meets neither other tests nor the machine's network. It needs no
root. Where the system does not permit it, the tests are skipped (exit code 77).
"""
import os
import subprocess
import sys
import unittest

_INSIDE = "VDNA_TEST_INSIDE"
_SET_UP = 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"'


def _in_own_network(command):
    return ["unshare", "-rn", "sh", "-c", _SET_UP, "sh", *command]


def _refusal():
    """Why no namespace can be made; "" if one can."""
    try:
        result = subprocess.run(_in_own_network(["true"]), capture_output=True, text=True)
    except FileNotFoundError as error:
        return str(error)
    return result.stderr.strip() if result.returncode != 0 else ""


def _test_ids(suite):
    for entry in suite:
        if isinstance(entry, unittest.TestSuite):
            yield from _test_ids(entry)
        else:
            yield entry.id().removeprefix("__main__.")


def main(prepare):
    """Run the tests of the module that calls this. `prepare` makes what they share, once."""
    if os.environ.get(_INSIDE):
        unittest.main()
    # `ip` is not on every user's path.
    os.environ["PATH"] += ":/usr/sbin:/sbin"
    refusal = _refusal()
    if refusal:
        print(f"skipped: no network namespace here: {refusal}")
        sys.exit(77)
    prepare()
    names = sys.argv[1:] or list(
        _test_ids(unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"])))
    script = os.path.abspath(sys.modules["__main__"].__file__)
    failed = [name for name in names if subprocess.run(
        _in_own_network([sys.executable, script, "-v", name]),
        env={**os.environ, _INSIDE: "1"}).returncode != 0]
    for name in failed:
        print(f"FAILED {name}; run it again with: {sys.executable} {script} {name}")
    print(f"{len(names) - len(failed)} of {len(names)} passed")
    sys.exit(1 if failed else 0)
