#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Follows the tutorials: runs the commands of docs/tutorial/*.md as they stand in the text.

    tests/e2e/tutorial_test.py --mixrig build/release/host/tools/mixrig [PAGE.md ...]

Blocks fenced by ```sh are run, in reading order, in one temporary folder with `mixrig` on PATH. Any
command that fails fails the test. Blocks with a word after sh are not run: ```sh hardware needs
devices, ```sh manual needs a screen, a browser or a person."""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = ["first_composite", "your_recording", "rig_on_the_bench", "day_on_set"]  # each goes on with the one before
FENCE = re.compile(r"^```sh *(\w*) *\n(.*?)^``` *$", re.MULTILINE | re.DOTALL)
NOT_RUN = {"hardware", "manual"}


def blocks(page):
    """(line number, word after sh, commands) of each shell block of a page."""
    text = page.read_text()
    return [(text.count("\n", 0, match.start()) + 1, match.group(1), match.group(2))
            for match in FENCE.finditer(text)]


def run_block(commands, folder, environment, limit_s):
    """None, or what went wrong."""
    try:
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", commands], cwd=folder, env=environment,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, errors="replace", timeout=limit_s)
    except subprocess.TimeoutExpired:
        return f"took longer than {limit_s} s"
    if done.returncode != 0:
        return f"exit status {done.returncode}\n{done.stdout[-2000:]}"
    return None


def follow(pages, mixrig, limit_s):
    failed = 0
    with tempfile.TemporaryDirectory(prefix="mixrig_tutorial_") as folder:
        programs, work = Path(folder) / "bin", Path(folder) / "work"
        programs.mkdir()
        work.mkdir()
        (programs / "mixrig").symlink_to(mixrig)
        environment = dict(os.environ, PATH=f"{programs}:{os.environ['PATH']}")
        for page in pages:
            ran = 0
            for line, kind, commands in blocks(page):
                where = f"{page.name}:{line}"
                if kind in NOT_RUN:
                    print(f"{where}: not run: {kind}")
                    continue
                if kind:
                    print(f"{where}: unknown kind of block '{kind}': use {', '.join(sorted(NOT_RUN))} or none")
                    failed += 1
                    continue
                began = time.monotonic()
                wrong = run_block(commands, work, environment, limit_s)
                print(f"{where}: {'FAILED: ' + wrong if wrong else 'passed'}, {time.monotonic() - began:.1f} s")
                ran += 1
                if wrong:  # later blocks use what this one makes
                    return failed + 1
            if ran == 0:
                print(f"{page.name}: no block was run")
                failed += 1
    return failed


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("pages", nargs="*", type=Path, help="instead of all tutorials, in this order")
    parser.add_argument("--mixrig", default=shutil.which("mixrig"), help="the program; that on PATH if not given")
    parser.add_argument("--limit-s", type=float, default=300, help="of one block, seconds")
    arguments = parser.parse_args()
    if not arguments.mixrig or not Path(arguments.mixrig).exists():
        sys.exit("tutorial_test.py: no mixrig: give --mixrig PROGRAM")
    pages = arguments.pages or [ROOT / "docs/tutorial" / f"{name}.md" for name in PAGES]
    if not arguments.pages:
        lost = set((ROOT / "docs/tutorial").glob("*.md")) - set(pages)
        if lost:
            sys.exit(f"tutorial_test.py: not in PAGES: {', '.join(sorted(p.name for p in lost))}")
    sys.exit(1 if follow(pages, Path(arguments.mixrig).resolve(), arguments.limit_s) else 0)


if __name__ == "__main__":
    main()
