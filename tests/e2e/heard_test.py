"""Nothing that a user sets is ignored silently: every coupling with every key, one at a time."""
import json
import shutil
import subprocess
from pathlib import Path

from gravity_test import SURVEY
from program_test import check, main

DRIVE = """
name = "heard"
duration_s = 50
reference_rate_hz = 1
[trajectory]
type = "car"
start = { lat_deg = 48.1, lon_deg = 11.5, height_m = 500 }
standstill_s = 20
[imu]
rate_hz = 20
grade = "mems"
[gnss]
rate_hz = 1
white_m = [1, 1, 2]
white_velocity_m_s = [0.05, 0.05, 0.1]
[baro]
rate_hz = 1
white_m = 0.5
bias_m = 2
[mag]
rate_hz = 2
[ranges]
rate_hz = 1
systems = "G"
gps_week = 2300
gps_second = 0
throughout = true
[vehicle]
kind = "car"
[filter]
initial_error = { level_deg = 1, heading_deg = 5, velocity_m_s = 0.1, position_m = 5 }
"""

# Values apart from the defaults and from what the scenario says.
KEYS = {
    "filter.mechanization": '"ecef"', "filter.loop": '"open"', "filter.smooth": "true", "filter.backward": "true",
    "filter.feedback_period_s": "7", "filter.feedback_attitude_deg": "2", "filter.scale_factors": "false", "filter.misalignments": "false",
    "filter.estimate_lever_arm": "true", "filter.zero_velocity_std_m_s": "0.3", "filter.zero_rate_std_deg_s": "2",
    "filter.nonholonomic": "false", "filter.nonholonomic_std_lateral_m_s": "0.9", "filter.constraint_rate_hz": "3", "filter.gate_probability": "0.01",
    "filter.floor_m": "3", "filter.loose": '"aggressive"', "filter.aggressive_parts": "4", "filter.separate.restart_s": "20",
    "filter.separate.position_time_s": "33", "filter.separate.baro_time_s": "80", "filter.integrity.use": "true", "filter.integrity.window_s": "33",
    "filter.protection.use": "true", "filter.protection.missed_detection": "0.01", "mag.use": "false", "mag.heading_std_deg": "9", "mag.heading_deviation_deg": "3",
    "baro.white_m": "4", "gnss.lever_arm_m": "[1, 2, -3]", "gnss.latency_std_s": "0.1", "gnss.correlated_m": "[2, 2, 3]",
    "gnss.consider_errors": "true", "gnss.elevation_mask_deg": "33", "ranges.white_m": "9", "ranges.correlated_m": "7",
    "ranges.use_rates": "false", "ranges.receiver_acceleration_m_s_sqrt_s": "9", "ranges.clock_h0_s": "1e-15", "odometer.std_m_s": "3",
    "gnss.latency_s": "0.2", "gnss.height_latency_s": "0.2", "gnss.jitter_s": "0.02", "gnss.std_scale": "3", "gnss.std_floor_m": "[9, 9, 9]",
    "gnss.change_white_m": "[3, 3, 3]", "gnss.use_velocity": "false", "filter.detect_wheels": "true", "ranges.intersystem_m": "9", "ranges.network_m": "9",
    "gnss.correlated_time_s": "510", "gnss.correlated_velocity_time_s": "51", "gnss.troposphere": '"none"', "baro.sea_level_pressure_pa": "100000",
    "imu.gyro_quantum_arcsec": "0.3", "imu.gyro_g_deg_h_g": "300", "stations.time_offset_s": "0.3", "earth.rotation_rad_s": "8e-5", "imu.stamp": '"start"',
    "compass.white_deg": "3", "imu.found_mounting_std_deg": "1", "gravity.model": '"ramp"',
    "heading.std_deg": "7", "output.lever_arm_m": "[5, 0, 0]", "vehicle.kind": '"air"',
}


