"""Install the build into the folder STAGE once, for all tests of this ring, and move it there from
where it was installed: nothing may remember the prefix.

    stage.py CMAKE BUILD STAGE
"""

import shutil
import subprocess
import sys
from pathlib import Path

cmake, build, stage = sys.argv[1], sys.argv[2], Path(sys.argv[3])

subprocess.run([cmake, "--build", build, "--target", "amalgamation"], check=True)
first = stage.with_name("first-prefix")
for folder in (first, stage):
    shutil.rmtree(folder, ignore_errors=True)
subprocess.run([cmake, "--install", build, "--prefix", first], check=True)
first.rename(stage)
