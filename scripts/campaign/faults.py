"""What can go wrong with a log: each fault changes a copy of it and says what it did."""
import math
from dataclasses import dataclass, field
from typing import Callable

from campaign.logs import ACCEL, AXES, GYRO, METRES_PER_DEGREE, POSITION, SIGMA, VELOCITY

WEEK = 604_800.0
FOREVER = 1e9


def same_clock(t):
    return t


@dataclass
class Effect:
    """What a fault did to a log. `clocks`: ways to read the solution's time; where the fault leaves open which clock is right, the one
    that suits the solution better is used."""
    until: float = None                       # the fault is over; None: it stays
    bad_fixes: int = 0
    clocks: list = field(default_factory=lambda: [same_clock])


@dataclass
class Fault:
    name: str
    group: str
    apply: Callable                           # (log, random, time) -> Effect
    part: float = 0.5                         # where in the log


def rows_between(table, start, stop):
    return [i for i, t in enumerate(table.times()) if start <= t < stop]


def change(table, rows, columns, function):
    """Puts function(value, row) into the cells."""
    for i in rows:
        for column in columns:
            table.put(i, column, function(table.number(i, column), i))


def gyro_columns(log, axes):
    return [log.imu.three(GYRO)[AXES.index(axis)] for axis in axes]


def accel_columns(log, axes):
    return [log.imu.three(ACCEL)[AXES.index(axis)] for axis in axes]


def imu_columns(log, what):
    """`what`: names such as "gyro z", "accel xyz", "all"."""
    if what == "all":
        return gyro_columns(log, AXES) + accel_columns(log, AXES)
    sensor, axes = what.split()
    return gyro_columns(log, axes) if sensor == "gyro" else accel_columns(log, axes)


# The IMU's values

def stuck(what, seconds):
    def apply(log, random, at):
        rows, columns = rows_between(log.imu, at, at + seconds), imu_columns(log, what)
        for i in rows[1:]:
            for column in columns:
                log.imu.rows[i][column] = log.imu.rows[rows[0]][column]
        return Effect(at + seconds)
    return apply


def constant(what, seconds, value):
    def apply(log, random, at):
        change(log.imu, rows_between(log.imu, at, at + seconds), imu_columns(log, what), lambda x, i: value)
        return Effect(at + seconds)
    return apply


def added(what, seconds, size):
    def apply(log, random, at):
        change(log.imu, rows_between(log.imu, at, at + seconds), imu_columns(log, what), lambda x, i: x + size)
        return Effect(at + seconds if seconds < FOREVER else None)
    return apply


def saturated(sensor, share, seconds):
    """The range is this share of what the sensor really shows (of the 99th percentile of its axes' sizes)."""
    def apply(log, random, at):
        start = at if seconds < FOREVER else -math.inf
        rows, columns = rows_between(log.imu, start, at + seconds), imu_columns(log, f"{sensor} xyz")
        sizes = sorted(abs(log.imu.number(i, column)) for i in range(0, len(log.imu.rows), 7) for column in columns)
        limit = share * sizes[int(0.99 * len(sizes))]
        change(log.imu, rows, columns, lambda x, i: max(-limit, min(limit, x)))
        return Effect(at + seconds if seconds < FOREVER else None)
    return apply


def text_burst(what, seconds, text):
    def apply(log, random, at):
        rows = rows_between(log.imu, at, at + seconds) or rows_between(log.imu, at, FOREVER)[:1]
        for i in rows if seconds > 0 else rows[:1]:
            for column in imu_columns(log, what):
                log.imu.rows[i][column] = text
        return Effect(at + seconds)
    return apply


def spike(what, size, samples):
    def apply(log, random, at):
        rows = rows_between(log.imu, at, FOREVER)[:samples]
        change(log.imu, rows, imu_columns(log, what), lambda x, i: x + size)
        return Effect(log.imu.times()[rows[-1]])
    return apply


