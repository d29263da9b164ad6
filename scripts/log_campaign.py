#!/usr/bin/env python3
"""Random simulated logs, written as strangers write them, processed as bare folders and measured against the truth.

    log_campaign.py --schuler build/bin/schuler -n 500 --seed 1 -o out/logs [--jobs N] [--quick] [--antenna] [--log INDEX --keep DIR]

Vehicle (car, air, ship, hand, static), motion, device grade, receiver (rate, latency, slow errors, sigmas stated wrong or not at all, with or
without velocity), further sensors, axes, units, names of columns and scale of time are drawn from the seed; log k of a seed is the same
however many there are. GNSS is withheld in windows of 10, 15 and 30 s. The program gets nothing but the folder.

Shares of epochs inside three sigma: position (north, east and down), velocity likewise, heading; over the whole solution and in the withheld
windows alone. With --antenna the antenna is away from the unit, and three of five folders have a dataset.toml with the lever arm; in the others the
solution is compared with the motion of the antenna, unless the program finds the lever arm. A window is inside where north and east are at every epoch. Written to the folder: logs.csv, one row a log, and logs.md: means,
the worst logs with their properties, and which properties the failing logs have. `--log INDEX --keep DIR` writes one log for a closer look.
"""
import argparse
import math
import sys
import tempfile
from pathlib import Path

from campaign.logs import Log
from campaign.random_logs import draw
from campaign.runs import FIELDS, TILT, Track, in_order, markdown, norm, position_error, process, rms, shown, simulate, wrapped, write_csv
from campaign.strangers import rewritten

SIGMAS = 3.0
COVERED, LEAST = 0.97, 0.90          # what the mean, and every single log, is to reach
HEADING_DEG = 10.0
CALENDARS = (0.0, -315_964_800.0, -315_964_782.0, 315_964_800.0)   # the solution may count from 1970 or from 1980, with leap seconds or without
GROUPS = ("vehicle", "path", "grade", "imu rate", "mounting", "axes", "receiver", "rate", "latency", "slow errors", "gnss velocity", "sigma", "sensors", "time",
          "units", "columns", "antenna", "length")


def written(program, one, folder):
    """Simulates a log, rewrites it into folder/logs, and gives the truth."""
    simulate(program, one.scenario, folder / "simulated")
    log = Log.read(folder / "simulated")
    truth = Track.read(folder / "simulated" / "reference.csv", FIELDS + TILT)
    log = rewritten(log, one.style)
    if one.told:
        log.settings = f"[gnss]\nlever_arm_m = {list(one.lever_arm)}\n"
    log.write(folder / "logs")
    return truth


def motion_of(truth, one, outcome):
    """That of the point to which the solution refers: the unit if its lever arm was told or found, otherwise the antenna."""
    found = any(fact["key"] == "gnss.lever_arm_m" and fact["how"] == "found" for fact in outcome.summary.get("facts", []))
    known = (one.told or found) and outcome.summary["point"] == "imu"
    return truth if known or not any(one.lever_arm) else truth.at_point(one.lever_arm)


def offset_of(track, one):
    """Seconds to subtract from the solution's times to count from the start of the log."""
    first = track.times[0]
    return min((one.style.base + calendar for calendar in CALENDARS), key=lambda base: abs(first - base))


def inside(errors, sigmas):
    """All components within three sigma; a sigma that is not a number covers nothing."""
    return all(abs(e) <= SIGMAS * s for e, s in zip(errors, sigmas))


def compared(track, truth, one):
    """Of every epoch that has a truth: time, errors, and what is inside."""
    offset, out = offset_of(track, one), []
    for row in track.rows:
        t = row["time_s"] - offset
        true = truth.at(t)
        if true is None:
            continue
        position = position_error(row, true)
        stds = [row[name] for name in ("std_n_m", "std_e_m", "std_d_m")]
        velocity = [row[name] - true[name] for name in ("vel_n_m_s", "vel_e_m_s", "vel_d_m_s")]
        heading = wrapped(row["heading_deg"] - true["heading_deg"])
        out.append({"t": t, "position": position, "position inside": inside(position, stds), "level inside": inside(position[:2], stds[:2]),
                    "velocity": norm(velocity), "velocity inside": inside(velocity, [row[name] for name in ("std_vn_m_s", "std_ve_m_s", "std_vd_m_s")]),
                    "heading": heading, "heading sigma": row["std_heading_deg"], "heading inside": inside([heading], [row["std_heading_deg"]])})
    return out


