#!/usr/bin/python3
"""How the sources are kept: length of files and functions, openings of comments, words of the glossary.

    house.py SOURCE_DIR             fails where a measure is worse than its floor in floors.toml
    house.py SOURCE_DIR --record    lowers the floors to what is measured; none is ever raised

Floors are for what is still to be mended. A file or word that is not listed there has none: files end at
MAX_FILE lines, words of WORDS do not occur.
"""
import pathlib
import re
import statistics
import sys
import tomllib

ROOMS = ("plant", "controllers", "strategies", "sim", "tools", "tests")
MAX_FILE = 400       # lines
MAX_FUNCTION = 60    # lines
OPENING = re.compile(r"^\s*///? (?:What|Where|Whether|Of|Those)\b")
# Words that the field has another term for, as they occur in code, comments, keys and messages.
WORDS = {
    "brought out": r"brought[ _]out",
    "believe": r"believ(?!er)\w*",
    "belief": r"belief\w*",
    "security block": r"security[ _]blocks?",
    "leftover": r"left[ _]?overs?",
    "quicken": r"quicken\w*",
    "lattice": r"lattice\w*",
    "posted": r"posted",
    "told": r"told",
}
# The first line of a function's body, as clang-format leaves it; the last is the brace below its start.
BODY = re.compile(r"^( *)(?!.*\b(?:if|for|while|switch|else|do|namespace|struct|class|enum|union|catch|try)\b)"
                  r"(?:.*\)(?: const)?(?: noexcept)?(?: override)?(?: -> [^{]+)?|.*[)}]) \{$")
ONE_LINE = re.compile(r"^(?:  )?(?! |if|for|while|switch|namespace|struct|class|enum|using|return|static_assert|constexpr auto)"
                      r".*\)(?: const)?(?: noexcept)?(?: override)?(?: : .*)? \{.*\}$")


def sources(folder):
    for room in ROOMS:
        for file in sorted((folder / room).rglob("*")):
            if file.suffix in (".cpp", ".h", ".py") and file.is_file():
                yield file.relative_to(folder).as_posix(), file.read_text(encoding="utf-8").splitlines()


def function_lengths(lines):
    """Lines of each function, from that of its opening brace to that of its closing one."""
    lengths, number = [], 0
    while number < len(lines):
        start = BODY.match(lines[number])
        if ONE_LINE.match(lines[number]):
            lengths.append(1)
        number += 1
        if not start or start.group(1) not in ("", "  "):
            continue
        end = next((i for i in range(number, len(lines)) if lines[i] in (start.group(1) + "}", start.group(1) + "};")),
                   None)
        if end is not None:
            lengths.append(end - number + 2)
            number = end
    return lengths


def measure(folder):
    """Files that are too long by their lines, and the counts of everything else by its name."""
    files, counts = {}, dict.fromkeys(("comment openings", "functions over 60 lines", *WORDS), 0)
    places = {name: [] for name in counts}
    lengths = []
    for name, lines in sources(folder):
        if len(lines) > MAX_FILE:
            files[name] = len(lines)
        if name.startswith("tests/laws/"):
            continue
        text = "\n".join(lines)
        found = {word: len(re.findall(rf"(?<![a-z]){pattern}(?![a-z])", text, re.IGNORECASE))
                 for word, pattern in WORDS.items()}
        if not name.endswith(".py"):
            found["comment openings"] = sum(1 for line in lines if OPENING.match(line))
            if not name.startswith("tests/"):
                own = function_lengths(lines)
                lengths += own
                found["functions over 60 lines"] = sum(1 for length in own if length > MAX_FUNCTION)
        for what, count in found.items():
            counts[what] += count
            if count:
                places[what].append(f"{name} ({count})")
    return files, counts, places, lengths


def record(file, floors, files, counts):
    """The floors, lowered to what is measured."""
    old_files = floors.get("files", {})
    out = ["# What is still to be mended (house.py): lines of long files, and counts. They may only fall.", "", "[files]"]
    out += [f'"{name}" = {min(lines, old_files.get(name, lines))}' for name, lines in sorted(files.items())
            if not floors or name in old_files]
    out += ["", "[counts]"]
    out += [f'"{name}" = {min(count, floors.get("counts", {}).get(name, count))}' for name, count in counts.items()]
    file.write_text("\n".join(out) + "\n", encoding="utf-8")


def main():
    folder = pathlib.Path(sys.argv[1])
    file = folder / "tests" / "laws" / "floors.toml"
    floors = tomllib.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    files, counts, places, lengths = measure(folder)
    if "--record" in sys.argv:
        record(file, floors, files, counts)
        return 0
    faults = []
    for name, lines in files.items():
        floor = floors["files"].get(name, MAX_FILE)
        if lines > floor:
            faults.append(f"{name}: {lines} lines; at most {floor}: split it by its seams")
    faults += [f"{name}: not longer than {MAX_FILE} lines any more; lower the floors with --record"
               for name in floors["files"] if name not in files]
    for what, count in counts.items():
        if count > floors["counts"].get(what, 0):
            faults.append(f"{what}: {count}, at most {floors['counts'].get(what, 0)}; git diff shows the new one "
                          f"among {len(places[what])} files: {', '.join(places[what][:5])} ...")
    print(f"files over {MAX_FILE} lines: {len(files)}, of these outside of tests: "
          f"{sum(1 for name in files if not name.startswith('tests/'))}")
    print(f"functions: {len(lengths)}, median {statistics.median(lengths):g} lines, 90th percentile "
          f"{statistics.quantiles(lengths, n=10)[-1]:g} lines")
    print("\n".join(f"{what}: {count}" for what, count in counts.items()))
    print(f"words of the glossary still to be replaced: {sum(counts[word] for word in WORDS)}")
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
