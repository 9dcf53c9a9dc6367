"""Make once, for all tests of this suite: in STAGE/prefix a stripped installation, moved there from
where it was installed, for nothing may remember its prefix; in STAGE/debug the component `debug`;
in STAGE/debs the Debian packages, if they can be made here.

    stage.py CMAKE CPACK BUILD STAGE
"""

import shutil
import subprocess
import sys
from pathlib import Path

cmake, cpack, build, stage = *sys.argv[1:3], Path(sys.argv[3]), Path(sys.argv[4])

shutil.rmtree(stage, ignore_errors=True)
subprocess.run([cmake, "--build", build, "--target", "amalgamation"], check=True)
subprocess.run([cmake, "--install", build, "--strip", "--prefix", stage / "first"], check=True)
subprocess.run([cmake, "--install", build, "--component", "debug", "--prefix", stage / "debug"],
               check=True)
Path(stage, "first").rename(stage / "prefix")

settings = build / "CPackConfig.cmake"
if settings.exists():
    subprocess.run([cpack, "--config", settings, "-B", stage / "debs"], check=True)
