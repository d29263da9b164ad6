"""Paper A's complex from outside: its table, couplings, studies and refusals."""
import csv
import json
import math
import re
from pathlib import Path
from xml.etree import ElementTree

from program_test import check, main


def together(block):
    """Root of the sum of squares over the axes."""
    return math.sqrt(sum(axis["rms"] ** 2 for axis in block.values()))


def complex_numbers(program, source):
    """Root mean squares over runs at or below the paper's single run (table 4.3.1), consistent, through an outage of 100 s too."""
    flight = source / "examples/paper-a-flight.toml"
    table = program("run", flight, "-o", "one", "--outputs", "summary").stdout
    check("paper A, table 4.3.1" in table and "4.648" in table, "the paper's table stands beside the run's")
    summary = json.loads(program("montecarlo", flight, "-n", 20, "-o", "many", "--outage", "600:100", "--json").stdout)
    errors, states = summary["errors"], summary["states"]
    got = {"horizontal, m": (errors["position_m"]["horizontal"]["rms"], 7.5), "height, m": (errors["position_m"]["up"]["rms"], 4.87),
           "gyros, rad/s": (together(states["gyro_bias_deg_h"]) * math.radians(1) / 3600, 1.3e-6),
           "accelerometers, ug": (together(states["accel_bias_ug"]), 80.0),
           "heading, rad": (math.radians(states["attitude_deg"]["up"]["rms"]), 4.7e-4)}
    level = states["attitude_deg"]
    got["tilt, rad"] = (math.radians(math.hypot(level["east"]["rms"], level["north"]["rms"])), 1.6e-4)
    for axis in ("east", "north", "up"):
        got[f"velocity {axis}, m/s"] = (errors["velocity_m_s"][axis]["rms"], 0.0236)
    got["growth in an outage of 100 s, m"] = (summary["outages"][0]["growth_horizontal"]["median"], 10.0)
    for name, (value, bound) in got.items():
        print(f"{name}: {value:.3g} (at most {bound:g})")
        check(value < bound, f"{name}: {value} above {bound}")
    consistency = summary["consistency"]
    for block in ("position", "velocity", "attitude", "gyro_bias", "accel_bias", "gnss_position", "gnss_velocity", "baro_bias"):
        mean, dof = consistency[f"nees_{block}"]["mean"], consistency[f"nees_{block}"]["expected"]
        check(0.6 < mean / dof < 1.5, f"NEES of {block}: {mean}")

    for jobs in (1, 2):
        program("montecarlo", flight, "-n", 3, "-j", jobs, "-o", f"jobs{jobs}", "-q")
    for name in ("runs.csv", "epochs.csv"):
        one, two = ((Path(program.folder) / f"jobs{jobs}" / name).read_bytes() for jobs in (1, 2))
        check(one == two, f"{name} does not depend on --jobs")


def complex_schemes(program, source):
    """One flight through the couplings: each inertial one beats the receiver alone where it should, and knows how good it is."""
    rows = json.loads(program("run", source / "examples/schemes.toml", "-o", "schemes", "--json").stdout)["schemes"]
    row = {r["scheme"]: r for r in rows}
    for name in ("loose", "loose-aggressive", "loose-open"):
        check(row[name]["horizontal_m"] < 0.9 * row["gnss"]["horizontal_m"], f"{name} against the receiver alone")
        check(row[name]["tilt_deg"] < 0.2 * row["separate"]["tilt_deg"], f"{name}: tilt against the separate scheme")
        check(row[name]["outage_end_horizontal_m"] < 0.1 * row["separate-restart"]["outage_end_horizontal_m"], f"{name}: outage")
        check(row[name]["nees_position"] < 3, f"{name}: NEES {row[name]['nees_position']}")
    check(row["loose-15"]["nees_position"] < 3, f"slow errors considered: NEES {row['loose-15']['nees_position']}")
    untold = json.loads(program("run", source / "examples/schemes.toml", "--scheme", "loose", "-o", "untold", "--json",   # one in place of all
                                "--set", "filter.preset=ins15", "--set", "gnss.correlated_m=[0,0,0]",
                                "--set", "gnss.correlated_velocity_m_s=[0,0,0]").stdout)["consistency"]
    check(untold["nees_position"]["mean"] > 60, "a filter that is not told of the receiver's slow errors has no right NEES")


