"""What is known about a data set and how: found where it is not given, used and checked where it is, written down so that a run repeats."""
import csv
import gzip
import json
import math
import os
import random
import shutil
import statistics
import sys
import tomllib
from pathlib import Path

from program_test import DRIVE, check, main, repetitions

WINDOWS = "50:15,75:15,100:15,125:15,150:15,175:15"


def rms(rows, field="end_horizontal_m"):
    return math.sqrt(sum(row[field] ** 2 for row in rows) / len(rows))


def summary_of(program, *arguments):
    return json.loads(program("process", *arguments, "--json").stdout)


def facts_of(summary):
    return {fact["key"]: fact for fact in summary["facts"]}


def as_toml(sections):
    def text(value):
        if isinstance(value, dict):
            return "{ " + ", ".join(f"{k} = {text(v)}" for k, v in value.items()) + " }"
        return json.dumps(value)
    return "".join(f"[{name}]\n" + "".join(f"{key} = {text(v)}\n" for key, v in keys.items()) for name, keys in sections.items())


def simulated(program, folder):
    """The logs of a simulated car without a word about them, and the true words."""
    (folder / "drive.toml").write_text(DRIVE.replace('grade = "tactical"', 'grade = "mems"'))
    program("simulate", "drive.toml", "-o", "logs")
    said = tomllib.loads((folder / "logs/dataset.toml").read_text())
    (folder / "logs/dataset.toml").unlink()
    true = {"vehicle": {"kind": "car"}, "imu": {"file": "imu.csv", **{k: said["imu"][k] for k in ("kind", "stamp", "axes", "mounting_deg")}},
            "gnss": {"file": "gnss.csv", "latency_s": 0.0, "velocity_latency_s": 0.0, "height": "ellipsoidal",
                     "lever_arm_m": said["gnss"]["lever_arm_m"]}, "time": {"scale": said["time"]["scale"]}}
    return true


def facts_partial(program, source):
    """Saying true things never makes it worse: random subsets of what is true, against the folder without a word."""
    folder = Path(program.folder)
    true = simulated(program, folder)
    outage = ["--outage", "60:10,85:10,110:10", "--outputs", "summary"]
    bare = rms(summary_of(program, "logs", "-o", "bare", *outage)["outages"])
    draw = random.Random(7)
    for trial in repetitions(range(6), 2):
        some = {name: {k: v for k, v in keys.items() if k == "file" or draw.random() < 0.5} for name, keys in true.items()}
        (folder / "logs/dataset.toml").write_text(as_toml(some))
        summary = summary_of(program, "logs", "-o", f"some{trial}", *outage)
        got = rms(summary["outages"])
        check(got < 1.1 * bare + 0.05, f"{some}: {got:.3f} m, bare {bare:.3f} m")
        check(not any("contradict" in text for text in summary["warnings"]), f"{some} is true: {summary['warnings']}")
        check(summary["ignored"] == [], f"{some}: {summary['ignored']}")
        facts = facts_of(summary)
        for name, keys in some.items():
            for key in keys:
                check(facts[f"{name}.{key}"]["how"] == "given", f"{name}.{key} is given: {facts.get(f'{name}.{key}')}")
        if "axes" not in some["imu"]:
            check(facts["imu.axes"]["how"] == "found" and facts["imu.axes"]["note"], "the axes are found, and by what is said")
    # what is wrong is used all the same, with one warning that names both values
    (folder / "logs/dataset.toml").write_text('[imu]\nfile = "imu.csv"\naxes = "flu"\n[gnss]\nfile = "gnss.csv"\n')
    warnings = [text for text in summary_of(program, "logs", "-o", "wrong", *outage)["warnings"] if "contradict" in text]
    check(len(warnings) == 1 and "imu.axes" in warnings[0] and '"flu"' in warnings[0], f"wrong axes: {warnings}")


