#!/usr/bin/python3
"""No room but strategies/ knows a strategy by its name: all others ask its entry what it can do.

    strategy_names.py SOURCE_DIR
"""
import pathlib
import re
import sys

ROOMS = ("plant", "controllers", "sim", "tools/servomill")
ENTRY = re.compile(r'return \{"(\w+)",|Entry entry = \{"(\w+)",')
COMPARED = r'name\s*(?:\(\))?\s*[!=]=\s*"({0})"|"({0})"\s*[!=]=\s*[\w.>-]*name'
ASKED = re.compile(r"entry->name\s*[!=]=|strategies::find\(\"")


def main():
    folder = pathlib.Path(sys.argv[1])
    names = {name for file in (folder / "strategies").glob("*.cpp")
             for pair in ENTRY.findall(file.read_text(encoding="utf-8")) for name in pair if name}
    assert {"none", "table", "feedback", "gcode"} <= names, names
    compared = re.compile(COMPARED.format("|".join(sorted(names))))
    faults, files = [], 0
    for room in ROOMS:
        for file in sorted((folder / room).rglob("*.[ch]*")):
            if file.suffix not in (".cpp", ".h"):
                continue
            files += 1
            for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
                if compared.search(line) or ASKED.search(line):
                    faults.append(f"{file.relative_to(folder)}:{number}: knows a strategy by its name: {line.strip()}")
    print("\n".join(faults) if faults else f"{files} files know none of {', '.join(sorted(names))} by name")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
