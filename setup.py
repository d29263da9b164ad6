"""`pip install --no-build-isolation .`: the Python package, built by CMake (docs/python.md).

    SCHULER_BUILD=FOLDER     a build folder that is there already is built on and used, instead of build-python
    SCHULER_JOBS=N           compilers at once (default: one a processor core)
"""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
VERSION = re.search(r"project\(schuler VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text()).group(1)


class CMakeBuild(build_ext):
    def build_extension(self, ext):
        build = Path(os.environ.get("SCHULER_BUILD") or ROOT / "build-python").resolve()
        options = [f"-DPYTHON_EXECUTABLE={sys.executable}", "-DSCHULER_PYTHON=ON"]
        if not (build / "CMakeCache.txt").is_file():
            options += ["-DCMAKE_BUILD_TYPE=Release", "-DSCHULER_TESTS=OFF", "-DSCHULER_BENCH=OFF", "-DSCHULER_WERROR=OFF",
                        "-DSCHULER_UNITY=ON", "-DSCHULER_PCH=ON"]
            options += ["-G", "Ninja"] if shutil.which("ninja") else []
        subprocess.run(["cmake", "-S", ROOT, "-B", build, *options], check=True)
        jobs = os.environ.get("SCHULER_JOBS") or str(os.cpu_count() or 1)
        subprocess.run(["cmake", "--build", build, "--target", "schuler_python", "-j", jobs], check=True)
        made = [p for p in (build / "python/schuler").glob("_schuler*.so")]
        if len(made) != 1:
            sys.exit(f"setup: {len(made)} modules in {build / 'python/schuler'}, expected one")
        target = Path(self.get_ext_fullpath(ext.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(made[0], target)


setup(name="schuler", version=VERSION, description="Integrated inertial-satellite navigation",
      package_dir={"": "python"}, packages=["schuler"], package_data={"schuler": ["*.pyi", "py.typed"]},
      ext_modules=[Extension("schuler._schuler", sources=[])], cmdclass={"build_ext": CMakeBuild},
      options={"build": {"build_base": str(ROOT / "build-python/setuptools")}},   # build/ is CMake's
      python_requires=">=3.11", install_requires=["numpy"], zip_safe=False)
