# SPDX-License-Identifier: Apache-2.0
"""plvo.evaluate says what `plvo eval --json` says."""
import json
import math
import os
import subprocess

import pytest

import plvo

PLVO = os.environ["PLVO_BINARY"]


@pytest.fixture(scope="module")
def tracked(recording, tmp_path_factory):
    files = tmp_path_factory.mktemp("tracked")
    outputs = ["--out", files / "t", "--covariance", files / "c", "--motions", files / "m"]
    subprocess.run([PLVO, "run", recording, "--quiet", *outputs], check=True)
    return files


def command(recording, tracked, *more):
    arguments = [PLVO, "eval", "--gt", recording / "groundtruth.txt", "--est", tracked / "t", "--json", "-", *more]
    return json.loads(subprocess.run(arguments, check=True, capture_output=True).stdout)


def close(a, b):
    """Files have nine decimals, results all of them."""
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(close(a[key], b[key]) for key in a)
    if isinstance(a, list):
        return len(a) == len(b) and all(map(close, a, b))
    return a == pytest.approx(b, rel=1e-3, abs=1e-7) if isinstance(a, float) else a == b


def test_of_a_file(recording, tracked):
    found = plvo.evaluate(recording / "groundtruth.txt", tracked / "t", rpe_deltas=["1f", "0.2s"])
    assert found == command(recording, tracked, "--rpe-delta", "1f", "--rpe-delta", "0.2s")
    assert 0 < found["ate_m"]["rmse"] < 0.02


def test_of_the_folder_itself(recording, tracked):
    assert plvo.evaluate(recording, tracked / "t") == plvo.evaluate(recording / "groundtruth.txt", tracked / "t")
    with pytest.raises(plvo.Error, match="has neither groundtruth.txt nor"):
        plvo.evaluate(tracked, tracked / "t")


def test_of_results(recording, tracked):
    found = plvo.evaluate(recording / "groundtruth.txt", plvo.run(recording))
    expected = command(recording, tracked, "--rpe-delta", "1f", "--rpe-delta", "1s", "--est-covariance", tracked / "c", "--est-motions",
                       tracked / "m")
    assert "rpe" in found and "ate_m" in found
    assert close(found, expected)


def test_the_truth_is_fitted(recording, tracked, tmp_path):
    def rows(delay):
        for i in range(500):
            a, b, c = (0.2 * math.sin(0.01 * i * f) for f in (2.1, 1.7, 2.9))
            w = math.sqrt(1 - a * a - b * b - c * c)
            yield f"{0.01 * i + delay:.6f} {a} {b} {c} {a} {b} {c} {w}\n"

    (tmp_path / "groundtruth.txt").write_text("".join(rows(0.02)))
    (tmp_path / "t").write_text("".join(rows(0)))
    found = plvo.evaluate(tmp_path / "groundtruth.txt", tmp_path / "t", fit_truth=True)
    assert found == command(tmp_path, tmp_path, "--fit-truth")
    assert found["truth_fit"]["clock_ms"] == pytest.approx(20, abs=0.1)
    with pytest.raises(plvo.Error, match="the truth cannot be fitted"):  # too short
        plvo.evaluate(recording, tracked / "t", fit_truth=True)
    with pytest.raises(ValueError, match="interpolated"):
        plvo.evaluate(recording, tracked / "t", sampling="nearest", fit_truth=True)


def test_errors_are_the_librarys_words(recording, tracked, tmp_path):
    with pytest.raises(plvo.Error) as error:
        plvo.evaluate(tmp_path / "nowhere.txt", tracked / "t")
    assert error.value.code == "not_found"
    with pytest.raises(ValueError, match="1f, 0.5s or 2m"):
        plvo.evaluate(recording / "groundtruth.txt", tracked / "t", rpe_deltas=["1 hour"])
    with pytest.raises(ValueError, match="interpolated or nearest"):
        plvo.evaluate(recording / "groundtruth.txt", tracked / "t", sampling="somehow")
    results = list(plvo.run(recording))
    with pytest.raises(ValueError, match="increase"):
        plvo.evaluate(recording / "groundtruth.txt", results + results)
    with pytest.raises(plvo.Error):
        plvo.evaluate(recording / "groundtruth.txt", results[:1])
