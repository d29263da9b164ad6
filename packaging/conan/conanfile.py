"""Conan 2 recipe of these sources: conan create packaging/conan --build=missing"""
from pathlib import Path

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy
from conan.tools.gnu import PkgConfigDeps


class Schuler(ConanFile):
    name = "schuler"
    version = "0.1.0"
    license = "Apache-2.0"
    description = "Integrated inertial-satellite navigation"
    settings = "os", "compiler", "build_type", "arch"
    requires = ("eigen/3.4.0", "fmt/9.1.0", "geographiclib/2.1.2", "hdf5/1.14.1", "matio/1.5.24", "sqlite3/3.42.0", "zstd/1.5.5", "lz4/1.9.4",
                "bzip2/1.0.8", "zlib/1.2.13", "yaml-cpp/0.7.0", "tomlplusplus/3.3.0", "nlohmann_json/3.11.2", "cli11/2.3.2",
                "fast_float/3.10.1", "boost/1.81.0", "kissfft/131.1.0", "cpp-httplib/0.11.4")

    def export_sources(self):
        root = Path(self.recipe_folder).resolve().parent.parent
        for pattern in ("CMakeLists.txt", "LICENSE", "cmake/*", "cli/*", "serve/*", "src/*", "data/*", "octave/*", "examples/*", "ui/bundle/*"):
            copy(self, pattern, root, self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        PkgConfigDeps(self).generate()   # cmake/schuler_dependencies.cmake asks pkg-config for most of them
        toolchain = CMakeToolchain(self)
        for option in ("SCHULER_TESTS", "SCHULER_BENCH", "SCHULER_WERROR"):
            toolchain.variables[option] = False
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()

    def package_info(self):
        self.cpp_info.libs = ["schuler"]
        self.cpp_info.defines = ["EIGEN_MAX_ALIGN_BYTES=32", "EIGEN_MAX_STATIC_ALIGN_BYTES=32"]
