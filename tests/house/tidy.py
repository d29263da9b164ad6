#!/usr/bin/env python3
"""clang-tidy on the lines that the last commit changed: tidy.py --source FOLDER --build FOLDER [--since COMMIT] [--seconds N]

The checks are those of .clang-tidy but for the static analyzer, which takes ten minutes for some files. Exit 77 (skipped), with the reason, where there is nothing to compare with, or where the files are too many
for the time; `--itself` shows that a mistake is found.
"""
import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

TIDY, DIFF, SKIPPED = "clang-tidy-16", "clang-tidy-diff-16.py", 77
NOISE = ("warnings generated", "Suppressed ", "Use -header-filter", "No relevant changes")


def skip(why):
    print(f"skipped: {why}")
    sys.exit(SKIPPED)


def git(source, *arguments):
    done = subprocess.run(["git", "-C", str(source), *arguments], capture_output=True, text=True, check=False)
    return done.stdout if done.returncode == 0 else None


def findings(source, build, since, seconds):
    """The lines of the tool that name a finding in a changed line; None if the time was not enough."""
    changes = git(source, "diff", "-U0", "--no-color", since, "--", "src")
    if not changes:
        return []
    command = [DIFF, "-clang-tidy-binary", TIDY, "-p1", "-path", str(build), "-quiet", "-j", "2", "-checks=-clang-analyzer-*"]
    with subprocess.Popen(command, cwd=source, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          start_new_session=True) as done:
        try:
            said, _ = done.communicate(changes, timeout=seconds)
        except subprocess.TimeoutExpired:
            os.killpg(done.pid, signal.SIGKILL)  # the tool's children too
            return None
    lines = [line for line in said.splitlines() if line.strip() and not any(n in line for n in NOISE)]
    return lines if done.returncode != 0 or any(": warning: " in line or ": error: " in line for line in lines) else []


def itself(source):
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "src").mkdir()
        shutil.copy(source / ".clang-tidy", place)
        (place / "compile_commands.json").write_text(
            json.dumps([{"directory": folder, "command": "c++ -std=c++20 -c src/a.cpp", "file": "src/a.cpp"}]))
        name = ("-c", "user.name=test", "-c", "user.email=test@example.org")

        def commit(text):
            (place / "src/a.cpp").write_text(text)
            for step in (("init", "-q"), ("add", "-A"), (*name, "commit", "-qm", "x")):
                if git(place, *step) is None:
                    skip("git does not commit here")

        old = "int* old = 0;\n"
        commit(old)
        commit(old + "int f() { return 1; }\n")
        clean = findings(place, place, "HEAD~1", 120)
        assert clean == [], clean  # the old mistake is on no changed line
        commit(old + "int f() { return 1; }\nint* fresh = 0;\n")
        wrong = findings(place, place, "HEAD~1", 120)
        assert wrong is not None and any("src/a.cpp:3:" in line and "modernize-use-nullptr" in line for line in wrong), wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--source", type=Path, required=True)
    parser.add_argument("--build", type=Path)
    parser.add_argument("--since", default="HEAD~1")
    parser.add_argument("--seconds", type=float, default=240.0)
    parser.add_argument("--itself", action="store_true")
    given = parser.parse_args()
    for program in ("git", TIDY, DIFF):
        if shutil.which(program) is None:
            skip(f"{program} is not installed")
    if given.itself:
        return itself(given.source)
    if git(given.source, "rev-parse", "--verify", "-q", given.since + "^{commit}") is None:
        skip(f"there is no commit {given.since}")
    if not (given.build / "compile_commands.json").is_file():
        skip("the build has no compile_commands.json")
    found = findings(given.source, given.build, given.since, given.seconds)
    if found is None:
        skip(f"not finished in {given.seconds:.0f} s: run it by hand, with --seconds")
    print("\n".join(found) if found else "no findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
