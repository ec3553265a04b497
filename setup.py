"""Builds the Python module by CMake, for `pip install .`."""
import pathlib
import re
import subprocess

from skbuild import setup

ROOT = pathlib.Path(__file__).parent


def numpy():
    """pybind11 knows the arrays of NumPy 2 from its version 2.12 on."""
    found = subprocess.run(["pkg-config", "--exists", "pybind11 >= 2.12"], check=False)
    return "numpy" if found.returncode == 0 else "numpy<2"


setup(
    name="palpa",
    version=re.search(r"project\(palpa VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1],
    description="Feel a 3-D model in mid-air: from depth images to a driven ultrasound array",
    license="MIT",
    packages=["palpa"],
    package_dir={"": "python"},
    package_data={"palpa": ["py.typed", "*.pyi"]},
    include_package_data=False,
    python_requires=">=3.11",
    install_requires=[numpy()],
    cmake_install_dir="python",
    cmake_install_target="install-python",
    cmake_args=["-DCMAKE_BUILD_TYPE=Release", "-DPALPA_BUILD_TESTS=OFF", "-DPALPA_BUILD_VIEWER=OFF", "-DPALPA_PYTHON=ON", "-DPALPA_UNITS=ON"],
)
