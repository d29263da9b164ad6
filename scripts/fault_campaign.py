#!/usr/bin/env python3
"""Puts faults into good logs, processes each, and looks whether the solution's sigmas cover what became of it.

    fault_campaign.py --schuler build/bin/schuler -o out/faults [--sets FOLDER...] [--simulated NAME...] [--only REGEX] [--jobs N] [--quick]

Two good logs are simulated: a car with an RTK receiver and a consumer unit, and an aircraft with an autonomous receiver, a tactical unit, a
barometer and a magnetometer. Further ones are named by --sets: folders with CSV files of an IMU and a receiver. Each fault is put into a copy
of each log, and the copy is processed as a bare folder. Errors are those against the truth where the set has one (reference.csv with
positions; it is kept from the program), against the undisturbed solution otherwise, and where the undisturbed solution is overconfident
against the truth itself: that is no fault's work, and its row says so.

An epoch counts as overconfident where north, east or down is wrong by more than 5 sigma and 1 m; a run does where more than 2 % of its epochs
are. A run is warned where it exits with another status than 0, its verdict is worse than the undisturbed one's, or it prints a warning that
the undisturbed run does not print (numbers left aside). Good fixes refused: those the program rejected beyond the number that the fault made
wrong. `back`: seconds from the end of the fault until the error stays below three times the undisturbed one for ten seconds.

Written to the folder: faults.md, faults.csv. The same program and logs give the same files.
"""
import argparse
import math
import random
import re
import sys
import tempfile
from pathlib import Path

from campaign.catalogue import QUICK, all_faults
from campaign.faults import Effect, Fault, same_clock, seed_of
from campaign.logs import Log
from campaign.runs import (in_order, kind_of_text, markdown, norm, position_error, process, rms, shown, simulate, Track, wrapped, write_csv)

FAR_M, FAR_SIGMAS, MUCH = 1.0, 5.0, 0.02
STAYS_S, TIMES = 10.0, 3.0
SETTLED_S = 60.0
ORDER = ("trustworthy", "care", "do not use")

CAR = """name = "car"
seed = 7
duration_s = {duration}
[trajectory]
type = "car"
start = {{ lat_deg = 48.137, lon_deg = 11.575, height_m = 520.0 }}
standstill_s = 30
vibration = {{ frequency_hz = 12, angle_deg = 0.02, accel_m_s2 = 0.3 }}
[imu]
rate_hz = 100
kind = "rates"
grade = "consumer"
[gnss]
rate_hz = 1
receiver = "rtk"
"""
AIRCRAFT = """name = "aircraft"
seed = 8
duration_s = {duration}
[trajectory]
type = "figure8"
start = {{ lat_deg = 50.45, lon_deg = 30.52, height_m = 400.0 }}
heading_deg = 30
length_m = 2000
width_m = 800
loop_height_m = 60
figure_s = 140
[imu]
rate_hz = 100
kind = "rates"
grade = "tactical"
[gnss]
rate_hz = 5
receiver = "autonomous"
[baro]
rate_hz = 10
white_m = 0.4
bias_m = 3
bias_walk_m = 0.05
[mag]
rate_hz = 10
inclination_deg = 66
white_ut = 0.3
hard_iron_ut = 0.2
"""


class GoodSet:
    """An undisturbed log, its solution, and what solutions are compared with."""

    def __init__(self, name, log, run):
        self.name, self.log = name, log
        self.base = run(log, f"{name}-undisturbed")
        if not self.base.finished:
            raise ValueError(f"{name}: the undisturbed log cannot be processed: {self.base.said}")
        self.truth = None if log.truth is None else track_of(log.truth)
        self.start = self.base.track.times[0] + SETTLED_S
        trusted = self.truth is not None and denied_share(errors_by(same_clock, self.base, self.truth)) <= MUCH
        self.reference = self.truth if trusted else self.base.track
        self.normal = self.error_of_base()
        self.rejected = rejected(self.base)
        self.known = {kind_of_text(text) for text in self.base.warnings()}

    def error_of_base(self):
        """Size of the undisturbed error: against the truth, or as the solution states it."""
        settled = [row for row in self.base.track.rows if row["time_s"] >= self.start]
        if self.reference is self.base.track:
            return rms(norm(sigmas(row)) for row in settled)
        pairs = ((row, self.reference.at(row["time_s"])) for row in settled)
        return rms(norm(position_error(row, true)) for row, true in pairs if true is not None)