def noise(gyro, accel, seconds):
    def apply(log, random, at):
        rows = rows_between(log.imu, at, at + seconds)
        change(log.imu, rows, gyro_columns(log, AXES), lambda x, i: x + random.gauss(0.0, gyro))
        change(log.imu, rows, accel_columns(log, AXES), lambda x, i: x + random.gauss(0.0, accel))
        return Effect(at + seconds)
    return apply


def imu_outliers(share, seconds, gyro, accel):
    def apply(log, random, at):
        start = at if seconds < FOREVER else -math.inf
        rows = [i for i in rows_between(log.imu, start, at + seconds) if random.random() < share]
        change(log.imu, rows, gyro_columns(log, AXES), lambda x, i: x + random.uniform(-gyro, gyro))
        change(log.imu, rows, accel_columns(log, AXES), lambda x, i: x + random.uniform(-accel, accel))
        return Effect(at + seconds if seconds < FOREVER else None)
    return apply


def one_cell(table, patterns, index, text):
    def apply(log, random, at):
        chosen = getattr(log, table)
        row = rows_between(chosen, at, FOREVER)[0]
        column = chosen.three(patterns)
        if column is None:
            return None
        chosen.rows[row][column[index]] = text
        return Effect(at, 1 if table == "gnss" else 0)
    return apply


# Rows: lost, twice, out of order

def lost(table, seconds, delay=0.0):
    def apply(log, random, at):
        chosen = getattr(log, table)
        rows = set(rows_between(chosen, at + delay, at + delay + seconds) or rows_between(chosen, at, FOREVER)[:1])
        chosen.rows = [row for i, row in enumerate(chosen.rows) if i not in rows]
        return Effect(at + delay + seconds)
    return apply


def lost_here_and_there(share):
    def apply(log, random, at):
        log.imu.rows = [row for row in log.imu.rows if random.random() >= share]
        return Effect()
    return apply


def holes(count, seconds):
    def apply(log, random, at):
        first, last = log.span()
        starts = sorted(random.uniform(first + 30.0, last - 30.0) for _ in range(count))
        gone = set()
        for start in starts:
            gone.update(rows_between(log.imu, start, start + seconds))
        log.imu.rows = [row for i, row in enumerate(log.imu.rows) if i not in gone]
        return Effect()
    return apply


def repeated(table, share):
    def apply(log, random, at):
        chosen, rows = getattr(log, table), []
        for row in chosen.rows:
            rows.append(row)
            if random.random() < share:
                rows.append(list(row))
        chosen.rows = rows
        return Effect()
    return apply


def block_again(seconds):
    def apply(log, random, at):
        rows = rows_between(log.imu, at, at + seconds)
        log.imu.rows[rows[-1] + 1:rows[-1] + 1] = [list(log.imu.rows[i]) for i in rows]
        return Effect(at + seconds)
    return apply


def swapped(table, share):
    def apply(log, random, at):
        rows = getattr(log, table).rows
        for i in range(len(rows) - 1):
            if random.random() < share:
                rows[i], rows[i + 1] = rows[i + 1], rows[i]
        return Effect()
    return apply


def block_late(seconds):
    def apply(log, random, at):
        first, second = rows_between(log.imu, at, at + seconds), rows_between(log.imu, at + seconds, at + 2 * seconds)
        rows = log.imu.rows
        rows[first[0]:second[-1] + 1] = [rows[i] for i in second] + [rows[i] for i in first]
        return Effect(at + 2 * seconds)
    return apply


def late_start(table, part):
    """The log of one sensor begins, or is lost up to, this part of the whole."""
    def apply(log, random, at):
        first, last = log.span()
        start = log.moment(part)
        chosen = [log.imu, *log.others] if table == "imu" else [log.gnss]
        for one in chosen:
            one.rows = [one.rows[i] for i in rows_between(one, start, FOREVER)]
        return Effect(start)
    return apply


# Clocks

