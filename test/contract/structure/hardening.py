"""hardening.py READELF PROGRAM [stack] [buffers]: what an attacker finds in an executable.

Its addresses differ from run to run (PIE); what the linker filled in cannot be changed (full RELRO:
GNU_RELRO and BIND_NOW); no memory is both written and executed; a function's return address is
checked (`stack`), and so are the sizes of buffers (`buffers`), as calls of libc tell.
"""
import re
import subprocess
import sys


def main(readelf, program, *checks):
    def read(*options):
        return subprocess.run([readelf, "--wide", *options, program], check=True,
                              capture_output=True, text=True).stdout

    headers, dynamic = read("--file-header", "--program-headers"), read("--dynamic")
    called = set(re.findall(r" UND (\w+)", read("--dyn-syms")))
    segments = dict(re.findall(r"^  (\w+) +0x.* ([RWE ]{3}) 0x\w+$", headers, re.M))
    loaded = re.findall(r"^  LOAD +0x.* ([RWE ]{3}) 0x\w+$", headers, re.M)
    expected = {
        "position-independent": re.search(r"Type: +DYN", headers) and "Flags: " in dynamic
                                and re.search(r"FLAGS_1.*\bPIE\b", dynamic),
        "relocated read-only": "GNU_RELRO" in segments,
        "bound at the start": re.search(r"BIND_NOW|FLAGS_1.*\bNOW\b", dynamic),
        "stack not executable": "E" not in segments.get("GNU_STACK", "E"),
        "nothing writable and executable": loaded and not any(
            "W" in flags and "E" in flags for flags in loaded),
        "stack protected": "stack" not in checks or "__stack_chk_fail" in called,
        "buffers checked": "buffers" not in checks or any(
            re.fullmatch(r"__\w+_chk", name) for name in called),
    }
    missing = [name for name, found in expected.items() if not found]
    if missing:
        sys.exit(f"{program}: not {', not '.join(missing)}; see vdna_program() in "
                 "lib/cmake/BuildFlags.cmake")


if __name__ == "__main__":
    main(*sys.argv[1:])
