"""Ranges from outside: the triad of paper D, schemes with few satellites, stations from a receiver's log."""
import json
import math
import os
import re
import shutil
import sys
from pathlib import Path

from program_test import check, main


def ranges_triad(program, source):
    """The study stands beside its reference, does not depend on --jobs, and refuses what it does not know."""
    done = json.loads(program("analyze", "triad", "--cases", "ce", "--baro", 30, "-n", 6, "--json").stdout)
    row = {r["key"]: r for r in done["rows"]}
    check(list(row) == ["c", "e"], f"cases: {list(row)}")
    check(abs(row["c"]["reference"]["pooled"] - 32.12) < 0.01, f"reference of case c: {row['c']['reference']}")
    check(done["ratio_c_e_at_600_s"] > 2, f"two stations replace two satellites: {done['ratio_c_e_at_600_s']}")
    for jobs in (1, 2):
        program("analyze", "triad", "--cases", "s", "-n", 3, "--jobs", jobs, "-o", f"triad{jobs}", "-q")
    for name in ("triad.csv", "course.csv", "summary.json", "report.html"):
        one, two = ((Path(program.folder) / f"triad{jobs}" / name).read_bytes() for jobs in (1, 2))
        check(one == two, f"{name} does not depend on --jobs")
    course = (Path(program.folder) / "triad1/course.csv").read_text().splitlines()
    check(len(course) == 602, f"a row a second: {len(course)}")
    check(float(course[302 + 60].split(",")[1]) < float(course[301].split(",")[1]), "the stations that come on help")
    for option, value in {"--cases": "az", "--grade": "toy", "--oscillator": "quartz", "--baro": "-3", "--mechanization": "polar"}.items():
        program.fails("analyze", "triad", option, value, parts=[option])


def ranges_schemes(program, source):
    """One flight through the schemes with fewer and fewer satellites: below four the receiver has no fix, the tight filter has."""
    rows = json.loads(program("run", source / "examples/schemes-satellites.toml", "-o", "few", "--json").stdout)["schemes"]
    error = {(r["scheme"], r["satellites"]): r["horizontal_m"] for r in rows}
    for scheme in ("tight", "intermediate"):
        check(error[scheme, 8] < 6 and error[scheme, 4] < 8, f"{scheme} with four and more: {error}")
    # how well a loose filter coasts is a matter of luck: root mean squares over flights
    rows = json.loads(program("montecarlo", source / "examples/schemes-satellites.toml", "-n", 5, "-o", "flights", "--json").stdout)["schemes"]
    error = {(r["scheme"], r["satellites"]): r["horizontal_m"] for r in rows}
    for scheme in ("tight", "intermediate"):
        for few in (3, 2):
            check(error[scheme, few] < 0.5 * error["loose", few], f"{scheme} with {few} satellites against loose coupling: {error}")
    for r in rows:
        if r["scheme"] != "gnss":
            check(0.6 < r["nees_position"]["mean"] < 7.5, f"{r['scheme']} with {r['satellites']} satellites: {r['nees_position']}")   # 99.9 % of five
    program("run", source / "examples/schemes-satellites.toml", "--scheme", "intermediate", "-o", "medium", "--set", "filter.protection.use=true", "-q")
    table = (Path(program.folder) / "few/comparison.csv").read_text().splitlines()
    check(table[0].startswith("scheme,satellites,") and len(table) == 21, f"comparison.csv: {table[0]}, {len(table)} lines")


def ranges_studies(program, source):
    """Budget and integrity where the filter has ranges: their errors one at a time, faults in one of them."""
    flight = source / "examples/triad-4sv.toml"
    budget = {r["source"]: r for r in json.loads(program("analyze", "budget", flight, "-n", 1, "--json").stdout)["rows"]}
    check("gnss_white" not in budget and "stations" not in budget, f"only what there is: {list(budget)}")
    check(budget["range_slow"]["horizontal_m"] > 2 * budget["range_white"]["horizontal_m"] > 0.1, "the slow errors of ranges rule")
    check(budget["accel_noise"]["horizontal_m"] < 0.2 * budget["all"]["horizontal_m"], "the accelerometers' noise does not")
    ratio = budget["root_sum_square"]["horizontal_m"] / budget["all"]["horizontal_m"]
    check(0.5 < ratio < 2, f"the parts explain the whole: {ratio}")

    done = json.loads(program("analyze", "integrity", flight, "--kind", "step", "ramp", "--size", "1,50", "-n", 1, "--json").stdout)
    row = {(r["kind"], r["size"]): r for r in done["rows"]}
    check(done["victim"] == "range" and done["false_alarm_runs"] == 0, f"{done}")
    check(row["step", 1.0]["detected"] == 0, "a step inside the noise is not found")
    for case in (("step", 50.0), ("ramp", 50.0), ("ramp", 1.0)):
        r = row[case]
        check(r["detected"] == 1 and r["largest_horizontal_m"] < 10 < r["largest_horizontal_uncontrolled_m"], f"{case}: {r}")
    program.fails("analyze", "integrity", flight, "--kind", "freeze", parts=["freeze", "--kind"])


