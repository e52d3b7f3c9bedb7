#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Which tests a change concerns: prints a regular expression for `ctest -R`.

usage: changed.py BUILD_FOLDER REVISION
A file belongs to the module or test program whose folder it lies in. A changed module concerns every
test program that links it, directly or by other modules; a changed test file concerns the programs of
its folder; text concerns none; any other file (build rules, support of tests, scripts) concerns all.
The build folder tells the modules (modules.txt) and the programs (test_programs.txt).
"""
import pathlib
import subprocess
import sys

ALWAYS = "house"  # the rules on sources: a second
ALL = "."


def lines_of(file):
    return [line.split("|") for line in file.read_text().splitlines()]


def changed_files(revision):
    run = lambda *words: subprocess.run(["git", *words], check=True, capture_output=True, text=True).stdout.splitlines()
    return run("diff", "--name-only", "--no-renames", revision) + run("ls-files", "--others", "--exclude-standard")


def owner(path, folders):
    """The longest of the folders that holds the file, or none."""
    parents = [str(parent) for parent in pathlib.PurePath(path).parents]
    return next((parent for parent in parents if parent in folders), None)


def downstream(modules, changed):
    """Changed modules, and those that link one, to the end."""
    links = {name: {link.removeprefix("mixrig::") for link in (public + ";" + private).split(";")}
             for name, _, public, private in modules}
    grown = set(changed)
    while more := {name for name in links if name not in grown and links[name] & grown}:
        grown |= more
    return grown


def concerned(build, files):
    modules, programs = lines_of(build / "modules.txt"), lines_of(build / "test_programs.txt")
    module_of = {folder: name for name, folder, _, _ in modules}
    tests_of = {}
    for program, _, folders in programs:
        for folder in folders.split(";"):
            tests_of.setdefault(folder, set()).add(program)
    changed, tests = set(), {ALWAYS}
    for path in files:
        if path.endswith(".md") or path.startswith("docs/"):
            continue
        place = owner(path, module_of.keys() | tests_of.keys())
        if place is None:
            return None
        changed |= {module_of[place]} if place in module_of else set()
        tests |= tests_of.get(place, set())
    affected = downstream(modules, changed)
    return tests | {program for program, links, _ in programs
                    if {link.removeprefix("mixrig::") for link in links.split(";")} & affected}


def main():
    build, revision = pathlib.Path(sys.argv[1]), sys.argv[2]
    try:
        files = changed_files(revision)
    except subprocess.CalledProcessError as error:
        sys.exit(f"changed: git does not know '{revision}': give a commit or a branch ({error.stderr.splitlines()[0]})")
    tests = concerned(build, files)
    print(ALL if tests is None else "^(" + "|".join(sorted(tests)) + r")\.")


if __name__ == "__main__":
    main()
