"""Each public header compiles alone: it is the first that its own source file includes, or it is compiled here, as many at a time
as there are processors.

    headers.py --source ROOT --work DIR --include DIRS -- COMPILER...  (DIRS: of third-party headers, separated by ;)
"""
import argparse
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

parser = argparse.ArgumentParser()
parser.add_argument("--source", type=Path, required=True)
parser.add_argument("--work", type=Path, required=True)
parser.add_argument("--include", default="")
parser.add_argument("compiler", nargs="+")
args = parser.parse_args()

include = args.source / "src"
public = [header.relative_to(include) for header in sorted(include.rglob("*.h")) if not {"detail", "inner"} & set(header.parts)]


def first_in_its_source(header):
    """The build has compiled it alone then."""
    source = (include / header).with_suffix(".cpp")
    includes = re.findall(r'^#include\s*([<"][^>"]+[>"])', source.read_text(), flags=re.M) if source.is_file() else []
    return includes[:1] == [f'"{header}"']


headers = [header for header in public if not first_in_its_source(header)]
args.work.mkdir(parents=True, exist_ok=True)


def compiles(header):
    # Compiled, not only parsed, so that a compiler cache can answer the next time.
    unit = args.work / (str(header).replace("/", "_") + ".cpp")
    text = f'#include "{header}"\n#include "{header}"\n'
    if not unit.is_file() or unit.read_text() != text:
        unit.write_text(text)
    third_party = [word for folder in filter(None, args.include.split(";")) for word in ("-isystem", folder)]
    command = [*args.compiler, "-std=c++20", "-O0", "-Wall", "-Wextra", "-Werror", "-I", str(include), *third_party, "-c", str(unit),
               "-o", str(unit.with_suffix(".o"))]
    done = subprocess.run(command, capture_output=True, text=True)
    return header, done.returncode, done.stderr


with ThreadPoolExecutor(os.cpu_count()) as pool:
    failed = [(header, text) for header, status, text in pool.map(compiles, headers) if status != 0]
for header, text in failed:
    print(f"{header} does not compile alone:\n{text}")
print(f"{len(public)} headers, {len(headers)} compiled here, {len(failed)} do not compile alone")
sys.exit(1 if failed or not public else 0)
