# SPDX-License-Identifier: Apache-2.0
"""Writes MCAP files (from https://mcap.dev/spec), rosbag2's databases (with Python's own sqlite3) and ROS 1 bags (with ROS's own
rosbag), independent of plvo's readers. A message is (topic, type as in ROS 1, received_ns, bytes)."""
import pathlib
import sqlite3
import struct
import subprocess
import zlib

MAGIC = b"\x89MCAP0\r\n"


def pack(command, data):
    """Compresses with a program: zstd, lz4."""
    return subprocess.run(command, input=data, stdout=subprocess.PIPE, check=True).stdout


def compress(name, data):
    if name == "zstd":
        return pack(["zstd", "-q", "-c"], data)
    return pack(["lz4", "-q", "-c"], data) if name == "lz4" else data


def zstd_with_size(data):
    """One frame that states its size, as ZSTD_compress makes it."""
    return pack(["zstd", "-q", "-c", f"--stream-size={len(data)}"], data)


def text(value):
    return struct.pack("<I", len(value.encode())) + value.encode()


def record(op, data):
    return struct.pack("<BQ", op, len(data)) + data


def ros2_type(name):
    return name.replace("/", "/msg/", 1)


class Mcap:
    def __init__(self, messages, compression="", wire="cdr", chunk=4, chunked=True, summary=True):
        self.wire = wire
        self.channels = {}
        self.out = bytearray(MAGIC + record(1, text("ros2" if wire == "cdr" else "ros1") + text("test")))
        self.body, self.described, self.indexes = bytearray(), bytearray(), bytearray()
        self.first, self.last, self.offsets = None, 0, {}
        for number, message in enumerate(messages):
            self.add(number, *message)
            if chunked and number % chunk == chunk - 1:
                self.end_chunk(compression)
            elif not chunked:
                self.out += self.body
                self.body.clear()
        if chunked and self.body:
            self.end_chunk(compression)
        self.out += record(15, struct.pack("<I", 0))
        start = len(self.out) if summary else 0
        if summary:
            self.out += self.described + self.indexes
            self.out += record(11, struct.pack("<QHIIIIQQI", len(messages), len(self.channels), len(self.channels), 0, 0, 1, 0, self.last, 0))
        self.out += record(2, struct.pack("<QQI", start, 0, 0)) + MAGIC

    def add(self, number, topic, kind, received_ns, data):
        if topic not in self.channels:
            channel = len(self.channels) + 1
            self.channels[topic] = channel
            name, encoding = (ros2_type(kind), "ros2msg") if self.wire == "cdr" else (kind, "ros1msg")
            described = record(3, struct.pack("<H", channel) + text(name) + text(encoding) + text("# of no interest"))
            described += record(4, struct.pack("<HH", channel, channel) + text(topic) + text(self.wire) + struct.pack("<I", 0))
            self.body += described
            self.described += described
        channel = self.channels[topic]
        self.offsets.setdefault(channel, []).append((received_ns, len(self.body)))
        self.first = received_ns if self.first is None else min(self.first, received_ns)
        self.last = max(self.last, received_ns)
        self.body += record(5, struct.pack("<HIQQ", channel, number, received_ns, received_ns) + data)

    def end_chunk(self, compression):
        packed = compress(compression, bytes(self.body))
        at = len(self.out)
        self.out += record(6, struct.pack("<QQQI", self.first, self.last, len(self.body), zlib.crc32(self.body)) + text(compression)
                           + struct.pack("<Q", len(packed)) + packed)
        self.indexes += record(8, struct.pack("<QQQQIQ", self.first, self.last, at, len(self.out) - at, 0, 0) + text(compression)
                               + struct.pack("<QQ", len(packed), len(self.body)))
        for channel, entries in self.offsets.items():
            content = b"".join(struct.pack("<QQ", *entry) for entry in entries)
            self.out += record(7, struct.pack("<HI", channel, len(content)) + content)
        self.body.clear()
        self.offsets.clear()
        self.first, self.last = None, 0


def write_mcap(path, messages, **how):
    pathlib.Path(path).write_bytes(Mcap(messages, **how).out)


def write_db3(path, messages):
    """The tables of rosbag2_storage_sqlite3."""
    database = sqlite3.connect(path)
    database.execute("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL)")
    database.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
                     "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)")
    database.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, "
                     "data BLOB NOT NULL)")
    database.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
    topics = {}
    for topic, kind, received_ns, data in messages:
        if topic not in topics:
            topics[topic] = len(topics) + 1
            database.execute("INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')", (topics[topic], topic, ros2_type(kind)))
        database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", (topics[topic], received_ns, data))
    database.commit()
    database.close()


def write_metadata(folder, files):
    names = "".join(f"    - {name}\n" for name in files)
    pathlib.Path(folder, "metadata.yaml").write_text(f"rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n{names}")


def write_ros1(path, messages, compression="none"):
    """With ROS's own library. Returns False where it is not installed."""
    try:
        import genpy
        import rosbag
    except ImportError:
        return False

    class Message:
        _md5sum, _full_text = "*", "# of no interest"

    with rosbag.Bag(str(path), "w", compression=compression) as bag:
        for topic, kind, received_ns, data in messages:
            cls = type("Message", (Message,), {"_type": kind})
            bag.write(topic, (kind, data, "*", cls), genpy.Time(received_ns // 10**9, received_ns % 10**9), raw=True)
    return True
