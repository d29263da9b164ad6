#!/usr/bin/env python3
"""Outages over the whole of recorded logs, forward and smoothed: how far off are they, and do the sigmas say so?

    outage_campaign.py --schuler build/bin/schuler FOLDER... [--lengths 10,15,30] [--every 5] [--skip 40] [-o out/outages.md]

A window of each length begins every so many seconds; windows of one run lie at least 25 s, and one and a half of their lengths, apart. Each
folder is processed as it is, without any word about it beyond its files. The withheld fixes judge (or the reference, where there is a true
one): an epoch is inside where north and east are within three sigma of the difference, a window where all of its epochs are.
"""
import argparse
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path


def run(program, folder, windows, out, more):
    command = [program, "process", folder, "-o", out, "--smooth", "--outputs", "summary", *more]
    if windows:
        command += ["--outage", ",".join(f"{start:g}:{length:g}" for start, length in windows)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode > 1:
        raise RuntimeError(f"{folder}: {done.stderr.strip()}")
    return json.loads((Path(out) / "summary.json").read_text())


class Tally:
    """Outages of one kind: their errors, m, and how many lie inside."""

    def __init__(self):
        self.errors, self.windows, self.epochs, self.epochs_inside = [], [], 0, 0

    def add(self, outages, name):
        for o in outages:
            if not o["epochs"]:
                continue
            self.errors.append(o[name])
            self.windows.append(o["inside_3sigma"])
            self.epochs += o["epochs"]
            self.epochs_inside += o["epochs_inside_3sigma"]

    def cells(self):
        if not self.errors:
            return ["-"] * 3
        rms = math.sqrt(sum(e * e for e in self.errors) / len(self.errors))
        return [f"{rms:.3g}", f"{sum(self.windows)}/{len(self.windows)}", f"{100 * self.epochs_inside / self.epochs:.1f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--schuler", required=True)
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--lengths", default="10,15,30")
    parser.add_argument("--every", type=float, default=5.0, help="s between the beginnings of windows, over all runs")
    parser.add_argument("--skip", type=float, default=40.0, help="s at the beginning that are left alone")
    parser.add_argument("-o", "--output", help="file for the table; the terminal has it anyway")
    parser.add_argument("--more", default="", help="further options of `schuler process`, in one string")
    args = parser.parse_args()
    lines = ["| log | outage, s | end, forward, m RMS | windows | epochs, % | largest, smoothed, m RMS | windows | epochs, % |", "|---|---|---|---|---|---|---|---|"]
    with tempfile.TemporaryDirectory() as out:
        for folder in args.folders:
            whole = run(args.schuler, folder, [], out, args.more.split())["duration_s"]
            for length in (float(x) for x in args.lengths.split(",")):
                apart = args.every * math.ceil(max(length + 25.0, 2.5 * length) / args.every)
                forward, smoothed = Tally(), Tally()
                for phase in range(int(apart / args.every)):
                    first = args.skip + args.every * phase
                    starts = [first + k * apart for k in range(int((whole - length - 5.0 - first) / apart) + 1)] if whole > first + length + 5.0 else []
                    if not starts:
                        continue
                    try:
                        s = run(args.schuler, folder, [(start, length) for start in starts], out, args.more.split())
                    except RuntimeError as error:
                        print(error, file=sys.stderr)
                        continue
                    forward.add(s["outages_forward"], "end_horizontal_m")
                    smoothed.add(s["outages"], "max_horizontal_m")
                lines.append("| " + " | ".join([Path(folder).name, f"{length:g}", *forward.cells(), *smoothed.cells()]) + " |")
                print(lines[-1], flush=True)
    if args.output:
        Path(args.output).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