def share(epochs, key):
    return sum(e[key] for e in epochs) / len(epochs) if epochs else math.nan


def measured(one, outcome, truth):
    """The figures of a run."""
    epochs = compared(outcome.track, truth, one) if outcome.finished else []
    parts = [[e for e in epochs if start < e["t"] < start + length] for start, length in one.outages]   # the first fix is at zero
    parts = [part for part in parts if part]
    out = [e for part in parts for e in part]
    last = epochs[-1] if epochs else None
    checked = outcome.summary.get("self_check") or {}
    return {"exit": outcome.code, "verdict": outcome.verdict, "widened": (checked.get("noise_scale") or {}).get("gyro") if checked.get("widened") else "",
            "self-check": checked.get("inside_3sigma_epochs") or math.nan, "epochs": len(epochs), "position": share(epochs, "position inside"),
            "velocity": share(epochs, "velocity inside"), "heading": share(epochs, "heading inside"), "outage position": share(out, "position inside"),
            "outage velocity": share(out, "velocity inside"), "outage heading": share(out, "heading inside"), "windows": len(parts),
            "windows inside": sum(all(e["level inside"] for e in part) for part in parts),
            "window ends m": rms(math.hypot(*part[-1]["position"][:2]) for part in parts), "position rms m": rms(norm(e["position"]) for e in epochs),
            "velocity rms m/s": rms(e["velocity"] for e in epochs), "end heading deg": last["heading"] if last else math.nan,
            "end heading sigma deg": last["heading sigma"] if last else math.nan, "end heading inside": bool(last and last["heading inside"]),
            "rejected": (outcome.summary.get("gnss") or {}).get("rejected") or 0, "warnings": len(outcome.summary.get("warnings", [])),
            "said": outcome.said if outcome.code != 0 else next(iter(outcome.summary.get("warnings", [])), ""),
            "reasons": "; ".join((outcome.summary.get("verdict") or {}).get("reasons") or [])}


def failures(row):
    """Why a log does not reach its lines."""
    if not row["epochs"]:
        return [f"nothing (exit {row['exit']})"]
    out = [name for name in ("position", "velocity", "heading") if row[name] < LEAST]
    out += [f"{name} in outages" for name in ("position", "velocity") if row[f"outage {name}"] < LEAST]
    if row["moves"] and not (row["end heading inside"] and abs(row["end heading deg"]) <= HEADING_DEG):
        out.append("heading at the end")
    return out


class Campaign:
    """Logs of one seed through one program."""

    def __init__(self, options, folder):
        self.options, self.folder = options, folder

    def drawn(self, index):
        return draw(self.options.seed, index, *((130.0, 200.0) if self.options.quick else (180.0, 1200.0)), self.options.antenna)

    def row(self, index):
        """Everything about one log."""
        one = self.drawn(index)
        folder = self.folder / str(index)
        truth = written(self.options.schuler, one, folder)
        outages = ",".join(f"{start}:{length}" for start, length in one.outages)
        outcome = process(self.options.schuler, folder / "logs", folder / "out", *(["--outage", outages] if outages else []))
        row = {"log": one.seed, "moves": one.moves, **one.properties, **measured(one, outcome, motion_of(truth, one, outcome))}
        row["failures"] = "; ".join(failures(row))
        return row


def mean(rows, key):
    values = [row[key] for row in rows if math.isfinite(row[key])]
    return sum(values) / len(values) if values else math.nan


def percent(value):
    return "-" if math.isnan(value) else f"{value:.1%}"


