"""Runs of the program, and the errors of its solutions against a reference."""
import bisect
import csv
import json
import math
import re
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor

from campaign.logs import METRES_PER_DEGREE

FIELDS = ("time_s", "lat_deg", "lon_deg", "height_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "heading_deg")
SIGMAS = ("std_n_m", "std_e_m", "std_d_m", "std_vn_m_s", "std_ve_m_s", "std_vd_m_s", "std_heading_deg")


TILT = ("roll_deg", "pitch_deg")


def turned(arm, row):
    """A lever arm (forward, right, down) as north, east, down."""
    roll, pitch, heading = (math.radians(row[name]) for name in ("roll_deg", "pitch_deg", "heading_deg"))
    x, y, z = arm
    y, z = y * math.cos(roll) - z * math.sin(roll), y * math.sin(roll) + z * math.cos(roll)
    x, z = x * math.cos(pitch) + z * math.sin(pitch), z * math.cos(pitch) - x * math.sin(pitch)
    return x * math.cos(heading) - y * math.sin(heading), x * math.sin(heading) + y * math.cos(heading), z


class Track:
    """Rows of a trajectory by their names; what a file does not have is not a number."""

    def __init__(self, rows):
        self.rows = rows
        self.times = [row["time_s"] for row in rows]

    @classmethod
    def read(cls, path, names=FIELDS + SIGMAS):
        with open(path, encoding="utf-8", newline="") as file:
            reader = csv.reader(file)
            header = next(reader)
            columns = [(name, header.index(name)) for name in names if name in header]
            blank = dict.fromkeys(names, math.nan)
            rows = [blank | {name: float(line[i]) if line[i] else math.nan for name, i in columns} for line in reader]
        return cls(rows)

    def at_point(self, arm):
        """The motion of another point of the body; velocities by differences over two rows."""
        arms = [turned(arm, row) for row in self.rows]
        rows = []
        for i, row in enumerate(self.rows):
            before, after = max(i - 1, 0), min(i + 1, len(arms) - 1)
            step = self.times[after] - self.times[before]
            north, east, down = arms[i]
            radius = METRES_PER_DEGREE * (1.0 + row["height_m"] / 6.371e6)
            moved = {"lat_deg": row["lat_deg"] + north / radius, "height_m": row["height_m"] - down,
                     "lon_deg": row["lon_deg"] + east / (radius * math.cos(math.radians(row["lat_deg"])))}
            moved |= {name: row[name] + (arms[after][k] - arms[before][k]) / step for k, name in enumerate(("vel_n_m_s", "vel_e_m_s", "vel_d_m_s"))}
            rows.append(row | moved)
        return Track(rows)

    def at(self, t, gap=1.5):
        """The row at a time, between its neighbours; None outside and in gaps."""
        i = bisect.bisect_left(self.times, t - 1e-6)
        if i == len(self.times):
            return None
        after = self.rows[i]
        if abs(after["time_s"] - t) < 1e-6:
            return after
        if i == 0 or after["time_s"] - self.times[i - 1] > gap:
            return None
        before = self.rows[i - 1]
        step = after["time_s"] - before["time_s"]
        part = (t - before["time_s"]) / step
        row = {name: before[name] + part * (after[name] - before[name]) for name in before}
        # Steps of walkers and waves are too quick for straight lines between tenths of a second: cubic where the neighbours are as near.
        if 2 <= i < len(self.rows) - 1 and self.times[i + 1] - self.times[i - 2] < 3.01 * step:
            weights = (-part * (part - 1) * (part - 2) / 6, (part + 1) * (part - 1) * (part - 2) / 2, -(part + 1) * part * (part - 2) / 2,
                       (part + 1) * part * (part - 1) / 6)
            around = self.rows[i - 2:i + 2]
            for name in ("height_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s"):
                row[name] = sum(weight * other[name] for weight, other in zip(weights, around))
        turn = wrapped(after["heading_deg"] - before["heading_deg"])
        row["heading_deg"] = before["heading_deg"] + part * turn
        return row


def wrapped(degrees):
    """An angle between -180 and 180 degrees."""
    return (degrees + 180.0) % 360.0 - 180.0 if math.isfinite(degrees) else math.nan


def position_error(row, truth):
    """Estimate minus truth: north, east, down, m."""
    radius = 1.0 + truth["height_m"] / 6.371e6
    north = (row["lat_deg"] - truth["lat_deg"]) * METRES_PER_DEGREE * radius
    east = wrapped(row["lon_deg"] - truth["lon_deg"]) * METRES_PER_DEGREE * radius * math.cos(math.radians(truth["lat_deg"]))
    return north, east, truth["height_m"] - row["height_m"]


def norm(vector):
    return math.sqrt(sum(x * x for x in vector))


def rms(values):
    values = list(values)
    return math.sqrt(sum(x * x for x in values) / len(values)) if values else math.nan


class Outcome:
    """What a run left: exit status, summary, solution, the last line it said."""

    def __init__(self, code, summary, track, said):
        self.code, self.summary, self.track, self.said = code, summary, track, said

    @property
    def finished(self):
        return self.track is not None and bool(self.track.rows)

    @property
    def verdict(self):
        return (self.summary.get("verdict") or {}).get("word", "")

    def warnings(self):
        """What the program complained about, with its reasons for the verdict."""
        verdict = self.summary.get("verdict") or {}
        texts = [*self.summary.get("warnings", []), *(verdict.get("reasons") or [])]
        return texts if self.code == 0 else [*texts, self.said]


def process(program, folder, work, *options, limit=600):
    """`schuler process` on a folder. `work` is removed afterwards."""
    command = [str(program), "process", str(folder), "-o", str(work), "--outputs", "solution,summary", *options]
    shutil.rmtree(work, ignore_errors=True)
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit, stdin=subprocess.DEVNULL, errors="replace")
        code, said = done.returncode, next(iter(reversed(done.stderr.strip().splitlines())), "")
    except subprocess.TimeoutExpired:
        code, said = -1, f"no end after {limit} s"
    solution, summary = work / "solution.csv", work / "summary.json"
    track = Track.read(solution) if solution.exists() else None
    told = json.loads(without_place(summary.read_text(encoding="utf-8"), folder)) if summary.exists() else {}
    shutil.rmtree(work, ignore_errors=True)
    return Outcome(code, told, track, without_place(said, folder))


