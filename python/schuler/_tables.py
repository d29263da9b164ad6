"""Tables of results: columns of NumPy with units, from run.h5 and files of comma-separated values."""
import csv
import re
from pathlib import Path

import numpy as np

from . import _schuler
from ._error import Error

_SI = {"deg": np.pi / 180, "deg/h": np.pi / 180 / 3600, "deg/s": np.pi / 180, "mg": 9.80665e-3, "ppm": 1e-6, "ns": 1e-9}


class Table:
    """Columns of one length. `table["position"]` or `table.position` is an array, (n,) or (n, k).

    name        "solution", ...
    units       unit of each column: a text, or a tuple of k
    components  what the k numbers of a row are: ("north", "east", "down"); () of a column of one number
    """

    def __init__(self, name, columns, units=None, components=None, attributes=None):
        self.name = name
        self._columns = columns
        self.units = dict(units or {})
        self.components = dict(components or {})
        self.attributes = dict(attributes or {})

    def __getitem__(self, column):
        try:
            return self._columns[column]
        except KeyError:
            near = _schuler.nearest_key(str(column), list(self._columns))
            raise Error.of(f"there is no column {column!r}", self.name, f"did you mean {near}?" if near
                           else f"there are {', '.join(self._columns)}") from None

    def __getattr__(self, column):
        if column.startswith("_") or column not in self._columns:
            raise AttributeError(f"table {self.__dict__.get('name')!r} has no column {column!r}")
        return self._columns[column]

    def __dir__(self):
        return [*super().__dir__(), *self._columns]

    def __contains__(self, column):
        return column in self._columns

    def __iter__(self):
        return iter(self._columns)

    def __len__(self):
        return len(next(iter(self._columns.values()), ()))

    def keys(self):
        """Names of the columns, as those of a dict."""
        return self._columns.keys()

    def items(self):
        """Pairs of name and array of each column; units as in `units`."""
        return self._columns.items()

    def si(self):
        """The same table in SI units and radians."""
        columns, units = {}, {}
        for name, values in self._columns.items():
            unit = self.units.get(name, "")
            parts = unit if isinstance(unit, tuple) else (unit,)
            factors = np.array([_SI.get(part, 1.0) for part in parts])
            plain = np.all(factors == 1.0) or values.dtype.kind in "iub"
            columns[name] = values if plain else values * (factors if len(parts) > 1 else factors[0])
            units[name] = unit if plain else tuple(_in_si(p) for p in parts) if len(parts) > 1 else _in_si(parts[0])
        return Table(self.name, columns, units, self.components, self.attributes)

    def to_pandas(self):
        """A pandas.DataFrame with a column a number, its unit in the name: "position_lat_deg". Needs pandas."""
        try:
            import pandas
        except ImportError:
            raise Error.of("pandas is not installed", "to_pandas", "apt-get install python3-pandas, or pip install pandas") from None
        out = {}
        for name, values in self._columns.items():
            unit = self.units.get(name, "")
            if values.ndim == 1:
                out[_with_unit(name, unit)] = values
                continue
            flat = values.reshape(len(values), -1)
            parts = self.components.get(name) or tuple(str(i + 1) for i in range(flat.shape[1]))
            for i in range(flat.shape[1]):
                of_part = unit[i] if isinstance(unit, tuple) and i < len(unit) else unit if isinstance(unit, str) else ""
                out[_with_unit(f"{name}_{parts[i] if i < len(parts) else i + 1}", of_part)] = flat[:, i]
        return pandas.DataFrame(out)

    def __repr__(self):
        lines = [f"  {name}: {values.shape} {' '.join(u) if isinstance(u := self.units.get(name, ''), tuple) else u}".rstrip()
                 for name, values in self._columns.items()]
        return "\n".join([f"<schuler.Table {self.name}, {len(self)} rows>", *lines])


def _in_si(unit):
    return {"deg": "rad", "deg/h": "rad/s", "deg/s": "rad/s", "mg": "m/s^2", "ppm": "1", "ns": "s"}.get(unit, unit)


def _with_unit(name, unit):
    word = re.sub(r"[^A-Za-z0-9]+", "_", unit).strip("_")
    return name if not word or word == "1" or name.endswith("_" + word) else f"{name}_{word}"


def _attribute(path, item, name):
    try:
        return _schuler.h5_attribute(path, item, name)
    except Error:
        return ""


FULL_COVARIANCES = ("covariance", "covariance_smoothed")


def h5_tables(path):
    """Names of the tables in a run.h5: "solution", "innovations/gnss_position", ..."""
    found = []
    for group in _schuler.h5_names(path, "/"):
        try:
            inside = _schuler.h5_names(path, "/" + group)
        except Error:       # a table in the root group
            if group in FULL_COVARIANCES:
                found.append(group)
            continue
        if "time_ns" in inside or "time_s" in inside:
            found.append(group)
        else:
            found += [f"{group}/{name}" for name in inside]
    return found


def h5_table(path, name):
    """A group of a run.h5 as a table."""
    if name in FULL_COVARIANCES:
        columns = {"time_s": _schuler.h5_table(path, f"/{name}_time_s"), "covariance": _schuler.h5_table(path, f"/{name}", "matrices")}
        states = tuple(_attribute(path, f"/{name}", "states").split(","))
        return Table(name, columns, {"time_s": "s", "covariance": "SI"}, {}, {"states": states})
    columns, units, components, attributes = {}, {}, {}, {}
    for item in sorted(_schuler.h5_names(path, "/" + name), key=lambda n: (not n.startswith("time"), n)):
        where = f"/{name}/{item}"
        columns[item] = _schuler.h5_table(path, where, "integers" if item in ("time_ns", "line") else "table")
        unit = tuple(_attribute(path, where, "units").split(","))
        units[item] = unit[0] if len(unit) == 1 else unit
        named = _attribute(path, where, "columns")
        components[item] = tuple(named.split(",")) if named and columns[item].ndim > 1 else ()
        if item == "source":
            attributes["names"] = tuple(_attribute(path, where, "names").split(","))
    return Table(name, columns, units, components, attributes)


_UNIT_WORDS = [("m_s2", "m/s^2"), ("m_s", "m/s"), ("deg_h", "deg/h"), ("deg_s", "deg/s"), ("rad_s", "rad/s"), ("mgal", "mGal"), ("deg", "deg"),
               ("rad", "rad"), ("ns", "ns"), ("hz", "Hz"), ("pa", "Pa"), ("ppm", "ppm"), ("mg", "mg"), ("m", "m"), ("s", "s"), ("t", "T")]


def csv_table(path):
    """A file of comma-separated values with a header as a table; the unit of a column is what its name ends with."""
    path = Path(path)
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.reader(line for line in file if not line.startswith("#")) if row]
    if not rows:
        return Table(path.stem, {})
    columns, units = {}, {}
    for i, name in enumerate(rows[0]):
        texts = [row[i] if i < len(row) else "" for row in rows[1:]]
        try:
            columns[name] = np.array([float(text) if text else np.nan for text in texts])
        except ValueError:
            columns[name] = np.array(texts, dtype=str)
        units[name] = next((unit for word, unit in _UNIT_WORDS if name.lower().endswith("_" + word)), "")
    return Table(path.stem, columns, units)
