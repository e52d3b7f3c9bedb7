#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Each text of the operator's page has words in each other language, with the same values, and no table has more.

usage: check_words.py FOLDER    the page's files; words_*.js are the tables
"""
import html.parser
import pathlib
import re
import sys

ATTRIBUTES = ("aria-label", "title", "placeholder", "alt")


class Texts(html.parser.HTMLParser):
    """What a reader sees or hears of index.html."""

    def __init__(self, text):
        super().__init__()
        self.found, self.in_body = set(), False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.in_body |= tag == "body"
        self.found |= {value for name, value in attributes if name in ATTRIBUTES}

    def handle_data(self, text):
        if self.in_body and text.strip():
            self.found.add(text.strip())


def end_of_value(code, at):
    """Behind the } of a template's value that begins at `at`; it may hold templates."""
    depth = 1
    while depth:
        if code[at] == "`":
            at = code.index("`", at + 1)
        depth += {"{": 1, "}": -1}.get(code[at], 0)
        at += 1
    return at


def templates(code):
    """The keys of all tr`...`: value i is {i}."""
    keys = set()
    for found in re.finditer(r"\btr`", code):
        at, key, count = found.end(), "", 0
        while code[at] != "`":
            if code.startswith("${", at):
                key, count, at = f"{key}{{{count}}}", count + 1, end_of_value(code, at + 2)
            else:
                key, at = key + code[at], at + 1
        keys.add(key)
    return keys


def table_of(code):
    entries = re.findall(r"'((?:[^'\\]|\\.)+)':\s*'((?:[^'\\]|\\.)+)',", code)
    return {key.replace("\\'", "'"): words for key, words in entries}


def main():
    folder = pathlib.Path(sys.argv[1])
    code = "\n".join(file.read_text() for file in sorted(folder.glob("*.js")) if not file.name.startswith("words_"))
    page = (folder / "index.html").read_text()
    wanted = {text for text in Texts(page).found | templates(code) if re.search("[A-Za-z]{2}", text)}
    faults = []
    for file in sorted(folder.glob("words_*.js")):
        table = table_of(file.read_text())
        faults += [f"{file.name} lacks: {key}" for key in sorted(wanted - set(table) - {"mixrig"})]
        faults += [f"{file.name} has what the page does not say: {key}" for key in sorted(set(table) - wanted)
                   if f"'{key}'" not in code and f"name: '{key}" not in code]
        faults += [f"{file.name} has other values: {key}" for key, words in table.items()
                   if sorted(re.findall(r"\{\d\}", key)) != sorted(re.findall(r"\{\d\}", words))]
        print(f"{file.name}: {len(table)} texts")
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