def stamp(table, seconds, count=1):
    def apply(log, random, at):
        chosen = getattr(log, table)
        for row in rows_between(chosen, at, FOREVER)[:count]:
            chosen.shift(row, seconds)
        return Effect(at, count if table == "gnss" else 0)
    return apply


def clock_away(table, seconds, duration):
    """A clock that is off for a while, or from then on."""
    def apply(log, random, at):
        tables = log.tables() if table == "both" else [log.imu, *log.others] if table == "imu" else [log.gnss]
        bad = 0
        for one in tables:
            rows = rows_between(one, at, at + duration)
            for row in rows:
                one.shift(row, seconds)
            bad += len(rows) if one is log.gnss and table == "gnss" and duration < FOREVER else 0
        after = [lambda t: t - seconds if t >= at + seconds - 1e-6 else t]
        return Effect(at + duration if duration < FOREVER else at, bad, after if table == "both" else [same_clock, *after])
    return apply


def clock_off(table, seconds):
    """A clock that is off from the first sample on."""
    def apply(log, random, at):
        for one in [log.imu, *log.others] if table == "imu" else [log.gnss]:
            for row in range(len(one.rows)):
                one.shift(row, seconds)
        return Effect(None, 0, [same_clock, lambda t: t - seconds])
    return apply


def clock_drift(parts_per_million):
    def apply(log, random, at):
        first = log.imu.times()[0]
        for one in [log.imu, *log.others]:
            for row, t in enumerate(one.times()):
                one.shift(row, (t - first) * 1e-6 * parts_per_million)
        return Effect()
    return apply


def rollover():
    """The second of the week begins anew in all logs."""
    def apply(log, random, at):
        tables = log.tables()
        for one in tables:
            for row, t in enumerate(one.times()):
                one.shift(row, (WEEK if t < at else 0.0) - at)
        first = min(one.times()[0] for one in tables)
        return Effect(at, 0, [lambda t: t + at - (WEEK if t >= first - 1.0 else 0.0)])
    return apply


# The receiver

def moved(log, row, north, east, down=0.0):
    """Moves a fix by metres."""
    table = log.gnss
    lat, lon, height = table.three(POSITION)
    here = table.number(row, lat)
    table.put(row, lat, here + north / METRES_PER_DEGREE, 10)
    table.put(row, lon, table.number(row, lon) + east / METRES_PER_DEGREE / math.cos(math.radians(here)), 10)
    if down != 0.0:
        table.put(row, height, table.number(row, height) - down, 4)


def jump(metres, seconds, delay=0.0, vertical=False):
    def apply(log, random, at):
        angle = random.uniform(0.0, 2.0 * math.pi)
        rows = rows_between(log.gnss, at + delay, at + delay + seconds) if seconds > 0 else rows_between(log.gnss, at, FOREVER)[:1]
        for row in rows:
            if vertical:
                moved(log, row, 0.0, 0.0, metres)
            else:
                moved(log, row, metres * math.cos(angle), metres * math.sin(angle))
        return Effect(at + delay + seconds if seconds < FOREVER else None, len(rows))
    return apply


def ramp(speed, seconds):
    def apply(log, random, at):
        angle = random.uniform(0.0, 2.0 * math.pi)
        times, rows = log.gnss.times(), rows_between(log.gnss, at, at + seconds)
        for row in rows:
            size = speed * (times[row] - at)
            moved(log, row, size * math.cos(angle), size * math.sin(angle))
        return Effect(at + seconds, len(rows))
    return apply


def frozen(seconds, columns):
    """The receiver repeats what it said. `columns`: "position" or "all"."""
    def apply(log, random, at):
        rows = rows_between(log.gnss, at, at + seconds)
        wanted = list(log.gnss.three(POSITION))
        if columns == "all":
            wanted += log.gnss.three(VELOCITY) or []
        for row in rows[1:]:
            for column in wanted:
                log.gnss.rows[row][column] = log.gnss.rows[rows[0]][column]
        return Effect(at + seconds, len(rows))
    return apply


