#!/usr/bin/env python3
"""Records what the program writes, and compares two records byte by byte: before and after a change that may not alter a result.

    recorded_outputs.py record FOLDER --schuler build/bin/schuler [--data FOLDER] [--only TEXT]
    recorded_outputs.py compare BEFORE AFTER [--figures]

`record` runs every example, all studies, conversions, an item of each paper, and `process`, `inspect` and `ahrs` on one simulated drive, and with --data every data set of a
folder; standard output and exit status of each are files of the record, too. `compare` leaves out only the time taken, the version, the
folder and the marks that the program puts beside its files; it names every file that differs and the first line that does, with --figures
also the greatest difference of each column of a table. The exit status is 0 where nothing differs, or else 1.
"""
import argparse
import csv
import filecmp
import math
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TABLES = "solution,summary,config,kml,states"
# What two runs of one program do not have in common.
FLEETING = re.compile(rb'"timing": ?\{[^}]*\}|"(?:version|commit|started|finished|filter_s)": ?[^,}\n]*|\([0-9.]+ s\)|^read [0-9.]+ s, .*$', re.MULTILINE)


def commands(data):
    """Name and arguments of each; the drive of `simulate` comes first, since others read it."""
    examples = ROOT / "examples"
    yield "simulate", ["simulate", examples / "demo.toml", "-o", "drive"]
    drive = "../simulate/drive"
    for scenario in sorted(examples.glob("*.toml")):
        yield f"run-{scenario.stem}", ["run", scenario, "-o", "out", "--outputs", TABLES]
    for coupling in ("loose", "separate", "gnss"):   # the separate scheme has no smoother
        more = ["--set", "filter.smooth=false"] if coupling == "separate" else []
        yield f"process-{coupling}", ["process", drive, "-o", "out", "--scheme", coupling, "--outputs", TABLES, *more]
    yield "process-smooth", ["process", drive, "-o", "out", "--smooth", "--backward", "--outputs", TABLES]
    yield "process-outage", ["process", drive, "-o", "out", "--outage", "100:30", "--mechanization", "ecef", "--outputs", TABLES]
    yield "process-open", ["process", drive, "-o", "out", "--loop", "open", "--outputs", TABLES]
    yield "inspect", ["inspect", drive]
    yield "inspect-json", ["inspect", drive, "--json"]
    yield "ahrs", ["ahrs", drive, "-o", "out"]
    yield "montecarlo", ["montecarlo", examples / "static.toml", "-n", "4", "-o", "out"]
    yield "analyze-requirements", ["analyze", "requirements"]
    yield "analyze-budget", ["analyze", "budget", examples / "static.toml", "-n", "2"]
    yield "analyze-covariance", ["analyze", "covariance", examples / "paper-a-flight.toml"]
    yield "analyze-integrity", ["analyze", "integrity", examples / "approach.toml", "-n", "1"]
    yield "analyze-observability", ["analyze", "observability"]
    yield "analyze-observability-path", ["analyze", "observability", examples / "demo.toml"]
    yield "analyze-equator", ["analyze", "equator"]
    yield "analyze-schuler", ["analyze", "schuler"]
    yield "analyze-allan", ["analyze", "allan", f"{drive}/imu.csv"]
    yield "analyze-triad", ["analyze", "triad", "-n", "1"]
    yield "analyze-protection", ["analyze", "protection", "-n", "2"]
    yield "batch", ["batch", drive, "-o", "out", "--outputs", TABLES]
    yield "gravity", ["gravity", examples / "gravity-step.toml", "-o", "out"]
    yield "gravity-runs", ["gravity", examples / "gravity-step.toml", "--runs", "2", "-o", "out"]
    yield "simulate-ranges", ["simulate", examples / "triad-4sv.toml", "-o", "out"]
    yield "replay", ["replay", drive, "--to", "stdout", "--speed", "0", "--stop", "30"]
    for extension in ("gpx", "kml", "geojson", "tum", "sbet", "pos", "nmea"):
        yield f"convert-{extension}", ["convert", f"{drive}/reference.csv", f"out.{extension}"]
    yield "evaluate", ["evaluate", f"{drive}/reference.csv", f"{drive}/reference.csv"]
    for paper, item in (("A", "table-1.4.2"), ("B", "all"), ("C", "all"), ("D", "figure-2"), ("E", "figure-7")):
        yield f"paper-{paper}", ["paper", paper, item, "-o", "out", "-n", "2"]
    yield "receiver", ["receiver", "generate", "sky.ibyte", "--seconds", "0.1"]
    for topic in ("--reference", "settings", "formats"):
        yield f"help-{topic.strip('-')}", ["help", topic]
    for folder in sorted(p for p in data.iterdir() if p.is_dir()) if data else ():
        yield f"inspect-{folder.name}", ["inspect", folder]
        kind = "ahrs" if folder.name.startswith("broad") else "process"
        yield f"{kind}-{folder.name}", [kind, folder, "-o", "out"] + (["--outputs", TABLES] if kind == "process" else [])
        if kind == "process":
            yield f"gnss-{folder.name}", ["gnss", folder, "-o", "out"]   # of those with raw measurements; the others are refused


