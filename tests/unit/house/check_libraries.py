#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that NOTICE lists the shared libraries that a program links, and the GStreamer packages that the sources name;
and that no solver of Ceres uses SuiteSparse.

usage: check_libraries.py PROGRAM NOTICE SOURCE_FOLDER...
"""
import pathlib
import re
import subprocess
import sys


def listed(notice, head):
    """First words of the rows of a table, up to an empty line."""
    rows = notice.split(f"\n{head} ", 1)[1].split("\n\n", 1)[0].splitlines()[1:]
    return {row.split()[0] for row in rows if len(row.split()) > 1}


def main():
    program, notice = sys.argv[1], pathlib.Path(sys.argv[2]).read_text()
    sources = {file: file.read_text() for folder in sys.argv[3:] for file in pathlib.Path(folder).rglob("*.cpp")}
    needed = re.findall(r"\(NEEDED\).*\[(.*?)\.so", subprocess.run(["readelf", "-d", program], check=True, text=True,
                                                                  stdout=subprocess.PIPE).stdout)
    linked = {name for name in needed if not name.startswith(("ld-linux", "libasan", "libubsan", "libtsan"))}
    loaded = {name for text in sources.values() for name in re.findall(r"gstreamer1\.0-[a-z-]*[a-z]", text)}
    faults = [f"{file}: ceres::Solver::Options without EIGEN_SPARSE: its solver would be SuiteSparse's, see NOTICE"
              for file, text in sources.items() if "ceres::Solver::Options" in text and "= ceres::EIGEN_SPARSE;" not in text]
    for head, used in (("linked", linked), ("loaded", loaded)):
        rows = listed(notice, head)
        faults += [f"{name} is {head}, and NOTICE has no licence for it" for name in sorted(used - rows)]
        faults += [f"NOTICE lists {name}, which is not {head}" for name in sorted(rows - used)]
    print("\n".join(faults) or f"{len(linked)} libraries and {len(loaded)} packages are listed")
    sys.exit(bool(faults))


main()
