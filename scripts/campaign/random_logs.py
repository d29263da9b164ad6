"""Random logs: vehicle, motion, instruments and the stranger who wrote them, all drawn from one seed."""
import math
import random
from dataclasses import dataclass

from campaign.strangers import GNSS_STYLES, IMU_STYLES, TIME_STYLES, Style


LATERAL_M_S2 = 6.0   # what an aircraft does in a bend


@dataclass
class Draw:
    """One random log: its properties for tables, its scenario, how it is written, and which spans are withheld."""
    seed: str
    properties: dict
    scenario: str
    style: Style
    outages: list
    duration: float
    moves: bool
    lever_arm: tuple = (0.0, 0.0, 0.0)   # of the antenna, forward, right, down, m
    told: bool = False                   # the folder has a dataset.toml that gives it


def toml(section, pairs):
    return f"[{section}]\n" + "".join(f"{key} = {value}\n" for key, value in pairs.items())


def quoted(text):
    return f'"{text}"'


def start_of(dice, height):
    return f"{{ lat_deg = {dice.uniform(-60, 70):.4f}, lon_deg = {dice.uniform(-180, 180):.4f}, height_m = {height:.1f} }}"


def vibration(hertz, degrees, accel):
    return f"{{ frequency_hz = {hertz:.2f}, angle_deg = {degrees:.3f}, accel_m_s2 = {accel:.3f} }}"


def car(dice, duration):
    return "town drive", {"type": quoted("car"), "start": start_of(dice, dice.uniform(0, 1500)), "standstill_s": round(dice.uniform(5, 60), 1),
                          "vibration": vibration(dice.uniform(8, 20), dice.uniform(0, 0.05), dice.uniform(0, 0.6))}


def aircraft(dice, duration):
    kind = dice.choice(["figure8", "racetrack", "takeoff", "weave"])
    keys = {"type": quoted(kind), "start": start_of(dice, dice.uniform(300, 3000)), "heading_deg": round(dice.uniform(0, 360), 1)}
    if kind == "figure8":
        length = dice.uniform(500, 3000)
        speed = min(dice.uniform(15, 70), math.sqrt(LATERAL_M_S2 * 0.15 * length))   # its tightest bends have about that radius
        keys |= {"length_m": round(length), "width_m": round(0.4 * length), "loop_height_m": round(0.03 * length), "figure_s": round(2.3 * length / speed)}
    elif kind == "weave":
        keys["speed_m_s"] = round(dice.uniform(120, 230))
    else:
        keys["speed_m_s"] = round(dice.uniform(60, 120))
    if kind == "takeoff":
        keys |= {"standstill_s": round(dice.uniform(10, 60)), "height_change_m": 800}
    return kind, keys


def ship(dice, duration):
    keys = {"type": quoted("ship"), "start": start_of(dice, 0), "heading_deg": round(dice.uniform(0, 360), 1), "speed_m_s": round(dice.uniform(3, 10), 1)}
    for wave, size in (("roll", "deg"), ("pitch", "deg"), ("yaw", "deg"), ("heave", "m")):
        keys[f"waves.{wave}_{size}"] = round(dice.uniform(0.3, 3.0), 2)
        keys[f"waves.{wave}_period_s"] = round(dice.uniform(5, 12), 1)
    return "in waves", keys


def hand(dice, duration):
    """A walk with stops."""
    north = east = 0.0
    heading, points, left = dice.uniform(0, 2 * math.pi), [], duration + 60.0
    while left > 0:
        leg, speed, stop = dice.uniform(15, 50), dice.uniform(0.8, 1.8), dice.uniform(3, 15) if dice.random() < 0.3 else 0.0
        north, east = north + leg * math.cos(heading), east + leg * math.sin(heading)
        points.append(f"{{ north_m = {north:.2f}, east_m = {east:.2f}, speed_m_s = {speed:.2f}, stop_s = {stop:.1f} }}")
        heading += dice.choice([-1, 1]) * dice.uniform(0.3, 1.6)
        left -= leg / speed + stop
    return "walk", {"type": quoted("waypoints"), "start": start_of(dice, dice.uniform(0, 1500)), "standstill_s": round(dice.uniform(3, 30), 1),
                    "corner_radius_m": 3.2, "knot_spacing_m": 1.0, "lateral_accel_m_s2": 1.0, "longitudinal_accel_m_s2": 0.6,
                    "vibration": vibration(dice.uniform(1.5, 2.2), dice.uniform(1, 6), dice.uniform(0.5, 2.5)), "waypoints": f"[{', '.join(points)}]"}


