"""The examples examples/consumer and examples/embed build and run against an installed Schuler, as a user of find_package(schuler) would.

    consumer.py --source ROOT --build BUILD_DIR --cmake CMAKE --compiler CXX
"""
import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

parser = argparse.ArgumentParser()
parser.add_argument("--source", type=Path, required=True)
parser.add_argument("--build", type=Path, required=True)
parser.add_argument("--cmake", required=True)
parser.add_argument("--compiler", required=True)
args = parser.parse_args()


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


with tempfile.TemporaryDirectory() as folder:
    prefix, build = Path(folder, "prefix"), Path(folder, "build")
    run(args.cmake, "--install", args.build, "--prefix", prefix, "--component", "development")
    # Without -march: what was compiled for this processor must work for a user who did not ask for it.
    for example in ("consumer", "embed"):
        run(args.cmake, "-S", args.source / "examples" / example, "-B", build / example, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
            f"-DCMAKE_PREFIX_PATH={prefix}", f"-DCMAKE_CXX_COMPILER={args.compiler}")
        run(args.cmake, "--build", build / example)
    text = run(build / "consumer" / "consumer")
    print(text)
    # A body at rest levels to the attitude the example gave it, and stays at rest to rounding.
    found = re.fullmatch(r"roll 2\.000 pitch -1\.000 deg; after 1 s at rest: (\S+) m/s\n", text)
    if not found or not float(found.group(1)) < 1e-6:
        sys.exit("the example does not find the attitude and the rest that it was given")
    # A car that stands, then drives, finds its heading while it is on its way, and knows how far off it is.
    text = run(build / "embed" / "embed")
    print(text)
    found = re.search(r"phase 6\n.*: (\S+) m off, by its own account (\S+) m\n", text, re.S)
    if not found or not float(found.group(1)) < 4.0 * float(found.group(2)) < 20.0:
        sys.exit("the embedded navigator does not find its way")