CORRELATORS = """
name = "correlators"
duration_s = 60
[trajectory]
type = "figure8"
start = { lat_deg = 52.3, lon_deg = 104.3, height_m = 3000 }
length_m = 4000
width_m = 1500
figure_s = 120
[imu]
rate_hz = 100
grade = "tactical"
[gnss]
rate_hz = 0
[ranges]
systems = "G"
gps_week = 2300
gps_second = 0
elevation_mask_deg = 7.5
correlated_m = 0.5
clock_h0_s = 2e-19
[receiver]
rate_hz = 5
cn0_db_hz = 40
[filter]
initial_error = { level_deg = 0.05, heading_deg = 0.1, velocity_m_s = 0.1, position_m = 10 }
[run]
settle_s = 20
"""


def ranges_correlators(program, source):
    """Budget and integrity where a receiver is simulated at the level of its correlators, in and out of the filter's loop."""
    (Path(program.folder) / "correlators.toml").write_text(CORRELATORS)
    for scheme in ("tight", "deep"):
        order = ("correlators.toml", "--set", f"filter.scheme={scheme}")
        budget = {r["source"]: r for r in json.loads(program("analyze", "budget", *order, "-n", 1, "--json").stdout)["rows"]}
        check("range_white" not in budget and {"channels", "range_slow", "clock"} <= set(budget), f"{scheme}: {list(budget)}")
        # what the IMU's errors leave beside exact measurements against what the channels' noise leaves
        for key in ("horizontal_m", "velocity_m_s"):
            check(budget["accel_noise"][key] < 0.5 * budget["channels"][key], f"{scheme}: {key}: {budget}")
        check(budget["accel_noise"]["horizontal_m"] < 0.1 < 10 * budget["channels"]["horizontal_m"] < 20, f"{scheme}: {budget}")
        ratio = budget["root_sum_square"]["horizontal_m"] / budget["all"]["horizontal_m"]
        check(0.5 < ratio < 2, f"{scheme}: the parts explain the whole: {ratio}")
        done = json.loads(program("analyze", "integrity", *order, "--kind", "step", "ramp", "--size", "1,60", "-n", 1, "--start", 30,
                                  "--duration", 20, "--json").stdout)
        row = {(r["kind"], r["size"]): r for r in done["rows"]}
        check(done["victim"] == "range" and done["false_alarm_runs"] == 0, f"{scheme}: {done}")
        check(row["step", 1.0]["detected"] == 0, f"{scheme}: a step inside the noise is not found")
        for case in (("step", 60.0), ("ramp", 60.0)):
            r = row[case]
            check(r["detected"] == 1 and r["largest_horizontal_m"] < 10 < r["largest_horizontal_uncontrolled_m"], f"{scheme}: {case}: {r}")


def ranges_protection(program, source):
    """Faults against protection levels, in short; the files of a run that asks for them."""
    done = json.loads(program("analyze", "protection", "-n", 40, "-o", "trials", "--json").stdout)
    check(done["misleading_epochs"]["events"] == 0, f"errors above their levels: {done['misleading_epochs']}")
    check(done["alarms"]["events"] + done["excluded"]["events"] > 20, f"faults are noticed: {done['alarms']}, {done['excluded']}")
    check(len((Path(program.folder) / "trials/trials.csv").read_text().splitlines()) == 41, "a row a fault")
    program("run", source / "examples/triad-4sv.toml", "--scheme", "medium", "--set", "filter.protection.use=true", "-o", "guarded", "-q")
    rows = (Path(program.folder) / "guarded/protection.csv").read_text().splitlines()
    check(rows[0] == "time_s,hpl_m,vpl_m,used,excluded,alarm" and len(rows) > 700, f"protection.csv: {rows[0]}, {len(rows)} lines")
    check(len((Path(program.folder) / "guarded/receiver.csv").read_text().splitlines()) > 700, "receiver.csv")
    program.fails("analyze", "protection", "--missed-detection", 2, parts=["--missed-detection"])
    program.fails("run", source / "examples/triad-4sv.toml", "--set", "filter.protection.false_alarm=3", parts=["false_alarm"])