def velocity_off(size, seconds, scale=1.0):
    def apply(log, random, at):
        columns, rows = log.gnss.three(VELOCITY), rows_between(log.gnss, at, at + seconds)
        if columns is None:
            return None
        change(log.gnss, rows, columns[:2], lambda x, i: scale * x + size)
        return Effect(at + seconds, len(rows))
    return apply


def outage_then_offset(metres, outage, seconds):
    def apply(log, random, at):
        lost("gnss", outage)(log, random, at)
        return jump(metres, seconds, delay=outage)(log, random, at)
    return apply


def gnss_outliers(share, metres):
    def apply(log, random, at):
        rows = [i for i in range(len(log.gnss.rows)) if random.random() < share]
        for row in rows:
            angle = random.uniform(0.0, 2.0 * math.pi)
            size = metres * random.uniform(0.5, 1.5)
            moved(log, row, size * math.cos(angle), size * math.sin(angle), random.uniform(-size, size))
        return Effect(None, len(rows))
    return apply


def sigma(function, seconds):
    """The stated sigmas become function(sigma); a log without any gets columns with function(1)."""
    def apply(log, random, at):
        table = log.gnss
        rows = rows_between(table, at, at + seconds) if seconds < FOREVER else range(len(table.rows))
        columns = table.find_all(SIGMA)
        if not columns:
            table.header += ["std_n_m", "std_e_m", "std_d_m"]
            columns = [len(table.header) - k for k in (3, 2, 1)]
            for row in table.rows:
                row += ["1.0"] * 3
        change(table, rows, columns, lambda x, i: function(x))
        return Effect(at + seconds if seconds < FOREVER else None)
    return apply


def null_island(seconds):
    def apply(log, random, at):
        rows = rows_between(log.gnss, at, at + seconds) or rows_between(log.gnss, at, FOREVER)[:1]
        for row in rows:
            for column in log.gnss.three(POSITION):
                log.gnss.rows[row][column] = "0.0"
        return Effect(at + seconds, len(rows))
    return apply


def lat_lon_swapped():
    def apply(log, random, at):
        lat, lon, _ = log.gnss.three(POSITION)
        for row in log.gnss.rows:
            row[lat], row[lon] = row[lon], row[lat]
        return Effect()
    return apply


# What is said about the sensors, and columns that are not what their names say

def negated(what):
    def apply(log, random, at):
        change(log.imu, range(len(log.imu.rows)), imu_columns(log, what), lambda x, i: -x)
        return Effect()
    return apply


def exchanged(sensor, one, other):
    def apply(log, random, at):
        a, b = imu_columns(log, f"{sensor} {one}{other}")
        for row in log.imu.rows:
            row[a], row[b] = row[b], row[a]
        return Effect()
    return apply


def stated(section, line):
    """A dataset.toml that names the files and says one thing that is wrong."""
    def apply(log, random, at):
        sections = {"imu": [f'file = "{log.imu.name}"'], "gnss": [f'file = "{log.gnss.name}"']}
        for table in log.others:
            for name in ("baro", "mag"):
                if table.name.startswith(name):
                    sections[name] = [f'file = "{table.name}"']
        sections[section].append(line)
        log.settings = "".join(f"[{name}]\n" + "".join(f"{text}\n" for text in lines) for name, lines in sections.items())
        return Effect()
    return apply


def wrong_axes():
    """Axes that put gravity where it is not."""
    def apply(log, random, at):
        columns = accel_columns(log, AXES)
        means = [sum(log.imu.number(i, column) for i in range(200)) / 200.0 for column in columns]
        up = max(range(3), key=lambda k: abs(means[k]))
        return stated("imu", 'axes = "fur"' if up != 1 else 'axes = "frd"')(log, random, at)
    return apply


def seed_of(set_name, fault):
    """A seed that stays the same whatever else is in the campaign."""
    return f"{set_name}/{fault}"