def record(args):
    program = str(Path(args.schuler).resolve())
    folder = Path(args.folder)
    if folder.exists() and any(folder.iterdir()):
        sys.exit(f"{folder} is not empty")
    data = Path(args.data).resolve() if args.data else None

    def carry_out(item):
        name, arguments = item
        place = folder / name
        place.mkdir(parents=True)
        done = subprocess.run([program, *map(str, arguments)], cwd=place, capture_output=True, text=True, errors="replace", timeout=1800)
        (place / "stdout.txt").write_text(done.stdout)
        (place / "stderr.txt").write_text(done.stderr)
        (place / "status.txt").write_text(f"{done.returncode}\n")
        print(f"{name}: exit {done.returncode}", flush=True)

    wanted = [c for c in commands(data) if not args.only or args.only in c[0] or c[0] == "simulate"]
    carry_out(wanted[0])
    with ThreadPoolExecutor(args.jobs) as pool:
        list(pool.map(carry_out, wanted[1:]))


def steady(path, folder):
    return FLEETING.sub(b"", path.read_bytes().replace(str(folder.resolve()).encode(), b""))


def first_line(before, after):
    for number, (a, b) in enumerate(zip(before.splitlines(), after.splitlines()), 1):
        if a != b:
            return f"line {number}: {a[:100].decode(errors='replace')} | {b[:100].decode(errors='replace')}"
    return "one is the beginning of the other"


def figures(before, after):
    """Greatest difference of each column of two tables with the same header and number of rows."""
    with open(before, newline="") as a, open(after, newline="") as b:
        rows = [list(csv.reader(a)), list(csv.reader(b))]
    if not rows[0] or rows[0][0] != rows[1][0] or len(rows[0]) != len(rows[1]):
        return [f"{len(rows[0]) - 1} and {len(rows[1]) - 1} rows"]
    most = {}
    for a, b in zip(rows[0][1:], rows[1][1:]):
        for name, x, y in zip(rows[0][0], a, b):
            if x == y:
                continue
            try:
                most[name] = max(most.get(name, 0.0), abs(float(x) - float(y)))
            except ValueError:
                most[name] = math.inf
    return [f"{name} {value:.3g}" for name, value in most.items()]


def compare(args):
    before, after = Path(args.before), Path(args.after)
    files = [{p.relative_to(f): p for p in f.rglob("*") if p.is_file() and p.name != ".schuler"} for f in (before, after)]
    if not files[0]:
        sys.exit(f"{before} has no files")
    differing = 0
    for name in sorted(files[0].keys() | files[1].keys()):
        if name not in files[0] or name not in files[1]:
            print(f"{name}: only {'after' if name in files[1] else 'before'}")
            differing += 1
            continue
        a, b = files[0][name], files[1][name]
        if filecmp.cmp(a, b, shallow=False):
            continue
        old, new = steady(a, before), steady(b, after)
        if old == new:
            continue
        differing += 1
        print(f"{name}: {first_line(old, new)}")
        if args.figures and name.suffix == ".csv":
            print("    " + ", ".join(figures(a, b)))
    print(f"{differing} of {len(files[0].keys() | files[1].keys())} files differ")
    return 1 if differing else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    doing = parser.add_subparsers(dest="doing", required=True)
    to_record = doing.add_parser("record")
    to_record.add_argument("folder")
    to_record.add_argument("--schuler", required=True)
    to_record.add_argument("--data", help="folder of data sets, each processed as it is")
    to_record.add_argument("--only", help="only commands whose name contains this")
    to_record.add_argument("--jobs", type=int, default=2)
    to_compare = doing.add_parser("compare")
    to_compare.add_argument("before")
    to_compare.add_argument("after")
    to_compare.add_argument("--figures", action="store_true", help="how much each column of a table differs")
    args = parser.parse_args()
    return record(args) if args.doing == "record" else compare(args)


if __name__ == "__main__":
    sys.exit(main())
