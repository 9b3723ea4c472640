#!/usr/bin/env python3
"""Prints the lines of code of each room of `src/`, without tests, comments and blank lines.

Usage: tests/count.py [--files] [FOLDER]

FOLDER is the root of a checkout; this one is the default. Tests are modules and files behind
`#[cfg(test)]`. `--files` prints each file as well.
"""

import argparse
import re
from collections import Counter
from pathlib import Path

# A comment, or text in which `//` and `{` mean nothing.
TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*)
    |(?P<text>b?r(?P<fence>\#*)".*?"(?P=fence)|b?"(?:\\.|[^"\\])*"|b?'(?:\\.[^']*|[^'\\])')""",
    re.VERBOSE | re.DOTALL,
)
TESTS = re.compile(r"#\[cfg\(test\)\]\s*(?:#\[[^\]]*\]\s*)*(?:pub(?:\([^)]*\))?\s+)?mod\s+(\w+)\s*(;|\{)")


def end_of_comment(text: str, start: int) -> int:
    """Returns the end of a block comment; such comments nest."""
    depth, at = 0, start
    while at < len(text):
        if text.startswith("/*", at):
            depth, at = depth + 1, at + 2
        elif text.startswith("*/", at):
            depth, at = depth - 1, at + 2
            if depth == 0:
                return at
        else:
            at += 1
    return at


def without_comments(text: str) -> str:
    """Returns the code; each literal becomes one that holds as many lines and no braces."""
    code, at = [], 0
    while found := TOKEN.search(text, at):
        code.append(text[at : found.start()])
        at = found.end()
        if found["comment"] == "/*":
            at = end_of_comment(text, found.start())
            code.append("\n" * text.count("\n", found.start(), at))
        elif found["text"]:
            code.append("\n".join("_" if line.strip() else "" for line in found["text"].split("\n")))
    return "".join([*code, text[at:]])


def end_of_block(code: str, at: int) -> int:
    """Returns the end of the block whose `{` ends at `at`."""
    depth = 1
    while depth and at < len(code):
        depth += (code[at] == "{") - (code[at] == "}")
        at += 1
    return at


def read(file: Path) -> tuple[int, list[Path]]:
    """Returns the lines of code of a file, and the files and folders of its tests."""
    code, tests = without_comments(file.read_text()), []
    while found := TESTS.search(code):
        end = found.end()
        if found[2] == ";":
            folder = file.parent if file.name in ("mod.rs", "lib.rs", "main.rs") else file.with_suffix("")
            tests += [folder / f"{found[1]}.rs", folder / found[1]]
        else:
            end = end_of_block(code, end)
        code = code[: found.start()] + code[end:]
    return sum(bool(line.strip()) for line in code.split("\n")), tests


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--files", action="store_true", help="print each file as well")
    parser.add_argument("folder", nargs="?", type=Path, default=Path(__file__).parent.parent)
    arguments = parser.parse_args()
    source = arguments.folder / "src"
    lines, tests = {}, set()
    for file in sorted(source.rglob("*.rs")):
        lines[file], found = read(file)
        tests.update(found)
    rooms: Counter[str] = Counter()
    for file, count in lines.items():
        if tests.isdisjoint([file, *file.parents]):
            path = file.relative_to(source)
            rooms[f"{path.parts[0]}/" if len(path.parts) > 1 else path.name] += count
            if arguments.files:
                print(f"{count:7} {path}")
    for room, count in sorted(rooms.items()):
        print(f"{count:7} {room}")
    print(f"{rooms.total():7} in all")


if __name__ == "__main__":
    main()
