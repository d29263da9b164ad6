#!/usr/bin/env python3
"""Heading in straight motion: error, sigma and NEES over seeds where the start does not know it (45 deg, one sigma).

    straight_motion.py --schuler build/bin/schuler [-n 20]

Each row: root mean square of the heading's error and of its sigma (deg) and the mean of their squared ratio, at 10 s and at the end.
"""
import argparse
import csv
import math
import subprocess
import sys
import tempfile
from pathlib import Path

START = "start = { lat_deg = 50.45, lon_deg = 30.52, height_m = 400 }\nheading_deg = 77\n"
STRAIGHT = 'type = "great_circle"\nspeed_m_s = 8\n'
SHIP = 'type = "ship"\nspeed_m_s = 8\n' + "".join(
    f"waves.{wave} = {value}\n" for wave, value in
    {"roll_deg": 2, "roll_period_s": 7, "pitch_deg": 1.5, "pitch_period_s": 6, "yaw_deg": 1, "yaw_period_s": 9, "heave_m": 1, "heave_period_s": 8}.items())
EIGHT = 'type = "figure8"\nlength_m = 800\nwidth_m = 400\nloop_height_m = 40\nfigure_s = 100\n'
CASES = {
    "straight, consumer": (STRAIGHT, "consumer", ""),
    "straight, mems": (STRAIGHT, "mems", ""),
    "straight, mems, antenna 0.45 m aside": (STRAIGHT, "mems", "lever_arm_m = [0.4, -0.2, -1.1]\n"),
    "ship in waves, consumer": (SHIP, "consumer", ""),
    "figures of eight, mems": (EIGHT, "mems", ""),
}


def headings(path):
    with open(path, encoding="utf-8") as file:
        return {round(float(row["time_s"]), 2): row for row in csv.DictReader(file)}


def scenario(path, grade, antenna):
    return (f'name = "straight"\nseed = 1\nduration_s = 400\n[trajectory]\n{path}{START}[imu]\nrate_hz = 100\ngrade = "{grade}"\n'
            f'[gnss]\nrate_hz = 5\nreceiver = "rtk"\n{antenna}[filter]\n'
            "initial_error = { level_deg = 1, heading_deg = 45, velocity_m_s = 0.3, position_m = 3 }\n")


def measured(program, folder, case, count):
    (folder / "s.toml").write_text(scenario(*case), encoding="utf-8")
    subprocess.run([program, "simulate", folder / "s.toml", "-o", folder / "truth", "-q", "--force"], check=True)
    truth = headings(folder / "truth/reference.csv")
    sums = {}
    for seed in range(1, count + 1):
        subprocess.run([program, "run", folder / "s.toml", "--seed", str(seed), "-o", folder / "out", "-q", "--output-rate", "0.1", "--outputs", "solution"],
                       check=True)
        rows = [(t, row) for t, row in headings(folder / "out/solution.csv").items() if t in truth]
        for name, (t, row) in {"early": rows[1], "end": rows[-1]}.items():
            error = (float(row["heading_deg"]) - float(truth[t]["heading_deg"]) + 180) % 360 - 180
            sigma = float(row["std_heading_deg"])
            e, s, n = sums.get(name, (0, 0, 0))
            sums[name] = (e + error**2 / count, s + sigma**2 / count, n + (error / sigma)**2 / count)
    return [value for name in ("early", "end") for value in (math.sqrt(sums[name][0]), math.sqrt(sums[name][1]), sums[name][2])]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--schuler", required=True, help="the program")
    parser.add_argument("-n", type=int, default=20, help="number of seeds")
    options = parser.parse_args()
    print("| | error, sigma, NEES at 10 s | at 390 s |\n|---|---|---|")
    for name, case in CASES.items():
        with tempfile.TemporaryDirectory() as folder:
            a = measured(options.schuler, Path(folder), case, options.n)
        print(f"| {name} | {a[0]:.1f}, {a[1]:.1f}, {a[2]:.1f} | {a[3]:.1f}, {a[4]:.1f}, {a[5]:.1f} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
