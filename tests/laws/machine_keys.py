#!/usr/bin/python3
"""Every key of a machine that `servomill list keys` knows stands in scenarios/machines/README.md, and no other.

    machine_keys.py SOURCE_DIR SERVOMILL
"""
import pathlib
import re
import sys

import scenario_keys

MODELS = {"set_valued", "regularised", "lugre"}  # rows of a table that is not about keys


def known_keys(servomill):
    """Keys of the machine and its sections; tables are headings there."""
    listed = scenario_keys.listed_keys(servomill, "machine")
    return {key for section, keys in listed.items() for key, kind in keys.items()
            if not re.match(r"(list of )?tables?\b", kind) and section != "machine.axis"} - {"errors"} | {"lead_error"}


def described_keys(folder):
    text = (folder / "scenarios/machines/README.md").read_text(encoding="utf-8")
    rows = [line.split("|")[1] for line in text.splitlines() if line.startswith("| `")]
    keys = {key for row in rows for key in re.findall(r"`(\w+)`", row)}
    return keys | set(re.findall(r"^`(\w+)` and `\w+` \(default", text, re.MULTILINE)) | set(
        re.findall(r"^`\w+` and `(\w+)` \(default", text, re.MULTILINE))


def main():
    known, described = known_keys(sys.argv[2]), described_keys(pathlib.Path(sys.argv[1]))
    missing, unknown = known - described, described - known - MODELS
    assert len(known) > 80, f"found {len(known)} keys only: they are listed differently now"
    for key in sorted(missing):
        print(f"scenarios/machines/README.md says nothing of {key}")
    for key in sorted(unknown):
        print(f"scenarios/machines/README.md describes {key}, which no reader knows")
    return 1 if missing or unknown else 0


if __name__ == "__main__":
    sys.exit(main())