# Of these, those that have a part of a survey, with a start that is given.
START = {f"initial.{key}": value for key, value in {
    "lat_deg": "55.8", "lon_deg": "37.5", "height_m": "164", "heading_deg": "45", "roll_deg": "0", "pitch_deg": "0", "vel_n_m_s": "7.0711",
    "vel_e_m_s": "7.0711", "vel_d_m_s": "0", "std_n_m": "1", "std_e_m": "1", "std_d_m": "1", "std_vn_m_s": "0.01", "std_ve_m_s": "0.01", "std_vd_m_s": "0.01",
    "std_roll_deg": "0.01", "std_pitch_deg": "0.01", "std_heading_deg": "0.1"}.items()}
OF_A_SURVEY = {
    "initial.gyro_bias_deg_h": "[0.02, 0, 0]", "initial.accel_bias_mg": "[0, 0, 0.001]", "initial.std_roll_deg": "3", "initial.std_heading_deg": "9",
    "imu.estimate_noise": "true", "gravity.prior_mgal": "[5, 5, 5]", "filter.scale_factors": "true", "filter.misalignments": "true",
} | {key: KEYS[key] for key in (
    "filter.mechanization", "filter.loop", "filter.smooth", "filter.backward", "filter.feedback_period_s",
    "filter.estimate_lever_arm", "filter.nonholonomic", "filter.gate_probability", "filter.loose", "filter.separate.restart_s", "filter.integrity.use",
    "filter.protection.use", "mag.heading_std_deg", "baro.white_m", "gnss.lever_arm_m", "gnss.correlated_m", "gnss.consider_errors", "gnss.latency_s",
    "gnss.std_scale", "gnss.use_velocity", "ranges.white_m", "odometer.std_m_s", "imu.gyro_quantum_arcsec", "imu.gyro_g_deg_h_g", "earth.rotation_rad_s", "imu.stamp",
    "heading.std_deg", "output.lever_arm_m", "vehicle.kind")}


def run(program, *arguments):
    return subprocess.run([program.path, *map(str, arguments)], cwd=program.folder, capture_output=True, text=True, timeout=60, stdin=subprocess.DEVNULL)


def each_key(program, keys, *command):
    folder = Path(program.folder)

    def outputs(name):
        told = json.loads((folder / name / "summary.json").read_text())
        for key in ("timing", "facts", "ignored", "warnings"):
            told.pop(key, None)
        return [(file.name, file.read_bytes()) for file in sorted((folder / name).glob("*.csv"))], json.dumps(told)

    silent = []
    shutil.rmtree(folder / "plain", ignore_errors=True)
    run(program, *command, "-o", "plain", "-q")
    plain = outputs("plain")
    for key, value in keys.items():
        shutil.rmtree(folder / "with", ignore_errors=True)
        done = run(program, *command, "-o", "with", "-q", "--set", f"{key}={value}")
        if done.returncode not in (0, 1):
            if done.returncode != 2 or key not in done.stderr:
                silent.append((key, done.returncode, done.stderr))
            continue
        named = [i["key"] for i in json.loads((folder / "with/summary.json").read_text())["ignored"]]
        if outputs("with") == plain and key not in named:
            silent.append(key)
    check(not silent, f"{command}: ignored without a word: {silent}")


def gravity(program, source):
    """The same for a survey, whose start is given or found."""
    folder = Path(program.folder)
    (folder / "survey.toml").write_text(SURVEY)
    program("simulate", "survey.toml", "-o", "survey", "-q")
    given = [word for key, value in START.items() for word in ("--set", f"{key}={value}")]
    each_key(program, OF_A_SURVEY, "gravity", "survey", *given)
    found = dict(OF_A_SURVEY)
    found.pop("imu.estimate_noise"), found.pop("initial.std_roll_deg"), found.pop("initial.std_heading_deg")  # the noise is given in the data set
    each_key(program, found, "gravity", "survey")


def heard(program, source):
    """What is written changes, or the key is refused by name, or it is told that it has no effect."""
    folder = Path(program.folder)
    (folder / "drive.toml").write_text(DRIVE)
    program("simulate", "drive.toml", "-o", "drive", "-q")

    for scheme in ("gnss", "separate", "loose", "tight", "medium"):
        each_key(program, KEYS, "process", "drive", "--scheme", scheme)
    # what is typed is not hidden behind the keys of the file
    for command in (("process", "drive", "--scheme", "gnss"), ("ahrs", "drive")):
        told = run(program, *command, "-o", "typed", "--set", "filter.integrity.use=true", "--set", "filter.gate_probability=0.01").stderr
        lines = [line for line in told.splitlines() if "no effect" in line]
        typed = [any(line.startswith(f"warning: {key} is given") for line in lines[:2]) for key in ("filter.integrity.use", "filter.gate_probability")]
        check(all(typed) and any(" more are given" in line for line in lines[2:]), f"{command}: {told}")


