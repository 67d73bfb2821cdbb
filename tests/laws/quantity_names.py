#!/usr/bin/python3
"""No file compares the name of a quantity: all ask its entry what it takes and how it is evaluated.

    quantity_names.py SOURCE_DIR
"""
import pathlib
import re
import sys

ROOMS = ("plant", "controllers", "strategies", "sim", "tools/servomill")
# Recorded signals have names of their own, below the quantities; some are called alike.
OF_SIGNALS = "sim/records/"
ENTRY = re.compile(r'\{\.name = (?:"(\w+)"|(k\w+)),')
CONSTANT = re.compile(r'constexpr std::string_view (k\w+) = "(\w+)";')


def names_in(text):
    """Names of the quantities that a file lists."""
    constants = dict(CONSTANT.findall(text))
    return {name or constants[constant] for name, constant in ENTRY.findall(text)}


def main():
    folder = pathlib.Path(sys.argv[1])
    names = set()
    for file in (folder / "sim" / "evaluation").glob("*_quantities.cpp"):
        names |= names_in(file.read_text(encoding="utf-8"))
    assert {"imposed_error_residual", "blocks", "circular_error", "location_error", "distortion"} <= names, names
    literal = '"(?:' + "|".join(sorted(names)) + ')"'
    compared = re.compile(rf"[!=]=\s*{literal}|{literal}\s*[!=]=|(?:find_quantity|quantity_entry)\({literal}")
    faults, files = [], 0
    for room in ROOMS:
        for file in sorted((folder / room).rglob("*.[ch]*")):
            name = file.relative_to(folder).as_posix()
            if file.suffix not in (".cpp", ".h") or name.startswith(OF_SIGNALS):
                continue
            files += 1
            for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
                if compared.search(line):
                    faults.append(f"{name}:{number}: compares the name of a quantity: {line.strip()}")
    print("\n".join(faults) if faults else f"{files} files compare none of {len(names)} names of quantities")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
