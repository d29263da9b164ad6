"""Recipes and packages agree with the build: versions, libraries, HDF5 under each of its names, scripts that make packages.

    packaging.py ROOT CMAKE
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

root, cmake = Path(sys.argv[1]).resolve(), sys.argv[2]
failures = []


def check(true, text):
    if not true:
        failures.append(text)


version = re.search(r"project\(\s*schuler\s+VERSION\s+([\d.]+)", (root / "CMakeLists.txt").read_text(), re.I).group(1)
conan = (root / "packaging/conan/conanfile.py").read_text()
compile(conan, "conanfile.py", "exec")
vcpkg = json.loads((root / "packaging/vcpkg/vcpkg.json").read_text())
check(f'version = "{version}"' in conan and vcpkg["version"] == version, f"a recipe is not of version {version}")
# what the build asks pkg-config for has to be made by Conan
check("PkgConfigDeps(self).generate()" in conan and "from conan.tools.gnu import PkgConfigDeps" in conan, "Conan makes no files for pkg-config")
modules = re.findall(r"schuler_pkg_config\(\S+ \S+ (\S+)\)", (root / "cmake/schuler_dependencies.cmake").read_text())
check(len(modules) > 5, f"{modules}")
CALLED = {"libzstd": "zstd", "liblz4": "lz4"}
for module in modules:
    check(f'"{CALLED.get(module, module)}/' in conan, f"Conan's recipe does not require {module}")
    check(any(d == CALLED.get(module, module) for d in vcpkg["dependencies"] if isinstance(d, str)), f"vcpkg's recipe does not require {module}")
for library in ("hdf5", "kissfft", "fast"):
    check(library in conan and any(library in str(d) for d in vcpkg["dependencies"]), library)

# HDF5 as Debian calls it, as others call it, and without a file for pkg-config
if shutil.which("pkg-config"):
    folders = subprocess.run(["pkg-config", "--variable=pc_path", "pkg-config"], capture_output=True, text=True, check=True).stdout.strip().split(":")
    for name, leave_out in (("serial", []), ("other", ["hdf5-serial.pc"]), ("none", ["hdf5-serial.pc", "hdf5.pc"])):
        with tempfile.TemporaryDirectory() as place:
            place = Path(place)
            (place / "pc").mkdir()
            for folder in map(Path, folders):
                for file in folder.glob("*.pc") if folder.is_dir() else []:
                    if file.name not in leave_out and not (name == "none" and file.name.startswith("hdf5")):
                        shutil.copyfile(file, place / "pc" / file.name)
            (place / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.22)\nproject(try LANGUAGES C CXX)\n"
                                                  f"include({root}/cmake/schuler_dependencies.cmake)\nget_target_property(where schuler_hdf5 INTERFACE_INCLUDE_DIRECTORIES)\n"
                                                  "find_file(header hdf5.h PATHS ${where} NO_DEFAULT_PATH)\nmessage(STATUS \"header: ${header}\")\n")
            done = subprocess.run([cmake, "-S", place, "-B", place / "build"], capture_output=True, text=True, check=False,
                                  env={**os.environ, "PKG_CONFIG_LIBDIR": str(place / "pc"), "PKG_CONFIG_PATH": ""})
            check(done.returncode == 0 and re.search(r"header: /.*hdf5\.h", done.stdout), f"HDF5 ({name}): {done.stdout[-500:]} {done.stderr[-500:]}")

# the package and the comparison of two folders: what makes bytes differ is switched off
package, twice = (root / "scripts/package").read_text(), (root / "scripts/reproducible").read_text()
check("-DSCHULER_ARCH=x86-64-v2" in package and "SOURCE_DATE_EPOCH" in package, "scripts/package")
check("CCACHE_DISABLE=1" in twice and "cmp -s" in twice, "scripts/reproducible")
check("-ffile-prefix-map=${PROJECT_SOURCE_DIR}" in (root / "cmake/schuler_compiler.cmake").read_text(), "names of folders in the program")
unit = (root / "examples/live/schuler-live.service").read_text()
check("Type=notify" in unit and re.search(r"^WatchdogSec=\d", unit, re.M), "the unit is not watched")
check("schuler-live.service" in (root / "cmake/schuler_install.cmake").read_text(), "the unit is not installed")
print("\n".join(failures) or "good")
sys.exit(1 if failures else 0)
