#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the documents of the repository.

    check_docs.py [--mixrig PROGRAM] [--root FOLDER] [--manual-words N] [PAGE.md ...]

Without pages all *.md files of the repository are checked. Each page must hold:
- relative links and pictures exist, and so does the heading that a link to a page names;
- no line is longer than 300 characters, outside tables;
- README.md of the root has at most 120 lines and 900 words.
Without pages also: docs has at most 35,000 words without docs/results, of these at most 10,000 in pages that a
program writes. There a word is a part of a line between spaces that has a letter or a digit: bars of tables are none.
With a program also: each `mixrig SUBCOMMAND` and each of its --options in a ```sh block exists in the
output of --help. Prints one line a fault; exit status 1 if there is any."""
import argparse
import re
import shlex
import subprocess
import sys
from pathlib import Path

MOST_CHARACTERS, README_LINES, README_WORDS = 300, 120, 900
MANUAL_WORDS, GENERATED_WORDS = 35000, 10000
GENERATED = {"docs/reference/commands.md"}  # by mixrig help-pages
SKIPPED = {"build", "out", ".git", ".cache"}
FENCE = re.compile(r"^```(.*?)\n(.*?)^```", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"!?\[[^\]]*\]\(<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\)")
HTML_LINK = re.compile(r"<(?:img|a|source)\b[^>]*?\b(?:src|href)=\"([^\"]+)\"")
HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*#*$", re.MULTILINE)
ANCHOR = re.compile(r"<a\s+(?:name|id)=\"([^\"]+)\"")
CODE = re.compile(r"`[^`\n]*`")
OPTION = re.compile(r"^--?[A-Za-z][\w-]*")


def blank(match):
    """As many lines as the match had, without its text."""
    return "\n" * match.group(0).count("\n")


def slug(heading):
    """The anchor that GitHub gives to a heading."""
    words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")


def anchors(page):
    text = FENCE.sub(blank, page.read_text())
    return {slug(h) for h in HEADING.findall(text)} | set(ANCHOR.findall(text))


def line_of(text, position):
    return text.count("\n", 0, position) + 1


def check_links(page, root):
    text = CODE.sub(lambda m: " " * len(m.group(0)), FENCE.sub(blank, page.read_text()))
    for match in sorted([*LINK.finditer(text), *HTML_LINK.finditer(text)], key=lambda m: m.start()):
        target = match.group(1)
        if re.match(r"[a-z][a-z0-9+.-]*:", target):  # another scheme, such as https:
            continue
        path, _, anchor = target.partition("#")
        place = (root / path.lstrip("/") if path.startswith("/") else page.parent / path) if path else page
        if not place.exists():
            yield line_of(text, match.start()), f"no file {target}"
        elif anchor and place.suffix == ".md" and anchor not in anchors(place):
            yield line_of(text, match.start()), f"no heading #{anchor} in {path or page.name}"


def check_length(page):
    inside = False
    for number, line in enumerate(page.read_text().splitlines(), 1):
        inside ^= line.startswith("```")
        if len(line) > MOST_CHARACTERS and (inside or not line.lstrip().startswith("|")):
            yield number, f"{len(line)} characters, more than {MOST_CHARACTERS}"


def count_words(page):
    return sum(any(c.isalnum() for c in part) for part in page.read_text().split())


def check_readme(page):
    text = page.read_text()
    lines, words = len(text.splitlines()), len(text.split())
    if lines > README_LINES:
        yield README_LINES, f"{lines} lines, more than {README_LINES}"
    if words > README_WORDS:
        yield README_LINES, f"{words} words, more than {README_WORDS}"


def check_manual(pages, root, most):
    """Faults of all pages of docs together."""
    words = {str(p.relative_to(root)): count_words(p) for p in pages if p.is_relative_to(root / "docs")
             and not p.is_relative_to(root / "docs/results")}
    total, generated = sum(words.values()), sum(count for page, count in words.items() if page in GENERATED)
    if total > most:
        yield f"docs: {total} words, more than {most}"
    if generated > GENERATED_WORDS:
        yield f"docs: {generated} words in generated pages, more than {GENERATED_WORDS}"
    for page in sorted(GENERATED - words.keys()) if words else []:
        yield f"{page}: no such page, but check_docs.py names it"


class Help:
    """Subcommands and options of the program, from its own --help."""

    def __init__(self, program):
        self.program, self.known = program, {}

    def of(self, path):
        """(subcommands, options) of a list of subcommands; options None where there is no such one."""
        if path not in self.known:
            done = subprocess.run([self.program, *path, "--help"], capture_output=True, text=True, timeout=300)
            text = done.stdout + done.stderr
            usage = re.search(r"^Usage: \S+ ?(.*)$", text, re.MULTILINE)
            if path and not (usage and usage.group(1).startswith(" ".join(path))):  # another command's help
                return set(), None
            # Commands stand under several headings; positional arguments are in capitals.
            commands = set(re.findall(r"^  ([a-z][\w-]*)(?:\s|$)", text, re.MULTILINE))
            options = set()
            for line in text.splitlines():
                match = re.match(r"^  (-[\w,-]+)", line)
                if match:
                    options |= set(match.group(1).split(","))
            self.known[path] = (commands, options)
        return self.known[path]


def words_of(line):
    """Words of a shell line without its comment, or None where its quotes go on in the next line."""
    try:
        return shlex.split(line, comments=True)
    except ValueError:
        return None


def invocations(block):
    """(line offset, words after `mixrig`) of each call in a shell block."""
    lines, offset, end_mark = block.splitlines(), 0, None
    while offset < len(lines):
        start, line = offset, lines[offset]
        offset += 1
        if end_mark is not None:  # the text of a here-document
            if line.strip() == end_mark:
                end_mark = None
            continue
        while line.rstrip().endswith("\\") and offset < len(lines):
            line = line.rstrip()[:-1] + " " + lines[offset]
            offset += 1
        here = re.search(r"<<-?\s*['\"]?(\w+)['\"]?", line)
        if here:
            end_mark = here.group(1)
        words = words_of(line.replace("[", " ").replace("]", " "))
        call = None
        for word in words or []:
            if word in ("&&", "||", "|", ";", "&") or word.startswith((">", "2>")):
                if call is not None:
                    yield start, call
                call = None
            elif call is not None:
                call.append(word.rstrip(";"))
                if word.endswith(";"):
                    yield start, call
                    call = None
            elif word == "mixrig" or word.endswith("/mixrig") and not word.startswith("-"):
                call = []
        if call is not None:
            yield start, call


def check_call(words, program):
    path = ()
    rest = list(words)
    while rest and rest[0] in program.of(path)[0]:
        path += (rest.pop(0),)
    commands, _ = program.of(path)
    if rest and commands and re.match(r"[a-z]", rest[0]) and program.of(path + (rest[0],))[1] is not None:
        path += (rest.pop(0),)  # one that --help does not list
        commands, _ = program.of(path)
    name = " ".join(("mixrig",) + path)
    if rest and commands and not rest[0].startswith("-") and rest[0] != "...":
        yield f"`{name}` has no subcommand '{rest[0]}'"
        return
    known = set().union(*(program.of(path[:n])[1] for n in range(len(path) + 1)))
    for word in rest:
        option = OPTION.match(word)
        if option and option.group(0) not in known:
            yield f"`{name}` has no option {option.group(0)}"


def check_commands(page, program):
    text = page.read_text()
    for match in FENCE.finditer(text):
        if match.group(1).split()[:1] != ["sh"]:
            continue
        first = line_of(text, match.start()) + 1
        for offset, words in invocations(match.group(2)):
            for wrong in check_call(words, program):
                yield first + offset, wrong


def pages_of(root):
    return sorted(p for p in root.rglob("*.md")
                  if not any(part in SKIPPED for part in p.relative_to(root).parts)
                  and "breach" not in p.relative_to(root).parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("pages", nargs="*", type=Path, help="instead of all pages")
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[3])
    parser.add_argument("--manual-words", type=int, default=MANUAL_WORDS, help="limit of docs without docs/results")
    parser.add_argument("--mixrig", help="the program whose --help is asked")
    arguments = parser.parse_args()
    root = arguments.root.resolve()
    program = Help(arguments.mixrig) if arguments.mixrig else None
    pages = [p.resolve() for p in arguments.pages] or pages_of(root)
    if not pages:
        sys.exit(f"check_docs.py: no pages in {root}")
    faults = 0
    for page in pages:
        found = [*check_links(page, root), *check_length(page)]
        if page == root / "README.md":
            found += check_readme(page)
        if program:
            found += check_commands(page, program)
        for line, wrong in sorted(found):
            print(f"{page.relative_to(root) if page.is_relative_to(root) else page}:{line}: {wrong}")
        faults += len(found)
    if not arguments.pages:
        for wrong in check_manual(pages, root, arguments.manual_words):
            print(wrong)
            faults += 1
    print(f"{len(pages)} pages, {faults} faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
