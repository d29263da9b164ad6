"""Paper B, attitude and heading: a disturbed magnetometer in the paper's quaternion filter and in the one to use."""
import numpy as np
import schuler
from figures import panels

random = np.random.default_rng(1)
dt, n = 0.01, 12000
time = dt * np.arange(1, n + 1)
rpy = np.column_stack([0.3 * np.sin(0.5 * time), 0.2 * np.cos(0.3 * time), 0.5 * np.sin(0.1 * time)])
C_nb = schuler.dcm_from_rpy(rpy)
turn = schuler.rotation_vector_from_quaternion(schuler.quaternion_from_dcm(np.swapaxes(C_nb[:-1], 1, 2) @ C_nb[1:]))
gyro = np.vstack([turn[:1], turn]) / dt + np.radians(0.1) + random.normal(0, 1e-3, (n, 3))
accel = np.einsum("nij,i->nj", C_nb, [0, 0, -9.81]) + random.normal(0, 0.02, (n, 3))
field = np.tile([2e-5, 0, 4.5e-5], (n, 1))
field[(time > 60) & (time < 70)] += [0, 2e-5, -1e-5]          # iron passes by
mag = np.einsum("nij,ni->nj", C_nb, field) + random.normal(0, 2e-7, (n, 3))

largest = {}
for name in ("quaternion-coupled", "mekf"):
    rows = schuler.attitude(time, gyro, accel, mag=mag, filter=name)
    first = n - len(rows)
    error = np.degrees(schuler.wrap_pi(rows.rpy - rpy[first:]))
    panels(f"paper_b_{name}", time[first:], [(f"{p}, deg", error[:, i]) for i, p in enumerate(("roll", "pitch", "heading"))])
    later = time[first:] > 30
    largest[name] = np.abs(error[later]).max(axis=0)
    print(f"{name}: largest errors of roll, pitch, heading {np.round(largest[name], 2)} deg")
assert largest["mekf"][:2].max() < 1.0, "iron does not tilt the horizon"