def summary(rows):
    """The closing lines."""
    good = [row for row in rows if row["epochs"]]
    windows = sum(row["windows"] for row in good)
    moving = [row for row in good if row["moves"]]
    headed = sum("heading at the end" not in row["failures"] for row in moving)
    return [f"logs: {len(rows)}, with a solution: {len(good)}, without: {len(rows) - len(good)}",
            "inside three sigma, mean over the logs: " + ", ".join(f"{key} {percent(mean(good, key))}" for key in ("position", "velocity", "heading")),
            "in outages: " + ", ".join(f"{key} {percent(mean(good, 'outage ' + key))}" for key in ("position", "velocity", "heading")),
            f"windows inside: {sum(row['windows inside'] for row in good)} of {windows}",
            f"logs below {LEAST:.0%}: " + ", ".join(f"{key} {sum(row[key] < LEAST for row in good)}" for key in ("position", "velocity", "heading", "outage position")),
            f"heading at the end within 3 sigma and {HEADING_DEG:.0f} deg: {headed} of {len(moving)} that move",
            f"logs that fail in something: {sum(bool(row['failures']) for row in rows)}; without any warning: "
            f"{sum(bool(row['failures']) and row['exit'] == 0 and row['warnings'] == 0 for row in rows)}"]


def worst(rows, count=25):
    """The worst logs with what they are."""
    ranked = sorted((row for row in rows if row["failures"]), key=lambda row: (min([x for x in (row["position"], row["velocity"], row["outage position"])
                                                                                    if math.isfinite(x)], default=-1.0), row["log"]))
    header = ["log", "position", "velocity", "heading", "in outages", "windows", "end heading, sigma, deg", "exit", "what it is", "fails in", "first message"]
    cells = [[row["log"], percent(row["position"]), percent(row["velocity"]), percent(row["heading"]), percent(row["outage position"]),
              f"{row['windows inside']}/{row['windows']}", f"{shown(row['end heading deg'])}, {shown(row['end heading sigma deg'])}", row["exit"],
              f"{row['vehicle']} ({row['path']}) {row['grade']} {row['imu rate']} Hz {row['mounting']} {row['axes']}; {row['receiver']} {row['rate']} Hz, late {row['latency']:g}/"
              f"{row['velocity latency']:g} s, velocity {row['gnss velocity']}, sigma {row['sigma']} ({row['sigma factor']:g}), slow {row['slow errors']}; {row['sensors']}; "
              f"{row['time']}; {row['units']}; antenna {row['antenna']}; {row['duration']} s", row["failures"], row["said"][:100]] for row in ranked[:count]]
    return markdown(header, cells)


def grouped_value(row, name):
    """The property by which logs are grouped."""
    if name == "latency":
        return "none" if row["latency"] == 0 else "below 0.1 s" if row["latency"] < 0.1 else "above"
    if name == "length":
        return "below 400 s" if row["duration"] < 400 else "to 800 s" if row["duration"] < 800 else "above"
    return str(row[name])


def by_property(rows):
    """How many logs of each kind fail, and in what."""
    out = []
    for name in GROUPS:
        kinds = {}
        for row in rows:
            kinds.setdefault(grouped_value(row, name), []).append(row)
        for kind, members in sorted(kinds.items()):
            bad = [row for row in members if row["failures"]]
            good = [row for row in members if row["epochs"]]
            out.append([name, kind, len(members), len(bad), f"{len(bad) / len(members):.0%}", len(members) - len(good), percent(mean(good, "position")),
                        percent(mean(good, "velocity")), percent(mean(good, "heading")), percent(mean(good, "outage position"))])
    return markdown(["property", "", "logs", "fail", "", "no solution", "position", "velocity", "heading", "position in outages"], out)