def complex_windows(program, source):
    """Spans of a comparison: files that agree with each other and repeat, a page, refusals in one line."""
    folder = Path(program.folder)
    text = (source / "examples/schemes.toml").read_text()
    text = text.replace("duration_s = 800", "duration_s = 300").replace("start_s = 600", "start_s = 100")
    (folder / "single.toml").write_text(re.sub(r"\[compare\]\nschemes = .*\n", "", text))
    text = re.sub(r"schemes = .*", 'schemes = ["gnss", "separate-restart", "loose"]\\nlimit_m = 25', text)
    windows = "".join(f'[[compare.window]]\nname = "{name}"\nstart_s = {start}\nend_s = {end}\n'
                      for name, start, end in (("without", 100, 190), ("calm", 40, 100), ("settled", 60, 300)))
    (folder / "plain.toml").write_text(text)
    (folder / "s.toml").write_text(text + windows)
    told = {name: program("run", "s.toml", "-o", name).stdout for name in ("one", "two")}["one"]
    program("run", "plain.toml", "-o", "plain", "-q")
    one, two, plain = ({path.name: path.read_bytes() for path in (folder / name).iterdir() if path.name != ".schuler"} for name in ("one", "two", "plain"))
    check(sorted(one) == ["comparison.csv", "report.html", "summary.json", "windows.csv"], f"files: {sorted(one)}")
    check("windows.csv" not in plain and plain["comparison.csv"] == one["comparison.csv"], "windows change nothing else")
    for name in ("comparison.csv", "report.html", "windows.csv"):
        check(one[name] == two[name], f"{name} repeats")

    rows = list(csv.DictReader(one["windows.csv"].decode().splitlines()))
    row = {(r["scheme"], r["window"]): r for r in rows}
    check(list(rows[0]) == ["scheme", "window", "start_s", "end_s", "horizontal_rms_m", "horizontal_max_m", "vertical_max_m",
                            "solution_share", "recovery_s"] and len(rows) == 9, f"windows.csv: {rows}")
    for r in json.loads(one["summary.json"])["schemes"]:
        for w in r["windows"]:
            for key, value in w.items():
                right = row[r["scheme"], w["name"]]["window" if key == "name" else key]
                same = right == "" if value is None else right == value or abs(float(right) - value) < 1e-8 * abs(value) + 1e-12
                check(same, f"{key}: {right} in windows.csv, {value} in summary.json")
    single = json.loads(program("run", "single.toml", "--scheme", "loose", "-o", "single", "--json").stdout)["errors"]["position_m"]
    for key, of, number in (("horizontal_rms_m", "horizontal", "rms"), ("horizontal_max_m", "horizontal", "max"),
                            ("vertical_max_m", "up", "max")):
        right = single[of][number]
        check(abs(float(row["loose", "settled"][key]) - right) < 1e-6, f"a run of its own has {key} = {right}: {row}")
    # a fix at 100 s, a solution for 1.5 s more, or 16 of 901 instants; the next one at 200 s
    alone = row["gnss", "without"]
    check(abs(float(alone["solution_share"]) - 16 / 901) < 1e-6 and alone["recovery_s"] == "10", f"receiver and its outage: {alone}")
    check(row["gnss", "calm"]["solution_share"] == row["loose", "without"]["solution_share"] == "1", "no gaps")
    check(float(row["loose", "without"]["recovery_s"]) == 0, "the coupled solution stays below the limit")
    restarted = row["separate-restart", "without"]
    check(float(restarted["horizontal_max_m"]) > 25 and restarted["recovery_s"] == "10", f"inertial unit alone: {restarted}")

    blocks = told[told.index("window without"):]
    check("window calm, 40 to 100 s" in blocks and "below 25 m" in blocks, f"a block a window: {blocks}")
    check(max(map(len, blocks.split("wrote")[0].splitlines())) <= 130, "the blocks fit 130 columns")
    page = one["report.html"].decode()
    ElementTree.fromstring(page.replace("<!DOCTYPE html>", ""))
    for part in ("horizontal error", "vertical error", "limit 25 m", "without: 100 to 190", "outage: 100 to 200",
                 "window calm", "Settings"):
        check(part in page, f"report.html: no {part}")

    for name, (old, new, parts) in {
            "backwards": ("end_s = 190", "end_s = 90", ["compare.window[0].end_s", "after start_s"]),
            "late": ("end_s = 190", "end_s = 301", ["compare.window[0].end_s", "duration_s = 300"]),
            "twice": ('"calm"', '"without"', ["compare.window[1].name", "already"]),
            "unknown": ("end_s = 190", "stop_s = 190", ["compare.window[0].stop_s", "write [[compare.window]]"]),
            "nameless": ('name = "calm"\n', "", ["compare.window[1]", "lacks name"])}.items():
        bad = (text + windows).replace(old, new, 1)
        (folder / "bad.toml").write_text(bad)
        program.fails("run", "bad.toml", "-o", name, parts=["bad.toml:", *parts])
        check(not (folder / name).exists(), f"{name} leaves nothing behind")
    (folder / "bad.toml").write_text(re.sub(r"schemes = .*\n", "", text) + windows)
    program.fails("run", "bad.toml", "-o", "schemeless", parts=["bad.toml:", "compare.window[0]", "schemes = ["])


