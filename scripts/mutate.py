#!/usr/bin/env python3
"""Mutation test: one small fault at a time is put into a copy of the sources; the tests of the room have to notice.

    scripts/mutate.py [--count N] [--seed S] [--room NAME]... [--folder FOLDER] [--list]

What is changed: a sign, a factor or constant, a whole number, a shift, a comparison, an index of an axis, in the filter, the mechanization,
the estimation, the time scales and the decoders. The copy and its build are kept in FOLDER (build-mutation), so that a second call starts faster. A mutant
that does not compile does not count; one whose tests run ten times as long as usual counts as noticed. Survivors are printed as a diff.
"""
import argparse
import random
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# Room: its files, the test programs that are to notice.
ROOMS = {
    "ins": (["ins/**/*.cpp"], ["test_ins", "test_filter"]),
    "filter": (["filter/**/*.cpp"], ["test_filter", "test_fusion"]),
    "estim": (["estim/**/*.cpp", "estim/**/*.h"], ["test_estim", "test_filter"]),
    "core": (["core/time*.cpp", "core/time*.h"], ["test_core", "test_io"]),
    "gnss": (["gnss/**/*.cpp", "gnss/system_time.h"], ["test_gnss"]),
    "io": (["io/receiver/**/*.cpp", "io/receiver/**/*.h", "io/rinex/**/*.cpp", "io/container/**/*.cpp", "io/detail/*.h"], ["test_io"]),
}

CODE = r"(?<![\w.])(?<!\de[+-])"     # before a number: it is not the rest of a name or of another number


def half_more(text):
    return repr(1.5 * float(text))


def one_more(text):
    return str(int(text) + 1)


# What is looked for, and what comes in its place: a text, or a function of what was found.
CHANGES = [
    (re.compile(r"(?<=[\w\)\]] )\+(?= [\w\(])"), "-"),
    (re.compile(r"(?<=[\w\)\]] )-(?= [\w\(])"), "+"),
    (re.compile(r"(?<=[\w\)\]] )\+=(?= )"), "-="),
    (re.compile(r"(?<=[\w\)\]] )-=(?= )"), "+="),
    (re.compile(r"(?<=[\(=,] )-(?=[A-Za-z])|(?<=\()-(?=[A-Za-z])|(?<=return )-(?=[A-Za-z\(])"), ""),
    (re.compile(r"(?<=[\w\)\]] )\*(?= [\w\(])"), "/"),
    (re.compile(r"(?<=[\w\)\]] )/(?= [\w\(])"), "*"),
    (re.compile(r"(?<=[\w\)\]] )<(?= [\w\(])"), ">="),
    (re.compile(r"(?<=[\w\)\]] )>(?= [\w\(])"), "<="),
    (re.compile(r"(?<=[\w\)\]] )(?:<=)(?= [\w\(])"), ">"),
    (re.compile(r"(?<=[\w\)\]] )(?:>=)(?= [\w\(])"), "<"),
    (re.compile(r"(?<=[\w\)\]] )==(?= [\w\(])"), "!="),
    (re.compile(r"(?<=[\w\)\]] )!=(?= [\w\(])"), "=="),
    (re.compile(r"(?<=[\w\)\]] )<<(?= [\w\(])"), ">>"),
    (re.compile(r"(?<=[\w\)\]] )>>(?= [\w\(])"), "<<"),
    # constants: 2.0, 0.5, 1e-3 and 1.602e-19 times 1.5; whole numbers, 12 and 0x1F, one more
    (re.compile(CODE + r"(?:\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+)(?![\w.])"), half_more),
    (re.compile(CODE + r"(?:[2-9]|[1-9]\d+)(?![\w.'])"), one_more),
    (re.compile(CODE + r"0x[0-9A-Fa-f]+(?![\w.'])"), lambda text: hex(int(text, 16) + 1)),
    (re.compile(r"\.x\(\)"), ".y()"),
    (re.compile(r"\.y\(\)"), ".z()"),
    (re.compile(r"\.z\(\)"), ".x()"),
    (re.compile(r"(?<=[\w\)] )&&(?= [\w\(!])"), "||"),
    (re.compile(r"(?<=[\w\)] )\|\|(?= [\w\(!])"), "&&"),
]


def is_templates(code, match):
    """A shift or a comparison that is the end of template arguments, `Matrix<double, 3> a`."""
    return match.group() in ("<", ">", "<<", ">>") and re.search(r"[A-Za-z_]\w*<[^()]*$", code[:match.start()]) is not None


