# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The messages of every image from their bytes and to them (CDR), many times as fast as by message objects.

Read messages have the attributes of ROS's that are used here, and no others. Numbers are aligned to their size,
relative to what follows the four bytes that state the representation; strings end with a zero, which counts.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from posemix._arrays import FloatArray

__all__ = [
    "LAYOUTS", "DetectionArray", "PosedFrame", "Reader", "Writer", "read_detections_2d", "read_detections_3d",
    "read_odometry", "read_transforms",
]  # fmt: skip

# Little-endian, without any options: what is written.
_HEAD = b"\x00\x01\x00\x00"
_PADDING = [bytes(n) for n in range(8)]
_BOX_NUMBERS = {2: 5, 3: 10}
_NANOSECONDS = 1_000_000_000
# The first and last time of a message [ns]; what is beyond, as of a wrong clock, is at these.
_FIRST_NS, _LAST_NS = -(2**31) * _NANOSECONDS, 2**31 * _NANOSECONDS - 1

_POSE = {"position": "geometry_msgs/Point", "orientation": "geometry_msgs/Quaternion"}
_SHAPED = {"pose": "geometry_msgs/Pose", "covariance": "double[36]"}
_HEADER = "std_msgs/Header"
# Fields of the messages as they are read and written here, which those of the workspace must have.
LAYOUTS: dict[str, dict[str, str]] = {
    "vision_msgs/msg/Detection3DArray": {"header": _HEADER, "detections": "sequence<vision_msgs/Detection3D>"},
    "vision_msgs/msg/Detection2DArray": {"header": _HEADER, "detections": "sequence<vision_msgs/Detection2D>"},
    "vision_msgs/msg/Detection3D": {
        "header": _HEADER, "results": "sequence<vision_msgs/ObjectHypothesisWithPose>",
        "bbox": "vision_msgs/BoundingBox3D", "id": "string",
    },
    "vision_msgs/msg/Detection2D": {
        "header": _HEADER, "results": "sequence<vision_msgs/ObjectHypothesisWithPose>",
        "bbox": "vision_msgs/BoundingBox2D", "id": "string",
    },
    "vision_msgs/msg/ObjectHypothesisWithPose": {
        "hypothesis": "vision_msgs/ObjectHypothesis", "pose": "geometry_msgs/PoseWithCovariance",
    },
    "vision_msgs/msg/ObjectHypothesis": {"class_id": "string", "score": "double"},
    "vision_msgs/msg/BoundingBox3D": {"center": "geometry_msgs/Pose", "size": "geometry_msgs/Vector3"},
    "vision_msgs/msg/BoundingBox2D": {"center": "vision_msgs/Pose2D", "size_x": "double", "size_y": "double"},
    "vision_msgs/msg/Pose2D": {"position": "vision_msgs/Point2D", "theta": "double"},
}  # fmt: skip


class Vector(NamedTuple):
    """A point, vector or quaternion."""

    x: float
    y: float
    z: float
    w: float = 0.0


class Pose(NamedTuple):
    """A pose."""

    position: Vector
    orientation: Vector


class PoseWithCovariance(NamedTuple):
    """A pose with the 36 numbers of its covariance."""

    pose: Pose
    covariance: FloatArray


class Hypothesis(NamedTuple):
    """A class and its score."""

    class_id: str
    score: float


class Result(NamedTuple):
    """One of the results of a detection."""

    hypothesis: Hypothesis
    pose: PoseWithCovariance


class Stamp(NamedTuple):
    """A time."""

    sec: int
    nanosec: int

    @property
    def nanoseconds(self) -> int:
        """The time [ns]."""
        return self.sec * _NANOSECONDS + self.nanosec


class Header(NamedTuple):
    """A time and a frame."""

    stamp: Stamp
    frame_id: str


class Box(NamedTuple):
    """The box of a detection in space; of one in the image there is none."""

    center: Pose | None


class Detection(NamedTuple):
    """A detection."""

    header: Header
    results: list[Result]
    bbox: Box
    id: str


class DetectionArray(NamedTuple):
    """Detections."""

    header: Header
    detections: list[Detection]


class PosedFrame(NamedTuple):
    """A pose tx, ty, tz, qx, qy, qz, qw of a child in the frame of the header."""

    header: Header
    child_frame_id: str
    row: tuple[float, ...]


def _pose(numbers: Sequence[float]) -> Pose:
    return Pose(Vector(*numbers[:3]), Vector(*numbers[3:7]))


