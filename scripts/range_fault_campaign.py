#!/usr/bin/env python3
"""Faults in the range of one satellite, with the test over time: does the solution stay inside its sigmas?

    range_fault_campaign.py --schuler build/bin/schuler [--scenario examples/triad-all.toml] [--satellites G05,G13,...] [--seeds 5] [--jobs 2]

Each fault, ramps of range and rate together, ramps of the range alone, and steps, is put into the range of each satellite from 200 to 600 s.
A line a fault over satellites and seeds, from 100 s on: RMS and largest error of the position, RMS of its stated sigma, NEES over its
degrees of freedom (1 expected; from the three sigmas), share of the epochs with north, east and down inside three sigma, that share and
those told by a warning, runs that name the right source, runs that name another one, time from the fault to the first alarm. The first
line is without a fault. The table in docs/triad.md.
"""
import argparse
import csv
import math
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from campaign.runs import FIELDS, SIGMAS, Track, position_error

FAULTS = [("none", 0.0), *(("ramp", x) for x in (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)), *(("range ramp", x) for x in (0.2, 1.0)), ("step", 50.0),
          ("step", 300.0)]
START, DURATION, SETTLED = 200.0, 400.0, 100.0


def fault_text(kind, size, satellite):
    offset, ramp, rate = (size, 0.0, 0.0) if kind == "step" else (0.0, size, -size if kind == "range ramp" else 0.0)
    return (f"\n[[ranges.fault]]\nsource = \"{satellite}\"\nstart_s = {START}\nduration_s = {DURATION}\noffset_m = {offset}\n"
            f"ramp_m_s = {ramp}\nrate_m_s = {rate}\n")


def alarms_of(path):
    with open(path, encoding="utf-8", newline="") as file:
        return [(float(row["time_s"]), row["alarm"]) for row in csv.DictReader(file) if row["alarm"]]


def run(program, scenario, kind, size, satellite, seed, watch):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = scenario.read_text(encoding="utf-8")
        if kind != "none":
            text += fault_text(kind, size, satellite)
        (folder / "scenario.toml").write_text(text, encoding="utf-8")
        done = subprocess.run([str(program), "run", str(folder / "scenario.toml"), "--seed", str(seed), "-o", str(folder / "out"), "-q",
                               "--set", f"filter.protection.use={'true' if watch else 'false'}", "--outputs", "solution,summary",
                               "--output-rate", "1"], capture_output=True, text=True, check=False)
        solution = next(folder.glob("out/**/solution.csv"), None)
        if solution is None:
            sys.exit(f"{kind} {size:g} {satellite} seed {seed}: no solution: {done.stderr.strip()}")
        truth = Track.read(next(p for p in folder.glob("out/**/reference.csv")), FIELDS)
        rows = Track.read(solution, FIELDS + SIGMAS).rows
        protection = next(folder.glob("out/**/protection.csv"), None)
        return judged(rows, truth, alarms_of(protection) if protection else [], satellite)


def judged(rows, truth, alarms, satellite):
    start = truth.times[0]
    epochs = []
    for row in rows:
        if row["time_s"] - start < SETTLED:
            continue
        at = truth.at(row["time_s"])
        if at is None:
            continue
        error = position_error(row, at)
        sigma = [row[name] for name in SIGMAS[:3]]
        epochs.append((sum(e * e for e in error), sum(s * s for s in sigma), sum((e / s) ** 2 for e, s in zip(error, sigma)) / 3.0,
                       all(abs(e) < 3.0 * s for e, s in zip(error, sigma))))
    during = [(t - start, name) for t, name in alarms if t - start >= START]
    return {"epochs": epochs, "right": any(name == satellite for _, name in during),
            "wrong": any(name != satellite for _, name in alarms), "time": next((t - START for t, _ in during), None)}


def line(kind, size, runs):
    epochs = [e for r in runs for e in r["epochs"]]
    n = len(epochs)
    times = sorted(r["time"] for r in runs if r["time"] is not None)
    what = kind if kind == "none" else f"{kind} {size:g} {'m' if kind == 'step' else 'm/s'}"
    return (f"| {what} | {math.sqrt(sum(e[0] for e in epochs) / n):.1f} | {math.sqrt(max(e[0] for e in epochs)):.1f} "
            f"| {math.sqrt(sum(e[1] for e in epochs) / n):.1f} | {sum(e[2] for e in epochs) / n:.2f} "
            f"| {100.0 * sum(e[3] for e in epochs) / n:.1f} % | {sum(r['right'] for r in runs)} of {len(runs)} "
            f"| {sum(r['wrong'] for r in runs)} | {f'{times[len(times) // 2]:.0f}' if times else '-'} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--schuler", type=Path, required=True)
    parser.add_argument("--scenario", type=Path, default=Path("examples/triad-all.toml"))
    parser.add_argument("--satellites", default="G05,G10,G13")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--without", action="store_true", help="without the test over time")
    args = parser.parse_args()
    print("| fault | RMS error, m | largest, m | sigma, m | NEES | inside 3 sigma | right source named | another named | to alarm, s |\n"
          "|---|---|---|---|---|---|---|---|---|")
    with ThreadPoolExecutor(args.jobs) as pool:
        for kind, size in FAULTS:
            satellites = args.satellites.split(",") if kind != "none" else ["-"]
            jobs = [pool.submit(run, args.schuler, args.scenario, kind, size, satellite, seed, not args.without)
                    for satellite in satellites for seed in range(1, args.seeds + 1)]
            print(line(kind, size, [job.result() for job in jobs]), flush=True)


if __name__ == "__main__":
    main()
