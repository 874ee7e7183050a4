"""pip install --no-build-isolation .    CMake builds the binding with the engine in it; nothing is downloaded.

FRESHET_BUILD   a CMake build folder with FRESHET_PYTHON=ON, to take the binding from instead.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent
VERSION = re.search(r"project\(freshet VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


class Build(build_ext):
    def build_extension(self, extension):
        folder = os.environ.get("FRESHET_BUILD")
        if not folder:
            folder = pathlib.Path(self.build_temp).resolve()
            subprocess.run(["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "-D", "CMAKE_BUILD_TYPE=Release",
                            "-D", "FRESHET_PYTHON=ON", "-D", "FRESHET_TESTS=OFF", "-D", "FRESHET_BENCH=OFF",
                            "-D", "BUILD_SHARED_LIBS=OFF", "-D", f"Python_EXECUTABLE={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", folder, "--target", "freshet_python"], check=True)
        built, = pathlib.Path(folder).glob("python/freshet/_freshet*.so")
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(built, target)


setup(version=VERSION, ext_modules=[Extension("freshet._freshet", [])], cmdclass={"build_ext": Build})
