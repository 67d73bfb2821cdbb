#!/usr/bin/python3
"""Every `servomill` command line of a README parses, and those of seconds do what they promise.

    readme_commands.py SOURCE_DIR SERVOMILL [--list]

A command line whose files all belong to the source tree is run, in an empty folder that shows the tree; the others, with
files of the reader's own or with placeholders, are parsed as far as their options. --list prints which is which.
"""
import itertools
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import time

import readmes

PATIENCE = 300.0  # s, for a command that takes less than 5 s on an idle machine; sanitizers take twenty times as long
SLOW = (  # take longer than 5 s: parsed only
    r"budget |converge |plan-calibration |sweep ",
    r"run scenarios/(iso|parts|precompensation)/",
    r"run scenarios/(standards/rotary|structure/experiment2|thermal/corrected_day)\b",
    r"bode scenarios/structure/bed\b",
)
PLACEHOLDER = re.compile(r"\b(SCENARIO|SECTION|PROGRAM|COMMAND|OUT|SHARD|FILE|KEY|NAME|FORMAT|FOLDER|PART|M\.toml|I/N|I-of-N|A-B)\b|\.\.\.|\.\*|\*")
INPUT = re.compile(r"\.(toml|ngc|cls|h5|tbl|var|csv|nc|mat|xml)$")


def command_lines(page):
    for first, language, lines in page.blocks:
        if language not in ("indented", ""):
            continue
        for number, line in enumerate(lines, first):
            found = re.match(r"\s*(?:\$ )?(?:build/\w+/)?servomill (\w.*)", line)
            if found:
                yield number, found[1]
    for number, code in page.code_in_sentences():
        found = re.match(r"servomill (\w.*)", code)
        if found and not found[1].startswith("COMMAND"):
            yield number, found[1]


def variants(line):
    """Words of the shell without comment; options in [] are all given, A|B gives one command line each."""
    line = re.sub(r"(^|\s)#(\s|$).*", "", line.replace("\\|", "|"))
    line = re.sub(r"\]\.\.\.|\]", " ", line).replace("[", " ")
    choices = [word.split("|") if re.fullmatch(r"[\w.-]+(\|[\w.-]+)+", word) else [word.removesuffix("...")] for word in shlex.split(line)]
    return [[word for word in words if word] for words in itertools.product(*choices)]


def is_of_the_tree(root, words):
    """True for a command without placeholders whose inputs are files of the tree."""
    inputs = [word for i, word in enumerate(words) if INPUT.search(word) and words[i - 1] not in ("-o", "--output", "--record")]
    if any(PLACEHOLDER.search(word) for word in words):
        return False
    return all((root / word).exists() for word in inputs) and (bool(inputs) or words[0] == "list")


def run(servomill, words, folder):
    return subprocess.run([servomill, *words], capture_output=True, text=True, timeout=PATIENCE, check=False, cwd=folder)


def fault_of(root, servomill, words, parsed_only):
    with tempfile.TemporaryDirectory() as folder:
        parsed = run(servomill, [*words, "--help"], folder)
        if parsed.returncode != 0 or not parsed.stdout.startswith("Usage"):
            return parsed.stderr.strip() or "prints no help"
        if parsed_only:
            return ""
        for name in ("scenarios", "tests"):
            (pathlib.Path(folder) / name).symlink_to(root / name)
        done = run(servomill, words, folder)
        return "" if done.returncode == 0 else f"status {done.returncode}: {done.stderr.strip()}"


def main():
    root, servomill = pathlib.Path(sys.argv[1]).resolve(), str(pathlib.Path(sys.argv[2]).resolve())
    faults, parsed, ran, seen = [], 0, 0, {}
    for page in readmes.pages(root):
        for number, words in ((number, words) for number, line in command_lines(page) for words in variants(line)):
            slow = any(re.match(pattern, " ".join(words)) for pattern in SLOW)
            parsed_only = slow or not is_of_the_tree(root, words)
            begin = time.monotonic()
            if tuple(words) not in seen:
                seen[tuple(words)] = fault_of(root, servomill, words, parsed_only)
                parsed, ran = parsed + 1, ran + (not parsed_only)
            if "--list" in sys.argv:
                print(f"{page.name}:{number}: {'parsed' if parsed_only else 'ran'} {time.monotonic() - begin:.2f} s: {' '.join(words)}")
            if seen[tuple(words)]:
                faults.append(f"{page.name}:{number}: servomill {' '.join(words)}: {seen[tuple(words)]}")
    assert parsed > 40 and ran > 5, f"{parsed} command lines and {ran} to run: the READMEs are written differently now"
    print("\n".join(faults) if faults else f"{parsed} command lines parse, {ran} of them ran")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
