#!/usr/bin/python3
"""Every key that the readers of a machine know stands in scenarios/machines/README.md, and no other.

    machine_keys.py SOURCE_DIR
"""
import pathlib
import re
import sys

SOURCES = ("read_machine.cpp", "read_drive.cpp", "read_servo.cpp", "read_encoder.cpp")
CALL = re.compile(r'(?:real|real_or|reals|integer_or|boolean_or|text|text_or|choice|choice_or|table|tables_or_none|'
                  r'filter_frequency|needed_if)\(\s*(?:filter, |table, |axis, )?(?:[^,"()]*,\s*)?"(\w+)"')
NAMED = re.compile(r'^  const std::string_view key = linear \? "(\w+)" : "(\w+)"', re.MULTILINE)
PERIOD = re.compile(r'period\(nc, "(\w+)"')
STEPS = re.compile(r'read_either\(axis, "(\w+)", "(\w+)"')
STRUCTURE = {"nc", "axis", "marks", "scale", "motor", "screw", "friction", "winding", "cogging", "filter",
             "friction_compensation", "backlash_compensation", "errors", "Z"}  # tables: they are headings


def known_keys(folder):
    keys = set()
    for name in SOURCES:
        text = (folder / "sim" / name).read_text(encoding="utf-8")
        keys |= set(CALL.findall(text)) | set(PERIOD.findall(text))
        for pattern in (NAMED, STEPS):
            keys |= {key for pair in pattern.findall(text) for key in pair}
    return keys - STRUCTURE


def described_keys(folder):
    text = (folder / "scenarios/machines/README.md").read_text(encoding="utf-8")
    rows = [line.split("|")[1] for line in text.splitlines() if line.startswith("| `")]
    keys = {key for row in rows for key in re.findall(r"`(\w+)`", row)}
    return keys | set(re.findall(r"^`(\w+)` and `\w+` \(default", text, re.MULTILINE)) | set(
        re.findall(r"^`\w+` and `(\w+)` \(default", text, re.MULTILINE))


def main():
    folder = pathlib.Path(sys.argv[1])
    known, described = known_keys(folder), described_keys(folder)
    models = {"set_valued", "regularised", "lugre"}  # rows of a table that is not about keys
    missing, unknown = known - described, described - known - models
    assert len(known) > 80, f"found {len(known)} keys only: the readers are written differently now"
    for key in sorted(missing):
        print(f"scenarios/machines/README.md says nothing of {key}")
    for key in sorted(unknown):
        print(f"scenarios/machines/README.md describes {key}, which no reader knows")
    return 1 if missing or unknown else 0


if __name__ == "__main__":
    sys.exit(main())