def facts_repeat(program, source):
    """config.toml holds what was in force: it repeats the run to the last bit, with nothing left to be found."""
    folder = Path(program.folder)
    simulated(program, folder)
    one = summary_of(program, "logs", "-o", "one")
    written = tomllib.loads((folder / "one/config.toml").read_text())
    check(written["imu"]["estimate_noise"] is False and written["gnss"]["estimate_std"] is False, "nothing is left to be tuned")
    check(isinstance(written["gnss"]["latency_s"], float), f"the latency in force: {written['gnss']['latency_s']}")
    check("lever_arm_m" not in written["gnss"], "a lever arm that is neither given nor found is not given by config.toml")
    facts = facts_of(one)
    noise = facts["imu.gyro_noise_deg_sqrt_h"]
    check(noise["how"] == "found" and noise["sigma"] > 0 and noise["unit"] == "deg/sqrt(h)" and noise["to_s"] > noise["from_s"],
          f"a fitted noise has sigma and span: {noise}")
    check(math.isclose(noise["value"], written["imu"]["gyro_noise_deg_sqrt_h"]), "the same value in both")
    check({fact["how"] for fact in one["facts"]} <= {"given", "file", "found", "default"}, "four words")
    again = summary_of(program, "logs", "-o", "two", "--config", "one/config.toml")
    for name in ("solution.csv", "config.toml"):
        check((folder / "one" / name).read_bytes() == (folder / "two" / name).read_bytes(), f"{name} is repeated to the last bit")
    check(facts_of(again)["imu.axes"]["how"] == "given", "config.toml gives")
    table = program("process", "logs", "-o", "three", "--outputs", "report").stdout
    check("found  vehicle.kind" in table and '"car"' in table, "process prints what was found")
    check("imu.axes" in (folder / "three/report.html").read_text() and "found" in (folder / "three/report.html").read_text(),
          "so does the report")


CURVES = """
duration_s = 871
[trajectory]
type = "figure8"
start = { lat_deg = 45.5, lon_deg = 132.5, height_m = 2820 }
length_m = 2513
width_m = 1005
figure_s = 122
[imu]
rate_hz = 50
grade = "mems"
[gnss]
rate_hz = 5
white_m = [0.25, 0.25, 0.4]
white_velocity_m_s = [0.05, 0.05, 0.08]
correlated_m = 0
latency_s = 0.12
velocity_latency_s = 0.12
"""


def facts_curves(program, source):
    """Slow curves tell little of lateness: gain errors of the gyros are neither a drift of clocks nor a latency beyond its sigma."""
    folder = Path(program.folder)
    (folder / "curves.toml").write_text(CURVES)
    for seed in repetitions((1, 4), 1):
        logs = folder / f"logs{seed}"
        program("simulate", "curves.toml", "--seed", str(seed), "-o", logs)
        (logs / "dataset.toml").unlink()
        (logs / "reference.csv").rename(folder / f"truth{seed}.csv")
        found = {f["key"]: f["value"] for f in json.loads(program("inspect", logs, "--json").stdout)["findings"]}
        check("imu.clock_drift_ppm" not in found, f"there is no drift: {found.get('imu.clock_drift_ppm')}")
        late, sigma = (float(x) for x in found["gnss.latency_s"].removesuffix(" s").split(" +- "))
        check(abs(late - 0.12) < 3.0 * sigma, f"0.12 s late: {late} +- {sigma} s")


def facts_heading(program, source):
    """quad_apm_106: a quadcopter that moves little at first. Its heading at the start is inside its sigma, by the autopilot's estimate, whatever
    the latency: a trial of another heading must not win by giving way to the fixes that refute it."""
    log = Path(os.environ.get("SCHULER_DATA", source.parent / "shared/data")) / "quad_apm_106"
    if not log.is_dir():
        print(f"skipped: {log} is not there (set SCHULER_DATA)")
        sys.exit(77)
    with open(log / "reference.csv", encoding="utf-8") as file:
        truth = float(next(csv.DictReader(file))["ahrs_yaw_deg"])
    for given in ([], ["--set", "gnss.latency_s=0.0301"]):
        summary = summary_of(program, log, "-o", "out", "--outputs", "summary", "--self-check", "off", *given)
        found = facts_of(summary)["initial.heading_deg"]
        off = math.remainder(found["value"] - truth, 360.0)
        check(abs(off) < 30.0 and abs(off) < 3.0 * found["sigma"], f"{given}: {found}, {off:.1f} deg off")
        check(not any("restarted" in text for text in summary["warnings"]), f"{given}: {summary['warnings']}")


