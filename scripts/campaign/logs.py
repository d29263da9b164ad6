"""CSV logs as they lie in a folder: read without losing a digit, changed cell by cell, written again."""
import math
import re
import shutil
from pathlib import Path

METRES_PER_DEGREE = 111_319.49
AXES = "xyz"
GYRO = [rf"^(gyro|gyr|w|omega|angular_velocity)_?{axis}(_|$)" for axis in AXES]
ACCEL = [rf"^(accel|acc|a|f)_?{axis}(_|$)" for axis in AXES]
POSITION = [r"^lat", r"^lon", r"^(height|alt)"]
VELOCITY = [r"^(vel_n|vn)(_|$)", r"^(vel_e|ve)(_|$)", r"^(vel_d|vd|vel_u|vu)(_|$)"]
SIGMA = r"^(std|sd|sigma|hacc|vacc|sacc|h_acc|v_acc|s_acc)"
STAMP = r"^(time|t|timestamp|tow)(_|$)|time_valid"
UNITS = ((r"(_deg_s|_dps)$", math.pi / 180.0), (r"_g$", 9.80665))
TICKS = ((r"_ms$", 1e-3), (r"_us$", 1e-6), (r"_ns$", 1e-9))


def factor_of(name, units):
    """What a number under this name is to be multiplied with to be canonical."""
    return next((factor for pattern, factor in units if re.search(pattern, name)), 1.0)


class Table:
    """A CSV file. Cells stay text, so that what is not changed is written as it was read."""

    def __init__(self, name, separator, header, rows):
        self.name, self.separator, self.header, self.rows = name, separator, header, rows

    @classmethod
    def read(cls, path):
        lines = [line for line in path.read_text(encoding="utf-8", errors="replace").splitlines() if line and line[0] != "#"]
        separator = max(",;\t", key=lines[0].count) if lines else ","
        header = [name.strip() for name in lines[0].split(separator)] if lines else []
        return cls(path.name, separator, header, [line.split(separator) for line in lines[1:]])

    def copy(self):
        return Table(self.name, self.separator, list(self.header), [list(row) for row in self.rows])

    def write(self, folder):
        lines = [self.separator.join(self.header), *map(self.separator.join, self.rows)]
        (folder / self.name).write_text("\n".join(lines) + "\n", encoding="utf-8")

    def find(self, pattern):
        """Number of the first column whose name matches, or None."""
        return next((i for i, name in enumerate(self.header) if re.search(pattern, name.lower())), None)

    def find_all(self, pattern):
        return [i for i, name in enumerate(self.header) if re.search(pattern, name.lower())]

    def three(self, patterns):
        """The columns of a vector, or None where one is missing."""
        found = [self.find(pattern) for pattern in patterns]
        return None if None in found else found

    def clock(self):
        """The column of the stamps, and seconds in its unit."""
        column = self.find(STAMP)
        column = 0 if column is None else column
        return column, factor_of(self.header[column].lower(), TICKS)

    def times(self):
        """The stamps in seconds."""
        column, tick = self.clock()
        return [number(row[column]) * tick for row in self.rows]

    def number(self, row, column):
        """A cell in canonical units."""
        return number(self.rows[row][column]) * factor_of(self.header[column].lower(), UNITS)

    def put(self, row, column, value, decimals=9):
        """Writes a value given in canonical units into a cell."""
        value /= factor_of(self.header[column].lower(), UNITS)
        self.rows[row][column] = f"{value:.{decimals}f}" if abs(value) < 1e15 else repr(value)

    def shift(self, row, seconds):
        """Moves all stamps of a row."""
        for column in self.find_all(STAMP):
            tick = factor_of(self.header[column].lower(), TICKS)
            text = self.rows[row][column]
            if not math.isfinite(number(text)):
                continue
            decimals = len(text.partition(".")[2])
            whole = "." not in text and float(seconds / tick).is_integer()
            self.rows[row][column] = str(int(text) + int(seconds / tick)) if whole else f"{float(text) + seconds / tick:.{max(decimals, 3)}f}"


def number(text):
    """The number in a cell; not a number where there is none."""
    try:
        return float(text)
    except ValueError:
        return math.nan


class Log:
    """A folder with an IMU and a receiver among its CSV files."""

    def __init__(self, imu, gnss, others, truth=None):
        self.imu, self.gnss, self.others, self.truth = imu, gnss, others, truth
        self.settings = None   # text of a dataset.toml

    @classmethod
    def read(cls, folder):
        """@raises ValueError where the folder has no CSV files of an IMU and a receiver."""
        imu = gnss = truth = None
        others = []
        for path in sorted(Path(folder).glob("*.csv")):
            table = Table.read(path)
            is_imu = table.three(GYRO) is not None and table.three(ACCEL) is not None
            is_place = table.three(POSITION) is not None
            is_reference = path.name.startswith("reference")
            if is_imu and imu is None:
                imu = table
            elif is_reference and is_place:
                truth = table
            elif is_place and gnss is None:
                gnss = table
            elif not is_imu and not is_place and not is_reference:
                others.append(table)
        if imu is None or gnss is None:
            raise ValueError(f"{folder}: no CSV files of an IMU and a receiver")
        return cls(imu, gnss, others, truth)

    def copy(self):
        return Log(self.imu.copy(), self.gnss.copy(), [table.copy() for table in self.others], self.truth)

    def tables(self):
        return [self.imu, self.gnss, *self.others]

    def write(self, folder):
        """Writes the sensors' logs; the truth is kept from the program."""
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        for table in self.tables():
            table.write(folder)
        if self.settings is not None:
            (folder / "dataset.toml").write_text(self.settings, encoding="utf-8")

    def span(self):
        """First and last second that both sensors have."""
        imu, gnss = self.imu.times(), self.gnss.times()
        return max(imu[0], gnss[0]), min(imu[-1], gnss[-1])

    def velocities(self):
        """Times and velocities over the ground, north and east, from positions about a second apart."""
        lat, lon, _ = self.gnss.three(POSITION)
        times, out, before = self.gnss.times(), [], 0
        for i, t in enumerate(times):
            while times[before] < t - 1.0:
                before += 1
            if t - times[before] < 0.5:
                continue
            here, there = self.gnss.number(i, lat), self.gnss.number(before, lat)
            north = (here - there) * METRES_PER_DEGREE
            east = (self.gnss.number(i, lon) - self.gnss.number(before, lon)) * METRES_PER_DEGREE * math.cos(math.radians(here))
            out.append((t, north / (t - times[before]), east / (t - times[before])))
        return [row for row in out if math.isfinite(row[1] + row[2])]

    def moment(self, part):
        """The hardest time near this part of the log: the velocity changes most in the five seconds that follow."""
        first, last = self.span()
        wanted, reach = first + part * (last - first), 0.15 * (last - first)
        rows, hardest, later = self.velocities(), (-1.0, wanted), 0
        for t, north, east in rows:
            while later + 1 < len(rows) and rows[later][0] < t + 5.0:
                later += 1
            if abs(t - wanted) < reach and first + 30.0 < t < last - 30.0:
                hardest = max(hardest, (round(math.hypot(rows[later][1] - north, rows[later][2] - east), 6), t))
        return round(hardest[1], 3)
