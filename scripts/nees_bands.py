"""How often a single run whose filter is told the truth about its errors is called inconsistent: 5 % is meant. The table in docs/results.md.

    scripts/nees_bands.py PROGRAM [SEEDS]          one job, a line a preset and block

Of each run the mean NEES and its 95 % bounds are those of summary.json; `mean` is that over the runs, whose expectation is 3.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"
FLIGHT = """
name = "bands"
duration_s = 600
reference_rate_hz = 5
[trajectory]
type = "paper_a"
start = {{ lat_deg = 55, lon_deg = 30, height_m = 5000 }}
lat_amplitude_rad = 0.004
lon_rate_rad_s = 4e-5
height_amplitude_m = 1000
period_s = [200, 200, 200]
[imu]
rate_hz = 50
grade = "perfect"
gyro_turn_on_bias_deg_h = 5
gyro_noise_deg_sqrt_h = 0.05
accel_turn_on_bias_mg = 1
accel_noise_m_s_sqrt_h = 0.05
{imu}
[gnss]
rate_hz = 1
white_m = [1.5, 1.5, 2.5]
white_velocity_m_s = [0.05, 0.05, 0.08]
[filter]
initial_error = {{ level_deg = 0.1, heading_deg = 1, velocity_m_s = 0.1, position_m = 3 }}
{filter}
"""
PRESETS = {"ins15": FLIGHT.format(imu="", filter='preset = "ins15"'),
           "ins21": FLIGHT.format(imu="gyro_scale_factor_ppm = 500\naccel_scale_factor_ppm = 500", filter='preset = "ins21"'),
           "complex22": EXAMPLES / "paper-a-flight.toml",
           "tight": EXAMPLES / "triad-4sv.toml"}
BLOCKS = ("position", "velocity", "attitude")


def main():
    program, seeds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 50
    print(f"{'preset':12}{'block':12}{'mean':>8}{'outside':>12}{'of them low':>14}")
    outside_all = total = 0
    for name, scenario in PRESETS.items():
        found = {block: [] for block in BLOCKS}
        with tempfile.TemporaryDirectory() as folder:
            if not isinstance(scenario, Path):
                scenario, text = Path(folder) / "bands.toml", scenario
                scenario.write_text(text)
            for seed in range(1, seeds + 1):
                subprocess.run([program, "run", scenario, "--seed", str(seed), "--outputs", "summary", "-o", folder, "-q"], check=True)
                consistency = json.loads((Path(folder) / "summary.json").read_text())["consistency"]
                for block in BLOCKS:
                    found[block].append(consistency[f"nees_{block}"])
        for block, runs in found.items():
            low = sum(r["mean"] < r["low95"] for r in runs)
            high = sum(r["mean"] > r["high95"] for r in runs)
            outside_all, total = outside_all + low + high, total + len(runs)
            mean = sum(r["mean"] for r in runs) / len(runs)
            print(f"{name:12}{block:12}{mean:8.2f}{100 * (low + high) / len(runs):10.0f} %{100 * low / len(runs):12.0f} %", flush=True)
    print(f"all: {100 * outside_all / total:.1f} % of {total}")


main()
