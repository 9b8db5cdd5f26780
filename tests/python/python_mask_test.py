# SPDX-License-Identifier: Apache-2.0
"""A mask of the camera's images: what lies in masked pixels has no influence, and what is no mask is refused."""
import numpy as np
import pytest

import plvo

WIDTH, HEIGHT = 320, 240


def bumper():
    mask = np.ones((HEIGHT, WIDTH), bool)
    mask[HEIGHT * 17 // 20:] = False
    return mask


def poses(recording, mask, content=None):
    sequence = plvo.Sequence(recording)
    odometry = plvo.Odometry(sequence.camera, mask=mask)
    hidden = ~bumper()
    found = []
    for frame in sequence:
        colour, depth = frame.colour.copy(), frame.depth.copy()
        if content is not None:
            colour[hidden] = content.integers(0, 256, (hidden.sum(), 3))
            depth[hidden] = content.integers(0, 65536, hidden.sum())
        found.append(odometry.track(colour, depth, frame.stamp_ns).T_world_camera)
    return np.array(found), odometry


def test_what_lies_in_masked_pixels_has_no_influence(recording):
    room, odometry = poses(recording, bumper())
    noise, _ = poses(recording, bumper(), np.random.default_rng(1))
    assert np.array_equal(room, noise)
    assert (odometry.features().image[HEIGHT - 1] == 128).all(), "masked pixels are grey"
    plain, without = poses(recording, None)
    assert not np.array_equal(room, plain)
    assert odometry.memory_bytes - without.memory_bytes >= WIDTH * HEIGHT * 33 // 16


def test_any_array_of_bytes_or_bools_is_a_mask(recording):
    masked, _ = poses(recording, bumper())
    for same in (bumper().astype(np.uint8) * 255, np.asfortranarray(bumper()), np.repeat(bumper(), 2, axis=1)[:, ::2]):
        assert np.array_equal(poses(recording, same)[0], masked)
    by_run = [result.T_world_camera for result in plvo.run(recording, mask=bumper())]
    assert np.array_equal(by_run, masked)


def test_the_mask_is_copied(recording):
    sequence = plvo.Sequence(recording)
    mask = bumper()
    odometry = plvo.Odometry(sequence.camera, mask=mask)
    mask[:] = False
    del mask
    last = [odometry.track(*frame).T_world_camera for frame in sequence][-1]
    assert np.array_equal(last, poses(recording, bumper())[0][-1])


def test_what_is_no_mask_is_refused(recording):
    camera = plvo.Sequence(recording).camera
    with pytest.raises(plvo.Error, match="size of the camera's images, 320x240, not 240x320"):
        plvo.Odometry(camera, mask=bumper().T)
    with pytest.raises(plvo.Error, match="leaves no pixel"):
        plvo.Odometry(camera, mask=np.zeros((HEIGHT, WIDTH), bool))
    with pytest.raises(TypeError, match="bool or uint8"):
        plvo.Odometry(camera, mask=bumper().astype(float))
    with pytest.raises(ValueError, match="height, width"):
        plvo.Odometry(camera, mask=np.ones((HEIGHT, WIDTH, 3), np.uint8))