def scenarios(program, source):
    """What a scenario's own [filter] and a campaign's options say in vain is told as well."""
    folder = Path(program.folder)
    (folder / "drive.toml").write_text(DRIVE + 'scheme = "tight"\nloose = "aggressive"\nintegrity.use = true\nseparate.restart_s = 60\n')
    said = ["filter.integrity.use", "filter.loose", "filter.separate.restart_s"]
    done = program("run", "drive.toml", "-o", "once", "--outputs", "summary")
    told = json.loads((folder / "once/summary.json").read_text())
    check([i["key"] for i in told["ignored"]] == said, f"run: {told['ignored']}")
    check(all(key in done.stderr for key in said), done.stderr)
    (folder / "plain.toml").write_text(DRIVE)
    program("montecarlo", "plain.toml", "-n", 2, "-o", "some", "--set", "filter.loose=aggressive", "--scheme", "tight")
    told = json.loads((folder / "some/summary.json").read_text())
    check([i["key"] for i in told["ignored"]] == ["filter.loose"], f"montecarlo: {told['ignored']}")
    program("run", "plain.toml", "-o", "open", "--scheme", "separate", "--loop", "open", "--outputs", "summary")
    check(json.loads((folder / "open/summary.json").read_text())["loop"] == "closed", "the loop of the separate scheme is closed")
    # presets change the states of a scenario as of a data set
    (folder / "scale.toml").write_text(DRIVE.replace('grade = "mems"', 'grade = "mems"\ngyro_scale_factor_ppm = 1000\naccel_scale_factor_ppm = 1000'))
    program("simulate", "scale.toml", "-o", "scale", "-q")
    found = {}
    for command, source_of in (("run", "scale.toml"), ("process", "scale")):
        for preset in ("ins15", "ins21"):
            out = f"{command}-{preset}"
            program(command, source_of, "-o", out, "-q", "--set", f"filter.preset={preset}", "--outputs", "solution,summary")
            found[command, preset] = (folder / out / "solution.csv").read_text()
        check(found[command, "ins15"] != found[command, "ins21"], f"{command}: presets that are the same")
        for preset, lacks in (("ins15", True), ("ins21", False)):
            told = json.loads((folder / f"{command}-{preset}/summary.json").read_text())["warnings"]
            check(any(f'"{preset}" switches off filter.scale_factors' in text for text in told) == lacks, f"{command}, {preset}: {told}")
    # states.csv is written where there is a filter with such states, and asked for in vain elsewhere
    program("run", "plain.toml", "-o", "states", "-q", "--outputs", "summary,states")
    names = (folder / "states/states.csv").read_text().splitlines()[0].split(",")
    check({"time_s", "gyro_bias_1_rad_s", "std_gyro_bias_1_rad_s", "std_accel_bias_3_m_s2"} <= set(names), f"states.csv: {names}")
    for command, words in (("process", ("--scheme", "gnss")), ("ahrs", ())):
        program(command, "scale", "-o", f"none-{command}", "-q", "--outputs", "summary,states", *words)
        told = json.loads((folder / f"none-{command}/summary.json").read_text())
        check("output.files" in [i["key"] for i in told["ignored"]], f"{command}: {told['ignored']}")
        check(not (folder / f"none-{command}/states.csv").exists(), f"{command}: states of no filter")
    # no example says anything in vain: these three refine a preset
    for name in ("airliner-hg9900", "approach", "faults"):
        program("run", source / f"examples/{name}.toml", "-o", name, "-q", "--outputs", "summary")
        told = json.loads((folder / name / "summary.json").read_text())
        check(told["ignored"] == [], f"{name}: {told['ignored']}")


if __name__ == "__main__":
    main({"heard": heard, "heard_gravity": gravity, "heard_scenarios": scenarios})
