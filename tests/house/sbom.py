"""scripts/sbom: one JSON document of the fields of CycloneDX, every library with its version, those that are linked and those of the page.

    sbom.py ROOT PROGRAM
"""
import json
import shutil
import subprocess
import sys
from pathlib import Path

root, program = Path(sys.argv[1]), sys.argv[2]
if not shutil.which("dpkg-query"):
    sys.exit(77)
done = subprocess.run([root / "scripts/sbom", program], capture_output=True, text=True, check=False)
failures = []


def check(true, text):
    if not true:
        failures.append(text)


check(done.returncode == 0 and not done.stderr, f"exit status {done.returncode}: {done.stderr}")
bill = json.loads(done.stdout)
check(bill["bomFormat"] == "CycloneDX" and bill["specVersion"] == "1.5", f"{bill['bomFormat']} {bill['specVersion']}")
own = bill["metadata"]["component"]
version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
check(own["name"] == "schuler" and own["version"] == version, f"the program itself: {own}, {version}")
parts = {part["name"]: part for part in bill["components"]}
check(len(parts) == len(bill["components"]), "a library is named twice")
for name, part in parts.items():
    check(part["version"].strip() and part["purl"].endswith("@" + part["version"]), f"{name} has no version: {part}")
for name in ("libeigen3-dev", "libfmt-dev", "libc6", "zlib1g", "uplot"):
    check(name in parts, f"{name} is missing")
check(any(name.startswith("libhdf5") and "dev" not in name for name in parts), "the shared library of HDF5 is missing")
missing = subprocess.run([root / "scripts/sbom", "/nonexistent"], capture_output=True, text=True, check=False)
check(missing.returncode == 1 and "/nonexistent" in missing.stderr, f"without a program: {missing}")
print("\n".join(failures) or f"{len(parts)} libraries")
sys.exit(1 if failures else 0)
