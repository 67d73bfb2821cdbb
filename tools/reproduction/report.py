"""The comparison as text: one line a row, as Markdown and as one HTML page that needs nothing else."""
import base64
import dataclasses
import html
import math

from reproduction import rows as vocabulary
from reproduction import verdicts
from reproduction.pictures import NOT_DRAWN
from reproduction.values import Value


@dataclasses.dataclass(frozen=True)
class Line:
    """A row with what was found for it."""
    row: vocabulary.Row
    value: Value
    verdict: str

    def here(self):
        if self.value.number is None:
            return f"missing: {self.value.reason}" if self.verdict == verdicts.MISSING else "-"
        return quantity(self.value.number, self.row.unit, self._digits())

    def _digits(self):
        # as many as show whether the value is within its tolerance
        number, tolerance = abs(self.value.number), self.row.tolerance
        if not tolerance or not number:
            return 3
        return max(3, math.ceil(math.log10(number)) - math.floor(math.log10(tolerance)))


def judged(row, value):
    return Line(row, value, verdicts.verdict(row, value.number))


def quantity(number, unit, digits=3):
    """A number with so many digits, or four above 1000, and its unit."""
    text = f"{number:.{max(4, digits)}g}" if abs(number) >= 1000 else f"{number:.{digits}g}"
    return text if unit == "1" else f"{text} {unit}"


def accepted(row):
    """What the row's limits are, for the reader."""
    if row.lacks:
        return ""
    low, high = verdicts.limits(row)
    if row.meaning == "below":
        return f"magnitude <= {high:g}"
    if row.meaning == "above":
        return f">= {low:g}"
    return f"{low:.5g} to {high:.5g}" if low < high else f"{low:.5g}"


def summary(lines):
    """{verdict: {basis: count}} of the verdicts that occur, in their order; a series counts once a verdict and basis."""
    counts = {}
    for verdict in verdicts.ALL:
        having = {(line.row.part_of or line.row.id, line.row.basis) for line in lines if line.verdict == verdict}
        bases = [basis for _, basis in having]
        if bases:
            counts[verdict] = {basis: bases.count(basis) for basis in vocabulary.BASES if basis in bases}
    return counts


def summary_lines(lines):
    return [f"{verdict}: {sum(bases.values())} (" + ", ".join(f"{n} {basis}" for basis, n in bases.items()) + ")"
            for verdict, bases in summary(lines).items()]


def _groups(lines):
    names = dict.fromkeys(line.row.group for line in lines)
    return {name: [line for line in lines if line.row.group == name] for name in names}


INTRODUCTION = (
    "Every number of Guevel et al. 2025 [G] and of Li 2024 [L] beside ours. Verdicts are computed from tolerances that are "
    "stored with their reasons in tools/reproduction/rows.toml.",
    "Kinds: identified numbers fixed a parameter and prove nothing by themselves; predicted ones followed; chosen ones follow "
    "from an input that the paper does not give; what is built in the model contains, so that it could not say otherwise; "
    "given ones are the paper's own inputs and what follows from its numbers alone. Only predictions are called reproduced; "
    "within bound are predictions that the paper gives a limit for, and assumed ones. A table of values counts once a basis in "
    "the summary.")


def markdown(lines, drawn, begun):
    """The whole report; figures are referred to as files."""
    out = ["# Both papers, reproduced", "", f"servomill {begun}", "", *(f"{text}\n" for text in INTRODUCTION), "## Summary", ""]
    out += [f"- {one}" for one in summary_lines(lines)]
    for name, group in _groups(lines).items():
        out += ["", f"## {name}", "", "| quantity | paper | here | accepted | basis | verdict | why they differ |",
                "|---|---|---|---|---|---|---|"]
        out += ["| " + " | ".join(_cell(text) for text in _columns(line)) + " |" for line in group]
    out += ["", "## Figures", ""]
    for one in drawn:
        out += [f"### {_title(one.picture)}", "", _caption(one.picture), ""]
        picture = one.file and f"![{_title(one.picture)}]({one.file.parent.name}/{one.file.name})"
        out += [picture or f"Not drawn: {one.reason}.", ""]
    return "\n".join([*out, *NOT_DRAWN]) + "\n"


def _cell(text):
    return text.replace("|", "\\|").replace("<", "&lt;").replace(">", "&gt;")


def _columns(line):
    row = line.row
    why = row.why if not row.lacks else f"{row.lacks}; {row.why}"
    return [row.quantity, row.printed, line.here(), accepted(row), row.basis, line.verdict, why]


