"""The commands and programs of docs/reference/SPEC-lcm.md, word for word."""

import os
import re
from pathlib import Path

from tools import run

SOURCE = Path(__file__).resolve().parents[3]
PAGE = SOURCE / "docs/reference/SPEC-lcm.md"
# Of Debian's liblcm-java.
LCM_JAR = Path("/usr/share/java/lcm.jar")


def section(heading):
    page = PAGE.read_text(encoding="utf-8")
    (text,) = re.findall(rf"^## {re.escape(heading)}\n(.*?)(?=^## |\Z)", page, re.M | re.S)
    return text


def commands(heading):
    """The blocks of shell commands of a section, in order."""
    return re.findall(r"^```sh\n(.*?)^```$", section(heading), re.M | re.S)


def program(heading):
    """The name that a section gives its program, and the program."""
    found = re.findall(r"^`(\S+)`:\n\n```\S+\n(.*?)^```$", section(heading), re.M | re.S)
    ((name, text),) = found
    return name, text


def in_a_checkout(folder):
    """The folder, as the root of the project to these commands."""
    (folder / "build").mkdir()
    (folder / "lcmtypes").symlink_to(SOURCE / "lcmtypes")
    return folder


def with_path(folder):
    """The environment in which the programs of a folder come first."""
    return {**os.environ, "PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"}


def shell(block, folder, environment):
    return run("sh", "-euc", block, cwd=folder, env=environment, fetches=True)


def build_jar(folder, environment):
    """The JAR that shows lcm-spy our types."""
    (block,) = commands("Record, replay, look")
    shell(block, folder, environment)
    return folder / "build/vdna_lcmtypes.jar"
