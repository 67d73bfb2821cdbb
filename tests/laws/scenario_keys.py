#!/usr/bin/python3
"""`servomill list keys` lists every key that a scenario or machine of the tree, or an example of a README, uses.

    scenario_keys.py SOURCE_DIR SERVOMILL
"""
import pathlib
import re
import subprocess
import sys
import tomllib

import readmes

ERROR = [(r"E[XYZ]0[XYZABC]$", "EX0C"), (r"E[ABC]0[XYZABC]$", "EC0Y"), (r"E[XYZABC][XYZABC]$", "EXX")]
EXAMPLE = "setpoint"  # the strategy that strategies/README.md builds
NAMES = {"errors": "NAME", "program.subroutines": "NAME", "program.parameters": "#101", "machine.axis": "X", "machine.inertial_deflection": "XX", "machine.heat.surroundings": "NAME",
         "machine.heat.body": "NAME", "machine.heat.body.NAME.conductance_W_per_K": "NAME", "machine.heat.source": "NAME", "machine.heat.sensor": "NAME"}


def listed_keys(servomill, *section):
    """{section: {key: what stands in brackets after it}}"""
    text = subprocess.run([servomill, "list", "keys", *section], capture_output=True, text=True, check=True).stdout
    out, keys = {}, {}
    for line in text.splitlines():
        if line.startswith("["):
            keys = out.setdefault(line[1:-1].removeprefix("top"), {})
        elif line:
            key, rest = line.split(maxsplit=1)
            keys[key] = rest[rest.rindex(" [") + 2:-1] if " [" in rest else rest
    return out


def listed_name(section, key):
    """The name under which a key is listed that has a name, a letter or an error of its own."""
    if section in NAMES:
        return NAMES[section]
    if section == "errors.NAME":
        return next((name for pattern, name in ERROR if re.match(pattern, key)), key)
    if section.endswith(("work_offset", "program.start", "test.at", "test.from", "test.to", "day.place.at")):
        return re.sub("^[XYZ]_mm$", "X_mm", re.sub("^[ABC]_deg$", "C_deg", key))
    if section.endswith(("recording.measured", "recording.reference")):
        return re.sub("^[XYZABC]$", "X", key)
    return key


def below(section, key):
    """Section of the keys below a key."""
    path = f"{section}.{key}" if section else key
    path = re.sub(r"^(case\.)?machine_override|^case\.strategy\.machine(?=\.|$)", "machine", path)
    path = path.replace("machine.axis.X.screw.lead_error", "errors.NAME.EXX")
    path = re.sub(r"machine\.heat\.(body|sensor)\.NAME\.errors_per_K", "errors.NAME", path)
    return re.sub(r"^machine\.errors", "errors", path)


def unknown_keys(table, listed, section=""):
    """Dotted names of the keys of a table that are not listed."""
    for written, value in table.items():
        key = listed_name(section, written)
        if section == "case.strategy":
            known = table.get("type") == EXAMPLE or key in {**listed[section], **listed.get(f"case.strategy.{table.get('type')}", {})}
        else:
            known = key in listed.get(section, {})
        if not known:
            yield f"{section}.{written}".lstrip(".")
            continue
        if section == "" and key == "sweep":
            continue  # its keys are those of the scenario: the reader of sweeps knows them
        for item in value if isinstance(value, list) else [value]:
            if isinstance(item, dict):
                yield from unknown_keys(item, listed, below(section, key))


def section_of(folder, file, table):
    """A machine file, or one laid over it, has the keys of the section machine at its top, a scenario its own."""
    return "machine" if file.parent == folder / "scenarios/machines" or file.name == "machine.toml" else section_of_example(table)


def is_experiment(table):
    """Experiments of `servomill identify` and contributions to an uncertainty have keys of their own (sim/identification/README.md,
    sim/standards/README.md); their readers refuse others."""
    return {"loop", "recording"} <= set(table) or "resolution_um" in table


def is_readings(table):
    """A file of readings, or a part of one, has keys of its own (sim/readings/README.md); its reader refuses others."""
    return bool({"group", "adjustment", "artefact"} & set(table))


def section_of_example(table):
    return "machine" if {"structure", "friction_model", "identified", "axis", "structural_mode", "inertial_deflection", "heat"} & set(table) else ""


def main():
    root, listed = pathlib.Path(sys.argv[1]).resolve(), listed_keys(sys.argv[2])
    faults, files, examples = [], 0, 0
    for file in sorted((root / "scenarios").rglob("*.toml")):
        table = tomllib.loads(file.read_text(encoding="utf-8"))
        files += 1
        if is_experiment(table) or is_readings(table):
            continue
        faults += [f"{file.relative_to(root)}: {key} is not listed by servomill list keys"
                   for key in unknown_keys(table, listed, section_of(root, file, table))]
    for page in readmes.pages(root):
        for first, language, lines in page.blocks:
            if language == "toml":
                examples += 1
                table = tomllib.loads("\n".join(lines))
                if is_experiment(table) or is_readings(table):
                    continue
                faults += [f"{page.name}:{first}: {key} is not listed by servomill list keys"
                           for key in unknown_keys(table, listed, section_of_example(table))]
    assert files > 30 and examples > 5, f"{files} files, {examples} examples: the tree is laid out differently now"
    print("\n".join(faults) if faults else f"every key of {files} files and {examples} examples is listed")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
