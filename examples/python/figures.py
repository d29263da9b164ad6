"""What the examples share: where figures go, and that they may be left out."""
import sys
from pathlib import Path

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
except ImportError:
    plt = None
    print("matplotlib is not here: no figures (apt-get install python3-matplotlib)")

FOLDER = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("figures")
SCENARIOS = Path(__file__).resolve().parent.parent


def panels(name, time, curves, sigma=None, label="time, s"):
    """A figure NAME.png with a panel for each (title, values); one-sigma bands where given."""
    if plt is None:
        return
    figure, axes = plt.subplots(len(curves), 1, sharex=True, figsize=(7, 2.2 * len(curves)), squeeze=False)
    for i, (title, values) in enumerate(curves):
        axis = axes[i, 0]
        axis.plot(time, values, linewidth=0.8)
        if sigma is not None:
            axis.fill_between(time, -sigma[i], sigma[i], alpha=0.25)
        axis.set_ylabel(title)
        axis.grid(True)
    axes[-1, 0].set_xlabel(label)
    FOLDER.mkdir(parents=True, exist_ok=True)
    figure.tight_layout()
    figure.savefig(FOLDER / f"{name}.png", dpi=100)
    plt.close(figure)
    print(f"wrote {FOLDER / name}.png")