def _title(picture):
    what = "figure " if picture.number[0].isdigit() else ""
    return f"[{picture.paper}] {what}{picture.number}"


def _caption(picture):
    return f"In the paper: {picture.shows}" + (f" Here: {picture.here}" if picture.here else "")


STYLE = """
body { font: 15px/1.45 "DejaVu Sans", Verdana, sans-serif; color: #111; max-width: 1280px; margin: 1.5em auto; padding: 0 1em; }
table { border-collapse: collapse; width: 100%; font-size: 13px; margin: .4em 0 1.6em; }
th, td { text-align: left; vertical-align: top; padding: .3em .55em; border-bottom: 1px solid #ddd; }
th { border-bottom: 2px solid #888; } .number { white-space: nowrap; } small { color: #666; } td.why { color: #444; min-width: 20em; }
.verdict { white-space: nowrap; font-weight: bold; padding: .05em .4em; border-radius: .3em; }
.reproduced { background: #d3ecd4; } .within-bound { background: #e3eed0; } .as-given, .as-identified, .built-in { background: #e6eef6; } .not-reproduced { background: #f6cfc9; }
.not-explained { background: #fbdcb0; } .cannot-be-compared { background: #e4e4e4; } .no-value-here { background: #f3b5d5; }
figure { margin: 1.2em 0 2.2em; } figure img { max-width: 100%; } figcaption { color: #333; max-width: 62em; }
nav a { margin-right: 1em; } h2 { margin-top: 1.8em; } .missing { background: #f3f3f3; padding: 1em; }
"""


def _reason(row):
    return "" if row.lacks else f"<br><small>{html.escape(row.tolerance_reason)}</small>"


def _marked(verdict):
    return f'<span class="verdict {verdict.replace(" ", "-")}">{html.escape(verdict)}</span>'


def page(lines, drawn, begun):
    """One HTML page with its pictures inside."""
    out = ['<!DOCTYPE html>', '<html lang="en"><head><meta charset="utf-8">', "<title>Both papers, reproduced</title>",
           f"<style>{STYLE}</style></head><body>", "<h1>Both papers, reproduced</h1>", f"<p>servomill {html.escape(begun)}</p>"]
    out += [f"<p>{html.escape(text)}</p>" for text in INTRODUCTION]
    out += ["<nav>" + "".join(f'<a href="#g{n}">{html.escape(name)}</a>' for n, name in enumerate(_groups(lines))) +
            '<a href="#figures">Figures</a></nav>', "<h2>Summary</h2>", "<table><tr><th>verdict</th>" +
            "".join(f"<th>{basis}</th>" for basis in vocabulary.BASES) + "</tr>"]
    for verdict, bases in summary(lines).items():
        out.append(f"<tr><td>{_marked(verdict)}</td>" +
                   "".join(f"<td>{bases.get(basis, '')}</td>" for basis in vocabulary.BASES) + "</tr>")
    out.append("</table>")
    for number, (name, group) in enumerate(_groups(lines).items()):
        out += [f'<h2 id="g{number}">{html.escape(name)}</h2>',
                "<table><tr><th>quantity</th><th>paper</th><th>here</th><th>accepted</th><th>basis</th><th>verdict</th>"
                "<th>why they differ</th></tr>"]
        for line in group:
            what, printed, here, limits, basis, verdict, why = _columns(line)
            missing = line.value.number is None
            out.append(f'<tr id="{html.escape(line.row.id)}"><td>{html.escape(what)}</td><td>{html.escape(printed)}</td>'
                       f'<td{"" if missing else " class=number"}>{html.escape(here)}</td>'
                       f'<td><span class="number">{html.escape(limits)}</span>{_reason(line.row)}</td>'
                       f'<td>{basis}</td><td>{_marked(verdict)}</td><td class="why">{html.escape(why)}</td></tr>')
        out.append("</table>")
    out.append('<h2 id="figures">Figures</h2>')
    for one in drawn:
        title = html.escape(_title(one.picture))
        if one.file:
            data = base64.b64encode(one.file.read_bytes()).decode()
            out.append(f'<figure><img alt="{title}" src="data:image/png;base64,{data}">')
        else:
            out.append(f'<figure><p class="missing">Not drawn: {html.escape(one.reason)}.</p>')
        out.append(f"<figcaption><b>{title}.</b> {html.escape(_caption(one.picture))}</figcaption></figure>")
    out += [f"<p>{html.escape(text)}</p>" for text in NOT_DRAWN]
    out.append("</body></html>")
    return "\n".join(out) + "\n"
