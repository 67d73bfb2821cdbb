#!/usr/bin/python3
"""Rooms include only what stands below them: tools -> sim -> {controllers, strategies} -> plant, and
the rooms of sim/ one another as listed, without circles."""
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
# Rooms of sim/: which others each may include. Rooms stand in the order of their floors.
SIM_ROOMS = {
    "system": [],
    "config": ["system"],
    "metrology": [],
    "records": ["system"],
    "model": ["config", "metrology", "records"],
    "engine": ["model", "records", "system"],
    "tables": ["model"],
    "frequency": ["engine", "model", "records"],
    "evaluation": ["engine", "metrology", "model", "records", "system"],
    "input": ["config", "evaluation", "metrology", "model", "system"],
    "preparation": ["engine", "evaluation", "frequency", "input", "metrology", "model", "system"],
    "run": ["config", "engine", "evaluation", "frequency", "input", "model", "preparation", "records", "system"],
    "sweep": ["config", "evaluation", "input", "model", "preparation", "records", "run", "system"],
    "programs": ["config", "evaluation", "input", "model", "preparation", "run", "sweep", "system"],
}
# Upward includes that are still to be cut; the list may only shrink.
KNOWN = set()
standing = list(SIM_ROOMS)
faults = [f"{room} may include {lower}, which stands no lower" for room, seen in SIM_ROOMS.items() for lower in seen
          if standing.index(lower) >= standing.index(room)]


def sim_room(name):
    """The room of sim/ that a path is in; none of other folders and of generated headers."""
    parts = name.split("/")
    return parts[1] if parts[0] == "sim" and len(parts) > 2 else None


def may_include(name, included):
    """The law of the rooms of sim/."""
    own, other = sim_room(name), sim_room(included)
    if own is None or other is None or own == other or other in SIM_ROOMS[own]:
        return True
    needed.add((name, included))
    return (name, included) in KNOWN


files, needed = 0, set()
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
faults += [f"{name}: no longer includes {included}; take it off the list" for name, included in sorted(KNOWN - needed)]
print("\n".join(faults) or f"{files} files, every include points downward")
sys.exit(bool(faults) or files == 0)
