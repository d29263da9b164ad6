"""The self-check of `process` and its verdict: last line, exit status, what is written, and whether wider noise makes other outages truer."""
import csv
import json
import math
import os
import subprocess
import sys
import tomllib
from pathlib import Path

from program_test import check, main

FLIGHT = """name = "air"
seed = 4
duration_s = 420
[trajectory]
type = "figure8"
start = { lat_deg = 50.45, lon_deg = 30.52, height_m = 400.0 }
length_m = 2000
width_m = 800
loop_height_m = 60
figure_s = 140
[imu]
rate_hz = 50
grade = "mems"
[gnss]
rate_hz = 1
receiver = "rtk"
"""
# a tenth of what the unit has
TOO_QUIET = [f"--set={pair}" for pair in ("imu.gyro_noise_deg_sqrt_h=0.02", "imu.accel_noise_m_s_sqrt_h=0.005", "imu.gyro_bias_deg_h=1",
                                          "imu.accel_bias_mg=0.02")]


def flight(program):
    (Path(program.folder) / "flight.toml").write_text(FLIGHT)
    program("simulate", "flight.toml", "-o", "logs", "-q")
    return Path(program.folder)


def any_status(program, *arguments):
    return subprocess.run([program.path, *map(str, arguments)], cwd=program.folder, capture_output=True, text=True, timeout=200)


def summary_in(folder):
    return json.loads((folder / "summary.json").read_text())


def verdict_honest(program, source):
    """A unit that is as good as told: trustworthy, with the evidence; switched off there is none."""
    folder = flight(program)
    done = program("process", "logs", "-o", "on")
    summary = summary_in(folder / "on")
    check(summary["verdict"]["word"] == "trustworthy", f"{summary['verdict']}")
    check(done.stdout.splitlines()[-1] == "trustworthy: " + summary["verdict"]["reasons"][0], f"the last line: {done.stdout.splitlines()[-1]!r}")
    checked = summary["self_check"]
    check(checked["windows"] >= 8 and checked["length_s"] == 15 and checked["widened"] is False, f"{checked}")
    check(checked["inside_3sigma_epochs"] >= 0.98 and 0.3 < checked["end_rms_m"] / checked["sigma_rms_m"] < 2.0, f"{checked}")
    check(sum(row["withheld"] for row in checked["regimes"]) == checked["epochs"], f"every epoch has its motion: {checked['regimes']}")
    page = (folder / "on/report.html").read_text()
    check("Verdict" in page and "trustworthy" in page and "Growth without fixes" in page, "the report shows it")

    off = program("process", "logs", "-o", "off", "--self-check", "off")
    summary = summary_in(folder / "off")
    check(summary["self_check"] is None and summary["verdict"]["word"] == "care", f"{summary['verdict']}")
    check(off.stdout.splitlines()[-1].startswith("usable with care: "), f"{off.stdout.splitlines()[-1]!r}")
    check((folder / "on/solution.csv").read_bytes() == (folder / "off/solution.csv").read_bytes(), "an honest solution stays as it is")
    run = json.loads(program("run", "flight.toml", "-o", "run", "--json").stdout)
    check(run["self_check"] is None and run["verdict"]["word"] == "trustworthy", f"the truth judges a scenario: {run['verdict']}")
    ignored = json.loads(program("run", "flight.toml", "-o", "run", "--json", "--self-check", "off").stdout)["ignored"]
    check([row["key"] for row in ignored] == ["filter.self_check"], f"{ignored}")
    for command in (("run", "flight.toml"), ("montecarlo", "flight.toml", "-n", "2")):
        done = program(*command, "-o", f"{command[0]}_on", "--self-check", "on")
        check("filter.self_check is given and has no effect: it belongs to `schuler process`" in done.stderr, f"{command}: {done.stderr}")


def verdict_widened(program, source):
    """Noise a tenth of what it is: found and widened, which makes outages of the user's own true; config.toml keeps it."""
    folder = flight(program)
    program("process", "logs", "-o", "one", *TOO_QUIET)
    one = summary_in(folder / "one")
    checked = one["self_check"]
    check(checked["widened"] and checked["noise_scale"]["gyro"] > 1.5, f"{checked}")
    check(checked["before"]["inside_3sigma_epochs"] < 0.8 < 0.95 < checked["inside_3sigma_epochs"], f"{checked}")
    check(any("noise of the gyros is taken" in text for text in one["warnings"]), f"it is told: {one['warnings']}")
    scale = {fact["key"]: fact for fact in one["facts"]}["imu.gyro_noise_scale"]
    check(scale["how"] == "found" and scale["value"] == checked["noise_scale"]["gyro"], f"{scale}")
    check(tomllib.loads((folder / "one/config.toml").read_text())["imu"]["gyro_noise_scale"] == scale["value"], "config.toml has it")

    program("process", "logs", "-o", "two", "--config", "one/config.toml")
    two = summary_in(folder / "two")
    check((folder / "one/solution.csv").read_bytes() == (folder / "two/solution.csv").read_bytes(), "config.toml repeats the wider run")
    check(two["self_check"]["widened"] is False and two["self_check"]["noise_scale"] is None, "and does not widen again")

    outages = ["--outage", "100:20,180:20,260:20,340:20", *TOO_QUIET, "--json"]
    inside = {}
    for name in ("on", "off"):
        summary = json.loads(program("process", "logs", "-o", "out", *outages, "--self-check", name).stdout)
        inside[name] = sum(row["inside_3sigma"] for row in summary["outages"])
    check(inside["off"] < inside["on"] == 4, f"outages inside three sigma: {inside}")
    # rows that are written while the filter runs
    program("process", "logs", "-o", "stream", *TOO_QUIET, "--output-rate", "0", "--outputs", "solution,summary,config", "--set", 'reference.file=""')
    program("process", "logs", "-o", "again", "--config", "stream/config.toml", "--self-check", "off")
    check((folder / "stream/solution.csv").read_bytes() == (folder / "again/solution.csv").read_bytes(), "streamed rows are those of the wider run")


