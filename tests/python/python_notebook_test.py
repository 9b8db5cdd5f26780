# SPDX-License-Identifier: Apache-2.0
"""The cells of docs/user/sequence.ipynb run one after the other, as a notebook runs them, and draw what it promises."""
import json
import os
import pathlib

import numpy as np
import pytest

matplotlib = pytest.importorskip("matplotlib", reason="sudo apt install python3-matplotlib")

NOTEBOOK = json.loads((pathlib.Path(os.environ["PLVO_PAGE"]).parent / "sequence.ipynb").read_text())


def test_it_is_a_notebook_without_outputs():
    assert NOTEBOOK["nbformat"] == 4 and NOTEBOOK["metadata"]["kernelspec"]["language"] == "python"
    for cell in NOTEBOOK["cells"]:
        assert cell["cell_type"] in ("code", "markdown") and isinstance(cell["metadata"], dict) and cell["source"]
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None


def test_its_cells_run_in_their_order(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", str(pathlib.Path(os.environ["PLVO_BINARY"]).parent), prepend=os.pathsep)
    matplotlib.use("Agg")
    pyplot = pytest.importorskip("matplotlib.pyplot")
    names, pictures = {}, []
    for cell in NOTEBOOK["cells"]:
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), "sequence.ipynb", "exec"), names)
        for number in pyplot.get_fignums():
            figure = pyplot.figure(number)
            figure.savefig(f"{len(pictures)}.png")
            pictures.append(np.asarray(figure.canvas.buffer_rgba()).copy())
        pyplot.close("all")
    assert len(pictures) == 3
    assert all(picture.std() > 10 for picture in pictures)
    # What its pictures show: the truth in the axes of plvo's world, and errors within the covariance.
    assert len(names["trajectory"]) == 90
    assert np.ptp(names["true_positions"], axis=0).max() > 0.3
    assert np.abs(names["errors"]).max() < 0.02
    assert (np.abs(names["errors"][1:]) < 3 * names["sigmas"][1:]).mean() > 0.9
