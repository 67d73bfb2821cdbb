"""The READMEs of the source tree, their code blocks and the code within their sentences."""
import pathlib
import re

IGNORED = {"build", "out", ".git"}
FENCE = re.compile(r"^(\s*)```(\w*)\s*$")


def files(root):
    """All README.md of the tree, the top one first."""
    found = [file for file in sorted(root.rglob("README.md")) if not IGNORED & set(file.relative_to(root).parts)]
    return sorted(found, key=lambda file: len(file.relative_to(root).parts))


class Page:
    """Text of one README, taken apart."""

    def __init__(self, root, file):
        self.file = file
        self.name = file.relative_to(root).as_posix()
        self.prose = []   # (line number, text) outside of code blocks
        self.blocks = []  # (line number of the first line, language, lines)
        self._read(file.read_text(encoding="utf-8").splitlines())

    def _read(self, lines):
        self.length = len(lines)
        opened = None  # (first line, language, indentation, lines)
        for number, line in enumerate(lines, 1):
            fence = FENCE.match(line)
            if opened is None and fence:
                opened = (number + 1, fence[2], len(fence[1]), [])
            elif fence:
                self.blocks.append((opened[0], opened[1], opened[3]))
                opened = None
            elif opened is not None:
                opened[3].append(line[min(opened[2], len(line) - len(line.lstrip())):])
            elif line.startswith("    ") and not line.lstrip().startswith(("|", "- ")):
                self._indented(number, line[4:])
            else:
                self.prose.append((number, line))

    def _indented(self, number, line):
        if self.blocks and self.blocks[-1][1] == "indented" and self.blocks[-1][0] + len(self.blocks[-1][2]) == number:
            self.blocks[-1][2].append(line)
        else:
            self.blocks.append((number, "indented", [line]))

    def code_in_sentences(self):
        """(line number, code) between single backticks; code may go over the end of a line."""
        text = "\n".join(line for _, line in self.prose)
        numbers = [number for number, _ in self.prose]
        for match in re.finditer(r"(?<!`)`([^`]+)`(?!`)", text):
            yield numbers[text.count("\n", 0, match.start())], " ".join(match[1].split())


def pages(root):
    return [Page(root, file) for file in files(pathlib.Path(root))]
