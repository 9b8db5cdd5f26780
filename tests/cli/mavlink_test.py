#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Receives MAVLink's ODOMETRY of `plvo run` and `plvo live`, decodes it by the public description of the protocol and
compares it with the files of the same run. The decoder shares no code with plvo; its checksum is compared with the
published check value of CRC-16/MCRF4XX. usage: mavlink_test.py PLVO
"""
import math
import os
import socket
import struct
import subprocess
import sys
import tempfile

# Fields of ODOMETRY in the order of the description: type, name, length of an array. Extensions are not in CRC_EXTRA.
FIELDS = [("uint64_t", "time_usec", 0), ("uint8_t", "frame_id", 0), ("uint8_t", "child_frame_id", 0)]
FIELDS += [("float", name, 0) for name in "xyz"] + [("float", "q", 4)]
FIELDS += [("float", name, 0) for name in ("vx", "vy", "vz", "rollspeed", "pitchspeed", "yawspeed")]
FIELDS += [("float", "pose_covariance", 21), ("float", "velocity_covariance", 21)]
EXTENSIONS = [("uint8_t", "reset_counter", 0), ("uint8_t", "estimator_type", 0), ("int8_t", "quality", 0)]
SIZES = {"uint64_t": 8, "float": 4, "uint8_t": 1, "int8_t": 1}
CODES = {"uint64_t": "Q", "float": "f", "uint8_t": "B", "int8_t": "b"}
ORDERED = sorted(FIELDS, key=lambda field: -SIZES[field[0]])  # stable: larger types first
BASE_CAMERA = "0.1 0.02 0.3 -0.5 0.5 -0.5 0.5"
FRAMES = 8


def crc_mcrf4xx(data, crc=0xFFFF):
    for byte in data:
        folded = (byte ^ crc) & 0xFF
        folded = (folded ^ (folded << 4)) & 0xFF
        crc = (crc >> 8) ^ (folded << 8) ^ (folded << 3) ^ (folded >> 4)
    return crc


def crc_extra():
    crc = crc_mcrf4xx(b"ODOMETRY ")
    for kind, name, length in ORDERED:
        crc = crc_mcrf4xx(f"{kind} {name} ".encode() + (bytes([length]) if length else b""), crc)
    return (crc & 0xFF) ^ (crc >> 8)


def decode(datagram):
    magic, length, incompatible, compatible, sequence, system, component = datagram[:7]
    assert magic == 0xFD and incompatible == 0 and compatible == 0, datagram[:10].hex()
    assert int.from_bytes(datagram[7:10], "little") == 331
    assert (system, component) == (1, 197)
    assert len(datagram) == 12 + length
    crc = crc_mcrf4xx(datagram[1:10 + length] + bytes([crc_extra()]))
    assert crc == int.from_bytes(datagram[-2:], "little"), "the checksum is wrong"
    fields = ORDERED + EXTENSIONS
    form = "<" + "".join(f"{count or 1}{CODES[kind]}" for kind, _, count in fields)
    values = list(struct.unpack(form, datagram[10:10 + length].ljust(struct.calcsize(form), b"\0")))
    message = {"sequence": sequence}
    for _, name, count in fields:
        message[name] = values[:count] if count else values[0]
        del values[:count or 1]
    return message


def received(reader):
    messages = []
    reader.settimeout(0.5)
    try:
        while True:
            messages.append(decode(reader.recv(4096)))
    except TimeoutError:
        return messages


def rows(path):
    return [[float(word) for word in line.split()] for line in open(path, encoding="ascii") if line[0] != "#"]


def near(a, b, tolerance=1e-5):
    return all(abs(x - y) <= tolerance * (1 + abs(y)) for x, y in zip(a, b, strict=True))


def compare(messages, poses, covariances):
    """The files have the base in REP 105's axes: x forward, y left, z up. MAVLink's are x forward, y right, z down."""
    assert len(messages) == len(poses) == FRAMES, (len(messages), len(poses))
    sign = [1, -1, -1]
    for number, (message, pose, covariance) in enumerate(zip(messages, poses, covariances, strict=True)):
        stamp, t, q = pose[0], pose[1:4], pose[4:8]
        assert message["time_usec"] == round(stamp * 1e6)
        assert (message["frame_id"], message["child_frame_id"]) == (20, 12)
        assert message["sequence"] == number and message["reset_counter"] == 0 and message["estimator_type"] == 2
        assert near([message[axis] for axis in "xyz"], [s * v for s, v in zip(sign, t)]), number
        assert near(message["q"], [q[3]] + [s * v for s, v in zip(sign, q[:3])]), number
        signs = sign + sign
        wanted = [signs[i] * signs[j] * covariance[1 + 6 * i + j] for i in range(6) for j in range(i, 6)]
        assert near(message["pose_covariance"], wanted, 1e-6), number
        if number == 0:
            assert math.isnan(message["vx"]) and math.isnan(message["velocity_covariance"][0])
            continue
        # The velocity is the motion since the frame before, in the axes of the base now.
        before = messages[number - 1]
        seconds = (message["time_usec"] - before["time_usec"]) * 1e-6
        way = [(message[axis] - before[axis]) / seconds for axis in "xyz"]
        assert abs(math.hypot(*way) - math.hypot(message["vx"], message["vy"], message["vz"])) < 1e-3
        w, x, y, z = message["q"]
        forward = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)]
        assert abs(sum(a * b for a, b in zip(forward, way)) - message["vx"]) < 1e-3, number
        assert message["velocity_covariance"][0] > 0
        assert 1 <= message["quality"] <= 100


def refuse(plvo, options, words):
    ended = subprocess.run([plvo, "run", "--camera", "sim", *options], capture_output=True, text=True, check=False)
    assert ended.returncode == 2 and words in ended.stderr, ended.stderr


def main():
    plvo = sys.argv[1]
    assert crc_mcrf4xx(b"123456789") == 0x6F91, "the check value that is published for CRC-16/MCRF4XX"
    with tempfile.TemporaryDirectory(prefix="plvo_mavlink_") as folder:
        poses, covariances = os.path.join(folder, "poses.txt"), os.path.join(folder, "covariances.txt")
        for command in (["run"], ["live", "--pace", "fast"]):
            reader = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            reader.bind(("127.0.0.1", 0))
            subprocess.run([plvo, *command, "--camera", "sim", "--scene", "bare", "--size", "160x120", "--frames", str(FRAMES),
                            "--quiet", "--base-camera", *BASE_CAMERA.split(), "--out", poses, "--covariance", covariances,
                            "--mavlink", f"127.0.0.1:{reader.getsockname()[1]}"], check=True)
            messages = received(reader)
            reader.close()
            compare(messages, rows(poses), rows(covariances))
    refuse(plvo, ["--mavlink", "14550"], "--mavlink: is of the robot's base: add --base-camera")
    refuse(plvo, ["--mavlink", "nowhere", "--base-camera", *BASE_CAMERA.split()], "--mavlink: expected [HOST:]PORT")
    print("ODOMETRY has the poses, covariances and velocities of the base in MAVLink's axes")


main()
