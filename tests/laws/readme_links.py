#!/usr/bin/python3
"""Links and quotations of the READMEs hold, and README.md stays a page of at most 200 lines.

    readme_links.py SOURCE_DIR
"""
import pathlib
import re
import sys

import readmes

MAX_LINES = 200  # of README.md
LINK = re.compile(r"\]\(([^)\s]+)\)")
TO_BE_WRITTEN = {"strategies/setpoint.h", "strategies/setpoint.cpp", "tests/strategies/setpoint_test.cpp"}  # by the reader of a page
QUOTED = re.compile(r"<!-- (\S+) -->")


def anchors(text):
    """Anchors of the headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def faults_of_links(page):
    for number, line in page.prose:
        for target in LINK.findall(line):
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            file = page.file.parent / path if path else page.file
            if not file.exists():
                yield f"{page.name}:{number}: no such file: {target}"
            elif anchor and anchor not in anchors(file.read_text(encoding="utf-8")):
                yield f"{page.name}:{number}: no such heading: {target}"


def faults_of_paths(root, page):
    """Files named in sentences exist, from the root or from the folder of the page."""
    known = re.compile(r"^(?:\.\./|[\w-]+/)+[\w.*-]+\.(?:h|cpp|py|toml|md|ngc|cls|txt)$")
    for number, code in page.code_in_sentences():
        if not known.match(code) or code in TO_BE_WRITTEN or code.startswith("out/") or re.search(r"\*|NAME|TOPIC", code):
            continue
        if not (root / code).exists() and not (page.file.parent / code).exists():
            yield f"{page.name}:{number}: no such file: {code}"


def faults_of_quotations(root, page):
    """A block of code after <!-- FILE --> stands in that file, line for line."""
    for number, line in page.prose:
        for name in QUOTED.findall(line):
            quoted = [lines for first, language, lines in page.blocks if first == number + 2 and language == "cpp"]
            text = (root / name).read_text(encoding="utf-8")
            if len(quoted) != 1 or "\n".join(quoted[0]) not in text:
                yield f"{page.name}:{number}: the code differs from {name}"


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    faults, links, quotations = [], 0, 0
    for page in readmes.pages(root):
        faults += [*faults_of_links(page), *faults_of_paths(root, page), *faults_of_quotations(root, page)]
        links += sum(len(LINK.findall(line)) for _, line in page.prose)
        quotations += sum(len(QUOTED.findall(line)) for _, line in page.prose)
        if page.name == "README.md" and page.length > MAX_LINES:
            faults.append(f"README.md: {page.length} lines; must be <= {MAX_LINES}: move sentences to the READMEs of the rooms")
    assert links > 40 and quotations > 0, "the READMEs are written differently now"
    print("\n".join(faults) if faults else f"{links} links and {quotations} quotations hold")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
