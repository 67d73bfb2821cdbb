#!/usr/bin/python3
"""Every option and name that a README sets in code is known to the sources.

    readme_keys.py SOURCE_DIR SERVOMILL

Options are those of the program's help and of the scripts in tools/. A name is a word of snake_case, or one that ends with a
unit: it must stand in the sources. Keys of TOML examples: scenario_keys.py.
"""
import pathlib
import re
import subprocess
import sys

import readmes

COMMANDS = ("run", "compare", "sweep", "merge", "budget", "converge", "bode", "step", "tune", "fmu", "lobes", "table", "compensate", "check", "canon",
            "post", "recording", "calibrate", "plan-calibration", "evaluate", "identify", "response", "time", "machine", "limits", "view", "list")
FOREIGN = {  # options of other programs that READMEs show
    "preset", "build", "install", "prefix", "complete", "sshlogin", "workdir", "time", "partition", "cpus-per-task", "requeue", "nodes", "mem", "array", "export", "target",
}
OPTION = re.compile(r"(?<![\w-])--([a-z][\w-]*\w)(?![\w-])")
SYMBOL = re.compile(r"^[A-Za-z]{1,3}_[A-Z]{2}$|_[A-Z]_")  # of a formula; a name with a placeholder
NAME = re.compile(r"^[A-Za-z]+(?:_[A-Za-z0-9]+)+$")
SOURCES = ("sim", "strategies", "controllers", "plant", "tools", "tests", "scenarios")
TYPES = (".cpp", ".h", ".py", ".toml", ".txt", ".json", "", ".sbatch", ".sh", ".ngc", ".in")


def known_options(root, servomill):
    helps = [subprocess.run([servomill, command, "--help"], capture_output=True, text=True, check=True).stdout for command in COMMANDS]
    scripts = [file for file in (root / "tools").rglob("*") if file.is_file() and file.suffix in ("", ".py", ".sh", ".sbatch")]
    scripts += (root / "tests/cli/gallery").glob("*.py")
    texts = helps + [file.read_text(encoding="utf-8") for file in scripts]
    return {option for text in texts for option in OPTION.findall(text)} | FOREIGN


def words_of_sources(root):
    words = set()
    for folder in SOURCES:
        for file in (root / folder).rglob("*"):
            if file.is_file() and file.suffix in TYPES and file.name != "README.md" and file.stat().st_size < 1_000_000:
                words |= set(re.findall(r"\w+", file.read_text(encoding="utf-8", errors="replace")))
                words |= {file.stem, file.parent.name}
    return words


def faults_of_sentences(page, options, words):
    for number, code in page.code_in_sentences():
        for option in OPTION.findall(code):
            if option not in options:
                yield f"{page.name}:{number}: no program has the option --{option}"
        name = re.match(r"^[\w.]+", code)
        for part in (name[0].split(".") if name and not re.search(r"[/<>]", code) else []):
            if NAME.match(part) and part not in words and not SYMBOL.search(part):
                yield f"{page.name}:{number}: {part} is not known"


def faults_of_lines(page, options):
    for first, language, lines in page.blocks:
        for number, line in enumerate(lines, first):
            is_command = language in ("indented", "") and re.search(r"\b(servomill|tools)\b", line)
            for option in OPTION.findall(line) if is_command else []:
                if option not in options:
                    yield f"{page.name}:{number}: no program has the option --{option}"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    options, words = known_options(root, sys.argv[2]), words_of_sources(root)
    faults = []
    for page in readmes.pages(root):
        faults += [*faults_of_sentences(page, options, words), *faults_of_lines(page, options)]
    assert len(options) > 80, f"{len(options)} options: the sources are written differently now"
    print("\n".join(faults) if faults else f"all options and names are known ({len(options)} options)")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
