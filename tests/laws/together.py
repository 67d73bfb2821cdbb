#!/usr/bin/python3
"""No source names what another of its group keeps to itself (servomill_together in the CMakeLists.txt files).

    together.py SOURCE_DIR

Sources of a group are compiled as one. Two types or constants of one name the compiler would refuse, but a second function
of one name is an overload, which may be called in place of the one that was meant.
"""
import itertools
import pathlib
import re
import sys

GROUP = re.compile(r"servomill_together\(\w+\s+([^)]*)\)")
FUNCTION = re.compile(r"^(?:\[\[\w+\]\] )?[\w:<>,&*\s]+?\b(\w+)\(")
NO_FUNCTION = ("namespace", "struct", "class", "enum", "using", "constexpr", "const ", "static_assert", "template", "return")


def lists_of_sources(root):
    return [path for room in ("plant", "controllers", "strategies", "sim", "tools") for path in (root / room).rglob("CMakeLists.txt")]


def code(text):
    """A source without its texts and comments."""
    text = re.sub(r'R"(\w*)\(.*?\)\1"', '""', text, flags=re.DOTALL)
    return re.sub(r'//[^\n]*|"(?:[^"\\\n]|\\.)*"', '""', text)


def own_functions(text):
    """Functions at the level of anonymous namespaces, which clang-format puts at the begin of a line."""
    inside, found = False, set()
    lines = text.splitlines()
    for number, line in enumerate(lines):
        if line == "namespace {":
            inside = True
        elif line.startswith("}  //") or line == "} ":
            inside = False
        elif inside and line[:1] not in ("", " ", "}", "#", "/") and not line.startswith(NO_FUNCTION):
            match = FUNCTION.match(" ".join(lines[number:number + 3]))
            if match:
                found.add(match[1])
    return found


def called(text):
    """Names in front of a parenthesis, but members and names of other namespaces."""
    return set(re.findall(r"(?<![\w.:>])(\w+)\s*\(", text))


def main():
    root = pathlib.Path(sys.argv[1])
    faults, groups = [], 0
    for file in lists_of_sources(root):
        for listed in GROUP.findall(file.read_text(encoding="utf-8")):
            groups += 1
            files = {name: file.parent / name for name in listed.split()}
            faults += [f"{file.relative_to(root)}: there is no {name}" for name, path in files.items() if not path.exists()]
            raw = {name: path.read_text(encoding="utf-8") for name, path in files.items() if path.exists()}
            own = {name: own_functions(text) for name, text in raw.items()}
            calls = {name: called(code(text)) for name, text in raw.items()}
            faults += [f"{file.parent.relative_to(root)}: {name} belongs to {one}, and {other} names it: rename it, or take one of them out of "
                       "their group" for one, other in itertools.permutations(raw, 2) for name in sorted(own[one] & calls[other])]
    print("\n".join(faults) or f"{groups} groups of sources, none names what another keeps to itself")
    return 1 if faults or not groups else 0


if __name__ == "__main__":
    sys.exit(main())