SLOW_VELOCITIES = """
name = "slow"
seed = 3
duration_s = 500
reference_rate_hz = 10
[vehicle]
kind = "car"
[trajectory]
type = "waypoints"
start = { lat_deg = 48, lon_deg = 11, height_m = 500 }
standstill_s = 15
corner_radius_m = 8
waypoints = [{ north_m = 600, east_m = 0, speed_m_s = 12 }, { north_m = 600, east_m = 600, speed_m_s = 12 }, { north_m = 1200, east_m = 600, speed_m_s = 12 },
             { north_m = 1200, east_m = 0, speed_m_s = 10 }, { north_m = 1200, east_m = -800, speed_m_s = 12 }, { north_m = 200, east_m = -800, speed_m_s = 12 },
             { north_m = 200, east_m = -2200, speed_m_s = 12 }]
[imu]
rate_hz = 100
grade = "mems"
[gnss]
rate_hz = 5
white_m = [0.8, 0.8, 1.3]
white_velocity_m_s = [0.03, 0.03, 0.05]
correlated_m = 0.8
correlated_velocity_m_s = 0.03
correlated_velocity_time_s = 20
"""

FIGURES_OF_EIGHT = """
name = "eight"
seed = 1
duration_s = 400
reference_rate_hz = 10
[trajectory]
type = "figure8"
start = { lat_deg = 48, lon_deg = 11, height_m = 500 }
length_m = 600
width_m = 240
loop_height_m = 10
figure_s = 60
[imu]
rate_hz = 100
grade = "consumer"
[gnss]
rate_hz = 5
white_m = [0.3, 0.3, 0.5]
white_velocity_m_s = [0.1, 0.1, 0.15]
correlated_m = 0.8
"""


def facts_vertical(program, source):
    """A receiver whose stated vertical sigma is hardly larger than the horizontal one: its slow errors leave room for the white part, no good fix is refused."""
    folder = Path(program.folder)
    (folder / "eight.toml").write_text(FIGURES_OF_EIGHT)
    program("simulate", "eight.toml", "-o", "simulated", "-q")
    drive = folder / "eight"
    drive.mkdir()
    for name in ("imu.csv", "gnss.csv"):
        shutil.copy(folder / "simulated" / name, drive / name)
    (drive / "dataset.toml").write_text('[vehicle]\nkind = "air"\n[imu]\nfile = "imu.csv"\naxes = "frd"\n[gnss]\nfile = "gnss.csv"\n')
    summary = summary_of(program, "eight", "-o", "out", "-q")
    check(summary["gnss"]["rejected"] < 40, f"{summary['gnss']} good fixes")
    check(summary["verdict"]["word"] == "trustworthy", f"{summary['verdict']}")


