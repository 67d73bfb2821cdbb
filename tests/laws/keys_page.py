#!/usr/bin/python3
"""scenarios/KEYS.md is what `servomill list keys --markdown` prints; --record writes it.

    keys_page.py SOURCE_DIR SERVOMILL [--record]
"""
import difflib
import pathlib
import subprocess
import sys


def main():
    page = pathlib.Path(sys.argv[1]) / "scenarios/KEYS.md"
    printed = subprocess.run([sys.argv[2], "list", "keys", "--markdown"], capture_output=True, text=True, check=True).stdout
    if sys.argv[3:] == ["--record"]:
        page.write_text(printed, encoding="utf-8")
        return 0
    written = page.read_text(encoding="utf-8")
    difference = list(difflib.unified_diff(written.splitlines(), printed.splitlines(), str(page), "list keys --markdown", lineterm="", n=0))
    print("\n".join(difference) or f"{page.name}: {len(written.splitlines())} lines, as printed")
    if difference:
        print("tests/laws/keys_page.py SOURCE_DIR SERVOMILL --record writes it")
    return 1 if difference else 0


if __name__ == "__main__":
    sys.exit(main())
