#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cuts the virtual board off while it records: each take opens, and at most a second is lost.

usage: cut.py --board PROGRAM --host PROGRAM [--cuts N] [--seed S] [--seconds S]
`mixrig` of the board and of this machine; parts of the board in $MIXRIG_BOARD_CACHE (board/virt/prepare). A cut is
the disk as it is at a random moment: the emulator is stopped, its disk copied, and it goes on; the last cut of a boot
ends it by kill -9. The guest's page cache is lost, a cache of the disk itself is not emulated. The file system's
journal is then played by e2fsck. What is lost is counted from the last whole frame to the guest's clock at the cut.
"""
import argparse
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "e2e"))
import kill_record_test  # noqa: E402

RATE_HZ, CUTS_OF_A_BOOT, MOST_LOST_S = 10, 10, 1.5
TOLD_S = 0.2  # the guest tells its time ten times a second


def boot(arguments, share, disk):
    """The emulator, and the file of what it prints."""
    log = share / "log"
    environment = {**os.environ, "MIXRIG_BOARD_TIMEOUT": "900"}
    child = subprocess.Popen([HERE.parent.parent / "board/virt/run", share, "cut_guest.sh", "-pidfile", share / "pid",
                              "-drive", f"file={disk},if=virtio,format=raw"], stdout=log.open("w"), stderr=subprocess.STDOUT,
                             env=environment)
    return child, log


def wait_for(child, log, words, limit_s):
    until = time.monotonic() + limit_s
    while words not in log.read_text(errors="replace"):
        if child.poll() is not None or time.monotonic() > until:
            sys.exit(f"cut: the board did not say '{words}': {log.read_text(errors='replace')[-800:]}")
        time.sleep(0.1)


def told_s(log):
    return float(re.findall(r"up (\d+\.\d+)", log.read_text(errors="replace"))[-1])


def takes_of(disk, folder):
    """Plays the journal, and copies what the disk holds into the folder."""
    done = subprocess.run(["e2fsck", "-fy", disk], capture_output=True, text=True)
    if done.returncode > 2:
        sys.exit(f"cut: the file system is lost: {done.stdout}")
    subprocess.run(["debugfs", "-R", f"rdump / {folder}", disk], check=True, capture_output=True)
    return sorted(path for path in folder.iterdir() if path.name.startswith("shot"))


def judge(arguments, disk, up_s):
    """Opens each take. Returns frames of the one that was cut off and seconds since its last whole frame (or None)."""
    result = (0, None, "between two takes")
    with tempfile.TemporaryDirectory(prefix="mixrig-cut-") as name:
        for take in takes_of(disk, pathlib.Path(name)):
            done = subprocess.run([arguments.host, "info", take, "--json", "-"], capture_output=True, text=True)
            young = "before its first frame was whole" in done.stderr or not (take / "take.toml").exists()
            if take.suffix == ".partial" and young:
                result = (0, None, "before its first frame")
            elif done.returncode != 0:
                sys.exit(f"cut: FAILED: {take.name} does not open: {done.stderr}")
            elif take.suffix == ".partial":
                frames = json.loads(done.stdout)["frames"]
                last_s = 1e-9 * kill_record_test.stamps_ns(take)[frames - 1]
                result = (frames, up_s - last_s, re.findall(r"took .*", done.stderr)[0])
    return result


def cut_of_a_boot(arguments, share, chosen, cuts, results):
    disk = share / "disk"
    disk.write_bytes(b"")
    os.truncate(disk, 256 << 20)
    subprocess.run(["mkfs.ext4", "-q", "-F", disk], check=True)
    child, log = boot(arguments, share, disk)
    try:
        wait_for(child, log, "begins shot1", 300)
        pid = int((share / "pid").read_text())
        for cut in range(cuts):
            time.sleep(chosen.uniform(0.5, arguments.seconds))
            os.kill(pid, signal.SIGKILL if cut == cuts - 1 else signal.SIGSTOP)
            up_s = told_s(log)
            copy = share / "cut"
            subprocess.run(["cp", "--sparse=always", disk, copy], check=True)
            if cut < cuts - 1:
                os.kill(pid, signal.SIGCONT)
            results.append(judge(arguments, copy, up_s))
            frames, age_s, said = results[-1]
            print(f"cut {len(results)}: at {up_s:.1f} s, {frames} frames, last whole one "
                  f"{'-' if age_s is None else f'{age_s:.2f} s'} old: {said}", flush=True)
    finally:
        try:
            os.kill(int((share / "pid").read_text()), signal.SIGKILL)  # its timeout lies between it and the child
        except (OSError, ValueError):
            pass  # it was cut off, or has not begun
        child.terminate()
        child.wait()
        (share / "pid").unlink(missing_ok=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--board", required=True)
    parser.add_argument("--host", required=True)
    parser.add_argument("--cuts", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=12, help="most between two cuts")
    arguments = parser.parse_args()
    chosen, results = random.Random(arguments.seed), []
    kill_record_test.RATE_HZ = RATE_HZ
    os.environ["PATH"] += ":/usr/sbin:/sbin"  # of e2fsprogs
    with tempfile.TemporaryDirectory(prefix="mixrig-board-") as name:
        share = pathlib.Path(name)
        share.chmod(0o755)
        (share / "bin").mkdir()
        shutil.copy(arguments.board, share / "bin/mixrig")
        shutil.copy(HERE / "cut_guest.sh", share)
        kill_record_test.make_source(arguments.host, share)
        (share / "rig.toml").write_text((share / "rig.toml").read_text().replace(str(share), "/tmp"))
        while len(results) < arguments.cuts:
            cut_of_a_boot(arguments, share, chosen, min(CUTS_OF_A_BOOT, arguments.cuts - len(results)), results)
    ages = sorted(age for _, age, _ in results if age is not None)
    print(f"{len(results)} cuts: every take opens; in {len(ages)} of them a take with frames was cut off, whose last whole "
          f"frame was {ages[len(ages) // 2]:.2f} s old in the middle, {ages[-1]:.2f} s at most")
    return 1 if ages[-1] > MOST_LOST_S + TOLD_S else 0


sys.exit(main())
