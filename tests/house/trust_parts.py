"""scripts/trust runs every part of its list and makes a row of each, also of those that succeed. The tools are stand-ins that do nothing.

    trust_parts.py ROOT
"""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

root = Path(sys.argv[1])
failures = []

STAND_INS = {
    "cmake": "exit 0",
    "ctest": "echo '100% tests passed, 0 tests failed out of 7'",
    "cppcheck": "exit 0",
    "gcc": "exit 0",
    "git": "echo src/a.cpp",
    "scripts/coverage.sh": "echo '| all | 1000 | 98.5 | 500 | 92.5 |'",
    "scripts/embedded.sh": "exit 0",
    "scripts/mutate.py": "echo 'mutants: 200, killed: 192 (96.0 %), survived: 8, did not compile: 3'",
    "build/tests/test_filter": "exit 0",
    "build-asan/tests/fuzz/fuzz_csv": "echo 'stat::number_of_executed_units: 5'",
}


def put(folder, name, text):
    path = folder / name if "/" in name else folder / "bin" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)


def trust(*parts, **other):
    """Exit status, rows of the table, what was said."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for tool, text in {**STAND_INS, **other}.items():
            put(folder, tool, text)
        script = folder / "scripts/trust"
        script.write_bytes((root / "scripts/trust").read_bytes())
        script.chmod(0o755)
        for log in ("build-plain.log", "build-analysis.log"):
            (folder / log).write_text("[1/1] Building CXX object a.o\n")
        done = subprocess.run([script, *parts], capture_output=True, text=True, check=False, timeout=60,
                              env={**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}"})
        return done.returncode, [line for line in done.stdout.splitlines() if line.startswith("| ")][1:], done.stdout + done.stderr


def check(true, text):
    if not true:
        failures.append(text)


status, _, said = trust("--list")
listed = said.split()
check(status == 0 and {"plain", "sanitizers", "threads", "fuzz", "month", "coverage", "mutation"} <= set(listed), f"--list: {said}")
for part in listed:
    status, rows, said = trust(part)
    check(status == 0 and rows, f"{part}: exit status {status}, {said}")
    for row in rows:
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        check(len(cells) == 5 and all(cells) and cells[2] == "0", f"{part}: a row without figures: {row}")
status, rows, said = trust()
check(status == 0 and len(rows) >= len(listed), f"without arguments: exit status {status}, {len(rows)} rows: {said}")
status, _, said = trust("plain", "nonsense")
check(status == 2 and "nonsense" in said, f"an unknown part: exit status {status}, {said}")
# A part that fails is seen in the status and in its row.
for part, stand_ins in (("mutation", {"scripts/mutate.py": "echo 'mutants: 200, killed: 188 (94.0 %), survived: 12, did not compile: 3'; exit 1"}),
                        ("coverage", {"scripts/coverage.sh": "exit 1"}), ("embedded", {"scripts/embedded.sh": "exit 1"}),
                        ("analysis", {"cppcheck": "echo 'a.cpp:1: zerodiv: Division by zero' >&2"}), ("attacks", {"ctest": "echo '50% tests passed, 1 tests failed out of 2'"}),
                        ("sanitizers", {"cmake": "exit 1"}), ("month", {"build/tests/test_filter": "exit 1"})):
    status, rows, said = trust(part, **stand_ins)
    check(status == 1 and rows, f"{part} fails and nobody says so: exit status {status}, {said}")
print("\n".join(failures) or f"{len(listed)} parts")
sys.exit(1 if failures else 0)
