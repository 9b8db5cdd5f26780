# SPDX-License-Identifier: Apache-2.0
"""pip install of a checkout and of its source distribution, into a new environment, without an index: the package imports, has the
program's version and its poses, and goes without a trace. It takes the modules of this build; that the backend builds them from a clean
checkout, tools/setup/package.sh tries."""
import os
import pathlib
import subprocess
import sys

import pytest

from conftest import PLVO

ROOT = pathlib.Path(__file__).resolve().parents[2]
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
PROGRAM = """
import sys
import plvo
assert plvo.__file__.startswith(sys.prefix), plvo.__file__
for r in plvo.run(sys.argv[1]):
    if r.has_pose:
        print(" ".join(f"{x:.9f}" for x in (*r.position, *r.quaternion)))
"""


def run(*command):
    done = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{command}:\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def python(tmp_path_factory):
    try:
        import ensurepip  # noqa: F401  (Debian: the package python3-venv)
    except ImportError:
        pytest.skip("python3-venv is not installed (sudo apt install python3-venv)")
    folder = tmp_path_factory.mktemp("environment") / "venv"
    run(sys.executable, "-m", "venv", "--system-site-packages", folder)
    return folder / "bin/python"


def pip(python, *words):
    return run(python, "-m", "pip", "--disable-pip-version-check", "--no-cache-dir", *words)


def install(python, what):
    pip(python, "install", "--no-index", "--config-settings", f"build={os.environ['PLVO_BUILD']}", what)


def check(python, recording, tmp_path):
    version = run(PLVO, "--version").split()[1]
    assert f"Version: {version}\n" in pip(python, "show", "plvo")
    run(PLVO, "run", recording, "--quiet", "--out", tmp_path / "t.txt")
    rows = [line.split(" ", 1)[1] for line in (tmp_path / "t.txt").read_text().splitlines() if not line.startswith("#")]
    assert run(python, "-c", PROGRAM, recording).splitlines() == rows
    pip(python, "uninstall", "--yes", "plvo")
    assert not list(python.parent.parent.rglob("*plvo*"))


def test_of_a_checkout(python, recording, tmp_path):
    install(python, ROOT)
    check(python, recording, tmp_path)


def test_of_its_source_distribution(python, recording, tmp_path):
    program = "import sys; sys.path.insert(0, sys.argv[1]); import wheel_backend; print(wheel_backend.build_sdist(sys.argv[2]))"
    name = run(sys.executable, "-B", "-c", program, ROOT / "tools/packaging", tmp_path).strip()
    install(python, tmp_path / name)
    check(python, recording, tmp_path)
