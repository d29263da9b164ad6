"""`pip install --no-build-isolation .` into an empty folder, on the build folder that is there; used from outside the sources."""
import os
import subprocess
import sys
import tempfile

from support import FOLDER, SOURCE, drive


def main():
    if subprocess.run([sys.executable, "-m", "pip", "--version"], capture_output=True).returncode != 0:
        print("skipped: pip is not here")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as root:
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"} | {"SCHULER_JOBS": "2"}
        done = subprocess.run([sys.executable, "-m", "pip", "install", "--no-build-isolation", "--no-deps", "--no-index", "--target", root, SOURCE],
                              env=environment, capture_output=True, text=True, timeout=250)
        if done.returncode != 0:
            sys.exit(f"pip: {done.stdout[-1500:]}{done.stderr[-1500:]}")
        code = (f"import schuler\nassert schuler.__file__.startswith({root!r}), schuler.__file__\n"
                f"print(len(schuler.process({str(drive())!r}, self_check=False).solution))")
        done = subprocess.run([sys.executable, "-c", code], env=environment | {"PYTHONPATH": root}, capture_output=True, text=True, cwd=FOLDER)
        if done.returncode != 0 or int(done.stdout) < 1000:
            sys.exit(f"the installed package: {done.stdout}{done.stderr}")
        print("good")


if __name__ == "__main__":
    main()
