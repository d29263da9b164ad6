"""The faults of the campaign: names, groups, sizes."""
from campaign import faults as f
from campaign.faults import FOREVER, Fault
from campaign.logs import ACCEL, GYRO, POSITION


def imu_values():
    out = [Fault(f"{what} stuck {s:g} s", "imu stuck", f.stuck(what, s))
           for what, times in (("gyro z", (1, 10)), ("gyro xyz", (1, 10)), ("accel x", (1, 10)), ("all", (0.2, 1, 10, 30))) for s in times]
    out += [Fault(f"{what} zero {s:g} s", "imu stuck", f.constant(what, s, 0.0)) for what, s in (("all", 1), ("gyro xyz", 5), ("accel z", 2))]
    out += [Fault(f"{sensor} saturates at {share:.0%}{'' if s < FOREVER else ' throughout'}", "imu saturated", f.saturated(sensor, share, s))
            for sensor, share in (("gyro", 0.3), ("accel", 0.7)) for s in (20, FOREVER)]
    out += [Fault(f"{what} {text or 'empty'} {s:g} s", "imu not a number", f.text_burst(what, s, text))
            for what, text, s in (("all", "nan", 0), ("all", "nan", 1), ("all", "nan", 10), ("gyro z", "nan", 5), ("all", "", 1), ("all", "inf", 0))]
    out += [Fault(f"gyro {axis} {size:+g} deg/s{after}", "imu bias", f.added(f"gyro {axis}", s, size * 0.0174533))
            for axis, size, s, after in (("x", 1, FOREVER, ""), ("y", 1, FOREVER, ""), ("z", 1, FOREVER, ""), ("z", 0.1, FOREVER, ""),
                                         ("z", 5, FOREVER, ""), ("z", 1, 30, " for 30 s"))]
    out += [Fault(f"accel {axis} {size:+g} m/s2", "imu bias", f.added(f"accel {axis}", FOREVER, size))
            for axis, size in (("x", 0.05), ("x", 0.5), ("z", 0.5))]
    out += [Fault(f"spike {what} {size:g}, {n} sample{'s' if n > 1 else ''}", "imu spike", f.spike(what, size, n), part)
            for what, size, n, part in (("accel x", 160, 1, 0.5), ("accel z", 160, 1, 0.5), ("accel y", 50, 10, 0.5), ("gyro z", 30, 1, 0.5),
                                        ("gyro x", 5, 10, 0.5), ("accel x", 1e6, 1, 0.5))]
    out += [Fault("early spike accel x 160", "imu spike", f.spike("accel x", 160, 1), 0.15)]
    out += [Fault(f"noise {gyro:g} rad/s {accel:g} m/s2 {s} s", "imu noise", f.noise(gyro, accel, s))
            for gyro, accel, s in ((0.5, 0, 5), (0, 10, 5), (0.3, 5, 20), (3, 50, 2))]
    out += [Fault(f"imu outliers {share:.0%} {f'{s} s' if s < FOREVER else 'throughout'}", "imu outliers", f.imu_outliers(share, s, 5, 50))
            for share, s in ((0.2, 10), (0.2, 60), (0.01, FOREVER), (0.2, FOREVER))]
    out += [Fault(f"imu cell {name} 1e300", "one cell", f.one_cell("imu", patterns, 0, "1e300")) for name, patterns in (("gyro x", GYRO), ("accel x", ACCEL))]
    return out


def imu_rows():
    out = [Fault(f"imu dropout {s:g} s", "imu dropout", f.lost("imu", s)) for s in (0.001, 0.01, 0.1, 0.5, 1, 2, 5, 10, 30, 60)]
    out += [Fault("imu dropout 1 s and gnss dropout 5 s", "imu dropout", together(f.lost("imu", 1), f.lost("gnss", 5)))]
    out += [Fault("twenty imu holes of 0.05 s", "imu dropout", f.holes(20, 0.05)), Fault("1% of imu rows lost", "imu dropout", f.lost_here_and_there(0.01))]
    out += [Fault(f"1% of {t} rows twice", "order", f.repeated(t, 0.01)) for t in ("imu", "gnss")]
    out += [Fault("second of imu rows twice", "order", f.block_again(1.0)), Fault("half a second of imu rows late", "order", f.block_late(0.5))]
    out += [Fault(f"1% of {t} rows swapped", "order", f.swapped(t, 0.01)) for t in ("imu", "gnss")]
    out += [Fault("imu begins in motion", "late start", f.late_start("imu", 0.3)), Fault("gnss begins in motion", "late start", f.late_start("gnss", 0.3)),
            Fault("gnss begins at half", "late start", f.late_start("gnss", 0.5))]
    return out