def static(dice, duration):
    attitude = [round(dice.uniform(-5, 5), 2), round(dice.uniform(-5, 5), 2), round(dice.uniform(0, 360), 1)]
    return "at rest", {"type": quoted("static"), "start": start_of(dice, dice.uniform(0, 1500)), "attitude_deg": attitude}


VEHICLES = {"car": (car, 8), "air": (aircraft, 6), "ship": (ship, 2), "hand": (hand, 3), "static": (static, 1)}
GRADES = {"consumer": 4, "mems": 4, "tactical": 2, "navigation": 1}


def weighted(dice, table):
    """A key by its weight; the weight is the value or its last part."""
    weights = [value[-1] if isinstance(value, tuple) else value for value in table.values()]
    return dice.choices(list(table), weights)[0]


def slow_velocity(seed, index, white):
    """Slow errors of a receiver's velocities, by its own filter and multipath: half have them. From numbers of their own."""
    own = random.Random(f"{seed}/{index}/velocity")
    if own.random() < 0.5:
        return {}
    return {"correlated_velocity_m_s": round(white * own.uniform(0.3, 1.0), 4), "correlated_velocity_time_s": round(own.uniform(2, 30), 1)}


def receiver(dice, seed, index):
    """Its properties and its section of the scenario."""
    kind = dice.choice(["rtk", "differential", "autonomous"])
    white = {"rtk": dice.uniform(0.008, 0.02), "differential": dice.uniform(0.2, 0.5), "autonomous": dice.uniform(0.7, 2.0)}[kind]
    speed = {"rtk": 0.03, "differential": 0.05, "autonomous": 0.08}[kind]
    slow = kind == "autonomous" and dice.random() < 0.6
    late = 0.0 if dice.random() < 0.4 else round(dice.uniform(0.02, 0.3), 3)
    late_velocity = late if dice.random() < 0.7 else round(dice.uniform(0.0, 0.3), 3)
    keys = {"rate_hz": dice.choice([1, 2, 4, 5, 10]), "receiver": quoted("rtk" if kind == "rtk" else "autonomous"),
            "white_m": [round(white, 4), round(white, 4), round(1.6 * white, 4)], "white_velocity_m_s": [speed, speed, round(1.6 * speed, 3)],
            "correlated_m": round(white * dice.uniform(0.5, 1.5), 3) if slow else 0, "correlated_time_s": round(dice.uniform(30, 600)),
            "latency_s": late, "velocity_latency_s": late_velocity, **slow_velocity(seed, index, speed)}
    told = {"receiver": kind, "rate": keys["rate_hz"], "latency": late, "velocity latency": late_velocity, "slow errors": "yes" if slow else "no"}
    return told, keys


def mounting(dice, vehicle):
    """A car's unit may sit in any way; on others nobody can tell which way is forward."""
    if vehicle != "car" or dice.random() < 0.5:
        return "level", [0, 0, 0]
    turn = dice.choice([0, 90, 180, -90]) + dice.uniform(-5, 5)
    return "turned", [round(dice.uniform(-4, 4), 2), round(dice.uniform(-4, 4), 2), round(turn, 2)]


def style(dice):
    time = dice.choice(list(TIME_STYLES))
    base = {"from 0": 0, "gps week": dice.randrange(1000, 600_000)}.get(time, dice.randrange(1_600_000_000, 1_780_000_000))
    stated = 0.0 if dice.random() < 0.25 else 1.0 if dice.random() < 0.4 else round(math.exp(dice.uniform(math.log(0.2), math.log(5.0))), 3)
    return Style(time, base, dice.choice(list(IMU_STYLES)), dice.choice(list(GNSS_STYLES)), dice.choices(["frd", "flu", "fur"], [4, 4, 2])[0],
                 dice.choice([",", ",", ";", "\t"]), dice.random() < 0.75, stated, dice.random() < 0.5)


def withheld(dice, duration):
    """Outages of 10, 15 or 30 s, a minute or more between them."""
    spans, t = [], dice.uniform(80, 110)
    while True:
        length = dice.choice([10, 15, 30])
        if t + length > duration - 15:
            return spans
        spans.append((round(t, 1), length))
        t += length + dice.uniform(50, 110)


def iron(dice, seed, index):
    """Hard iron (uT) and soft iron of the body: half of the magnetometers are calibrated. From numbers of its own, as the lever arm is."""
    calibrated, own = round(dice.uniform(0, 3), 2), random.Random(f"{seed}/{index}/iron")
    return (calibrated, 0) if own.random() < 0.5 else (round(own.uniform(3, 10), 2), round(own.uniform(0, 0.05), 3))