def complex_faults(program, source):
    flight = source / "examples/paper-a-flight.toml"
    done = json.loads(program("analyze", "integrity", flight, "--kind", "ramp", "step", "--size", "2,50", "-n", 3, "--json").stdout)
    row = {(r["kind"], r["size"]): r for r in done["rows"]}
    for case in (("ramp", 2.0), ("ramp", 50.0), ("step", 50.0)):
        r = row[case]
        check(r["detected"] == 1 and r["time_to_alert_s"]["q95"] < 10, f"{case}: {r}")
        check(r["largest_horizontal_m"] < 10 < r["largest_horizontal_uncontrolled_m"], f"{case}: {r}")
    check(row["step", 2.0]["largest_horizontal_m"] < 10, "a step inside the noise is no danger")
    check(done["false_alarm_runs"] == 0, "no false alarm")
    done = json.loads(program("analyze", "integrity", flight, "--kind", "freeze", "dropout", "step", "--size", "5,50", "-n", 1, "--json").stdout)
    check([(r["kind"], r["size"]) for r in done["rows"]] == [("freeze", None), ("dropout", None), ("step", 5.0), ("step", 50.0)],
          f"kinds without a size have one row: {done['rows']}")
    program.fails("analyze", "integrity", flight, "--kind", "freeze", "--size", "5", "-n", 1, parts=["--size", "freeze"])

    told = json.loads(program("analyze", "requirements", "--budget", 5, "--outage", "60,3600", "--json").stdout)
    # closed formulas (1.4.5), (1.4.7) with g0 = 9.80665 m/s^2 and R = 6371 km
    for value, right in ((told["rows"][0]["accel_ug"], 283.38534), (told["rows"][0]["gyro_deg_h"], 2.9220813),
                         (told["rows"][1]["accel_m_s2"], 5 * 9.80665 / (2 * 6371000))):
        check(abs(value / right - 1) < 1e-6, f"requirement {value} for {right}")
    outage = {d["device"]: d["outage_s"] for d in told["devices"]}
    check(outage["consumer"] < outage["tactical"] < outage["hg9900"], f"backwards: {outage}")

    budget = json.loads(program("analyze", "budget", flight, "-n", 2, "--json").stdout)["rows"]
    part = {r["source"]: r for r in budget}
    check(part["gnss_position"]["horizontal_m"] > 5 * part["gnss_white"]["horizontal_m"], "the slow error of the receiver rules the position")
    check(part["baro"]["up_m"] > part["gyro_bias"]["up_m"], "the barometer rules the height")


def complex_refusals(program, source):
    good = 'duration_s = 20\n[trajectory]\ntype = "static"\n[imu]\nrate_hz = 10\n[gnss]\nrate_hz = 1\n'
    folder = Path(program.folder)
    cases = {"negative": (good + "white_m = [1, -1, 1]\n", ["s.toml:8", "gnss.white_m", "out of range"]),
             "unknown": (good + "whitening = 1\n", ["s.toml:8", "gnss.whitening", "unknown key"]),
             "ground": (good.replace('"static"', '"paper_a"\nstart = { lat_deg = 55, lon_deg = 30, height_m = 100 }'),
                        ["s.toml:3", "below the ground", "trajectory.ground_height_m"]),
             "turn": ('[trajectory]\ntype = "waypoints"\nwaypoints = [ { north_m = 100 }, { north_m = 0 } ]\n',
                      ["s.toml:3", "waypoints[0]", "sharper"]),
             "scheme": (good + '[compare]\nschemes = ["loose", "loosest"]\n', ["compare.schemes", "loosest", "separate-restart"]),
             "fault": (good + '[[fault]]\nstart_s = 1\nkind = "melt"\n', ["melt", "step, ramp, drift"])}
    for name, (text, parts) in cases.items():
        (folder / "s.toml").write_text(text)
        program.fails("run", "s.toml", "-o", name, parts=parts)
        check(not (folder / name).exists(), f"{name} leaves nothing behind")
    (folder / "s.toml").write_text(good)
    program.fails("montecarlo", "s.toml", "-n", 0, parts=["--runs"])
    program.fails("montecarlo", "absent.toml", parts=["absent.toml"])
    program.fails("analyze", "requirements", "--budget", -5, parts=["--budget"])
    program.fails("analyze", "requirements", "--device", "hg99", parts=["hg99", "hg9900"])
    program.fails("analyze", "integrity", "s.toml", "--kind", "melt", parts=["melt", "step"])


if __name__ == "__main__":
    main({"complex_numbers": complex_numbers, "complex_schemes": complex_schemes, "complex_windows": complex_windows,
          "complex_faults": complex_faults, "complex_refusals": complex_refusals})