def facts_velocity(program, source):
    """Velocity errors of 3 cm/s that last for 20 s, within the sigma that the log states: found, and positions smoothed with them inside three sigma."""
    folder = Path(program.folder)
    (folder / "slow.toml").write_text(SLOW_VELOCITIES)
    program("simulate", "slow.toml", "-o", "simulated")
    drive = folder / "drive"
    drive.mkdir()
    for name in ("imu.csv", "gnss.csv"):
        shutil.copy(folder / "simulated" / name, drive / name)
    reference = '[reference]\nfile = "reference.csv"\n'
    shutil.copy(folder / "simulated/reference.csv", drive / "reference.csv")
    (drive / "dataset.toml").write_text('[vehicle]\nkind = "car"\n[imu]\nfile = "imu.csv"\naxes = "frd"\n[gnss]\nfile = "gnss.csv"\n' + reference)
    summary = summary_of(program, "drive", "-o", "out", "--smooth", "--self-check", "off", "--outputs", "summary,solution")
    with open(folder / "out/solution.csv", encoding="utf-8") as solution, open(drive / "reference.csv", encoding="utf-8") as truth:
        true = {round(float(row["time_s"]), 1): float(row["lat_deg"]) for row in csv.DictReader(truth)}
        rows = [row for row in csv.DictReader(solution) if round(float(row["time_s"]), 1) in true]
    north = [math.radians(float(row["lat_deg"]) - true[round(float(row["time_s"]), 1)]) * 6.366e6 / float(row["std_n_m"]) for row in rows]
    outside = sum(abs(x) > 3.0 for x in north) / len(north)
    check(len(north) > 400 and outside < 0.02, f"{100 * outside:.1f} % of {len(north)} epochs are beyond three sigma north")
    slow = facts_of(summary)["gnss.correlated_velocity_m_s"]
    check(slow["how"] == "found" and 0.015 < slow["value"][0] < 0.06, f"{slow}")


def facts_real(program, source):
    """drive_0708: a dataset.toml that says less than could be found is as good as none; a latency that counts twice is told."""
    data = Path(os.environ.get("SCHULER_DATA", source.parent / "shared/data"))
    drive = data / "drive_0708"
    if not drive.is_dir():
        print(f"skipped: {drive} is not there (set SCHULER_DATA)")
        sys.exit(77)
    folder = Path(program.folder)
    (folder / "said").mkdir()
    for name in ("imu.csv", "gnss.csv"):
        (folder / "said" / name).symlink_to(drive / name)
    outage = ["--outage", WINDOWS, "--outputs", "summary,solution,config"]
    bare = summary_of(program, drive, "-o", "bare", *outage)
    files = '[imu]\nfile = "imu.csv"\n[gnss]\nfile = "gnss.csv"\n'
    (folder / "said/dataset.toml").write_text(files + "lever_arm_m = [0.0, -0.05, 0.0]\n")
    said = summary_of(program, "said", "-o", "out", *outage)
    # Window by window, since each hangs on tenths of a degree of pitch at its beginning: settings that fit alike draw errors whose ratio is 1.7
    # or 0.6, so that the mean ratio of fifteen windows is uncertain by a tenth.
    def windows(logs):
        errors = []
        for first in (40, 50, 60, 70):
            chosen = ",".join(f"{start}:15" for start in range(first, 185, 40))
            rows = summary_of(program, logs, "-o", "many", "--outputs", "summary", "--outage", chosen)["outages"]
            errors += rows
        return errors
    alone, partial = windows(drive), windows("said")
    check(len(partial) == len(alone) > 12, f"{len(partial)} and {len(alone)} windows")
    ratios = [math.log(row["end_horizontal_m"] / other["end_horizontal_m"]) for row, other in zip(partial, alone)]
    mean, scatter = statistics.fmean(ratios), statistics.stdev(ratios) / math.sqrt(len(ratios))
    print(f"drive_0708, outages of 15 s: bare folder {rms(alone):.2f} m, partial dataset.toml {rms(partial):.2f} m, ratio {math.exp(mean):.2f}, "
          f"its logarithm +- {scatter:.2f}")
    check(mean < min(math.log(1.05) + 2.0 * scatter, math.log(1.4)), f"{ratios}")
    check(all(row["inside_3sigma"] for row in said["outages"]), "inside three sigma")
    facts = facts_of(said)
    check(facts["vehicle.kind"]["value"] == "car" and facts["vehicle.kind"]["how"] == "found", f"{facts['vehicle.kind']}")
    check(facts["gnss.lever_arm_m"]["how"] == "given", "the lever arm is given")
    (folder / "said/dataset.toml").write_text(files + "velocity_latency_s = 0.12\n")
    doubled = summary_of(program, "said", "-o", "doubled", *outage)
    check(rms(doubled["outages"]) < 1.05 * rms(bare["outages"]), f"{rms(doubled['outages'])} m, bare {rms(bare['outages'])}")
    told = [text for text in doubled["warnings"] if "velocity_latency_s" in text]
    check(len(told) == 1 and "0.120 s" in told[0] and "the data show" in told[0], f"a latency that counts twice: {doubled['warnings']}")
    check(doubled["findings"]["latency_s"] == bare["findings"]["latency_s"],
          f"what is refuted beyond doubt is not used: {doubled['findings']['latency_s']}")
    check(facts_of(doubled)["gnss.velocity_latency_s"]["how"] != "given", "what is used instead is not what was given")
    (folder / "said/dataset.toml").write_text(files + "velocity_latency_s = 0.12\n[run]\nkeep_given = true\n")
    insisted = summary_of(program, "said", "-o", "insisted", *outage)
    check(facts_of(insisted)["gnss.velocity_latency_s"]["how"] == "given" and any("velocity_latency_s" in text for text in insisted["warnings"]),
          "a given value that is to be kept is used, and the contradiction told")
    # what was found, given: the same run
    program("process", drive, "-o", "again", "--config", "bare/config.toml", *outage)
    same = (folder / "again/solution.csv").read_bytes() == (folder / "bare/solution.csv").read_bytes()
    check(same, "config.toml repeats the real drive to the last bit")


