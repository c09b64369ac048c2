# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A client of Foxglove's WebSocket protocol, as a viewer is, and its messages."""

from __future__ import annotations

import base64
import json
import struct
import time
from types import TracebackType
from typing import Any

import pytest

client = pytest.importorskip("websockets.sync.client")
descriptor_pb2 = pytest.importorskip("google.protobuf.descriptor_pb2")

from google.protobuf import descriptor_pool, message_factory

PROTOCOLS = ["foxglove.sdk.v1", "foxglove.websocket.v1"]
MESSAGE_DATA = 1


def decoder(schema_name: str, schema: bytes) -> Any:
    """The class of a protobuf message from the file descriptors that its publisher states."""
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(schema).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(schema_name))


def decoded(encoding: str, schema_name: str, schema: bytes, data: bytes) -> Any:
    """A message: a dict where it is JSON, else a protobuf message."""
    if encoding == "json":
        return json.loads(data)
    return decoder(schema_name, schema).FromString(data)


class FoxgloveClient:
    """Subscribes to the channels of a server and decodes what comes."""

    def __init__(self, port: int) -> None:
        self._connection = client.connect(
            f"ws://127.0.0.1:{port}", subprotocols=PROTOCOLS, open_timeout=10, close_timeout=1
        )
        self.info: dict[str, Any] = {}
        self.channels: dict[str, dict[str, Any]] = {}
        self._topics: dict[int, str] = {}
        self.gone: list[int] = []

    def __enter__(self) -> FoxgloveClient:
        self._socket = self._connection.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._connection.__exit__(kind, error, trace)

    def poll(self, timeout_s: float = 0.2) -> list[tuple[str, int, Any]]:
        """What comes until nothing does for a time: topic, time of the log [ns], message."""
        found = []
        while True:
            try:
                data = self._socket.recv(timeout=timeout_s)
            except TimeoutError:
                return found
            if isinstance(data, str):
                self._take(json.loads(data))
            elif data[0] == MESSAGE_DATA:
                subscription, stamp = struct.unpack_from("<IQ", data, 1)
                channel = self.channels[self._topics[subscription]]
                schema = channel["schema"].encode()
                if channel["encoding"] == "protobuf":
                    schema = base64.b64decode(schema)
                message = decoded(channel["encoding"], channel["schemaName"], schema, data[13:])
                found.append((channel["topic"], stamp, message))

    def _take(self, message: dict[str, Any]) -> None:
        if message["op"] == "serverInfo":
            self.info = message
        elif message["op"] == "advertise":
            self.channels.update({c["topic"]: c for c in message["channels"]})
        elif message["op"] == "unadvertise":
            self.gone += message["channelIds"]

    def wait_for(self, topic: str, timeout_s: float = 10.0) -> None:
        """Waits until a topic is advertised."""
        end = time.monotonic() + timeout_s
        while topic not in self.channels:
            self.poll(0.05)
            assert time.monotonic() < end, f"{topic} is not among {sorted(self.channels)}"

    def subscribe(self, *topics: str) -> None:
        """Subscribes to topics that are there."""
        rows = []
        for topic in topics:
            channel = self.channels[topic]["id"]
            self._topics[channel] = topic
            rows.append({"id": channel, "channelId": channel})
        self._socket.send(json.dumps({"op": "subscribe", "subscriptions": rows}))
