"""No two threads of the daemon access the same memory unsynchronised, as far as ThreadSanitizer sees.

Builds the preset `tsan` (the daemon and the stubs of test/support/stub), then runs those system tests
that make threads meet: reloads, signals, networks that hang or end. A report of ThreadSanitizer fails
them. Needs $VDNA_ALL, because it takes minutes. Environment: VDNA_BIN (folder of vdna).
"""

import os
import subprocess
import sys
from pathlib import Path

from selectord import grey_message, lcm_log
from tools import fresh, run, skip

ROOT = Path(__file__).resolve().parents[3]
BUILD = ROOT / "build" / "tsan"
STUBS = BUILD / "test" / "support" / "stub"
SYSTEM = ROOT / "test" / "system"
TESTS = {
    "test_reload.py": [],  # all
    "test_backbone_process.py": [
        "BackboneProcess.test_the_daemon_outlives_kills_and_stops_at_random_moments",
        "BackboneProcess.test_a_signal_during_a_hang_ends_both_at_once",
        "BackboneProcess.test_the_process_ends_with_the_daemon",
    ],
    "test_service_manager.py": [],
}


def programs(folder):
    """The daemon under ThreadSanitizer beside the other program as it is."""
    for name, place in (("vdna_selectord", BUILD / "bin"), ("vdna", Path(os.environ["VDNA_BIN"]))):
        (folder / name).symlink_to((place / name).resolve())
    return folder


def require_reports(work, environment):
    """A network that races a thread is reported, so that no report means something."""
    log, settings = work / "race.log", work / "race.toml"
    lcm_log(log, [("CAMERA", grey_message(0, b"race\0"))])
    settings.write_text("[camera]\nhealth = false\n[backbone]\nprocess = false\n")
    run(environment["VDNA_STUB_MAP"], work / "map", env=environment)
    daemon = [work / "bin/vdna_selectord", "-c", settings, "--map", work / "map", "--backbone",
              environment["VDNA_UNRULY_BACKBONE"], "--lcm-url", f"file://{log}"]  # fmt: skip
    done = subprocess.run(daemon, env={**environment, "TSAN_OPTIONS": f"log_path={work}/control"},
                          capture_output=True, text=True, check=False)  # fmt: skip
    if not any("count_up" in report.read_text() for report in work.glob("control.*")):
        sys.exit(f"a data race was not reported: exit {done.returncode}\n{done.stderr}")


def main():
    if "VDNA_ALL" not in os.environ:
        skip("builds the daemon once more; ./dev test --all does")
    run("cmake", "--preset", "tsan", cwd=ROOT)
    run("cmake", "--build", "--preset", "tsan", cwd=ROOT)
    work = fresh(Path("threads").resolve())
    environment = {
        **os.environ,
        "VDNA_BIN": str(programs(fresh(work / "bin"))),
        "VDNA_STUB_MAP": str(STUBS / "stub_map"),
        "VDNA_UNRULY_BACKBONE": str(STUBS / "libunruly_plugin.so"),
        "VDNA_SANITIZE": "thread",
        "TSAN_OPTIONS": f"log_path={work}/report atexit_sleep_ms=0",
    }
    require_reports(work, environment)
    failed = [name for name, tests in TESTS.items() if subprocess.run(
        [sys.executable, SYSTEM / name, *tests], env=environment, cwd=work, check=False
    ).returncode != 0]  # fmt: skip
    reports = sorted(work.glob("report.*"))
    for report in reports:
        print(report.read_text())
    print(f"{len(reports)} processes with reports; failed: {failed or 'none'}")
    return 1 if failed or reports else 0


if __name__ == "__main__":
    sys.exit(main())
