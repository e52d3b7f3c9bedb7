#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails the n-th system call of `mixrig record` on the files of its take, for each kind of call and each n.

usage: fail_call_test.py --mixrig PROGRAM [--every K] [--shim LIBRARY]
strace injects the error. With the library fail_new, operator new then fails, from the first allocation of the
command itself on: 40 K allocations apart, since GLib ends a program whose malloc fails. Each time: the program ends by itself, an error is one line, a take under the
final name is whole, and one under the partial name opens or has no whole frame.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import kill_record_test

CALLS = {"openat": "EMFILE", "write": "ENOSPC", "writev": "ENOSPC", "fdatasync": "EIO", "fsync": "EIO", "rename": "EIO",
         "mkdir": "ENOSPC", "fallocate": "ENOSPC", "lseek": "EIO", "newfstatat": "EIO"}
FILES = ("color.mkv", "depth.mkv", "amplitude.mkv", "ticks.csv", "pan_tilt.csv", "take.toml", "take.toml.partial", "reserve")
SKIPPED = 77


def info(mixrig, folder):
    done = subprocess.run([mixrig, "info", folder], capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def record(mixrig, folder, before, environment=None):
    """Records, with words before the command; returns what is wrong (or an empty text)."""
    out, partial = folder / "shot", folder / "shot.partial"
    for left in (out, partial):
        shutil.rmtree(left, ignore_errors=True)
    done = subprocess.run([*before, mixrig, "record", "--rig", folder / "rig.toml", out, "--duration", "0.2",
                           "--keep-free", "0"], capture_output=True, text=True, timeout=60, env=environment)
    errors = [line for line in done.stderr.splitlines() if line.startswith("mixrig: ")]
    if done.returncode not in (0, 1, 2):
        return f"status {done.returncode}: {done.stderr}"
    if (done.returncode == 0) != (not errors) or len(errors) > 1:
        return f"status {done.returncode} with {len(errors)} errors: {done.stderr}"
    if out.exists():
        status, said = info(mixrig, out)
        if status != 0 or "cut off" in said:
            return f"the take is not whole: {said}"
    elif done.returncode == 0:
        return "status 0 without a take"
    if (partial / "take.toml").exists():
        status, said = info(mixrig, partial)
        if status != 0 and "before its first frame was whole" not in said:
            return f"what is left does not open: {said}"
    return ""


def fail_call(mixrig, folder, call, number):
    """Returns whether a call failed, and what record() returns."""
    out, partial, log = folder / "shot", folder / "shot.partial", folder / "strace.log"
    paths = [word for path in (out, partial, *(partial / name for name in FILES)) for word in ("-P", path)]
    wrong = record(mixrig, folder, ["strace", "-f", "-qq", "-o", log, "-e", f"trace={call}", *paths, "-e",
                                    f"inject={call}:error={CALLS[call]}:when={number}"])
    return "INJECTED" in log.read_text(), wrong


def fail_allocations(mixrig, folder, shim, every):
    """Returns the number of faults."""
    count = folder / "count"
    environment = dict(os.environ, LD_PRELOAD=str(shim), MIXRIG_COUNT_NEW=str(count))
    if subprocess.run([mixrig, "--help"], capture_output=True, env=environment).returncode != 0:
        print("allocations: skipped, the library cannot be loaded first: a build with sanitizers?")
        return 0
    number, tried, faults = int(count.read_text()), 0, 0
    while True:
        count.unlink(missing_ok=True)
        wrong = record(mixrig, folder, [], dict(environment, MIXRIG_FAIL_NEW=str(number)))
        if wrong:
            faults += 1
            print(f"FAILED: allocation {number}: {wrong}")
        if count.exists() and int(count.read_text()) < number:
            break
        tried, number = tried + 1, number + 40 * every
    print(f"operator new: {tried} of the first {number} allocations failed, one after the other", flush=True)
    return faults


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--mixrig", required=True)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--shim", type=pathlib.Path)
    arguments = parser.parse_args()
    if shutil.which("strace") is None or subprocess.run(["strace", "-qq", "-o", "/dev/null", "true"]).returncode != 0:
        print("skipped: strace is not installed, or may not trace here")
        return SKIPPED
    faults = 0
    with tempfile.TemporaryDirectory(prefix="mixrig-fail-") as name:
        folder = pathlib.Path(name)
        kill_record_test.make_source(arguments.mixrig, folder)
        for call in CALLS:
            number, tried = 1, 0
            while True:
                failed, wrong = fail_call(arguments.mixrig, folder, call, number)
                if not failed:
                    break
                tried += 1
                if wrong:
                    faults += 1
                    print(f"FAILED: {call} number {number}: {wrong}")
                number += arguments.every
            print(f"{call}: {tried} of its calls failed, one after the other", flush=True)
            if tried == 0:
                print(f"FAILED: no {call} was made")
                faults += 1
        if arguments.shim:
            faults += fail_allocations(arguments.mixrig, folder, arguments.shim, arguments.every)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