def sites(file):
    """(line number, changed line) of every place that can be changed; messages, comments and includes are left alone."""
    found = []
    for number, line in enumerate(file.read_text().splitlines()):
        code = line.split("//")[0]
        if '"' in code or code.lstrip().startswith(("#", "*", "static_assert", "template", "using")) or "throw" in code:
            continue
        for pattern, by in CHANGES:
            for match in pattern.finditer(code):
                replacement = by(match.group()) if callable(by) else by
                if replacement == match.group() or is_templates(code, match):
                    continue
                changed = code[:match.start()] + replacement + code[match.end():]
                found.append((number, changed + line[len(code):]))
    return found


def files_of(room, source=ROOT / "src/schuler"):
    """Its files; a pattern without any would let a folder that was renamed pass unseen."""
    files = set()
    for glob in ROOMS[room][0]:
        some = sorted(source.glob(glob))
        if not some:
            sys.exit(f"mutate: {room}: no file matches {glob}")
        files.update(some)
    return sorted(files)


def run(command, limit, **options):
    try:
        return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=limit, check=False, **options)
    except subprocess.TimeoutExpired:
        return None


class Copy:
    """The tree in which faults are put, and its build."""

    def __init__(self, folder):
        self.tree, self.build = folder / "tree", folder / "tree/build"
        self.tree.mkdir(parents=True, exist_ok=True)
        kept = set()
        for name in run(["git", "ls-files"], 60, cwd=ROOT).stdout.splitlines():
            source, target = ROOT / name, self.tree / name
            kept.add(target)
            if not source.is_file() or (target.is_file() and target.read_bytes() == source.read_bytes()):
                continue
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, target)
        configured = run(["cmake", "-S", str(self.tree), "-B", str(self.build), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DSCHULER_BENCH=OFF",
                          "-DSCHULER_WERROR=OFF", "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG"], 600)
        if configured is None or configured.returncode != 0:
            sys.exit(f"mutate: the copy cannot be configured:\n{configured.stdout if configured else 'too slow'}")

    def compile(self, programs):
        done = run(["cmake", "--build", str(self.build), "--target", *programs], 7200)
        return done is not None and done.returncode == 0

    def notices(self, programs, limits):
        """The first program whose tests fail, or nothing."""
        for program in programs:
            done = run([str(self.build / "tests" / program), "--gtest_fail_fast", "--gtest_brief=1", "--gtest_filter=-*Slow*:*RealData*"],
                       limits[program], cwd=self.build / "tests")
            if done is None or done.returncode != 0:
                return program
        return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--room", action="append", choices=sorted(ROOMS))
    parser.add_argument("--folder", type=Path, default=ROOT / "build-mutation")
    parser.add_argument("--list", action="store_true", help="only list how many places there are")
    asked = parser.parse_args()
    rooms = asked.room or sorted(ROOMS)

    places = [(room, file, number, changed) for room in rooms for file in files_of(room) for number, changed in sites(file)]
    if asked.list:
        print("\n".join(f"{room}: {sum(place[0] == room for place in places)} places" for room in rooms))
        return
    chosen = random.Random(asked.seed).sample(places, min(asked.count, len(places)))
    chosen.sort(key=lambda place: rooms.index(place[0]))   # fewer changes of what is to be linked
    copy = Copy(asked.folder)
    programs = sorted({program for room in rooms for program in ROOMS[room][1]})
    if not copy.compile(programs):
        sys.exit("mutate: the unchanged copy does not compile")
    limits = {}
    for program in programs:
        start = time.monotonic()
        if copy.notices([program], {program: 3600.0}):
            sys.exit(f"mutate: {program} fails without any change")
        limits[program] = 10.0 * (time.monotonic() - start) + 10.0

    killed, survivors, invalid = 0, [], 0
    for room, file, number, changed in chosen:
        target = copy.tree / file.relative_to(ROOT)
        original = target.read_text()
        lines = original.splitlines(keepends=True)
        before = lines[number]
        lines[number] = changed + "\n"
        target.write_text("".join(lines))
        try:
            if not copy.compile(ROOMS[room][1]):
                invalid += 1
            elif copy.notices(ROOMS[room][1], limits):
                killed += 1
            else:
                survivors.append((file.relative_to(ROOT), number + 1, before.strip(), changed.strip()))
                print(f"survived: {file.relative_to(ROOT)}:{number + 1}\n  - {before.strip()}\n  + {changed.strip()}", flush=True)
        finally:
            target.write_text(original)
    counted = killed + len(survivors)
    share = 100.0 * killed / counted if counted else 100.0
    print(f"mutants: {counted}, killed: {killed} ({share:.1f} %), survived: {len(survivors)}, did not compile: {invalid}")
    sys.exit(0 if share >= 95.0 else 1)


if __name__ == "__main__":
    main()
