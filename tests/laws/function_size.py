#!/usr/bin/python3
"""Size and complexity of the functions in these sources: clang-tidy with function_size.clang-tidy.

    function_size.py SOURCE_DIR BUILD_DIR SOURCE...

BUILD_DIR holds compile_commands.json. Most of the time goes into headers: sources of one group (servomill_together in the
CMakeLists.txt files) are read as one, those that stand in no group alone.
"""
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

import together

CONFIG = pathlib.Path(__file__).parent / "function_size.clang-tidy"


def groups_of(root, sources):
    """The sources in lists that are read as one."""
    group = {}
    for file in together.lists_of_sources(root):
        for listed in together.GROUP.findall(file.read_text(encoding="utf-8")):
            names = [file.parent / name for name in listed.split()]
            group |= {name: names[0] for name in names}
    found = {}
    for source in sources:
        found.setdefault(group.get(source, source), []).append(source)
    return list(found.values())


def flags_of(command):
    """Definitions, paths and the standard: what the compiler needs to read a source."""
    words, flags = shlex.split(command), []
    for word, following in zip(words, [*words[1:], ""]):
        if re.match(r"-[DI]|-std=|-m", word):
            flags.append(word)
        elif word == "-isystem":
            flags += [word, following]
    return flags


def flags_of_all(commands, sources):
    """Those of all sources of a group: some have definitions of their own."""
    flags = flags_of(commands[sources[0]])
    for source in sources[1:]:
        flags += [one for one in flags_of(commands[source]) if one.startswith("-D") and one not in flags]
    return flags


def faults_of(build, flags, number, sources):
    """What clang-tidy says of sources that are read as one; none where it says nothing."""
    one = build / "function_size" / f"{number}.cpp"
    one.write_text("".join(f'#include "{source}"\n' for source in sources), encoding="utf-8")
    done = subprocess.run(["clang-tidy", "--quiet", f"--config-file={CONFIG}", one, "--", *flags], capture_output=True, text=True, check=False)
    return "" if done.returncode == 0 else done.stdout + done.stderr


def main():
    root, build = (pathlib.Path(name).resolve() for name in sys.argv[1:3])
    sources = [pathlib.Path(name).resolve() for name in sys.argv[3:]]
    with open(build / "compile_commands.json", encoding="utf-8") as file:
        commands = {pathlib.Path(one["file"]): one["command"] for one in json.load(file)}
    unknown = [str(source) for source in sources if source not in commands]
    assert not unknown, f"not compiled: {', '.join(unknown)}"
    (build / "function_size").mkdir(exist_ok=True)
    groups = groups_of(root, sources)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        faults = list(pool.map(lambda number, group: faults_of(build, flags_of_all(commands, group), number, group), range(len(groups)), groups))
    print("\n".join(filter(None, faults)) or f"{len(sources)} sources, read as {len(groups)}: no function is too long or too complex")
    return 1 if any(faults) else 0


if __name__ == "__main__":
    sys.exit(main())
