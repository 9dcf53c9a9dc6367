"""Network namespaces for tests: real LCM over UDP multicast, isolated from other tests and from the
machine's network. No root needed; if the system does not permit namespaces, the tests are skipped
(exit code 77).
"""
import os
import shlex
import subprocess
import sys
import unittest

_INSIDE = "VDNA_TEST_INSIDE"
_SET_UP = 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"'


def _in_own_network(command):
    return ["unshare", "-rn", "sh", "-c", _SET_UP, "sh", *command]


def _require_permission():
    """Exit with 77 if no namespace can be made."""
    os.environ["PATH"] += ":/usr/sbin:/sbin"  # `ip` is not on every user's path
    try:
        result = subprocess.run(_in_own_network(["true"]), capture_output=True, text=True)
        refusal = result.stderr.strip() if result.returncode != 0 else ""
    except FileNotFoundError as error:
        refusal = str(error)
    if refusal:
        print(f"skipped: no network namespace here: {refusal}")
        sys.exit(77)


def enter():
    """Restart the script in its own namespace, unless it is already in one."""
    if os.environ.get(_INSIDE):
        return
    _require_permission()
    os.environ[_INSIDE] = "1"
    command = _in_own_network([sys.executable, *sys.argv])
    sys.stdout.flush()
    os.execvp(command[0], command)


def _test_ids(suite):
    for entry in suite:
        if isinstance(entry, unittest.TestSuite):
            yield from _test_ids(entry)
        else:
            yield entry.id().removeprefix("__main__.")


def run_tests_apart(prepare):
    """Run the tests named on the command line, or all tests of the calling script, each in its own
    namespace. `prepare` makes their shared data, once."""
    if os.environ.get(_INSIDE):
        unittest.main()
    _require_permission()
    prepare()
    script = os.path.abspath(sys.argv[0])
    names = sys.argv[1:] or list(
        _test_ids(unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"])))
    failed = [name for name in names if subprocess.run(
        _in_own_network([sys.executable, script, "-v", name]),
        env={**os.environ, _INSIDE: "1"}).returncode != 0]
    settings = " ".join(f"{name}={shlex.quote(value)}" for name, value in os.environ.items()
                        if name.startswith("VDNA_"))
    for name in failed:
        print(f"FAILED {name}; run it again with: {settings} {sys.executable} {script} {name}")
    print(f"{len(names) - len(failed)} of {len(names)} passed")
    sys.exit(1 if failed else 0)
