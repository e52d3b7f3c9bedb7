#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that a program has what MIXRIG_HARDEN asks of the compiler and the linker.

usage: check_hardening.py PROGRAM
"""
import re
import subprocess
import sys


def main():
    said = subprocess.run(["readelf", "--wide", "--file-header", "--program-headers", "--dynamic", "--dyn-syms", sys.argv[1]],
                          check=True, text=True, stdout=subprocess.PIPE).stdout
    wanted = {"place in memory that varies (PIE)": r"Type:\s+DYN", "read-only relocations": r"GNU_RELRO",
              "binding at the start": r"\(FLAGS.*\bNOW\b", "stack protector": r"UND __stack_chk_fail\b",
              "_FORTIFY_SOURCE": r"UND __(mem|str|sn?printf|vsn?printf|read|fprintf|recv)\w*_chk\b",
              "_GLIBCXX_ASSERTIONS": r"UND _ZSt21__glibcxx_assert_fail"}
    missing = [name for name, pattern in wanted.items() if not re.search(pattern, said)]
    print("\n".join(f"{sys.argv[1]} has no {name}" for name in missing) or f"{sys.argv[1]}: {', '.join(wanted)}")
    sys.exit(bool(missing))


main()
