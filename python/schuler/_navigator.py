"""The navigation filter fed sample by sample or in blocks."""
from . import _schuler
from ._recording import Recording, check_of_stream
from ._tables import Table

_ROW_UNITS = {"time_ns": "ns", "position": ("rad", "rad", "m"), "velocity": "m/s", "rpy": "rad", "std_position": "m", "std_velocity": "m/s",
              "std_rpy": "rad"}
_NED = ("north", "east", "down")
_ROW_PARTS = {"position": ("lat", "lon", "height"), "velocity": _NED, "std_position": _NED, "std_velocity": _NED,
              "rpy": ("roll", "pitch", "heading"), "std_rpy": ("roll", "pitch", "heading")}


class Navigator:
    """Takes the samples of all instruments in any order within `lag` of the newest IMU sample and navigates by them.

    settings      dict of settings of dataset.toml, as for schuler.process: {"imu.grade": "mems", "imu.axes": "flu"}. What a batch run finds
                  from the whole log is not found: noise and latency are what the settings say (latency: 0 where not given).
    imu_interval  s, nominal, from IMU sample to IMU sample
    rates         dict: most samples a second of gnss (20), baro, mag, odometer, heading, gauges, body_velocity, ranges (0 each: not used);
                  gauge_count, range_sources
    lag           s, a sample may come so much later than the newest IMU sample
    still_delay   s, waited for the decision whether the vehicle stands (0.65: that of a batch run)
    longest_hole  s without IMU samples that are bridged

    Time: seconds (float) or nanoseconds (whole numbers), one axis for all. Every feed takes one sample, and returns a schuler.FeedStatus,
    or a block of n, and returns their numbers (uint8, n). Arrays are read where they lie. No sample raises; a wrong shape does.
    Raises schuler.Error naming the setting that cannot be.
    """

    def __init__(self, settings=None, *, imu_interval=0.01, rates=None, lag=0.5, still_delay=0.0, longest_hole=10.0):
        check_of_stream(dict(settings or {}))
        self._compiled = _schuler.Navigator(dict(settings or {}), imu_interval=imu_interval, rates=dict(rates or {}), lag=lag,
                                            still_delay=still_delay, longest_hole=longest_hole)

    def feed_imu(self, time, gyro, accel):
        """Samples of the IMU: time (s or ns; one or (n,)), gyro and accel ((3,) or (n, 3), sensor axes): rad/s and m/s^2, or with
        imu.kind = "increments" rad and m/s since the sample before. Time goes on: what is older than the lag is processed now.
        Returns a schuler.FeedStatus, or (n,) uint8 of a block."""
        return self._compiled.feed_imu(time, gyro, accel)

    def feed_gnss(self, time, position, velocity=None, std_position=None, std_velocity=None, fix="unknown", satellites=-1):
        """Fixes: time (s or ns; one or (n,)), position ((3,) or (n, 3): latitude, longitude in rad, height above the ellipsoid in m),
        velocity (north, east, down, m/s), one sigma of each (north, east, down, m and m/s), each like position or None; fix: "none",
        "autonomous", "differential", "rtk_float", "rtk_fixed" or "unknown"; number of satellites, -1: unknown. Returns a schuler.FeedStatus, or (n,) uint8 of a block."""
        return self._compiled.feed_gnss(time, position, velocity, std_position, std_velocity, fix, satellites)

    def feed_baro(self, time, height=None, pressure=None):
        """The barometer: time (s or ns; one or (n,)), height (m) or pressure (Pa), one or (n,). Returns a schuler.FeedStatus, or (n,) uint8 of
        a block."""
        return self._compiled.feed_baro(time, height, pressure)

    def feed_mag(self, time, field):
        """The magnetometer: time (s or ns; one or (n,)), field ((3,) or (n, 3), T, axes as mag.axes says). Returns a schuler.FeedStatus, or
        (n,) uint8 of a block."""
        return self._compiled.feed_mag(time, field)

    def feed_odometer(self, time, speed, std=None):
        """Speed of the wheels: time (s or ns; one or (n,)), speed and its sigma (m/s, forward positive; one or (n,); None: that of the
        settings). Returns a schuler.FeedStatus, or (n,) uint8 of a block."""
        return self._compiled.feed_odometer(time, speed, std)

    def feed_heading(self, time, heading, std=None):
        """A heading from true north, clockwise: time (s or ns; one or (n,)), heading and its sigma (rad; one or (n,); None: that of the
        settings). Returns a schuler.FeedStatus, or (n,) uint8 of a block."""
        return self._compiled.feed_heading(time, heading, std)

    def feed_gauges(self, time, height):
        """Height gauges, `gauge_count` of the rates: time (s or ns; one or (n,)), height ((3,) or (n, 3), m, up positive; NaN: no such
        gauge). Returns a schuler.FeedStatus, or (n,) uint8 of a block."""
        return self._compiled.feed_gauges(time, height)

    def feed_body_velocity(self, time, velocity):
        """A velocity log: time (s or ns; one or (n,)), velocity relative to the Earth ((3,) or (n, 3), m/s: forward, right, down). Returns a
        schuler.FeedStatus, or (n,) uint8 of a block."""
        return self._compiled.feed_body_velocity(time, velocity)

    def feed(self, recording):
        """All instruments of a schuler.Recording in the order of their times. Returns how many samples of each were taken: dict."""
        if not isinstance(recording, Recording):
            raise TypeError("feed takes a schuler.Recording; feed_imu, feed_gnss, ... take arrays")
        taken = self._compiled.feed_recording(recording._compiled)
        return {source.name.lower(): count for source, count in taken.items() if count}

    def feed_ranges(self, time, names, *, station=None, **columns):
        """One epoch of ranges to n sources: names ("G05", ...), station (n bools; False: satellites), and arrays of n:
        pseudorange, std, variance (m, m, m^2), range_rate, std_rate (m/s), cn0 (dB-Hz), tx (n, 3), tx_velocity (n, 3): transmitter,
        Earth-fixed (m, m/s), tx_clock (s), tx_clock_rate (s/s), frequency (Hz). time: s or ns. Returns a schuler.FeedStatus."""
        known = ("pseudorange", "range_rate", "std", "std_rate", "cn0", "tx", "tx_velocity", "tx_clock", "tx_clock_rate", "frequency", "variance")
        for name in columns:
            if name not in known:
                raise _schuler.Error.of("unknown keyword", name, f"known are {', '.join(known)}")
        return self._compiled.feed_ranges(time, list(names), list(station) if station is not None else [False] * len(names), columns)

    @property
    def phase(self):
        """A schuler.Phase."""
        return self._compiled.phase

    def state(self):
        """Now, at the newest IMU sample: time, time_ns, position (lat, lon, h; rad, m), velocity (north, east, down; m/s), q_nb (scalar
        first), rpy (rad), covariance (9, 9) of the errors of position, velocity and attitude (m, m/s, rad). None before Phase.NAVIGATING."""
        return self._compiled.state()

    def lagged(self):
        """The filter itself, `lag` ago, with every measurement until then; as state()."""
        return self._compiled.lagged()

    def sensor_errors(self):
        """dict of estimates and sigmas: gyro_bias (rad/s), accel_bias (m/s^2), gyro_scale, accel_scale; None before it navigates."""
        return self._compiled.sensor_errors()

    def rows(self):
        """Rows of the filter since the last call: schuler.Table; radians, m, m/s."""
        return Table("solution", self._compiled.take_rows(), _ROW_UNITS, _ROW_PARTS)

    def events(self):
        """What has happened since the last call: list of dicts with time (s) and kind (schuler.EventKind)."""
        return self._compiled.take_events()

    def counters(self):
        """What became of the samples: dict by instrument and status; holes and restarts."""
        return self._compiled.counters()

    def save(self):
        """Everything, as bytes for restore() in a navigator of the same settings on a machine of the same kind. Rows and events that were
        not fetched are not in it."""
        return self._compiled.save()

    def restore(self, saved):
        """Takes over what was saved. Raises schuler.Error where it cannot, and stays as it is."""
        self._compiled.restore(saved)

    def restart(self):
        """Forgets everything and aligns anew."""
        self._compiled.restart()
