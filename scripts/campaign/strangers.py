"""Logs as strangers write them: their names of columns, units, axes, scales of time."""
from dataclasses import dataclass

from campaign.logs import ACCEL, AXES, GYRO, SIGMA, Table

G = 9.80665
DEGREE = 57.29577951308232
# sensor x, y, z as (axis of forward-right-down, sign)
FRAMES = {"frd": ((0, 1), (1, 1), (2, 1)), "flu": ((0, 1), (1, -1), (2, -1)), "fur": ((0, 1), (2, -1), (1, 1))}
# name of the stamps, ticks a second, decimals
TIME_STYLES = {"from 0": ("time_s", 1.0, 6), "gps week": ("tow_s", 1.0, 6), "unix s": ("timestamp", 1.0, 6), "unix ms": ("timestamp_ms", 1e3, 3),
               "unix us": ("time_us", 1e6, 0), "unix ns": ("timestamp_ns", 1e9, 0), "unix ns, no unit": ("timestamp", 1e9, 0)}
IMU_STYLES = {"rad/s, m/s2": ("gyro_{}_rad_s", 1.0, "accel_{}_m_s2", 1.0), "deg/s, g": ("gyro_{}_dps", DEGREE, "acc_{}_g", 1.0 / G),
              "deg/s, m/s2": ("gyr_{}_deg_s", DEGREE, "acc_{}_m_s2", 1.0), "rad/s, m/s2, no unit": ("w{}", 1.0, "a{}", 1.0),
              "deg/s, g, no unit": ("gyro_{}", DEGREE, "accel_{}", 1.0 / G)}
GNSS_STYLES = {"canonical": {}, "long": {"lat_deg": "latitude", "lon_deg": "longitude", "height_m": "altitude", "vel_n_m_s": "vel_north", "vel_e_m_s": "vel_east",
                                         "vel_d_m_s": "vel_down", "std_n_m": "sigma_n", "std_e_m": "sigma_e", "std_d_m": "sigma_d"},
               "short": {"lat_deg": "lat", "lon_deg": "lon", "height_m": "h_ell", "vel_n_m_s": "vn", "vel_e_m_s": "ve", "vel_d_m_s": "vd", "std_n_m": "sdn",
                         "std_e_m": "sde", "std_d_m": "sdd", "std_vn_m_s": "sdvn", "std_ve_m_s": "sdve", "std_vd_m_s": "sdvd"}}


@dataclass
class Style:
    """How a stranger's logs look."""
    time: str
    base: int                  # seconds of the first stamp
    imu: str
    gnss: str
    axes: str
    separator: str
    velocity: bool
    stated: float              # factor of the stated sigmas; 0: none
    fix: bool


def stamped(rows, style):
    """Rows whose first cell, seconds from 0, becomes the stranger's stamp, without loss."""
    _, ticks, decimals = TIME_STYLES[style.time]
    out = []
    for row in rows:
        nanoseconds = style.base * 1_000_000_000 + round(float(row[0]) * 1e9)
        per_tick = round(1e9 / ticks)
        whole, rest = divmod(nanoseconds, per_tick)
        fraction = f".{rest * 10 ** decimals // per_tick:0{decimals}d}" if decimals else ""
        out.append([f"{whole}{fraction}", *row[1:]])
    return out


def imu_table(table, style):
    """The IMU's log in sensor axes and units of the style."""
    gyro_name, gyro_factor, accel_name, accel_factor = IMU_STYLES[style.imu]
    frame = FRAMES[style.axes]
    columns = [(table.three(patterns)[axis], sign * factor) for patterns, factor in ((GYRO, gyro_factor), (ACCEL, accel_factor)) for axis, sign in frame]
    rows = [[row[0], *(f"{float(row[column]) * factor:.9g}" for column, factor in columns)] for row in table.rows]
    header = [TIME_STYLES[style.time][0], *(gyro_name.format(axis) for axis in AXES), *(accel_name.format(axis) for axis in AXES)]
    return Table(table.name, style.separator, header, stamped(rows, style))


def gnss_table(table, style):
    """The receiver's log: columns left out, sigmas stated wrong."""
    names = GNSS_STYLES[style.gnss]
    sigmas = set(table.find_all(SIGMA))
    speeds = set(table.find_all(r"^vel_|^std_v[ned]"))
    left_out = (speeds if not style.velocity else set()) | (sigmas if style.stated == 0.0 else set()) | (set() if style.fix else set(table.find_all(r"^fix")))
    kept = [i for i in range(1, len(table.header)) if i not in left_out]
    rows = [[row[0], *(f"{float(row[i]) * style.stated:.6f}" if i in sigmas else row[i] for i in kept)] for row in table.rows]
    header = [TIME_STYLES[style.time][0], *(names.get(table.header[i], table.header[i]) for i in kept)]
    return Table(table.name, style.separator, header, stamped(rows, style))


def other_table(table, style):
    """Barometer and magnetometer, the latter in the axes of the IMU."""
    field = table.three([rf"^mag_{axis}" for axis in AXES])
    rows = table.rows
    if field is not None:
        rows = [[row[0], *(f"{sign * float(row[field[axis]]):.6f}" for axis, sign in FRAMES[style.axes])] for row in rows]
    return Table(table.name, style.separator, [TIME_STYLES[style.time][0], *table.header[1:]], stamped(rows, style))


def rewritten(log, style):
    """A log of the simulator as a stranger would have written it."""
    log.imu, log.gnss = imu_table(log.imu, style), gnss_table(log.gnss, style)
    log.others = [other_table(table, style) for table in log.others]
    return log
