#!/usr/bin/python3
"""Rooms include only what stands below them: tools -> sim -> {controllers, strategies} -> plant, and
the rooms of sim/ one another as listed, without circles; the library of a room is linked with those
and no others; what a room defines is in its namespace."""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
MAY_SEE = {
    "plant": ["plant/"],
    "controllers": ["controllers/", "plant/vocabulary/", "plant/kinematics/"],
    # strategies know the machine as the NC models it and the form of the models of errors, heat and structure
    "strategies": ["strategies/", "plant/vocabulary/", "plant/kinematics/", "plant/geometry/", "plant/heat/", "plant/structure/"],
    "sim": ["sim/", "controllers/", "strategies/", "plant/"],
    "tools": ["tools/", "sim/", "plant/vocabulary/"],
}
# Subrooms that see less than their room (readers that verify what others write know nothing of them), or more.
SUBROOM_MAY_SEE = {
    "controllers/dialects": ["controllers/dialects/", "plant/vocabulary/"],
    "controllers/tables": ["controllers/tables/", "plant/vocabulary/"],
    # declares strategies that are classes of Python, as a plug-in does
    "tools/python": ["tools/", "sim/", "strategies/", "plant/vocabulary/"],
}
# Rooms of sim/: which others each may include, beside plant/. Rooms stand in the order of their floors.
SIM_ROOMS = {
    "system": [],
    "config": ["system"],
    "numerics": [],
    "metrology": ["numerics"],
    "records": ["system"],
    "recordings": ["records", "system"],
    "readings": ["config", "recordings", "records"],
    "standards": ["config", "metrology", "numerics", "readings", "recordings", "system"],
    "responses": ["numerics", "recordings", "records", "system"],
    "model": ["controllers", "strategies", "config", "metrology", "numerics", "records", "standards"],
    "engine": ["controllers", "strategies", "model", "records", "system"],
    "fmu": ["controllers", "engine", "model"],
    "tables": ["controllers", "strategies", "model"],
    "frequency": ["engine", "model", "numerics", "records", "system"],
    "evaluation": ["engine", "metrology", "model", "records", "system"],
    "input": ["controllers", "strategies", "config", "evaluation", "metrology", "model", "standards", "system"],
    "identification": ["controllers", "config", "engine", "input", "model", "numerics", "recordings", "records", "system"],
    "calibration": ["config", "input", "metrology", "model", "numerics", "readings", "system"],
    "preparation": ["controllers", "strategies", "config", "engine", "evaluation", "frequency", "input", "metrology", "model",
                    "numerics", "readings", "recordings", "system"],
    "run": ["controllers", "strategies", "config", "engine", "evaluation", "frequency", "input", "metrology", "model",
            "preparation", "records", "standards", "system"],
    "sweep": ["config", "evaluation", "input", "model", "preparation", "records", "run", "system"],
    "programs": ["controllers", "strategies", "config", "evaluation", "input", "model", "preparation", "readings", "records", "run",
                 "sweep", "system"],
    "limits": ["controllers", "config", "engine", "model", "preparation", "programs", "recordings", "system"],
}
standing = ["plant", "controllers", "strategies", *SIM_ROOMS]
faults = [f"{room} may include {lower}, which stands no lower" for room, seen in SIM_ROOMS.items() for lower in seen
          if standing.index(lower) >= standing.index(room)]


def room_of(name):
    """plant, controllers, strategies or a room of sim/; none of other folders and of generated headers."""
    parts = name.split("/")
    return parts[1 if parts[0] == "sim" else 0] if len(parts) > (2 if parts[0] == "sim" else 1) else None


def may_include(name, included):
    """The law of the rooms of sim/."""
    own, other = room_of(name), room_of(included)
    return own not in SIM_ROOMS or other in (None, own, "plant", *SIM_ROOMS[own])


def linked_rooms(room):
    """What the library of a room of sim/ is linked with, by its CMakeLists.txt, but plant."""
    text = (root / "sim" / room / "CMakeLists.txt").read_text()
    found = re.search(rf"^servomill_room\({room} (?:COLD )?SEES ([a-z ]+) SOURCES$", text, re.MULTILINE)
    return set(found[1].split()) - {"plant"} if found else None


for room, seen in SIM_ROOMS.items():
    if linked_rooms(room) != set(seen):
        faults.append(f"sim/{room}/CMakeLists.txt: its library must be linked with {' '.join(seen)}")
folders = {path.name for path in (root / "sim").iterdir() if path.is_dir()}
faults += [f"sim/{folder}: is no room of the law" for folder in sorted(folders ^ set(SIM_ROOMS))]
for room in SIM_ROOMS:
    for path in sorted((root / "sim" / room).rglob("*")):
        if path.suffix in (".h", ".cpp") and f"\nnamespace servomill::sim::{room} {{" not in path.read_text():
            faults.append(f"{path.relative_to(root)}: is not in namespace servomill::sim::{room}")
files = 0
for room, allowed in MAY_SEE.items():
    for path in sorted((root / room).rglob("*")):
        if path.suffix not in (".h", ".cpp"):
            continue
        files += 1
        name = str(path.relative_to(root))
        sees = next((may for subroom, may in SUBROOM_MAY_SEE.items() if name.startswith(subroom + "/")), allowed)
        for number, line in enumerate(path.read_text().splitlines(), 1):
            found = re.match(r'\s*#include "([^"]+)"', line)
            if found and not (found[1].startswith(tuple(sees)) and may_include(name, found[1])):
                faults.append(f"{name}:{number}: may not see {found[1]}")
print("\n".join(faults) or f"{files} files, every include points downward")
sys.exit(bool(faults) or files == 0)
