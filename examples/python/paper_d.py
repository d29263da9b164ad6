"""Paper D, satellites, ADS-B stations and inertial unit in one filter: two of each, and two satellites alone."""
import numpy as np
import schuler
from figures import SCENARIOS, panels

for name in ("triad-2sv2st", "triad-2sv" if (SCENARIOS / "triad-2sv.toml").is_file() else "triad-3sv"):
    result = schuler.run(SCENARIOS / f"{name}.toml")
    errors = result.errors
    panels(f"paper_d_{name}", errors.time_s - errors.time_s[0], [(f"{p}, m", errors.position[:, i]) for i, p in enumerate(("east", "north", "up"))],
           errors.std_position.T)
    inside = np.mean(np.all(np.abs(errors.position) < 3 * errors.std_position, axis=1))
    print(f"{name}: {np.sqrt(np.mean(errors.position ** 2, axis=0)).round(2)} m rms, {100 * inside:.0f} % inside three sigma; {result.verdict}")
    assert inside > 0.8