def verdict_useless(program, source):
    """Accelerometer and receiver contradict each other: everything is written, and the status says not to use it."""
    folder = flight(program)
    lines = (folder / "logs/gnss.csv").read_text().splitlines()
    lat = lines[0].split(",").index("lat_deg")
    for i, line in enumerate(lines[1:], 1):   # the receiver is elsewhere every other minute
        cells = line.split(",")
        if i // 30 % 2:
            cells[lat] = f"{float(cells[lat]) + 0.01:.9f}"
        lines[i] = ",".join(cells)
    (folder / "logs/gnss.csv").write_text("\n".join(lines) + "\n")
    done = any_status(program, "process", "logs", "-o", "out")
    summary = summary_in(folder / "out")
    check(done.returncode == 1 and summary["verdict"]["word"] == "do not use", f"status {done.returncode}: {summary['verdict']}")
    check(done.stdout.splitlines()[-1].startswith("do not use: "), f"{done.stdout.splitlines()[-1]!r}")
    for name in ("solution.csv", "run.h5", "report.html", "track.kml", "config.toml"):
        check((folder / "out" / name).exists(), f"{name} is written")
    quiet = any_status(program, "process", "logs", "-o", "out", "--json")
    check(quiet.returncode == 1 and json.loads(quiet.stdout)["verdict"]["word"] == "do not use", "one document on standard output")
    check(quiet.stderr.splitlines()[-1].startswith("schuler: do not use: "), f"{quiet.stderr!r}")


def verdict_found_again(program, source):
    """A receiver that is 20 m off for 3 s after 25 s of silence: the smoothed run does without these fixes where they were believed, and is not surer by
    them where they were not. Flying steadily all that time is not rest."""
    folder = Path(program.folder)
    scenario = FLIGHT.replace("rate_hz = 1\n", "rate_hz = 5\n").replace('"mems"', '"consumer"').replace("duration_s = 420", "duration_s = 300").replace("seed = 4", "seed = 8")
    for receiver in ("autonomous", "rtk"):
        (folder / "again.toml").write_text(scenario.replace('"rtk"', f'"{receiver}"'))
        program("simulate", "again.toml", "-o", receiver, "-q")
        head, *fixes = csv.reader(open(folder / receiver / "gnss.csv"))
        time, lat = head.index("time_s"), head.index("lat_deg")
        first = float(fixes[0][time])
        kept = [row for row in fixes if not 120 < float(row[time]) - first <= 145]
        for row in kept:
            if 145 < float(row[time]) - first <= 148:
                row[lat] = repr(float(row[lat]) + 20 / 111_200)
        with open(folder / receiver / "gnss.csv", "w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([head, *kept])
        done = program("process", receiver, "-o", f"out-{receiver}", "--smooth")
        check("at rest they turn" not in done.stdout + done.stderr, f"no rest in flight: {done.stderr}")
        truth = {row["time_s"]: row for row in csv.DictReader(open(folder / receiver / "reference.csv"))}
        outside = compared = 0
        for row in csv.DictReader(open(folder / f"out-{receiver}/solution.csv")):
            if row["time_s"] not in truth:
                continue
            true = truth[row["time_s"]]
            north = 111_200 * (float(row["lat_deg"]) - float(true["lat_deg"]))
            east = 111_300 * math.cos(math.radians(50.45)) * (float(row["lon_deg"]) - float(true["lon_deg"]))
            compared += 1
            outside += abs(north) > 3 * float(row["std_n_m"]) + 0.02 or abs(east) > 3 * float(row["std_e_m"]) + 0.02
        summary = summary_in(folder / f"out-{receiver}")
        print(f"{receiver}: {outside} of {compared} epochs outside three sigma; {summary['verdict']}")
        check(compared > 1000 and outside < 0.01 * compared, f"{receiver}: {outside} of {compared}")
        check(all(float(row["std_n_m"]) > 0 and float(row["std_e_m"]) > 0 for row in csv.DictReader(open(folder / f"out-{receiver}/solution.csv"))), "no sigma is zero")
        check(receiver == "autonomous" or "first after an interruption" in json.dumps(summary["warnings"]), f"{receiver}: {summary['warnings']}")


def verdict_real(program, source):
    """Recorded logs: good ones are not condemned, those whose fixes contradict the unit are not trusted."""
    data = Path(os.environ.get("SCHULER_DATA", source.parent / "shared/data"))
    if not (data / "walk_0827").is_dir():
        print(f"skipped: {data} is not there (set SCHULER_DATA)")
        sys.exit(77)
    allowed = {"walk_0827": ("trustworthy", "care"), "navego_synth": ("trustworthy", "care"), "drive_0708": ("trustworthy", "care"),
               "quad_px4_f450_gpsglitch": ("care", "do not use")}
    for name, words in allowed.items():
        done = any_status(program, "process", data / name, "-o", "out", "--outputs", "summary")
        summary = summary_in(Path(program.folder) / "out")
        print(f"{name}: {done.stdout.splitlines()[-1]}")
        check(summary["verdict"]["word"] in words and done.returncode == (summary["verdict"]["word"] == "do not use"), f"{name}: {summary['verdict']}")


if __name__ == "__main__":
    main({"verdict_honest": verdict_honest, "verdict_widened": verdict_widened, "verdict_useless": verdict_useless, "verdict_found_again": verdict_found_again, "verdict_real": verdict_real})
