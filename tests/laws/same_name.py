#!/usr/bin/python3
"""Every source has a test of its own name, or stands in same_name.toml with the tests that cover it.

    same_name.py SOURCE_DIR
"""
import pathlib
import sys
import tomllib

ROOMS = ("plant", "controllers", "strategies", "sim", "tools")


def main():
    folder = pathlib.Path(sys.argv[1])
    tests = {file.name.removesuffix("_test.cpp") for file in (folder / "tests").rglob("*_test.cpp")}
    sources = {file.relative_to(folder).with_suffix("").as_posix()
               for room in ROOMS for file in (folder / room).rglob("*.cpp")}
    without = {source for source in sources if source.split("/")[-1] not in tests}
    groups = tomllib.loads((folder / "tests" / "laws" / "same_name.toml").read_text(encoding="utf-8"))["covered"]
    listed = {}
    faults = []
    for group in groups:
        faults += [f"same_name.toml: no test tests/{test}" for test in group["by"]
                   if not (folder / "tests" / test).is_file()]
        if not group["reason"]:
            faults.append(f"same_name.toml: {group['folder']}: no reason")
        for name in group["sources"]:
            listed[f"{group['folder']}/{name}"] = group
    faults += [f"{source}.cpp: has no test {source.split('/')[-1]}_test.cpp; write one, or name in "
               "tests/laws/same_name.toml the tests that cover it" for source in sorted(without - listed.keys())]
    faults += [f"same_name.toml: {source}: there is no such source; strike it off"
               for source in sorted(listed.keys() - sources)]
    faults += [f"same_name.toml: {source}: has a test of its own name; strike it off"
               for source in sorted((listed.keys() & sources) - without)]
    print(f"sources with a test of the same name: {len(sources) - len(without)} of {len(sources)}")
    print(f"sources listed with the tests that cover them: {len(listed)}")
    print(f"sources neither tested by name nor listed: {len(without - listed.keys())}")
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
