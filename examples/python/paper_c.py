"""Paper C, errors along the equator: how they grow with the speed, and the paper's tables with their misprints."""
import numpy as np
import schuler
from figures import panels

times = np.linspace(0, 5400, 91)
curves = []
for speed in (0.0, 600.0):
    height = [schuler.analyze.equator(speed=speed, height=10000, time=t, dphi=1.57e-7).summary["error"]["phi"] for t in times]
    curves.append((f"latitude error at {speed:.0f} m/s, m", np.array(height) * 6378245.0))
panels("paper_c_latitude", times / 60, curves, label="time, min")
periods = schuler.analyze.equator(speed=600, height=10000).summary["periods_s"]
print(f"periods at 600 m/s: {periods}")
zero = times[np.flatnonzero(np.diff(np.sign(curves[1][1])))]
assert abs(zero[1] - zero[0] - periods["mu"] / 2) < 120, "the latitude swings with one of the periods"
print(schuler.analyze.equator(paper=True).text)
