#!/usr/bin/python3
"""Own headers that the commands of tools/servomill include, directly and through others, and the share of comments.

    headers.py SOURCE_DIR    fails where a command includes more than MAX of them

Half of the time of compiling a file goes into reading headers, and a header that names another without need has all of
its users compiled again when that one changes. MAX may only fall.
"""
import pathlib
import re
import statistics
import sys

ROOMS = ("plant", "controllers", "strategies", "sim", "tools")
MAX = 39


def included(text):
    return re.findall(r'^#include "([^"]+)"', text, re.MULTILINE)


def reached(names, headers):
    """All that is included from `names` on, themselves among them."""
    seen, ahead = set(), list(names)
    while ahead:
        name = ahead.pop()
        if name in headers and name not in seen:
            seen.add(name)
            ahead += headers[name]
    return seen


def comment_share(texts):
    """Share of the lines that are not empty in which a comment stands."""
    lines = [line.strip() for text in texts for line in text.splitlines() if line.strip()]
    return sum(1 for line in lines if re.search(r"(?:^|\s)//", line)) / len(lines)


def main():
    root = pathlib.Path(sys.argv[1])
    texts = {path.relative_to(root).as_posix(): path.read_text(encoding="utf-8")
             for room in ROOMS for path in sorted((root / room).rglob("*")) if path.suffix in (".h", ".cpp")}
    headers = {name: included(text) for name, text in texts.items() if name.endswith(".h")}
    counts = {name: len(reached(included(text), headers)) for name, text in texts.items()
              if name.startswith("tools/servomill/") and name.endswith("_command.cpp")}
    print(f"own headers of a command: median {statistics.median(counts.values()):g}, at most {max(counts.values())} "
          f"({max(counts, key=counts.get)})")
    for kind, suffix in (("headers", ".h"), ("sources", ".cpp")):
        share = comment_share(text for name, text in texts.items() if name.endswith(suffix))
        print(f"lines with comments in {kind}: {100 * share:.0f} %")
    faults = [f"{name} includes {count} own headers, at most {MAX}: declare forward what it need not see"
              for name, count in counts.items() if count > MAX]
    print("\n".join(faults))
    return 1 if faults or not counts else 0


if __name__ == "__main__":
    sys.exit(main())
