#!/usr/bin/python3
"""Runs servomill on wrong inputs and compares all it says with gallery.txt, which is for reading.

    gallery.py SERVOMILL            fails with the difference, if there is one
    gallery.py SERVOMILL --record   writes gallery.txt anew: read it line by line before you commit it

Every wrong input is the scenario, machine and program of this folder with one thing changed.
"""
import difflib
import os
import shutil
import subprocess
import sys
import tempfile

from wrong_inputs import WRONG_INPUTS

HERE = os.path.dirname(os.path.abspath(__file__))
GOLDEN = os.path.join(HERE, "gallery.txt")
BASE = ("scenario.toml", "machine.toml", "part.ngc")
TIME_LIMIT = 60  # s, for one command: far more than any takes


def changed_lines(name, before, after):
    """Every line that is new, with its number, and those that went without one in their place."""
    out = []
    for tag, i1, i2, j1, j2 in difflib.SequenceMatcher(None, before, after, autojunk=False).get_opcodes():
        if tag in ("replace", "insert"):
            out += [f"    {name}:{j + 1}: {after[j]}" for j in range(j1, j2)]
        elif tag == "delete":
            out += [f"    {name}: without {line}" for line in before[i1:i2] if line]
    return out


def make_folder(folder, wrong):
    """Fills a folder with the right input, then makes it wrong; returns what to show of that."""
    for name in BASE:
        shutil.copy(os.path.join(HERE, name), folder)
    shown = []
    for name, old, new in wrong.get("edit", ()):
        path = os.path.join(folder, name)
        with open(path, encoding="utf-8") as file:
            before = file.read()
        assert old in before, f"{name} has no '{old}'"
        after = before.replace(old, new, 1)
        with open(path, "w", encoding="utf-8") as file:
            file.write(after)
        shown += changed_lines(name, before.splitlines(), after.splitlines())
    for name, content in wrong.get("write", {}).items():
        data = content if isinstance(content, bytes) else content.encode()
        os.makedirs(os.path.dirname(os.path.join(folder, name)), exist_ok=True)
        with open(os.path.join(folder, name), "wb") as file:
            file.write(data)
        if name in wrong.get("right", ()):
            continue
        about = wrong.get("about", repr(content))
        shown.append(f"    {name}: {about[name] if isinstance(about, dict) else about}")
    for name in wrong.get("folders", ()):
        os.makedirs(os.path.join(folder, name))
        shown.append(f"    {name}: a folder")
    return shown


def say(program, folder, wrong):
    """The section of the gallery for one wrong input."""
    out = [f"# {wrong['title']}"] + make_folder(folder, wrong)
    for command in wrong["commands"]:
        result = subprocess.run(["/bin/sh", "-c", command.replace("servomill", f"'{program}'", 1)], cwd=folder,
                                capture_output=True, text=True, timeout=TIME_LIMIT, check=False)
        out.append(f"$ {command}")
        out += result.stderr.replace(folder + "/", "").splitlines()
        if wrong.get("stdout"):
            out += [f"> {line}" for line in result.stdout.splitlines()]
        out.append(f"(exit status {result.returncode})")
        assert "internal error" not in result.stderr, "\n".join(out)
        left = sorted(set(os.listdir(folder)) - set(BASE) - set(wrong.get("write", ())) - set(wrong.get("folders", ())))
        if left:
            out.append(f"(left behind: {', '.join(left)})")
    return "\n".join(out) + "\n"


def main():
    program = os.path.abspath(sys.argv[1])
    sections = []
    for wrong in WRONG_INPUTS:
        with tempfile.TemporaryDirectory() as folder:
            sections.append(say(program, folder, wrong))
    text = "\n".join(sections)
    if "--record" in sys.argv:
        with open(GOLDEN, "w", encoding="utf-8") as file:
            file.write(text)
        return 0
    with open(GOLDEN, encoding="utf-8") as file:
        golden = file.read()
    difference = list(difflib.unified_diff(golden.splitlines(), text.splitlines(), "gallery.txt", "now", lineterm=""))
    print("\n".join(difference) or f"{len(WRONG_INPUTS)} wrong inputs: all messages as recorded")
    return 1 if difference else 0


if __name__ == "__main__":
    sys.exit(main())