class Reader:
    """Reads values one after the other.

    Parameters
    ----------
    data : bytes
        A message.

    Raises
    ------
    ValueError
        For another representation than plain CDR. All methods raise it where the message ends too early.
    """

    __slots__ = ("_at", "_data", "_order")

    def __init__(self, data: bytes) -> None:
        if len(data) < 4 or data[0] != 0 or data[1] > 1:
            raise ValueError(f"got a message that begins with {data[:4].hex(' ')}, expected plain CDR, 00 01 or 00 00")
        self._data, self._at, self._order = data, 4, "<" if data[1] else ">"

    def _take(self, layout: str, count: int, size: int) -> tuple[Any, ...]:
        at = self._at + (4 - self._at) % size
        self._at = at + count * size
        try:
            return struct.unpack_from(f"{self._order}{count}{layout}", self._data, at)
        except struct.error:
            raise self._early() from None

    def _early(self) -> ValueError:
        return ValueError(f"got a message that ends after {len(self._data)} bytes, expected {self._at} or more")

    def doubles(self, count: int) -> tuple[float, ...]:
        """So many numbers."""
        return self._take("d", count, 8)

    def array(self, count: int) -> FloatArray:
        """So many numbers, which cannot be changed."""
        at = self._at + (4 - self._at) % 8
        self._at = at + 8 * count
        if self._at > len(self._data):
            raise self._early()
        return np.frombuffer(self._data, f"{self._order}f8", count, at)

    def count(self) -> Iterator[int]:
        """A number of elements, to go through."""
        return iter(range(self._take("I", 1, 4)[0]))

    def string(self) -> str:
        """A string; what is no UTF-8 in it is replaced."""
        (size,) = self._take("I", 1, 4)
        begin, self._at = self._at, self._at + size
        if self._at > len(self._data):
            raise self._early()
        return self._data[begin : max(self._at - 1, begin)].decode("utf-8", "replace")

    def header(self) -> Header:
        """A std_msgs/Header."""
        sec, nanosec = self._take("I", 2, 4)
        if nanosec >= _NANOSECONDS:
            raise ValueError(f"a stamp has {nanosec} nanoseconds, expected less than {_NANOSECONDS}")
        # The seconds have a sign.
        return Header(Stamp(sec - (sec >> 31 << 32), nanosec), self.string())

    def pose(self) -> Pose:
        """A geometry_msgs/Pose or Transform."""
        return _pose(self.doubles(7))


def read_detections_3d(data: bytes) -> DetectionArray:
    """A vision_msgs/Detection3DArray."""
    return _detections(Reader(data), 3)


def read_detections_2d(data: bytes) -> DetectionArray:
    """A vision_msgs/Detection2DArray, without the boxes."""
    return _detections(Reader(data), 2)


def _detections(reader: Reader, dimension: int) -> DetectionArray:
    header = reader.header()
    return DetectionArray(header, [_detection(reader, dimension) for _ in reader.count()])


def _detection(reader: Reader, dimension: int) -> Detection:
    header = reader.header()
    results = [_result(reader) for _ in reader.count()]
    box = reader.doubles(_BOX_NUMBERS[dimension])
    return Detection(header, results, Box(_pose(box) if dimension == 3 else None), reader.string())


def _result(reader: Reader) -> Result:
    name = reader.string()
    score, *row = reader.doubles(8)
    return Result(Hypothesis(name, score), PoseWithCovariance(_pose(row), reader.array(36)))


def read_transforms(data: bytes) -> list[PosedFrame]:
    """The transforms of a tf2_msgs/TFMessage."""
    reader = Reader(data)
    return [PosedFrame(reader.header(), reader.string(), reader.doubles(7)) for _ in reader.count()]


def read_odometry(data: bytes) -> PosedFrame:
    """The pose in a nav_msgs/Odometry, without its covariance and the twist."""
    reader = Reader(data)
    return PosedFrame(reader.header(), reader.string(), reader.doubles(7))


@lru_cache(maxsize=1024)
def _text(text: str) -> bytes:
    data = text.encode()
    return struct.pack("<I", len(data) + 1) + data + b"\0"


class Writer:
    """Writes values one after the other."""

    __slots__ = ("_out",)

    def __init__(self) -> None:
        self._out = bytearray(_HEAD)

    def doubles(self, data: bytes) -> None:
        """Numbers, as the bytes of an array of <f8."""
        out = self._out
        out += _PADDING[(4 - len(out)) & 7]
        out += data

    def count(self, number: int) -> None:
        """A number of elements that follow."""
        out = self._out
        out += _PADDING[-len(out) & 3]
        out += struct.pack("<I", number)

    def string(self, text: str) -> None:
        """A string."""
        out = self._out
        out += _PADDING[-len(out) & 3]
        out += _text(text)

    def header(self, stamp_ns: int, frame: str) -> None:
        """A std_msgs/Header."""
        out = self._out
        out += _PADDING[-len(out) & 3]
        out += struct.pack("<iI", *divmod(min(max(stamp_ns, _FIRST_NS), _LAST_NS), _NANOSECONDS))
        out += _text(frame)

    def data(self) -> bytes:
        """The message."""
        return bytes(self._out)
