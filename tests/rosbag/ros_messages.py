# SPDX-License-Identifier: Apache-2.0
"""Serialises messages of ROS 1 and of ROS 2 (CDR in both byte orders), written from the public descriptions of the two formats and
independent of plvo's readers."""
import struct


class Encoder:
    """wire: 'ros1', 'cdr_le' or 'cdr_be'."""

    def __init__(self, wire):
        self.cdr = wire != "ros1"
        self.order = ">" if wire == "cdr_be" else "<"
        self.body = bytearray()
        self.start = {"ros1": b"", "cdr_le": b"\0\1\0\0", "cdr_be": b"\0\0\0\0"}[wire]

    def number(self, code, *values):
        for value in values:
            size = struct.calcsize("=" + code)
            if self.cdr:
                self.body += b"\0" * (-len(self.body) % size)
            self.body += struct.pack(self.order + code, value)
        return self

    def text(self, value):
        raw = value.encode() + (b"\0" if self.cdr else b"")
        self.number("I", len(raw))
        self.body += raw
        return self

    def blob(self, value):
        self.number("I", len(value))
        self.body += value
        return self

    def header(self, stamp_ns, frame):
        if not self.cdr:
            self.number("I", 7)
        self.number("i" if self.cdr else "I", stamp_ns // 10**9).number("I", stamp_ns % 10**9)
        return self.text(frame)

    def bytes(self):
        return bytes(self.start) + bytes(self.body)


def image(wire, stamp_ns, width, height, encoding, step, data, frame="camera", big_endian=0):
    e = Encoder(wire).header(stamp_ns, frame).number("I", height, width).text(encoding)
    return e.number("B", big_endian).number("I", step).blob(data).bytes()


def compressed_image(wire, stamp_ns, form, data, frame="camera"):
    return Encoder(wire).header(stamp_ns, frame).text(form).blob(data).bytes()


def compressed_depth(wire, stamp_ns, form, png, a=0.0, b=0.0, frame="camera"):
    return compressed_image(wire, stamp_ns, form, struct.pack("<iff", 0, a, b) + png, frame)


def camera_info(wire, stamp_ns, width, height, fx, fy, cx, cy, lens=(0, 0, 0, 0, 0), model="plumb_bob", frame="camera"):
    e = Encoder(wire).header(stamp_ns, frame).number("I", height, width).text(model).number("I", len(lens)).number("d", *lens)
    e.number("d", fx, 0, cx, 0, fy, cy, 0, 0, 1).number("d", 1, 0, 0, 0, 1, 0, 0, 0, 1)
    e.number("d", fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0)
    return e.number("I", 0, 0).number("I", 0, 0, 0, 0).number("B", 0).bytes()


def imu(wire, stamp_ns, rate, force):
    e = Encoder(wire).header(stamp_ns, "imu").number("d", 0, 0, 0, 1).number("d", -1, *[0] * 8)
    return e.number("d", *rate).number("d", 0.01, *[0] * 8).number("d", *force).number("d", 0.01, *[0] * 8).bytes()


def pose(wire, kind, stamp_ns, numbers, twist=(0,) * 6, variances=(0,) * 6):
    """kind: 'nav_msgs/Odometry' or 'geometry_msgs/PoseStamped'; numbers: tx ty tz qx qy qz qw."""
    e = Encoder(wire).header(stamp_ns, "world")
    if kind == "nav_msgs/Odometry":
        return e.text("base_link").number("d", *numbers).number("d", *[0] * 36).number("d", *twist).number(
            "d", *(variances[i] if i == j else 0.1 for i in range(6) for j in range(6))).bytes()
    return e.number("d", *numbers).bytes()


def transform(wire, numbers):
    return Encoder(wire).number("d", *numbers).bytes()


def transforms(wire, entries):
    """entries: parent, child, numbers."""
    e = Encoder(wire).number("I", len(entries))
    for parent, child, numbers in entries:
        e.header(0, parent).text(child).number("d", *numbers)
    return e.bytes()


def float32(wire, value):
    return Encoder(wire).number("f", value).bytes()