def facts_checked(program, source):
    """inspect checks a dataset.toml as process does; what is given and useless is told; single bad rows cost themselves."""
    folder = Path(program.folder)
    simulated(program, folder)
    described = folder / "logs/dataset.toml"
    files = '[imu]\nfile = "imu.csv"\n[gnss]\nfile = "gnss.csv"\n'
    for name, text, part in (("key", files + "latencys_s = 0.1\n", "latency_s"), ("type", files + 'latency_s = "soon"\n', "latency"),
                             ("file", files.replace("imu.csv", "absent.csv"), "absent.csv"),
                             ("column", files + 'columns = { height_m = "altitude" }\n', "altitude"),
                             ("time", files + "time_offset_s = 1e6\n", "overlap")):
        described.write_text(text)
        for command in (("inspect", "logs"), ("process", "logs", "-o", name)):
            program.fails(*command, parts=[part])
    described.write_text(files + "lever_arm_m = [0.0, 0.0, 0.0]\nvelocity_latency_s = 0.5\n")
    report = json.loads(program("inspect", "logs", "--json").stdout)
    check(any("velocity_latency_s" in problem["text"] for problem in report["problems"]), "inspect says what the data contradict")
    how = {fact["key"]: fact["how"] for fact in report["facts"]}
    check(how.get("gnss.velocity_latency_s") != "given" and how["gnss.lever_arm_m"] == "given" and how["vehicle.kind"] == "found", f"inspect says how it knows: {how}")

    described.write_text(files + "undulation_m = 40.0\n[baro]\nwhite_m = 3.0\n")
    summary = summary_of(program, "logs", "-o", "useless", "--outputs", "summary")
    check({entry["key"] for entry in summary["ignored"]} == {"gnss.undulation_m", "baro.white_m"}, f"ignored: {summary['ignored']}")
    check(sum("has no effect" in text for text in summary["warnings"]) == 2, f"and told: {summary['warnings']}")
    described.unlink()

    clean = rms(summary_of(program, "logs", "-o", "clean", "--outage", "60:10,85:10", "--outputs", "summary")["outages"])
    rows = {name: (folder / "logs" / name).read_text().splitlines() for name in ("imu.csv", "gnss.csv")}

    def spoil(name, line, change):
        cells = rows[name][line].split(",")
        spoiled = rows[name][:line] + [",".join(change(cells))] + rows[name][line + 1:]
        (folder / "logs" / name).write_text("\n".join(spoiled) + "\n")

    accidents = {"hour": ("imu.csv", lambda c: [repr(float(c[0]) + 3600.0), *c[1:]]), "huge": ("imu.csv", lambda c: [*c[:2], "1e300", *c[3:]]),
                 "nan": ("imu.csv", lambda c: [*c[:2], "nan", *c[3:]]), "ahead": ("gnss.csv", lambda c: [repr(float(c[0]) + 100.0), *c[1:]]),
                 "place": ("gnss.csv", lambda c: [c[0], "1e300", *c[2:]])}
    for accident, (name, change) in repetitions(accidents.items(), 2):
        spoil(name, 95, change)
        summary = summary_of(program, "logs", "-o", accident, "--outage", "60:10,85:10", "--outputs", "summary")
        got = rms(summary["outages"])
        check(got < 1.5 * clean + 0.1, f"{accident}: {got:.3f} m, undisturbed {clean:.3f} m")
        check(any("skipped" in text for text in summary["warnings"]), f"{accident} is told: {summary['warnings']}")
        (folder / "logs" / name).write_text("\n".join(rows[name]) + "\n")


