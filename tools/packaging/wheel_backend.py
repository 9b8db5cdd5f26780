# SPDX-License-Identifier: Apache-2.0
"""The build backend of pyproject.toml (PEP 517): a wheel of the component python of tools/cmake/install.cmake, in plain Python.

pip calls build_wheel in the root of the sources. The build stays in build/wheel-TAG, so that a second one is quick. The setting
build=DIR (pip install --config-settings build=DIR) takes a folder in which plvo was built with its Python package instead."""
import base64
import hashlib
import pathlib
import re
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAME = "plvo"


def version():
    return re.search(r"^project\(plvo VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"), re.M).group(1)


def tag():
    """Of this interpreter and this machine: pybind11 does not keep to the stable ABI."""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub(r'[-.]', '_', sysconfig.get_platform())}"


def metadata():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {version()}", f"Summary: {project['description']}",
             f"License: {project['license']['text']}", f"Requires-Python: {project['requires-python']}"]
    return "\n".join(lines + [f"Requires-Dist: {name}" for name in project["dependencies"]]) + "\n"


def build():
    """Builds the modules, as the Debian packages are built; returns the folder. CMAKE_BUILD_PARALLEL_LEVEL limits the processes."""
    folder = ROOT / "build" / f"wheel-{tag()}"
    subprocess.run(["cmake", "--preset", "package", "-S", ROOT, "-B", folder, "-DPLVO_BUILD_PYTHON=ON", "-DPLVO_WERROR=OFF",
                    f"-DPython_EXECUTABLE={sys.executable}"], cwd=ROOT, check=True)
    subprocess.run(["cmake", "--build", folder, "--target", "plvo_python_odometry", "plvo_python_evaluation"], check=True)
    return folder


def get_requires_for_build_wheel(config_settings=None):
    return []


def get_requires_for_build_sdist(config_settings=None):
    return []


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    folder = (config_settings or {}).get("build") or build()
    name = f"{NAME}-{version()}-{tag()}.whl"
    info = f"{NAME}-{version()}.dist-info"
    with tempfile.TemporaryDirectory() as prefix:
        subprocess.run(["cmake", "--install", folder, "--component", "python", "--strip", "--prefix", prefix], check=True)
        package = next(pathlib.Path(prefix).rglob("__init__.py")).parent
        files = {f"{NAME}/{path.relative_to(package)}": path.read_bytes() for path in sorted(package.rglob("*")) if path.is_file()}
    files[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    files[f"{info}/METADATA"] = metadata().encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: plvo\nRoot-Is-Purelib: false\nTag: {tag()}\n".encode()
    record = ""
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in files.items():
            wheel.writestr(path, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record += f"{path},sha256={digest},{len(content)}\n"
        wheel.writestr(f"{info}/RECORD", f"{record}{info}/RECORD,,\n")
    return name


def build_sdist(sdist_directory, config_settings=None):
    top = f"{NAME}-{version()}"
    with tarfile.open(pathlib.Path(sdist_directory) / f"{top}.tar.gz", "w:gz") as archive:
        for path in sorted(ROOT.iterdir()):
            if path.name not in ("build", ".git"):
                archive.add(path, f"{top}/{path.name}", filter=lambda entry: None if "__pycache__" in entry.name else entry)
        with tempfile.NamedTemporaryFile() as info:
            info.write(metadata().encode())
            info.flush()
            archive.add(info.name, f"{top}/PKG-INFO")
    return f"{top}.tar.gz"
