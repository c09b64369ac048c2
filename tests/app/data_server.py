#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A server of the files in a folder, with the faults that a download meets.

Writes its port to the standard output and every request to the file `requests` beside the folder. The first part of
a path says how it answers:
  plain      with ranges
  norange    always the whole file
  truncated  the first half of the file, though it promises all of it; a range as it should be
  broken     the first 1000 bytes of what was asked for, always
  tampered   the file with its first byte changed
  moved      a redirect to plain
  away       a redirect to an address of another machine
  slow       100 bytes every 10 ms
  flaky      503 to the first request of a file
"""

import sys
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import unquote

FOLDER = Path(sys.argv[1])
seen = set()


class Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, format, *args):  # noqa: A002
        pass

    def note(self):
        with open(FOLDER.parent / "requests", "a", encoding="utf-8") as file:
            file.write(f"{self.path} {self.headers.get('Range', '-')}\n")

    def refuse(self, code):
        self.send_response(code)
        self.send_header("Content-Length", "4")
        self.end_headers()
        self.wfile.write(b"html")

    def redirect(self, address):
        self.send_response(302)
        self.send_header("Location", address)
        self.send_header("Content-Length", "0")
        self.end_headers()

    def do_GET(self):
        self.note()
        kind, _, name = self.path.lstrip("/").partition("/")
        port = self.server.server_address[1]
        if kind == "moved":
            return self.redirect(f"http://127.0.0.1:{port}/plain/{name}")
        if kind == "away":
            return self.redirect("http://files.invalid/" + name)
        if kind == "flaky" and self.path not in seen:
            seen.add(self.path)
            return self.refuse(503)
        file = FOLDER / unquote(name)
        if not file.is_file():
            return self.refuse(404)
        self.answer(kind, file.read_bytes())

    def answer(self, kind, content):
        begin = 0
        wanted = self.headers.get("Range")
        if wanted and kind != "norange":
            begin = int(wanted.removeprefix("bytes=").partition("-")[0])
            if begin >= len(content):
                return self.refuse(416)
            self.send_response(206)
            self.send_header("Content-Range", f"bytes {begin}-{len(content) - 1}/{len(content)}")
        else:
            self.send_response(200)
        if kind == "tampered":
            content = bytes([content[0] ^ 1]) + content[1:]
        content = content[begin:]
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.send_body(kind, content, wanted)

    def send_body(self, kind, content, wanted):
        if kind == "truncated" and not wanted:
            content = content[: len(content) // 2]
            self.close_connection = True
        if kind == "broken":
            content = content[:1000]
            self.close_connection = True
        if kind != "slow":
            self.wfile.write(content)
            return
        for at in range(0, len(content), 100):
            self.wfile.write(content[at : at + 100])
            time.sleep(0.01)


server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
server.daemon_threads = True
print(server.server_address[1], flush=True)
server.serve_forever()
