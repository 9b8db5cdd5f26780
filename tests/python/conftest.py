# SPDX-License-Identifier: Apache-2.0
"""A simulated sequence of 24 small frames, with its true poses."""
import os
import subprocess
import sys

import pytest

sys.dont_write_bytecode = True

PLVO = os.environ["PLVO_BINARY"]


@pytest.fixture(scope="session")
def recording(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recorded") / "sequence"
    subprocess.run([PLVO, "simulate", "--out", folder, "--frames", "24", "--size", "320x240", "--quiet"], check=True)
    return folder