def squitter(address, lat, lon, height_m, odd):
    """An airborne position message of 1090 MHz, geometric height, as AVR text."""
    zones = 59 if odd else 60
    step = 360.0 / zones
    yz = math.floor(131072 * (lat % step) / step + 0.5)
    rlat = step * (yz / 131072 + math.floor(lat / step))
    zone = math.floor(2 * math.pi / math.acos(1 - (1 - math.cos(math.pi / 30)) / math.cos(math.radians(rlat)) ** 2))
    lon_step = 360.0 / max(zone - odd, 1)
    xz = math.floor(131072 * (lon % lon_step) / lon_step + 0.5)
    n = round((height_m / 0.3048 + 1000) / 25)
    altitude = (n >> 4) << 5 | 0x10 | (n & 0xF)
    bits = (17 << 107) | (5 << 104) | (address << 80) | (20 << 75) | (altitude << 60) | (odd << 58) | ((yz % 131072) << 41) | ((xz % 131072) << 24)
    value = bits >> 24
    rest = value << 24
    for bit in range(111, 23, -1):
        if rest >> bit & 1:
            rest ^= 0x1FFF409 << (bit - 24)
    return f"*{bits | rest:028X};\n"


def ranges_adsb(program, source):
    """Stations of a log of extended squitters instead of stations.csv."""
    program("simulate", source / "examples/triad-2sv2st.toml", "-o", "flown", "-q")
    folder = Path(program.folder) / "flown"
    surveyed = json.loads(program("process", folder, "--scheme", "tight", "-o", "surveyed", "--json", "--settle", 479).stdout)["errors"]
    stations = [line.split(",") for line in (folder / "stations.csv").read_text().splitlines()[1:]]
    log, ranges = "", (folder / "ranges.csv").read_text()
    for number, (name, lat, lon, height) in enumerate(stations):
        address = 0xABC001 + number
        ranges = re.sub(rf"\b{name}\b", f"ADSB-{address:06X}", ranges)
        for k in range(12):
            log += squitter(address, float(lat), float(lon), float(height), k % 2)
    log += "*8D40621D58C386435CC412692AD7;\n"   # damaged: wrong parity
    (folder / "ranges.csv").write_text(ranges)
    (folder / "stations.csv").unlink()
    (folder / "squitters.avr").write_text(log)
    settings = (folder / "dataset.toml").read_text()
    (folder / "dataset.toml").write_text(settings.replace("stations.csv", "squitters.avr"))
    told = program("inspect", folder / "squitters.avr").stdout
    check("ADSB-ABC001" in told and "ADSB-ABC002" in told, f"inspect tells the stations: {told}")
    kinds = [f["kind"] for f in json.loads(program("inspect", folder / "squitters.avr", "--json").stdout)["files"]]
    check(kinds == ["adsb"], f"inspect --json: {kinds}")
    heard = json.loads(program("process", folder, "--scheme", "tight", "-o", "heard", "--json", "--settle", 479).stdout)["errors"]
    one, two = (e["position_m"]["horizontal"]["rms"] for e in (surveyed, heard))
    check(abs(one - two) < 6, f"places told to 5 m: {one} m surveyed, {two} m heard")
    (folder / "squitters.avr").write_text(log[:60])
    program.fails("process", folder, "--scheme", "tight", "-o", "none", parts=["squitters.avr", "stations.csv"])


