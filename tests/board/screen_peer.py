#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Beside the emulator: pictures of its display and keys for its keyboard, on request of a test in it.
usage: screen_peer.py QMP_SOCKET FOLDER      FOLDER/request: "picture" (FOLDER/picture.png) or "key NAME"
"""
import json
import os
import socket
import sys
import time


class Monitor:
    """The emulator's QMP monitor."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        while True:
            try:
                self.socket.connect(path)
                break
            except OSError:
                time.sleep(0.1)
        self.lines = self.socket.makefile("rw")
        self.lines.readline()  # the greeting
        self.ask("qmp_capabilities")

    def ask(self, command, **arguments):
        self.lines.write(json.dumps({"execute": command, "arguments": arguments}) + "\n")
        self.lines.flush()
        while True:  # events come in between
            answer = json.loads(self.lines.readline())
            if "error" in answer:
                raise RuntimeError(answer["error"]["desc"])
            if "return" in answer:
                return


def main():
    monitor, folder = Monitor(sys.argv[1]), sys.argv[2]
    request = os.path.join(folder, "request")
    while True:
        if not os.path.exists(request):
            time.sleep(0.05)
            continue
        with open(request, encoding="utf-8") as file:
            words = file.read().split()
        if words[0] == "picture":
            monitor.ask("screendump", filename=os.path.join(folder, "picture.png"), format="png")
        else:
            monitor.ask("send-key", keys=[{"type": "qcode", "data": words[1]}])
        os.remove(request)


main()
