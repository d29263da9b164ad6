"""Integrated inertial-satellite navigation: from IMU and GNSS logs to a trajectory with honest uncertainty.

    result = schuler.process("drive/", smooth=True)          # as the program: a schuler.Result with tables of NumPy
    result.solution.position                                 # (n, 3): lat, lon, height
    recording = schuler.open("drive/")                       # the instruments as arrays
    navigator = schuler.Navigator({"imu.grade": "mems"})     # the filter, sample by sample or in blocks
    schuler.analyze.equator(speed=600, height=10000, dh=1)   # theory and studies

Arrays are in SI units and radians, except those of files (result tables), whose units are in `table.units`; `table.si()` converts.
"""
from . import _schuler
from ._commands import function_of as _function_of
from ._error import Error
from ._navigator import Navigator
from ._recording import Recording, open
from ._result import NotTrustworthy, Result
from ._schuler import (EventKind, FeedStatus, HeadingSettings, Mekf, MekfSettings, NavigatorState, Phase, Source, TiltSettings,
                       C_en, datum_changed, dcm_from_quaternion, dcm_from_rotation_vector, dcm_from_rpy, ecef_from_geodetic,
                       geodetic_from_ecef, gps_from_utc, gps_from_week, gravity_vector, moved_by_ned, ned_difference, quaternion_from_dcm,
                       quaternion_from_rotation_vector, quaternion_from_rpy, radii, rotation_vector_from_quaternion, rpy_from_dcm,
                       rpy_from_quaternion, skew, utc_from_gps, wrap_2pi, wrap_pi)
from ._tables import Table

__version__ = _schuler.__version__

demo = _function_of("demo")
process = _function_of("process")
run = _function_of("run")
simulate = _function_of("simulate")
inspect = _function_of("inspect")
evaluate = _function_of("evaluate")
convert = _function_of("convert")
ahrs = _function_of("ahrs")
gravity = _function_of("gravity")
montecarlo = _function_of("montecarlo")
batch = _function_of("batch")
gnss = _function_of("gnss")
paper = _function_of("paper")

from . import analyze  # noqa: E402  (made of the same table)


def attitude(time, gyro, accel, *, mag=None, mag_time=None, speed=None, speed_time=None, filter="mekf", offline=False, settings=None):
    """Attitude and heading of a whole log in memory.

    time, gyro, accel   (n,) s or ns; (n, 3) rad/s; (n, 3) m/s^2, body axes forward-right-down
    mag, mag_time       (m, 3) T, body axes, at (m,) times, or at those of the IMU; none: the heading starts at zero
    speed, speed_time   (k,) m/s over ground along the body's x axis
    filter              mekf, dcm, quaternion, quaternion-printed, quaternion-coupled
    offline             forward filter and backward smoother (mekf)
    settings            schuler.MekfSettings

    Returns a schuler.Table: time_ns, q_nb (n, 4; scalar first), rpy (n, 3; rad), std_phi (n, 3; rad, about north, east, down),
    gyro_bias (n, 3; rad/s). Raises schuler.Error.
    """
    columns = _schuler.attitude(time, gyro, accel, mag_time=mag_time, mag=mag, speed_time=speed_time, speed=speed, filter=filter,
                                offline=offline, settings=settings if settings is not None else MekfSettings())
    units = {"time_ns": "ns", "q_nb": "1", "rpy": "rad", "std_phi": "rad", "gyro_bias": "rad/s"}
    parts = {"q_nb": ("w", "x", "y", "z"), "rpy": ("roll", "pitch", "heading"), "std_phi": ("north", "east", "down"), "gyro_bias": ("x", "y", "z")}
    return Table("attitude", columns, units, parts)


__all__ = [name for name in dir() if not name.startswith("_")]
