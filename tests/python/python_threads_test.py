# SPDX-License-Identifier: Apache-2.0
"""Threads of Python: arrays that several of them use first, and an object that several of them use at once."""
import subprocess
import sys
import threading

import pytest

import plvo

# Nothing of NumPy has been used when the threads begin.
FIRST = """
import sys, threading
import plvo

start, ends = threading.Barrier(8), []

def read():
    sequence = plvo.Sequence(sys.argv[1])
    odometry = plvo.Odometry(sequence.camera)
    start.wait()
    for frame in sequence:
        result = odometry.track(*frame)
    ends.append((result.T_world_camera.tobytes(), result.covariance.tobytes()))

threads = [threading.Thread(target=read, daemon=True) for _ in range(8)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
assert len(ends) == 8 and len(set(ends)) == 1, ends
"""


@pytest.mark.parametrize("attempt", range(3))
def test_threads_are_the_first_to_use_arrays(recording, attempt):
    """subprocess ends a hang with TimeoutExpired."""
    subprocess.run([sys.executable, "-c", FIRST, recording], check=True, timeout=180)


def test_threads_that_meet_in_a_sequence_are_told_so(recording):
    """Each frame goes to one of them, and no read fails otherwise."""
    for _ in range(4):
        sequence, start, stamps, refused, others = plvo.Sequence(recording), threading.Barrier(8), [], [], []

        def read():
            start.wait()
            while True:
                try:
                    stamps.append(next(sequence).stamp_ns)
                except StopIteration:
                    return
                except RuntimeError as error:
                    refused.append(str(error))
                except Exception as error:
                    others.append(error)

        threads = [threading.Thread(target=read) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert not others
        assert sorted(stamps) == [frame.stamp_ns for frame in plvo.Sequence(recording)]
        assert set(refused) <= {"this Sequence is at work in another thread; give each thread its own"}
