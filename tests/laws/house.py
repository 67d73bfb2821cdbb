#!/usr/bin/python3
"""How the sources are kept: length of files and functions, openings of comments, words and names of the glossary.

    house.py SOURCE_DIR SERVOMILL   fails where a measure is worse than its floor in floors.toml, and at every name that the
                                    glossary has replaced: keys, options and quantities as SERVOMILL lists them
    house.py SOURCE_DIR --record    lowers the floors to what is measured; none is ever raised

Floors are for what is still to be mended. A file or word that is not listed there has none: files end at
MAX_FILE lines, words of WORDS do not occur.
"""
import pathlib
import re
import statistics
import sys
import tomllib

import old_names

ROOMS = ("plant", "controllers", "strategies", "sim", "tools", "tests")
MAX_FILE = 400       # lines
MAX_FUNCTION = 60    # lines
OPENING = re.compile(r"^\s*///? (?:What|Where|Whether|Of|Those)\b")
PAGES = (".md", ".toml", ".ngc")  # read for words only
# Words that the field has another term for, as they occur in code, comments, keys, messages and pages.
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
    "set point": r"set[ -]points?(?! of)",
    "raw part": r"raw[ _]parts?",
    "part zero": r"part[ _-]zero",
    "laid on": r"laid (?:on|over)",
    "kMost, kLeast": r"k(?:most|least)\w*",
    "straight kernel": r"straight[ _]?kernel\w*",
    "bring out": r"br(?:ing|ings|ought)[ _]out",
}
# Pages that may have them, with the reason.
WORD_EXCEPTIONS = {
    "CHANGELOG.md": "names what was replaced",
    "scenarios/statements/saturation.toml": "quotes paper [G]: security blocks",
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


def pages(folder):
    """READMEs, scenarios and programs: texts in which the words of the glossary count, too."""
    for file in sorted([*folder.glob("*.md"), *(one for room in (*ROOMS, "scenarios") for one in (folder / room).rglob("*"))]):
        name = file.relative_to(folder).as_posix()
        if file.suffix in PAGES and not name.startswith(("tests/laws/", "tests/conformance/programs/", "tests/fuzz/corpus/")):
            yield name, file.read_text(encoding="utf-8", errors="replace")


def words_in(text):
    return {word: len(re.findall(rf"(?<![a-z]){pattern}(?![a-z])", text, re.IGNORECASE)) for word, pattern in WORDS.items()}


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
        found = words_in(text)
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
    for name, text in pages(folder):
        for what, count in words_in(text).items() if name not in WORD_EXCEPTIONS else ():
            counts[what] += count
            if count:
                places[what].append(f"{name} ({count})")
    return files, counts, places, lengths


def names_in(folder, servomill):
    """Names that the glossary has replaced: in quotes in the sources, of files, and as the program lists them."""
    out = []
    for name, lines in sources(folder):
        if not name.startswith("tests/"):
            out += old_names.old_literals(name, "\n".join(lines))
    all_files = [one.relative_to(folder).as_posix() for room in (*ROOMS, "scenarios") for one in (folder / room).rglob("*")]
    out += old_names.old_files(name for name in sorted(all_files) if name.endswith((".cpp", ".h", ".py", ".toml", ".ngc")))
    return out + old_names.old_names(servomill)


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
    faults += names_in(folder, sys.argv[2])
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