def track_of(table):
    """A truth that is named like a reference.csv."""
    with tempfile.TemporaryDirectory() as folder:
        table.write(Path(folder))
        return Track.read(Path(folder) / table.name)


def rejected(outcome):
    return (outcome.summary.get("gnss") or {}).get("rejected") or 0


def sigmas(row):
    """Sigmas of position; one that is not a number vouches for nothing."""
    return [x if math.isfinite(x) else 0.0 for x in (row["std_n_m"], row["std_e_m"], row["std_d_m"])]


def errors_by(clock, outcome, reference):
    """Time, size of the error, whether the sigmas deny it, and error of the heading, of every epoch that can be compared."""
    out = []
    for row in outcome.track.rows:
        t = clock(row["time_s"])
        true = reference.at(t)
        if true is None:
            continue
        error = position_error(row, true)
        size = norm(error)
        denied = not math.isfinite(size) or any(abs(e) > max(FAR_M, FAR_SIGMAS * s) for e, s in zip(error, sigmas(row)))
        out.append((t, size if math.isfinite(size) else math.inf, denied, wrapped(row["heading_deg"] - true["heading_deg"])))
    return out


def denied_share(errors):
    return sum(e[2] for e in errors) / len(errors) if errors else math.nan


def best_errors(effect, outcome, reference):
    """Errors under the reading of the clock that suits the solution best."""
    found = [errors_by(clock, outcome, reference) for clock in effect.clocks]
    found = [errors for errors in found if errors]
    return min(found, key=lambda errors: (denied_share(errors), rms(e[1] for e in errors)), default=[])


def back_after(errors, end, limit):
    """Seconds after `end` until the error stays small; not a number where it does not."""
    since = None
    for t, size, _, _ in errors:
        if t < end:
            continue
        if size > limit:
            since = None
        elif since is None:
            since = t
        if since is not None and (t - since >= STAYS_S or t == errors[-1][0]):
            return since - end
    return math.nan


def complaint(good, outcome):
    """What of a run's warnings the undisturbed one does not have."""
    fresh = [text for text in outcome.warnings() if kind_of_text(text) not in good.known]
    return fresh[0] if fresh else ""


def is_warned(good, outcome, text):
    worse = outcome.verdict in ORDER and ORDER.index(outcome.verdict) > ORDER.index(good.base.verdict or ORDER[0])
    return outcome.code != 0 or worse or bool(text)


def judged(good, fault, effect, outcome):
    """A row of the table."""
    reference = good.truth or good.reference if fault.apply is None else good.reference
    errors = best_errors(effect, outcome, reference) if outcome.finished else []
    share = denied_share(errors)
    text = complaint(good, outcome)
    whole = len(good.base.track.rows)
    return {"set": good.name, "fault": fault.name, "group": fault.group, "exit": outcome.code, "finished": outcome.finished,
            "verdict": outcome.verdict, "warned": is_warned(good, outcome, text), "max_m": max((e[1] for e in errors), default=math.nan),
            "rms_m": rms(e[1] for e in errors), "heading_deg": rms(e[3] for e in errors if math.isfinite(e[3])), "denied": share,
            "overconfident": bool(share > MUCH),
            "back_s": back_after(errors, effect.until, TIMES * good.normal) if effect.until is not None else math.nan,
            "refused": max(0, rejected(outcome) - effect.bad_fixes - good.rejected), "covered": len(errors) / whole,
            "reference": "truth" if reference is good.truth else "undisturbed", "undisturbed_rms_m": good.normal, "warning": text}


