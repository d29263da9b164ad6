"""Data sets in memory."""
import tomllib

from . import _schuler
from ._error import Error
from ._tables import Table

_UNITS = {
    "time_ns": "ns", "gyro": {"rates": "rad/s", "increments": "rad"}, "accel": {"rates": "m/s^2", "increments": "m/s"},
    "position": ("rad", "rad", "m"), "velocity": "m/s", "std_position": "m", "std_velocity": "m/s", "position_age": "s", "velocity_age": "s",
    "height": "m", "pressure": "Pa", "field": "T", "speed": "m/s", "std": "m/s", "heading": "rad", "rpy": "rad", "movement": "1", "satellites": "1",
}
_COMPONENTS = {
    "gyro": ("x", "y", "z"), "accel": ("x", "y", "z"), "field": ("x", "y", "z"), "position": ("lat", "lon", "height"),
    "velocity": ("north", "east", "down"), "std_position": ("north", "east", "down"), "std_velocity": ("north", "east", "down"),
    "rpy": ("roll", "pitch", "heading"),
}


class Recording:
    """The instruments of a data set. SI units and radians; sensor axes as logged; time_ns on the data set's own axis.

    imu, gnss, baro, mag, odometer, heading, gauges, body_velocity, reference   schuler.Table each, without rows where there is none.
    Their arrays are views of the recording's memory: not copied, not to be written to.

    name         of the data set
    imu_kind     "rates" or "increments"
    origin_s     first fix (without one: first IMU sample), s: the zero of `start`, `stop` and outages
    config_toml  the settings in force when it was read, as TOML
    inferred_toml  the dataset.toml that was inferred, or an empty text
    warnings     list of texts
    """

    def __init__(self, compiled):
        self._compiled = compiled
        self.name, self.imu_kind, self.origin_s = compiled.name, compiled.imu_kind, compiled.origin_s
        self.config_toml, self.inferred_toml, self.warnings = compiled.config_toml, compiled.inferred_toml, list(compiled.warnings)
        for instrument, columns in compiled.channels().items():
            units = {name: self._unit(instrument, name) for name in columns}
            parts = {name: ("forward", "right", "down") if instrument == "body_velocity" else _COMPONENTS.get(name, ()) for name in columns}
            setattr(self, instrument, Table(instrument, columns, units, parts))

    def _unit(self, instrument, name):
        unit = _UNITS.get(name, "")
        if instrument == "heading" and name == "std":
            return "rad"
        return unit[self.imu_kind] if isinstance(unit, dict) else unit

    @property
    def settings(self):
        """The settings in force, by their keys in full: {"imu.grade": "mems", ...}."""
        return dict(_schuler.setting_keys(tomllib.loads(self.config_toml)))

    def stream_settings(self):
        """Those of them that say something to a schuler.Navigator: neither files nor what needs the whole log."""
        return {key: value for key, value in self.settings.items() if of_stream(key)}

    def __repr__(self):
        there = ", ".join(f"{name} {len(table)}" for name, table in vars(self).items() if isinstance(table, Table) and len(table))
        return f"<schuler.Recording {self.name}: {there}>"


def of_stream(key):
    """Whether a setting has a meaning where samples are fed one by one."""
    section, _, word = key.partition(".")
    return section in ("vehicle", "earth", "imu", "gnss", "baro", "mag", "odometer", "heading", "initial", "filter", "gauges", "log", "ranges", "gravity",
                       "compass") and word not in (
        "file", "time_offset_s", "clock_drift_ppm", "smooth", "backward", "self_check", "axis", "columns", "scale", "gap_factor")


def check_of_stream(settings):
    """Raises for a setting that a navigator would ignore."""
    for key, value in _schuler.setting_keys(settings):
        if not of_stream(key) and value is not False:
            raise Error.of("has no meaning where samples are fed one by one", key, "leave it out")


def open(path, *, settings=None):
    """Reads a data set: a folder, a dataset.toml, a KF-GINS YAML file, or a log that is recognised by its content.

    settings: dict over those of the data set, {"imu.axes": "flu"}.
    Returns a schuler.Recording. Raises schuler.Error with file, line and key.
    """
    return Recording(_schuler.open_recording(path, dict(settings or {})))