def ranges_car(program, source):
    """Tight coupling, smoothed, with magnetometer and wheels: better than without them, forward and smoothed, and as good as it says."""
    folder, seeds = Path(program.folder), (1, 2, 3)
    without = {"mag.use": "false", "filter.nonholonomic": "false", "filter.zero_velocity": "false", "filter.detect_wheels": "false"}
    inside = count = 0
    squares = {name: [0.0, 0.0, 0.0] for name in ("with", "without")}
    nees = {block: [0.0, 0.0, 0.0] for block in ("position", "velocity", "attitude")}
    for seed in seeds:
        program("simulate", source / "examples/car-tight.toml", "--seed", seed, "-o", "drive", "-q")
        for name, less in (("with", {}), ("without", without)):
            told = json.loads(program("process", "drive", "--scheme", "tight", "--smooth", "--settle", 60, "-o", name, "--json",
                                      *(x for key, value in less.items() for x in ("--set", f"{key}={value}"))).stdout)
            check(told["scheme"] == "tight" and told["smoothed"], f"what was in force: {told['scheme']}, smoothed {told['smoothed']}")
            errors, used = told["errors"], told["consistency"]["nis"]
            check(all((used.get(aid) is not None) == (name == "with") for aid in ("mag", "nonholonomic")), f"{name}: aids used {list(used)}")
            for i, rms in enumerate((errors["position_m"]["horizontal"]["rms"], errors["attitude_deg"]["heading"]["rms"],
                                     errors["position_m_forward"]["horizontal"]["rms"])):
                squares[name][i] += rms**2
            if name == "without":
                continue
            for block, sums in nees.items():
                for i, key in enumerate(("mean", "low95", "high95")):
                    sums[i] += told["consistency"][f"nees_{block}"][key] / len(seeds)
        truth = {row[0]: [float(x) for x in row[1:4]] for row in table(folder / "drive/reference.csv")}
        for row in table(folder / "with/solution.csv"):
            if row[0] not in truth:
                continue
            lat, lon, height = truth[row[0]]
            own = [float(x) for x in row[1:]]
            off = ((own[0] - lat) * 111_320, (own[1] - lon) * 111_320 * math.cos(math.radians(lat)), own[2] - height)
            inside += sum(abs(x) < 3 * sigma for x, sigma in zip(off, own[9:12]))
            count += 3
    for i, (what, factor) in enumerate((("horizontal", 0.9), ("heading", 0.9), ("forward", 0.2))):
        check(squares["with"][i] < factor**2 * squares["without"][i], f"{what}: {squares}")
    check(count > 3000 and inside > 0.98 * count, f"inside three sigma: {inside} of {count}")
    for block, (mean, low, high) in nees.items():
        check(low < mean < high, f"NEES {block}: {mean}, {low} to {high}")


def ranges_real(program, source):
    """A receiver's log beside the unit's, nothing said: its raw measurements serve the tight filter, and are watched for faults."""
    walk = Path(os.environ.get("SCHULER_DATA", source.parent / "shared/data")) / "walk_0827"
    if not walk.is_dir():
        print(f"skipped: {walk} is not there (set SCHULER_DATA)")
        sys.exit(77)
    folder = Path(program.folder) / "walk"
    folder.mkdir()
    for name in ("imu.csv", "gnss.ubx"):
        shutil.copy(walk / name, folder)
    program("process", "walk", "--scheme", "tight", "--self-check", "off", "-o", "out")
    done = json.loads((Path(program.folder) / "out/summary.json").read_text())
    check(done["gnss"]["accepted"] > 500 and done["gnss"]["rejected"] < 20, f"{done['gnss']}")
    check("protection" in (Path(program.folder) / "out/config.toml").read_text() and (Path(program.folder) / "out/protection.csv").exists(), "not watched")
    program("process", "walk", "--scheme", "tight", "--self-check", "off", "-o", "out", "--outage", "40:10")
    done = json.loads((Path(program.folder) / "out/summary.json").read_text())
    check(done["gnss"]["withheld"] > 30, f"an outage withholds: {done['gnss']}")


def table(path):
    """Rows of a CSV file without its head."""
    return [line.split(",") for line in path.read_text().splitlines()[1:]]


if __name__ == "__main__":
    main({"ranges_triad": ranges_triad, "ranges_schemes": ranges_schemes, "ranges_real": ranges_real, "ranges_studies": ranges_studies,
          "ranges_correlators": ranges_correlators, "ranges_protection": ranges_protection, "ranges_adsb": ranges_adsb, "ranges_car": ranges_car})