# deg/h per g: most of what the gyros of small units err with the specific force
G_DEPENDENCE = {"consumer": 720.0, "mems": 180.0}


def g_dependence(seed, index, grade):
    """g-dependent gyro bias (deg/h/g): half of the small units have one. From numbers of its own, as the lever arm is."""
    own, most = random.Random(f"{seed}/{index}/g"), G_DEPENDENCE.get(grade, 0.0)
    return 0.0 if own.random() < 0.5 or most == 0.0 else round(most * math.exp(own.uniform(-3.0, 0.0)), 1)


def further_sensors(dice, seed, index):
    """Sections of barometer and magnetometer, and their names."""
    text, names = "", []
    if dice.random() < 0.4:
        names.append("baro")
        text += toml("baro", {"rate_hz": dice.choice([5, 10, 25]), "white_m": round(dice.uniform(0.1, 0.8), 2), "bias_m": 5, "bias_walk_m": 0.02})
    if dice.random() < 0.35:
        names.append("mag")
        inclination = {"declination_deg": round(dice.uniform(-10, 10), 1), "inclination_deg": round(dice.uniform(-70, 70))}
        hard, soft = iron(dice, seed, index)
        text += toml("mag", {"rate_hz": 10, **inclination, "white_ut": 0.3, "hard_iron_ut": hard, "soft_iron": soft})
    return " ".join(names) or "none", text


# forward, right, down: least and most, m
LEVER_ARMS = {"car": ((-1.5, 1.5), (-0.6, 0.6), (-1.8, -0.3)), "air": ((-1.0, 2.0), (-0.5, 0.5), (-1.0, -0.1)), "ship": ((-8.0, 8.0), (-3.0, 3.0), (-12.0, -2.0)),
              "hand": ((-0.2, 0.2), (-0.2, 0.2), (-0.6, -0.1)), "static": ((-1.0, 1.0), (-1.0, 1.0), (-2.0, -0.1))}


def lever_arm(seed, index, vehicle):
    """A lever arm and whether the stranger says so; from numbers of its own, so that the rest of the log does not depend on it."""
    dice = random.Random(f"{seed}/{index}/antenna")
    arm = tuple(round(dice.uniform(*span), 2) for span in LEVER_ARMS[vehicle])
    return arm, dice.random() < 0.6


def stated_words(factor):
    return "missing" if factor == 0.0 else "right" if factor == 1.0 else "too small" if factor < 0.6 else "too large" if factor > 1.7 else "nearly right"


def draw(seed, index, shortest=180.0, longest=1200.0, antenna=False):
    """Log number `index` of a seed; it does not depend on the others. `antenna`: away from the unit."""
    dice = random.Random(f"{seed}/{index}")
    vehicle, grade = weighted(dice, VEHICLES), weighted(dice, GRADES)
    duration = round(dice.uniform(shortest, longest))
    path, trajectory = VEHICLES[vehicle][0](dice, duration)
    told, gnss = receiver(dice, seed, index)
    words, angles = mounting(dice, vehicle)
    sensors, sections = further_sensors(dice, seed, index)
    rate, written = dice.choice([50, 100, 100, 200]), style(dice)
    outages = withheld(dice, duration)
    g_error = g_dependence(seed, index, grade)
    arm, given = lever_arm(seed, index, vehicle) if antenna else ((0.0, 0.0, 0.0), False)
    if antenna:
        gnss["lever_arm_m"] = list(arm)
    properties = {"vehicle": vehicle, "path": path, "duration": duration, "grade": grade, "gyro_g": g_error, "imu rate": rate, "mounting": words, "axes": written.axes, **told,
                  "gnss velocity": "yes" if written.velocity else "no", "sigma": stated_words(written.stated), "sigma factor": written.stated,
                  "sensors": sensors, "time": written.time, "units": written.imu, "columns": written.gnss, "outages": len(outages),
                  "antenna": ("told" if given else "not told") if antenna else "at the unit"}
    general = f'name = "log{index}"\nseed = {dice.randrange(1, 1_000_000)}\nduration_s = {duration}\nreference_rate_hz = 50\n'
    if vehicle == "hand":
        general += toml("vehicle", {"kind": quoted("hand")})
    scenario = general + toml("trajectory", trajectory) + toml("imu", {"rate_hz": rate, "kind": quoted("rates"), "grade": quoted(grade), "gyro_g_deg_h_g": g_error,
                                                                                       "mounting_deg": angles})
    return Draw(f"{seed}/{index}", properties, scenario + toml("gnss", gnss) + sections, written, outages, duration, vehicle != "static",
                arm, given)