def clocks():
    out = [Fault(f"one imu stamp {s:+g} s", "one stamp", f.stamp("imu", s)) for s in (0.5, 3600, -10)]
    out += [Fault(f"one gnss stamp {s:+g} s", "one stamp", f.stamp("gnss", s)) for s in (1, 100, -100, 604800)]
    out += [Fault(f"imu clock {s:+g} s for 5 s", "clock", f.clock_away("imu", s, 5)) for s in (1, 3600)]
    out += [Fault(f"gnss clock {s:+g} s for 10 s", "clock", f.clock_away("gnss", s, 10)) for s in (1,)]
    out += [Fault(f"{t} clock{'s' if t == 'both' else ''} jump{'' if t == 'both' else 's'} {s:+g} s", "clock", f.clock_away(t, s, FOREVER))
            for t in ("imu", "gnss", "both") for s in (1, 3600, 604800)]
    out += [Fault(f"gnss clock off by {s:+g} s", "clock", f.clock_off("gnss", s)) for s in (18, -18, 1, 0.3)]
    out += [Fault("imu clock drifts 100 ppm", "clock", f.clock_drift(100)), Fault("end of the week", "clock", f.rollover())]
    return out


def gnss():
    out = [Fault(f"gnss jump {m} m for {s} s", "gnss jump", f.jump(m, s)) for m in (10, 30, 100, 300, 1000) for s in (10, 30)]
    out += [Fault(f"gnss jump {m} m stays", "gnss jump", f.jump(m, FOREVER)) for m in (10, 100, 1000)]
    out += [Fault(f"one fix {m} m off", "gnss jump", f.jump(m, 0)) for m in (10, 100, 100000)]
    out += [Fault(f"gnss height {m} m for 20 s", "gnss jump", f.jump(m, 20, vertical=True)) for m in (15, 45, 90)]
    out += [Fault(f"gnss ramp {v:g} m/s", "gnss ramp", f.ramp(v, 60)) for v in (0.1, 0.3, 1, 3, 10)]
    out += [Fault(f"gnss {what} frozen {s} s", "gnss frozen", f.frozen(s, columns))
            for what, columns in (("position", "position"), ("fix", "all")) for s in (5, 20, 60)]
    out += [Fault(f"gnss velocity {v:+g} m/s for 20 s", "gnss velocity", f.velocity_off(v, 20)) for v in (0.5, 2, 10)]
    out += [Fault("gnss velocity zero for 20 s", "gnss velocity", f.velocity_off(0, 20, 0.0))]
    out += [Fault(f"gnss lost {s} s", "gnss outage", f.lost("gnss", s)) for s in (15, 60)]
    out += [Fault(f"{m} m off after 15 s outage{'' if s < FOREVER else ', stays'}", "offset after outage", f.outage_then_offset(m, 15, s))
            for m in (5, 20, 100) for s in (20, FOREVER)]
    out += [Fault(f"20% of fixes {m} m off", "gnss outliers", f.gnss_outliers(0.2, m)) for m in (10, 50, 500)]
    out += [Fault(f"sigma {name}", "sigma", f.sigma(function, s))
            for name, function, s in (("zero", lambda x: 0.0, FOREVER), ("zero for 20 s", lambda x: 0.0, 20), ("negative", lambda x: -1.0, FOREVER),
                                      ("1e-9", lambda x: 1e-9, FOREVER), ("1e9 for 20 s", lambda x: 1e9, 20), ("a hundredth", lambda x: 0.01 * x, FOREVER),
                                      ("a fifth", lambda x: 0.2 * x, FOREVER), ("times 100", lambda x: 100.0 * x, FOREVER))]
    out += [Fault(f"gnss cell {name} {text}", "one cell", f.one_cell("gnss", POSITION, k, text))
            for k, name, text in ((0, "lat", "1e300"), (2, "height", "1e300"), (0, "lat", "nan"), (1, "lon", "abc"))]
    out += [Fault(f"latitude and longitude zero, {name}", "one cell", f.null_island(s)) for name, s in (("one fix", 0), ("5 s", 5))]
    out += [Fault("latitude and longitude exchanged", "columns", f.lat_lon_swapped())]
    return out


def configuration():
    out = [Fault(f"{what} negated", "columns", f.negated(what)) for what in ("gyro z", "gyro x", "gyro xyz", "accel x")]
    out += [Fault("gyro x and y exchanged", "columns", f.exchanged("gyro", "x", "y"))]
    out += [Fault("wrong axes stated", "stated", f.wrong_axes())]
    out += [Fault(name, "stated", f.stated(section, line))
            for name, section, line in (("mounting yaw 90 deg stated", "imu", "mounting_deg = [0, 0, 90]"),
                                        ("lever arm 1 m stated", "gnss", "lever_arm_m = [1, 0, 0]"),
                                        ("lever arm 10 m stated", "gnss", "lever_arm_m = [0, 10, 0]"),
                                        ("velocity 0.5 s late stated", "gnss", "velocity_latency_s = 0.5"),
                                        ("position 1 s late stated", "gnss", "latency_s = 1.0"),
                                        ("navigation grade stated", "imu", 'grade = "navigation"'))]
    return out


def together(first, second):
    """Two faults at the same time; what the second did counts."""
    def apply(log, random, at):
        first(log, random, at)
        return second(log, random, at)
    return apply


def all_faults():
    return [*imu_values(), *imu_rows(), *clocks(), *gnss(), *configuration()]


QUICK = ("gyro z stuck 1 s", "all nan 1 s", "imu dropout 1 s", "gyro z +1 deg/s", "spike accel x 160, 1 sample", "one imu stamp +3600 s",
         "gnss jump 100 m for 10 s", "gnss ramp 1 m/s", "gnss fix frozen 20 s", "20% of fixes 50 m off", "sigma zero", "gnss cell lat 1e300")