class Campaign:
    """Runs of one program in one folder."""

    def __init__(self, options, folder):
        self.program, self.folder, self.options = options.schuler, folder, options

    def run(self, log, name):
        """Processes a log under a name that no other run has."""
        folder = self.folder / re.sub(r"[^A-Za-z0-9.+-]+", "_", name)
        log.write(folder / "logs")
        return process(self.program, folder / "logs", folder / "out")

    def simulated(self, name, scenario):
        simulate(self.program, scenario, self.folder / "scenarios" / name)
        return GoodSet(name, Log.read(self.folder / "scenarios" / name), self.run)

    def sets(self):
        """The good logs, one after the other."""
        quick = self.options.quick
        if "car" in self.options.simulated:
            yield self.simulated("car", CAR.format(duration=150 if quick else 400))
        if "aircraft" in self.options.simulated and not quick:
            yield self.simulated("aircraft", AIRCRAFT.format(duration=500))
        for folder in self.options.sets:
            yield GoodSet(Path(folder).resolve().name, Log.read(folder), self.run)

    def faults(self):
        chosen = [fault for fault in all_faults() if not self.options.quick or fault.name in QUICK]
        return [fault for fault in chosen if not self.options.only or re.search(self.options.only, f"{fault.group}: {fault.name}")]

    def disturbed(self, good, fault):
        """The row of one fault, or None where the log has nothing that it could change."""
        log = good.log.copy()
        effect = fault.apply(log, random.Random(seed_of(good.name, fault.name)), good.log.moment(fault.part))
        if effect is None:
            return None
        return judged(good, fault, effect, self.run(log, f"{good.name}-{fault.name}"))

    def rows(self):
        """All rows, the undisturbed run of each set first."""
        for good in self.sets():
            yield judged(good, Fault("none", "undisturbed", None), Effect(), good.base)
            yield from (row for row in in_order(lambda fault, good=good: self.disturbed(good, fault), self.faults(), self.options.jobs) if row)


def table(rows):
    """The rows for people."""
    header = ["set", "fault", "against", "exit", "verdict", "warned", "max, m", "RMS, m", "heading RMS, deg", "beyond 5 sigma and 1 m", "", "back, s",
              "good fixes refused", "first new warning"]
    return markdown(header, [[row["set"], row["fault"], row["reference"], row["exit"], row["verdict"] or "-", shown(row["warned"]), shown(row["max_m"]),
                              shown(row["rms_m"]), shown(row["heading_deg"]), "-" if math.isnan(row["denied"]) else f"{row['denied']:.1%}",
                              "overconfident" if row["overconfident"] else "",
                              shown(row["back_s"]), row["refused"], row["warning"][:110]] for row in rows])


def by_group(rows):
    """Groups of faults with their counts, the worst first."""
    groups = {}
    for row in rows:
        groups.setdefault(row["group"], []).append(row)
    counted = [(name, len(g), sum(r["finished"] for r in g), sum(r["overconfident"] for r in g),
                sum(r["overconfident"] and not r["warned"] for r in g), sum(r["refused"] for r in g)) for name, g in groups.items()]
    counted.sort(key=lambda c: (-c[3], -c[4], c[0]))
    return markdown(["faults", "runs", "finished", "overconfident", "without warning", "good fixes refused"], counted)


def summary(rows):
    """The closing lines."""
    done = [row for row in rows if row["group"] != "undisturbed"]
    over = [row for row in done if row["overconfident"]]
    alone = [row["set"] for row in rows if row["group"] == "undisturbed" and row["overconfident"]]
    return [f"undisturbed and overconfident: {', '.join(alone) or 'none'}", f"runs: {len(done)}", f"finished: {sum(row['finished'] for row in done)}", f"overconfident: {len(over)}",
            f"overconfident without warning: {sum(not row['warned'] for row in over)}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--schuler", default="build/bin/schuler", type=Path, help="the program")
    parser.add_argument("--sets", nargs="*", default=[], help="folders with further good logs")
    parser.add_argument("--simulated", nargs="*", default=["car", "aircraft"], choices=["car", "aircraft"], help="simulated sets; none: only --sets")
    parser.add_argument("--only", help="regular expression of faults, as `group: name`")
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time")
    parser.add_argument("--quick", action="store_true", help="one short log and a dozen faults")
    parser.add_argument("--list", action="store_true", help="print the faults and stop")
    parser.add_argument("-o", "--output", type=Path, default=Path("out/faults"))
    options = parser.parse_args()
    if options.list:
        print("\n".join(f"{fault.group}: {fault.name}" for fault in all_faults()))
        return 0
    options.schuler = options.schuler.resolve()
    options.output.mkdir(parents=True, exist_ok=True)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for row in Campaign(options, Path(folder)).rows():
            rows.append(row)
            print(f"{row['set']}: {row['fault']}: exit {row['exit']}, {shown(row['max_m'])} m{', overconfident' if row['overconfident'] else ''}",
                  file=sys.stderr, flush=True)
    write_csv(options.output / "faults.csv", rows)
    lines = summary(rows)
    text = "\n".join(["# Faults put into good logs\n", table(rows), by_group(rows), *(line + "  " for line in lines)]) + "\n"
    (options.output / "faults.md").write_text(text, encoding="utf-8")
    print("\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
