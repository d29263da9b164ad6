"""Paper E, gravity from a moving vehicle: the disturbance along the track with its sigma, beside the truth."""
import numpy as np
import schuler
from figures import SCENARIOS, panels

table = schuler.gravity(SCENARIOS / "gravity-step.toml").gravity
error = table.disturbance_up_mgal - table.true_up_mgal
panels("paper_e_gravity", table.distance_m / 1000, [("estimate, mGal", table.disturbance_up_mgal), ("truth, mGal", table.true_up_mgal)],
       label="distance, km")
panels("paper_e_error", table.distance_m / 1000, [("error, mGal", error)], table.std_disturbance_up_mgal[None], label="distance, km")
inside = np.mean(np.abs(error) < 3 * table.std_disturbance_up_mgal)
print(f"rms {np.sqrt(np.mean(error ** 2)):.2f} mGal, {100 * inside:.0f} % inside three sigma")
assert inside > 0.9
