"""What the tests of the package share: a simulated drive, made once a process, and the program."""
import functools
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import numpy  # noqa: F401
except ImportError:
    print("skipped: NumPy is not here")
    sys.exit(77)

SOURCE = Path(os.environ["SCHULER_SOURCE"])
PROGRAM = os.environ["SCHULER_PROGRAM"]
_folder = tempfile.TemporaryDirectory(prefix="schuler-test-")
FOLDER = Path(_folder.name)

def program(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=120, cwd=FOLDER)


@functools.cache
def drive():
    """Folder of the data set of a drive of two minutes."""
    folder = FOLDER / "drive"
    done = program("simulate", scenario(), "-o", folder)
    assert done.returncode == 0, done.stderr
    return folder


@functools.cache
def scenario():
    text = (SOURCE / "examples/demo.toml").read_text()
    lines = ["duration_s = 120" if line.startswith("duration_s") else line for line in text.split("\n")]
    path = FOLDER / "short.toml"
    path.write_text("\n".join(lines).replace("[[outage]]\nstart_s = 240", "[[outage]]\nstart_s = 90").replace("start_s = 420\nduration_s = 60", "start_s = 100\nduration_s = 10").replace("duration_s = 30\n", "duration_s = 5\n"))
    return path


def main():
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
