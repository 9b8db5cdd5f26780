# SPDX-License-Identifier: Apache-2.0
"""Every program of docs/user/python.md runs, one after the other in one folder that has a recorded sequence in it."""
import os
import pathlib
import re
import subprocess
import sys

import pytest

PAGE = pathlib.Path(os.environ["PLVO_PAGE"])
PROGRAMS = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(), re.M | re.S)


def test_the_page_has_programs():
    assert len(PROGRAMS) >= 4


@pytest.mark.parametrize("program", PROGRAMS, ids=[str(i) for i in range(len(PROGRAMS))])
def test_a_program_of_the_page(program, recording, tmp_path):
    if "matplotlib" in program:
        pytest.importorskip("matplotlib", reason="sudo apt install python3-matplotlib")
    (tmp_path / "sequence").symlink_to(recording)
    run = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True,
                         env={**os.environ, "MPLBACKEND": "Agg", "MPLCONFIGDIR": str(tmp_path)})
    assert run.returncode == 0, run.stderr
    for picture in re.findall(r'savefig\("(.*?)"', program):
        assert (tmp_path / picture).read_bytes().startswith(b"\x89PNG")
