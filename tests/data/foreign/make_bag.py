#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
# Writes tiny.bag beside this file: a ROS 1 bag of format 2.0 by wiki.ros.org/Bags/Format/2.0 and
# the definitions of sensor_msgs, as `rosbag record` lays it out. Nothing here comes from host/.
import struct
import zlib
from pathlib import Path

text = lambda s: struct.pack("<I", len(s)) + s.encode()
head = lambda t, frame: struct.pack("<III", 7, int(t), round(t % 1 * 1e9)) + text(frame)
field = lambda name, value: struct.pack("<I", len(name) + 1 + len(value)) + name.encode() + b"=" + value


def record(fields, data):
    packed = b"".join(field(name, value) for name, value in fields)
    return struct.pack("<I", len(packed)) + packed + struct.pack("<I", len(data)) + data


def png(width, height, rows):
    part = lambda kind, data: (struct.pack(">I", len(data)) + kind + data
                               + struct.pack(">I", zlib.crc32(kind + data)))
    return (b"\x89PNG\r\n\x1a\n" + part(b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0))
            + part(b"IDAT", zlib.compress(rows)) + part(b"IEND", b""))


def camera(t, frame, width, height, lens, d, k):
    return (head(t, frame) + struct.pack("<II", height, width) + text(lens)
            + struct.pack(f"<I{len(d)}d", len(d), *d) + struct.pack("<9d", *k) + bytes(8 * 21 + 25))


def tf(parent, child, x, y, z):
    return head(0, parent) + text(child) + struct.pack("<7d", x, y, z, 0, 0, 0, 1)


def messages():
    """Topic, type, seconds, bytes."""
    yield "/tf_static", "tf2_msgs/TFMessage", 5.0, struct.pack("<I", 2) + tf(
        "body", "color_optical", 0.10, 0, 0) + tf("body", "depth_optical", 0.07, 0, 0.01)
    for i in range(3):
        t = 100 + i / 30
        yield ("/cam/color/camera_info", "sensor_msgs/CameraInfo", t,
               camera(t, "color_optical", 32, 24, "plumb_bob", [0.1, -0.05, 0.001, 0.002, 0.01],
                      [30.5, 0, 15.25, 0, 31.5, 11.75, 0, 0, 1]))
        yield ("/cam/depth/camera_info", "sensor_msgs/CameraInfo", t,
               camera(t, "depth_optical", 16, 12, "plumb_bob", [0] * 5,
                      [16, 0, 7.5, 0, 16, 5.5, 0, 0, 1]))
        row = bytes([200, 100, 10 + i]) * 32
        yield ("/cam/color/image_raw", "sensor_msgs/Image", t + 0.5,
               head(t, "color_optical") + struct.pack("<II", 24, 32) + text("bgr8")
               + struct.pack("<BII", 0, 96, 96 * 24) + row * 24)
        if i == 2:
            continue  # a colour picture without depth
        rows = (b"\0" + struct.pack(">16H", *[1500 + i] * 16)) * 12
        data = bytes(12) + png(16, 12, rows)
        yield ("/cam/depth/image_raw/compressedDepth", "sensor_msgs/CompressedImage", t + 0.5,
               head(t + 0.004, "depth_optical") + text("16UC1; compressedDepth")
               + struct.pack("<I", len(data)) + data)
        yield ("/cam/infra/image_raw", "sensor_msgs/Image", t + 0.5,
               head(t, "depth_optical") + struct.pack("<II", 1, 2) + text("mono8")
               + struct.pack("<BII", 0, 2, 2) + b"ab")


topics, chunk = {}, b""
for topic, kind, t, data in messages():
    if topic not in topics:
        topics[topic] = len(topics)
        about = field("topic", topic.encode()) + field("type", kind.encode()) + field("md5sum", b"0" * 32)
        chunk += record([("op", b"\x07"), ("conn", struct.pack("<I", topics[topic])),
                         ("topic", topic.encode())], about)
    chunk += record([("op", b"\x02"), ("conn", struct.pack("<I", topics[topic])),
                     ("time", struct.pack("<II", int(t), round(t % 1 * 1e9)))], data)
bag = b"#ROSBAG V2.0\n" + record([("op", b"\x03"), ("index_pos", bytes(8)), ("conn_count", bytes(4)),
                                  ("chunk_count", struct.pack("<I", 1))], b" " * 16)
bag += record([("op", b"\x05"), ("compression", b"none"), ("size", struct.pack("<I", len(chunk)))], chunk)
(Path(__file__).parent / "tiny.bag").write_bytes(bag)