def by_failure(rows):
    """In what the logs fail, and how many of these logs say a word about anything."""
    kinds = {}
    for row in rows:
        for kind in filter(None, row["failures"].split("; ")):
            kinds.setdefault(kind, []).append(row)
    ranked = sorted(kinds.items(), key=lambda pair: (-len(pair[1]), pair[0]))
    return markdown(["fails in", "logs", "with a warning or another status"], [[kind, len(members), sum(row["warnings"] > 0 or row["exit"] != 0 for row in members)]
                                                                              for kind, members in ranked])


WORDS = ("trustworthy", "care", "do not use", "")


def worst_share(row):
    """The smaller of the shares of positions inside three sigma, of all epochs and of those without fixes; 0 without a solution."""
    shares = [row[key] for key in ("position", "outage position") if math.isfinite(row[key])]
    return min(shares, default=0.0)


def by_verdict(rows):
    """What the program said of the logs against what became of them."""
    kinds = (("97 % and more", COVERED, 2.0), ("90 to 97 %", LEAST, COVERED), ("below 90 %", -1.0, LEAST))
    cells = [[word or "none", *(sum(row["verdict"] == word and low <= worst_share(row) < high for row in rows) for _, low, high in kinds),
              sum(row["verdict"] == word and "heading at the end" in row["failures"] for row in rows)]
             for word in WORDS if any(row["verdict"] == word for row in rows)]
    return markdown(["verdict", *(f"{name} inside" for name, _, _ in kinds), "heading wrong in the end"], cells)


def by_widening(rows):
    """Coverage in the withheld windows of the logs whose noise the self-check widened, and of the others."""
    cells = []
    for name, chosen in (("widened", [row for row in rows if row["widened"]]), ("not widened", [row for row in rows if not row["widened"] and row["epochs"]])):
        cells.append([name, len(chosen), percent(mean(chosen, "position")), percent(mean(chosen, "outage position")), sum(row["windows inside"] for row in chosen),
                      sum(row["windows"] for row in chosen)])
    return markdown(["noise", "logs", "position", "position in outages", "windows inside", "of"], cells)


def report(rows):
    return "\n".join(["# Random logs, processed as bare folders\n", *(line + "  " for line in summary(rows)), "\n## What they are said to be\n", by_verdict(rows),
                      by_widening(rows), "## In what they fail\n", by_failure(rows),
                      "## The worst\n", worst(rows), "## By property\n", by_property(rows)]) + "\n"


def keep(options):
    """Writes one log and how to process it."""
    folder = options.keep.resolve()
    campaign = Campaign(options, folder)
    one = campaign.drawn(options.log)
    written(options.schuler, one, folder)
    print(f"schuler process {folder / 'logs'} --outage {','.join(f'{start}:{length}' for start, length in one.outages)}")
    print("\n".join(f"{key}: {value}" for key, value in one.properties.items()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--schuler", default="build/bin/schuler", type=Path, help="the program")
    parser.add_argument("-n", "--count", type=int, help="number of logs (default 500, quick: 16)")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time")
    parser.add_argument("--quick", action="store_true", help="a few short logs")
    parser.add_argument("--antenna", action="store_true", help="the antenna is away from the unit")
    parser.add_argument("--log", type=int, help="only this log; with --keep it is written and not processed")
    parser.add_argument("--keep", type=Path, help="folder for the log named by --log")
    parser.add_argument("-o", "--output", type=Path, default=Path("out/logs"))
    options = parser.parse_args()
    options.schuler = options.schuler.resolve()
    if options.keep is not None:
        if options.log is None:
            parser.error("--keep needs --log")
        keep(options)
        return 0
    count = options.count or (16 if options.quick else 500)
    numbers = [options.log] if options.log is not None else range(options.first, options.first + count)
    options.output.mkdir(parents=True, exist_ok=True)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for row in in_order(Campaign(options, Path(folder)).row, numbers, options.jobs):
            rows.append(row)
            print(f"{row['log']}: {row['vehicle']} {row['grade']}: {percent(row['position'])} {row['failures']}", file=sys.stderr, flush=True)
    write_csv(options.output / "logs.csv", rows)
    (options.output / "logs.md").write_text(report(rows), encoding="utf-8")
    print("\n".join(summary(rows)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
