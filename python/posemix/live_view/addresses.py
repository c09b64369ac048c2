# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Network addresses of views; what is wrong with one is said before it is used."""

from __future__ import annotations

import socket
import time
from urllib.parse import urlsplit

__all__ = ["require_free", "require_listening", "split_address", "wait_until_free"]


def split_address(address: str) -> tuple[str, int]:
    """Host, which may be empty, and port of HOST:PORT, as of [::1]:8765; raises ValueError for another text."""
    host, colon, port = address.rpartition(":")
    number = int(port) if port.isascii() and port.isdigit() else 0
    if not colon or not 0 < number < 65536 or "/" in host or (":" in host and host[:1] + host[-1:] != "[]"):
        raise ValueError(f"address is '{address}'; expected HOST:PORT or :PORT")
    return host.strip("[]"), number


def require_free(host: str, port: int) -> None:
    """Raises OSError where another program listens at the address, or the host is not of this machine."""
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        with socket.socket(family, socket.SOCK_STREAM) as probe:
            # As servers do, so that one that has just ended is no obstacle.
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind((host, port))
    except OSError as error:
        raise OSError(error.errno, f"{host}:{port}: cannot be listened at: {error.strerror}") from error


def wait_until_free(host: str, port: int, timeout_s: float = 2.0) -> None:
    """Waits until a server that was stopped has let go of its address, but no longer than that [s]."""
    end = time.monotonic() + timeout_s
    while time.monotonic() < end:
        try:
            require_free(host, port)
            return
        except OSError:
            time.sleep(0.01)


def require_listening(url: str, who: str, timeout_s: float = 2.0) -> None:
    """Raises OSError where nothing listens at the host and port of a URL, ValueError where it has none."""
    parts = urlsplit(url)
    try:
        host, port = parts.hostname, parts.port
    except ValueError:
        host = port = None
    if not host or not port:
        raise ValueError(f"address is '{url}'; expected SCHEME://HOST:PORT/...")
    try:
        socket.create_connection((host, port), timeout=timeout_s).close()
    except OSError as error:
        raise OSError(error.errno, f"{url}: {who} does not listen there: {error.strerror or error}") from error
