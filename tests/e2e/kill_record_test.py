#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""kill -9 at random moments while `mixrig record` writes: each take opens, at most a second is lost.

usage: kill_record_test.py --mixrig PROGRAM [--kills N] [--seed S] [--format mkv|png]...
Two recordings run at once.
What is lost is measured by the stamps of the frames that `record` had taken, which the table has before
the encoder is done: from the last frame that is whole to the last one that was taken. Every fourth take
is then made whole by `info --repair`.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import random
import re
import signal
import subprocess
import sys
import tempfile
import time

RATE_HZ, PICTURES, FRAMES, SIZE = 50, 8, 3000, "64x48"
MOST_LOST_S, AT_ONCE = 1.0, 2


def make_source(mixrig, folder):
    """A take of a minute: few pictures, shown again and again."""
    take = folder / "take"
    subprocess.run([mixrig, "studio", take, "--plain", "--scenario", "walk", "--rig", "sr3000", "--seed", "31",
                    "--size", SIZE, "--frames", str(PICTURES)], check=True, stdout=subprocess.DEVNULL)
    for stream in ("color", "depth", "amplitude"):
        for number in range(PICTURES + 1, FRAMES + 1):
            (take / stream / f"{number:06}.png").symlink_to(f"{(number - 1) % PICTURES + 1:06}.png")
    pose = (take / "poses.txt").read_text().splitlines()[0].split(" ", 1)[1]
    (take / "poses.txt").write_text("".join(f"{i / RATE_HZ} {pose}\n" for i in range(FRAMES)))
    text = (take / "take.toml").read_text()
    text = re.sub(r"(?m)^count = .*", f"count = {FRAMES}", text)
    text = re.sub(r"(?m)^rate_hz = .*", f"rate_hz = {RATE_HZ}.0", text)
    (take / "take.toml").write_text(re.sub(r"(?s)\[truth\][^\[]*", "", text))
    (folder / "rig.toml").write_text(f'format = 1\nname = "played"\n[[camera]]\nname = "color"\nuri = "take:{take}/color"\n'
                                     f'[depth]\nuri = "take:{take}/depth"\n')


def stamps_ns(partial):
    """Mid-exposures of the colour pictures that were taken, by frame."""
    rows = [line.split(",") for line in (partial / "ticks.csv").read_text().splitlines()[1:]]
    return [int(cells[4]) for cells in rows if len(cells) > 5 and cells[1] == "color"]


def lost(partial, frames, killed_ns):
    """Seconds of frames that were taken and are not in the take, and seconds up to the kill."""
    taken = stamps_ns(partial)
    last_whole = taken[frames - 1] if frames > 0 else (taken or [killed_ns])[0]
    return 1e-9 * ((taken or [killed_ns])[-1] - last_whole), 1e-9 * (killed_ns - last_whole)


def info(mixrig, words):
    done = subprocess.run([mixrig, "info", *words, "--json", "-"], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"info {words}: status {done.returncode}: {done.stderr}")
    return json.loads(done.stdout), done.stderr


def kill_once(mixrig, folder, number, seconds, form):
    """Records, kills, opens; returns frames, what lost() gives and the line that `info` says."""
    out, partial = folder / f"shot {number}", folder / f"shot {number}.partial"
    child = subprocess.Popen([mixrig, "record", "--rig", folder / "rig.toml", out, "--duration", "50",
                              "--format", form, "--keep-free", "0"],
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        while not (partial / "take.toml").exists():
            if child.poll() is not None:
                raise AssertionError(f"record ended with {child.returncode} before its first frame")
            time.sleep(0.002)
        time.sleep(seconds)
    finally:
        killed_ns = time.monotonic_ns()
        child.send_signal(signal.SIGKILL)
        child.wait()
    opened = subprocess.run([mixrig, "info", partial], capture_output=True, text=True)
    if opened.returncode == 1 and "before its first frame was whole" in opened.stderr:  # too young
        return 0, lost(partial, 0, killed_ns), opened.stderr.strip()
    report, said = info(mixrig, [partial])
    if "were cut off" not in said or f"took {report['frames']} frames" not in said:
        raise AssertionError(f"info says: {said}")
    return report["frames"], lost(partial, report["frames"], killed_ns), said.strip()


def check_repair(mixrig, folder, number, frames):
    """The name is not taken over; then the take is whole, in any order, and a second call is refused."""
    out, partial = folder / f"shot {number}", folder / f"shot {number}.partial"
    out.mkdir()
    if subprocess.run([mixrig, "info", "--repair", partial], capture_output=True).returncode != 2:
        raise AssertionError("--repair took a name that is taken")
    out.rmdir()
    report, said = info(mixrig, ["--repair", partial])
    if report["frames"] != frames or partial.exists() or "were cut off" not in said:
        raise AssertionError(f"repaired: {report['frames']} of {frames} frames: {said}")
    again, said = info(mixrig, [out])
    if again["frames"] != frames or "cut off" in said:
        raise AssertionError(f"the repaired take: {again['frames']} of {frames} frames: {said}")
    if subprocess.run([mixrig, "info", "--repair", partial], capture_output=True).returncode != 2:
        raise AssertionError("--repair of what is not there")
    return out


def kill_and_check(mixrig, folder, number, seconds, form):
    """Returns what kill_once() does; every fourth take is made whole, and all are removed."""
    result = kill_once(mixrig, folder, number, seconds, form)
    if number % 4 == 0 and result[0] > 0:
        check_repair(mixrig, folder, number, result[0])
    subprocess.run(["rm", "-rf", folder / f"shot {number}", folder / f"shot {number}.partial"], check=True)
    return result


def kill_all(arguments, form):
    """Returns the number of faults."""
    chosen, losses, ages, counts, faults = random.Random(arguments.seed), [], [], [], 0
    with tempfile.TemporaryDirectory(prefix="mixrig-kill-") as name, concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
        folder = pathlib.Path(name)
        for file in ("take", "rig.toml"):
            (folder / file).symlink_to(arguments.source / file)
        moments = [chosen.uniform(0.0, 3.0) for _ in range(arguments.kills)]
        results = pool.map(lambda kill: kill_and_check(arguments.mixrig, folder, *kill, form), enumerate(moments))
        for seconds, (frames, (lost_s, age_s), said) in zip(moments, results):
            losses.append(lost_s)
            ages.append(age_s)
            counts.append(frames)
            if lost_s > MOST_LOST_S:
                faults += 1
                print(f"FAILED: killed after {seconds:.3f} s: {lost_s:.3f} s are lost: {said}")
    losses.sort()
    ages.sort()
    middle = len(losses) // 2
    print(f"{len(losses)} kills, {form}: every take opens; {min(counts)} to {max(counts)} frames; lost "
          f"{losses[middle]:.3f} s in the middle, {losses[-1]:.3f} s at most; the last whole frame is "
          f"{ages[middle]:.3f} s old in the middle, {ages[-1]:.3f} s at most", flush=True)
    return faults


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--mixrig", required=True)
    parser.add_argument("--kills", type=int, default=4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--format", action="append")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="mixrig-kill-") as name:
        arguments.source = pathlib.Path(name)
        make_source(arguments.mixrig, arguments.source)
        return 1 if sum(kill_all(arguments, form) for form in arguments.format or ["mkv"]) else 0


if __name__ == "__main__":
    os.environ.setdefault("LC_ALL", "C")
    sys.exit(main())
