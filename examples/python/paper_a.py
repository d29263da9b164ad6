"""Paper A, the integrated system: its flight, errors with their sigmas, and sensors for a budget over an outage."""
import numpy as np
import schuler
from figures import SCENARIOS, panels

result = schuler.run(SCENARIOS / "paper-a-flight.toml")
print(result.verdict)
errors = result.errors
time = errors.time_s - errors.time_s[0]
parts = ("east", "north", "up")
panels("paper_a_position", time, [(f"{p}, m", errors.position[:, i]) for i, p in enumerate(parts)], errors.std_position.T)
panels("paper_a_attitude", time, [(f"{p}, deg", errors.attitude[:, i]) for i, p in enumerate(("roll", "pitch", "heading"))], errors.std_attitude.T)

inside = np.mean(np.all(np.abs(errors.position[600:]) < 3 * errors.std_position[600:], axis=1))
print(f"position inside three sigma: {100 * inside:.1f} % of the epochs")
assert inside > 0.9

for row in schuler.analyze.requirements(budget=5.0).summary["rows"]:
    print(f"outage of {row['outage_s']:6.0f} s: gyros {row['gyro_deg_h']:10.3f} deg/h, accelerometers {row['accel_ug']:9.1f} ug")
