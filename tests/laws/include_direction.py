#!/usr/bin/python3
"""Rooms include only what stands below them: tools -> sim -> {controllers, strategies} -> plant."""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
MAY_SEE = {
    "plant": ["plant/"],
    "controllers": ["controllers/", "plant/vocabulary/", "plant/kinematics/"],
    # strategies know the machine as the NC believes it to be and the form of the error model
    "strategies": ["strategies/", "plant/vocabulary/", "plant/kinematics/", "plant/geometry/"],
    "sim": ["sim/", "controllers/", "strategies/", "plant/"],
    "tools": ["tools/", "sim/", "plant/vocabulary/"],
}
# Subrooms that see less than their room: readers that verify what others write know nothing of them.
SUBROOM_MAY_SEE = {
    "controllers/dialects": ["controllers/dialects/", "plant/vocabulary/"],
    "controllers/tables": ["controllers/tables/", "plant/vocabulary/"],
}
faults, files = [], 0
for room, allowed in MAY_SEE.items():
    for path in sorted((root / room).rglob("*")):
        if path.suffix not in (".h", ".cpp"):
            continue
        files += 1
        name = str(path.relative_to(root))
        sees = next((may for subroom, may in SUBROOM_MAY_SEE.items() if name.startswith(subroom + "/")), allowed)
        for number, line in enumerate(path.read_text().splitlines(), 1):
            found = re.match(r'\s*#include "([^"]+)"', line)
            if found and not found[1].startswith(tuple(sees)):
                faults.append(f"{name}:{number}: may not see {found[1]}")
print("\n".join(faults) or f"{files} files, every include points downward")
sys.exit(bool(faults) or files == 0)
