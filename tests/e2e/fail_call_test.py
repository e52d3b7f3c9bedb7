#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails the n-th system call of `mixrig record` or `mixrig run --out` on each of its files, for each kind of call and each n.

usage: fail_call_test.py --mixrig PROGRAM [--job record|run] [--every K] [--shim LIBRARY]
strace injects the error, two at once. With the library fail_new, operator new and malloc then fail, from the first
allocation of the command itself on: 130 allocations apart, or 300 K; those of GLib do not, since it ends the program. Each time: the program ends
by itself, an error is one line, a take under the final name is whole, and one under the partial name opens or has no
whole frame.
"""
import argparse
import collections
import concurrent.futures
import os
import pathlib
import queue
import re
import shutil
import signal
import subprocess
import sys
import tempfile

import kill_record_test

CALLS = {"openat": "EMFILE", "write": "ENOSPC", "writev": "ENOSPC", "fdatasync": "EIO", "fsync": "EIO", "rename": "EIO",
         "mkdir": "ENOSPC", "fallocate": "ENOSPC", "lseek": "EIO", "newfstatat": "EIO"}
TAKE = ("color.mkv", "depth.mkv", "amplitude.mkv", "ticks.csv", "pan_tilt.csv", "take.toml", "take.toml.partial", "reserve")
# By job: the folder of the take in the output, files, and arguments beside the output.
JOBS = {"record": ("", TAKE, lambda source: ["record", "--rig", source / "rig.toml", "--duration", "0.2", "--keep-free", "0"]),
        "run": ("composite", ("frames.csv", "report.json.partial", "contact_sheet.png.partial", "composite.partial",
                              *(f"composite.partial/{name}" for name in (*TAKE, "poses.txt"))),
                lambda source: ["run", source / "take/scene.toml", "--source", f"take:{source / 'take'}", "--backend", "cpu",
                                "--frames", "1-3", "--format", "video", "--out"])}
job = "record"
SKIPPED, AT_ONCE, ATTEMPTS = 77, 2, 3


def info(mixrig, folder):
    done = subprocess.run([mixrig, "info", folder], capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def run_job(mixrig, folder, before, environment=None):
    """Runs the job into a folder beside its source, with words before the command; returns what is wrong (or "")."""
    out, partial = folder / "shot", folder / "shot.partial"
    inner, _, words = JOBS[job]
    for left in (out, partial):
        shutil.rmtree(left, ignore_errors=True)
    done = subprocess.run([*before, mixrig, *words(folder.parent), out], capture_output=True, text=True, timeout=60,
                          env=environment)
    errors = [line for line in done.stderr.splitlines() if line.startswith("mixrig: ")]
    # A JSON value of nlohmann's allocates where it is destroyed: without memory for that, the report ends the program.
    # The take, which run writes into a folder of its own, is whole by then.
    whole = out.exists() or (inner and (partial / inner).exists())
    reporting = done.returncode == -signal.SIGABRT and "std::bad_alloc" in done.stderr and whole
    if done.returncode not in (0, 1, 2) and not reporting:
        return f"status {done.returncode}: {done.stderr}"
    if not reporting and ((done.returncode == 0) != (not errors) or len(errors) > 1):
        return f"status {done.returncode} with {len(errors)} errors: {done.stderr}"
    if out.exists():
        status, said = info(mixrig, out / inner)
        if status != 0 or "cut off" in said:
            return f"the take is not whole: {said}"
    elif done.returncode == 0:
        return "status 0 without a take"
    for left in (partial / inner, partial / f"{inner}.partial"):
        if not (left / "take.toml").exists():
            continue
        status, said = info(mixrig, left)
        if status != 0 and "before its first frame was whole" not in said:
            return f"what is left does not open: {said}"
    return ""


def paths(folder):
    return [folder / "shot", folder / "shot.partial", *(folder / "shot.partial" / name for name in JOBS[job][1])]


def traced(mixrig, folder, calls, files, more=()):
    """Returns what strace wrote of these calls on these files, and what run_job() returns."""
    log = folder / "strace.log"
    chosen = [word for file in files for word in ("-P", file)]
    wrong = run_job(mixrig, folder, ["strace", "-f", "--seccomp-bpf", "-qq", "-y", "-o", log, "-e",
                                    f"trace={','.join(calls)}", *chosen, *more])
    return log.read_text(), wrong


def calls_made(mixrig, folder):
    """The calls of a job without a fault: kind, index of the file in paths(), and which one of its thread, since
    strace counts by thread."""
    log, wrong = traced(mixrig, folder, CALLS, paths(folder))
    if wrong:
        sys.exit(f"FAILED: without a fault: {wrong}")
    counts, made = collections.Counter(), set()
    files = {str(file): i for i, file in enumerate(paths(folder))}
    # strace looks at the first name; -y also tells the present folder.
    for thread, call, file in re.findall(r'^(\d+) +(\w+)\((?:AT_FDCWD<.*?>, )?[^"<]*["<]([^">]*)[">]', log, re.M):
        if call in CALLS and file in files:
            counts[thread, call, file] += 1
            made.add((call, files[file], counts[thread, call, file]))
    return sorted(made)


def fail_call(mixrig, folder, call, file, number):
    """Returns whether a call failed, and what run_job() returns. Threads share their work in another way each time: a
    call that was not made is tried again."""
    log = wrong = ""
    for _ in range(ATTEMPTS):
        log, wrong = traced(mixrig, folder, [call], [paths(folder)[file]],
                            ["-e", f"inject={call}:error={CALLS[call]}:when={number}"])
        if "INJECTED" in log or wrong:
            break
    return "INJECTED" in log, wrong


def fail_calls(mixrig, folder, every, begin):
    """Returns the number of faults."""
    made = calls_made(mixrig, folder)
    faults, failed = 0, collections.Counter()
    chosen = [one for call in CALLS for one in [one for one in made if one[0] == call][::every]]
    for one, (injected, wrong) in zip(chosen, begin(lambda place, one: fail_call(mixrig, place, *one), chosen)):
        failed[one[0]] += injected
        if wrong:
            faults += 1
            print(f"FAILED: {one[0]} number {one[2]} on {paths(folder)[one[1]].name}: {wrong}")
    for call in CALLS:
        count = sum(one[0] == call for one in made)
        print(f"{call}: {failed[call]} of its {count} calls failed, one after the other", flush=True)
        if every == 1 and failed[call] == 0 and (count or job == "record"):
            faults += 1
            print(f"FAILED: no {call} was made to fail")
    if 2 * sum(failed.values()) < len(chosen):  # few calls of a kind are tried: by chance none of them is made again
        faults += 1
        print(f"FAILED: {sum(failed.values())} of {len(chosen)} calls were made to fail")
    return faults


def fail_allocation(mixrig, folder, shim, number):
    """Returns whether an allocation failed, and what run_job() returns."""
    count = folder / "count"
    count.unlink(missing_ok=True)
    environment = dict(os.environ, LD_PRELOAD=str(shim), MIXRIG_COUNT_NEW=str(count), MIXRIG_FAIL_NEW=str(number))
    wrong = run_job(mixrig, folder, [], environment)
    return not count.exists() or int(count.read_text()) >= number, wrong


def fail_allocations(mixrig, folder, shim, every, begin):
    """Returns the number of faults."""
    count = folder / "count"
    environment = dict(os.environ, LD_PRELOAD=str(shim), MIXRIG_COUNT_NEW=str(count))
    if subprocess.run([mixrig, "--help"], capture_output=True, env=environment).returncode != 0:
        print("allocations: skipped, the library cannot be loaded first: a build with sanitizers?")
        return 0
    step = 130 if every == 1 else 300 * every
    number, tried, faults, failed = int(count.read_text()), 0, 0, True
    while failed:
        numbers = [number + step * i for i in range(AT_ONCE)]
        for one, (failed, wrong) in zip(numbers, begin(lambda place, n: fail_allocation(mixrig, place, shim, n), numbers)):
            tried += failed
            if wrong:
                faults += 1
                print(f"FAILED: allocation {one}: {wrong}")
        number = numbers[-1] + step
    print(f"allocations: {tried} of the first {number} allocations failed, one after the other", flush=True)
    return faults


def main():
    global job
    parser = argparse.ArgumentParser()
    parser.add_argument("--mixrig", required=True)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--shim", type=pathlib.Path)
    parser.add_argument("--job", choices=JOBS, default=job)
    arguments = parser.parse_args()
    job = arguments.job
    if shutil.which("strace") is None or subprocess.run(["strace", "-qq", "-o", "/dev/null", "true"]).returncode != 0:
        print("skipped: strace is not installed, or may not trace here")
        return SKIPPED
    faults = 0
    with tempfile.TemporaryDirectory(prefix="mixrig-fail-") as name:
        folder = pathlib.Path(name)
        kill_record_test.make_source(arguments.mixrig, folder)
        places = queue.SimpleQueue()
        for i in range(AT_ONCE):
            (folder / str(i)).mkdir()
            places.put(folder / str(i))
        with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
            def begin(work, numbers):
                def one(number):
                    place = places.get()
                    try:
                        return work(place, number)
                    finally:
                        places.put(place)
                return list(pool.map(one, numbers))
            faults += fail_calls(arguments.mixrig, folder / "0", arguments.every, begin)
            if arguments.shim:
                faults += fail_allocations(arguments.mixrig, folder / "0", arguments.shim, arguments.every, begin)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