def without_place(text, folder):
    """A message that does not depend on where the logs were."""
    return text.replace(str(folder) + "/", "").replace(str(folder), "DATASET")


def simulate(program, scenario, folder, seed=None):
    """`schuler simulate`: @raises RuntimeError with what it said where it fails."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.parent.mkdir(parents=True, exist_ok=True)
    file = folder.parent / (folder.name + ".toml")
    file.write_text(scenario, encoding="utf-8")
    command = [str(program), "simulate", str(file), "-o", str(folder)] + ([] if seed is None else ["--seed", str(seed)])
    done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise RuntimeError(f"{file.name}: {done.stderr.strip()}")


def in_order(work, items, jobs):
    """Results of work(item) in the order of the items, `jobs` of them at a time."""
    with ThreadPoolExecutor(max_workers=max(1, jobs)) as pool:
        yield from pool.map(work, items)


def kind_of_text(text):
    """A message without its numbers."""
    return re.sub(r"[-+]?\d[\d.,e+-]*", "#", text)


def shown(value, digits=3):
    """A number for people; numbers that mean nothing are a dash."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.{digits}g}" if isinstance(value, float) and abs(value) < 10 ** digits else f"{value:.0f}" if isinstance(value, float) else str(value)


def write_csv(path, rows):
    """Rows of one set of keys; numbers are rounded so that the file is the same wherever it is made."""
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(rows[0].keys() if rows else [])
        for row in rows:
            writer.writerow([f"{x:.6g}" if isinstance(x, float) else x for x in row.values()])


def markdown(header, rows):
    """A Markdown table."""
    clean = [[str(cell).replace("|", "/").replace("\n", " ") for cell in row] for row in rows]
    return "\n".join(["| " + " | ".join(header) + " |", "|" + "---|" * len(header), *("| " + " | ".join(row) + " |" for row in clean)]) + "\n"