def facts_raw(program, source):
    """A receiver's RINEX beside an IMU whose clock starts at zero: the fixes of single epochs show by how much the clocks differ."""
    generator = Path(os.environ.get("SCHULER_DATA", source.parent / "shared/data")) / "spirent_rtk_noatm"
    if not generator.is_dir():
        print(f"skipped: {generator} is not there (set SCHULER_DATA)")
        sys.exit(77)
    folder = Path(program.folder)
    with open(generator / "Rover-dynamic_motion_Spirent.csv", newline="") as file:
        next(file)
        motion = list(csv.DictReader(file))
    with open(folder / "rose.csv", "w") as file:
        file.write("time_s,lat_deg,lon_deg,height_m,roll_deg,pitch_deg,heading_deg\n")
        for row in motion:
            place = [math.degrees(float(row["Lat"])), math.degrees(float(row["Long"])), float(row["Height"])]
            file.write(f"{float(row['Time_ms']) / 1e3:.3f},{place[0]:.11f},{place[1]:.11f},{place[2]:.4f},0,0,{math.degrees(float(row['Heading'])):.6f}\n")
    (folder / "rose.toml").write_text('name = "rose"\nseed = 5\nduration_s = 590\n[trajectory]\ntype = "file"\nfile = "rose.csv"\n'
                                      '[imu]\nrate_hz = 50\ngrade = "mems"\n')
    program("simulate", "rose.toml", "-o", "simulated", "-q")
    (folder / "logs").mkdir()
    shutil.copy(folder / "simulated/imu.csv", folder / "logs/imu.csv")
    (folder / "logs/rover.obs").write_bytes(gzip.decompress((generator / "Rover-dynamic_MO_Spirent.obs.gz").read_bytes()))
    for name in ("RINEX_EN_Spirent.23L", "RINEX_GN_Spirent.23N"):
        shutil.copy(generator / name, folder / "logs")
    summary = summary_of(program, "logs", "-o", "out", "--outputs", "solution,summary")
    offset = facts_of(summary)["imu.time_offset_s"]
    began = 1_357_207_200.0  # 2023-01-08 10:00:00, seconds of GPS time
    check(offset["how"] == "found" and abs(offset["value"] - began) < 0.1, f"{offset}")
    with open(folder / "out/solution.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    misses = []
    for row in rows:
        true = motion[min(round((float(row["time_s"]) - began) * 10), len(motion) - 1)]
        misses.append(math.hypot((float(row["lat_deg"]) - math.degrees(float(true["Lat"]))) * 111.2e3,
                                 (float(row["lon_deg"]) - math.degrees(float(true["Long"]))) * 73.3e3))
    check(len(misses) > 5000 and max(misses) < 3.0, f"{len(misses)} epochs, at worst {max(misses):.2f} m from the generator's motion")


if __name__ == "__main__":
    main({"facts_partial": facts_partial, "facts_repeat": facts_repeat, "facts_curves": facts_curves, "facts_real": facts_real, "facts_heading": facts_heading,
          "facts_vertical": facts_vertical, "facts_velocity": facts_velocity,
          "facts_checked": facts_checked,
          "facts_raw": facts_raw})
