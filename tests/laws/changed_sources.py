#!/usr/bin/python3
"""Prints the sources in which more than words has changed: messages, comments and lists of headers make no function longer or
more complex.

    changed_sources.py BASE FOLDER...      BASE is a commit; uncommitted changes count
"""
import pathlib
import re
import subprocess
import sys

WORDS = re.compile(r'"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*.*?\*/', re.DOTALL)
INCLUDE = re.compile(r"^[ \t]*#include[^\n]*$", re.MULTILINE)


def code_of(source):
    """A source without what comments and texts say, its list of headers and its line breaks."""
    code = WORDS.sub(lambda word: '""' if word[0].startswith('"') else " ", INCLUDE.sub("", source))
    return re.sub(r'""(?:\s*"")+', '""', " ".join(code.split()))


def main():
    base, folders = sys.argv[1], sys.argv[2:]

    def git(*arguments):
        return subprocess.run(["git", *arguments], capture_output=True, text=True, check=False)

    changed = git("diff", "--name-only", "--diff-filter=d", base, "--", *folders)
    changed.check_returncode()
    for name in changed.stdout.splitlines():
        if not name.endswith(".cpp"):
            continue
        before = git("show", f"{base}:{name}")
        if before.returncode != 0 or code_of(before.stdout) != code_of(pathlib.Path(name).read_text(encoding="utf-8")):
            print(name)


if __name__ == "__main__":
    main()
