#!/usr/bin/python3
"""How the sources of the page are kept.

    sources.py SOURCE_DIR    fails where the lock file or a source names a server of packages, a package has no fixed
                             version or no checksum, a source is too long, or one asks for anything on the network
"""
import json
import pathlib
import re
import sys

MAX_FILE = 400       # lines, as tests/laws/house.py
MAX_LINE = 150       # characters
SERVER = re.compile(r"https?://[^\s\"']*(?:registry|npm)|\bregistry\.[a-z]|\bnpm\w*\.(?:org|com)\b", re.IGNORECASE)
ADDRESS = re.compile(r"https?://(?!www\.w3\.org/)")   # names of SVG are no addresses
EXACT = re.compile(r"\d+\.\d+\.\d+")
UPWARD = {"core": (), "worker": ("core",), "data": ("core", "worker")}   # what a folder may import from


def lock_faults(folder):
    lock = json.loads((folder / "package-lock.json").read_text(encoding="utf-8"))
    package = json.loads((folder / "package.json").read_text(encoding="utf-8"))
    for name, one in lock["packages"].items():
        if name and "resolved" in one:
            yield f"package-lock.json: {name}: has the address of a server; .npmrc leaves it out"
        if name and "integrity" not in one:
            yield f"package-lock.json: {name}: has no checksum"
    for kind in ("dependencies", "devDependencies"):
        for name, version in package.get(kind, {}).items():
            if not EXACT.fullmatch(version):
                yield f"package.json: {name}: {version} is not one version"
            if lock["packages"][""][kind].get(name) != version:
                yield f"package-lock.json: {name}: is not that of package.json"


def source_faults(root):
    files = [*(root / "tools" / "page").rglob("*"), *(root / "tests" / "page").rglob("*"), root / "tools" / "view"]
    for file in sorted(one for one in files if one.is_file() and one.suffix not in (".png", ".pyc")):
        name, text = file.relative_to(root).as_posix(), file.read_text(encoding="utf-8")
        if SERVER.search(text) and file.name != "sources.py":
            yield f"{name}: names a server of packages: {SERVER.search(text)[0]}"
        if file.suffix not in (".js", ".mjs", ".css", ".html"):
            continue
        lines = text.splitlines()
        if len(lines) > MAX_FILE:
            yield f"{name}: {len(lines)} lines; at most {MAX_FILE}: split it by its seams"
        for number, line in enumerate(lines, 1):
            if len(line) > MAX_LINE and file.suffix in (".js", ".mjs"):
                yield f"{name}:{number}: {len(line)} characters; at most {MAX_LINE}"
            if "tools/page" in name and ADDRESS.search(line):
                yield f"{name}:{number}: asks for something on the network"
        yield from import_faults(root, file, text)


def import_faults(root, file, text):
    """Calculation knows no reader, the reader no page."""
    source = root / "tools" / "page" / "src"
    if source not in file.parents:
        return
    room = file.relative_to(source).parts[0]
    for target in re.findall(r'from "\.\./(\w+)/', text):
        if room in UPWARD and target not in UPWARD[room]:
            yield f"{file.relative_to(root)}: imports from {target}/, which {room}/ does not know"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    faults = [*lock_faults(root / "tools" / "page"), *lock_faults(root / "tests" / "h5web"), *source_faults(root)]
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
