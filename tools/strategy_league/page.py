"""The league as JSON, Markdown and one HTML page that needs nothing else."""
import html
import io

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from strategy_league import jobs  # noqa: E402

ALIKE = 1.05   # factor between errors that are taken for equal
SLOWER = 1.02  # factor of the cycle time that a shop would accept
OFFERS = ("nothing", "tables", "feedback hardware", "open NC")
COLUMNS = (("tip_rms", "tip rms, um"), ("tip_99", "tip 99 %, um"), ("tip_max", "tip largest, um"), ("axis_rms", "axis rms, urad"),
           ("contour_max", "contour error, um"), ("cycle_time", "cycle time, s"), ("jerk_rms", "jerk rms, m/s3"),
           ("current_rms", "current rms, A"), ("limits", "of limits, %"), ("blocks", "blocks"))
MARKERS = {"nothing": "o", "tables": "s", "feedback hardware": "^", "open NC": "D"}
COLOURS = {"nothing": "#0072b2", "tables": "#e69f00", "feedback hardware": "#009e73", "open NC": "#cc79a7"}


class Table:
    """Results by job, knowledge and strategy."""

    def __init__(self, league, results):
        self.league = league
        self.results = {(one["job"], one["knowledge"], one["strategy"]): one for one in results}
        self.jobs = [job for job in league.jobs if any(key[0] == job.name for key in self.results)]

    def spread(self, job, strategy):
        """99 % of the tip over all draws, ascending."""
        return sorted(one["tip_99"] for (name, knowledge, of), one in self.results.items()
                      if name == job.name and of == strategy.name and knowledge.startswith(jobs.DRAW) and "refused" not in one)

    def at(self, job, knowledge, strategy):
        known = knowledge if strategy.knows() else jobs.KNOWLEDGE[0]
        return self.results.get((job.name, known, strategy.name))

    def complete(self, job, knowledge):
        """(strategy, result) of those that ran."""
        pairs = [(one, self.at(job, knowledge, one)) for one in self.league.strategies_of(job)]
        return [(one, found) for one, found in pairs if found and "refused" not in found]

    def best(self, job, knowledge, offer, slower=None):
        """The strategy with the smallest 99 % of the tip among those that need no more than an NC offers, and take no more time
        than the program without any by the factor `slower`; ties: the first."""
        allowed = OFFERS[:OFFERS.index(offer) + 1]
        complete = self.complete(job, knowledge)
        plain = [found["cycle_time"] for one, found in complete if one.name == "none"]
        limit = plain[0] * slower if plain and slower else float("inf")
        able = [(found["tip_99"], n, one, found) for n, (one, found) in enumerate(complete)
                if one.needs in allowed and not one.measures and found["cycle_time"] <= limit]
        return min(able)[2:] if able else None

    def choices(self, slower=None):
        """{(knowledge, offer): {job name: (strategy name, tip 99 %)}}"""
        out = {}
        for knowledge in jobs.KNOWLEDGE:
            for offer in OFFERS:
                row = {}
                for job in self.jobs:
                    found = self.best(job, knowledge, offer, slower)
                    if found:
                        row[job.name] = (found[0].name, found[1]["tip_99"])
                out[knowledge, offer] = row
        return out

    def order_of_paper(self):
        """Lines on the paper's ordering, G-code better than feedback better than tables, by job with exact knowledge; within 5 % they are alike."""
        lines = []
        for job in self.jobs:
            found = {one.name: value["tip_99"] for one, value in self.complete(job, jobs.KNOWLEDGE[0])}
            names = [name for name in ("gcode", "feedback", "axis_tables") if name in found]
            if len(names) < 3:
                continue
            order = sorted(names, key=found.get)
            pairs = list(zip(names, names[1:]))
            if max(found[name] for name in names) <= ALIKE * min(found[name] for name in names):
                verdict = "all alike"
            else:
                verdict = "holds" if all(found[a] <= ALIKE * found[b] for a, b in pairs) else "turns"
            lines.append(f"{job.name}: {verdict}: " + ", ".join(f"{name} {found[name]:.3g} um" for name in order))
        return lines

    def pareto(self, job, knowledge):
        """Strategies that no other one beats in both the 99 % of the tip and the cycle time."""
        able = self.complete(job, knowledge)
        return [one for one, a in able
                if not any(b["tip_99"] <= a["tip_99"] and b["cycle_time"] <= a["cycle_time"]
                           and (b["tip_99"], b["cycle_time"]) != (a["tip_99"], a["cycle_time"]) for _, b in able)]


def cell(value):
    if value is None:
        return "-"
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"


def rows_of(table, job, knowledge):
    """Cells of the table of one job, a strategy each."""
    front = table.pareto(job, knowledge)
    for one in table.league.strategies_of(job):
        found = table.at(job, knowledge, one)
        if not found:
            continue
        needs = one.needs + (f"; measures {one.measures}" if one.measures else "")
        if "refused" in found:
            yield [one.name, needs, "refused: " + found["refused"]] + [""] * (len(COLUMNS) - 1)
            continue
        name = one.name + (" *" if one in front else "")
        yield [name, needs, *(cell(found.get(key)) for key, _ in COLUMNS)]


def headings():
    return ["strategy", "needs", *(title for _, title in COLUMNS)]


def choice_rows(table, slower=None):
    choices = table.choices(slower)
    for (knowledge, offer), row in choices.items():
        yield [knowledge, offer, *(f"{row[job.name][0]} ({row[job.name][1]:.3g} um)" if job.name in row else "-" for job in table.jobs)]


def spread_headings():
    return ["job", "strategy", "exact, um", "mean, um", "95 %, um", "worst, um", "draws"]


def spread_rows(table):
    """What draws of the knowledge do to the 99 % of the tip, a strategy and job each; with less than 40 draws the range."""
    for job in table.jobs:
        for strategy in table.league.strategies_of(job):
            values = table.spread(job, strategy)
            if not values:
                continue
            exact = table.at(job, jobs.KNOWLEDGE[0], strategy)
            low, high = np.percentile(values, (2.5, 97.5)) if len(values) >= 40 else (values[0], values[-1])
            yield [job.name, strategy.name, cell((exact or {}).get("tip_99")), cell(float(np.mean(values))), f"{cell(low)} to {cell(high)}",
                   cell(values[-1]), str(len(values))]


SPREAD = ("Draws of the knowledge: residual errors, drives, structure and heat known with normal deviates times the errors of \"errors and drives "
          "identified\", the same for every strategy. 99 % of the tip.")
NOTES = (
    "Every strategy runs the same program on the same machine with the same knowledge. Judged are all rows of feed motion in the named sections, at equal arc length. "
    "Of limits is the largest velocity, acceleration or jerk that path and offset together ask an axis for. A star marks strategies that no other one beats in both the 99 % of the tip and the cycle time.",
    "What is chosen below is the smallest 99 % of the tip among the strategies that need no more than the NC offers and measure nothing beside. "
    "Programs (nothing), tables, feedback hardware and an open NC are offered in this order, each with those before.")


def markdown(table, cutoffs, version):
    out = ["# League of strategies", "", f"servomill {version}", "", *(f"{text}\n" for text in NOTES),
           "Cutoffs by the tuning program: " + (", ".join(f"{name} {value} Hz" for name, value in cutoffs.items()) or "-") + ".", "",
           "## Which strategy to choose", ""]
    head = ["knowledge", "the NC offers", *(job.name for job in table.jobs)]
    out += lines_of(head, choice_rows(table))
    out += ["", "## The same within 2 % of the cycle time", "", *lines_of(head, choice_rows(table, SLOWER))]
    out += ["", "## The order of paper [G]: G-code, feedback, tables", "", *(f"- {line}" for line in table.order_of_paper())]
    rows = list(spread_rows(table))
    if rows:
        out += ["", "## Sensitivity to the knowledge", "", SPREAD, "", *lines_of(spread_headings(), rows)]
    for job in table.jobs:
        out += ["", f"## {job.title}"]
        for knowledge in jobs.KNOWLEDGE:
            out += ["", f"### {knowledge}", "", *lines_of(headings(), rows_of(table, job, knowledge))]
    return "\n".join(out) + "\n"


def lines_of(head, rows):
    return ["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(row) + " |" for row in rows)]


STYLE = """body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 1500px; padding: 0 1em; color: #222; background: #fff }
table { border-collapse: collapse; margin: 1em 0; font-size: 13px } th, td { border: 1px solid #ccc; padding: 3px 8px; text-align: right }
th { background: #f2f2f2; text-align: left } td:first-child, td:nth-child(2) { text-align: left } summary { cursor: pointer; font-weight: 600 }
@media (prefers-color-scheme: dark) { body { background: #1b1b1b; color: #ddd } th { background: #333 } th, td { border-color: #555 } svg { background: #fff } }"""


def page(table, cutoffs, version):
    def html_table(head, rows):
        body = "".join("<tr>" + "".join(f"<td>{html.escape(one)}</td>" for one in row) + "</tr>" for row in rows)
        return "<table><tr>" + "".join(f"<th>{html.escape(one)}</th>" for one in head) + f"</tr>{body}</table>"

    head = ["knowledge", "the NC offers", *(job.name for job in table.jobs)]
    parts = ["<!doctype html><html lang=en><meta charset=utf-8><title>League of strategies</title>", f"<style>{STYLE}</style>",
             "<h1>League of strategies</h1>", f"<p>servomill {html.escape(version)}</p>", *(f"<p>{text}</p>" for text in NOTES),
             "<p>Cutoffs by the tuning program: " + ", ".join(f"{name} {value} Hz" for name, value in cutoffs.items()) + "</p>",
             "<h2>Which strategy to choose</h2>",
             html_table(head, choice_rows(table)), "<h2>The same within 2 % of the cycle time</h2>",
             html_table(head, choice_rows(table, SLOWER)),
             "<h2>The order of paper [G]: G-code, feedback, tables</h2><ul>",
             *(f"<li>{html.escape(line)}</li>" for line in table.order_of_paper()), "</ul>"]
    rows = list(spread_rows(table))
    if rows:
        parts += ["<h2>Sensitivity to the knowledge</h2>", f"<p>{html.escape(SPREAD)}</p>", html_table(spread_headings(), rows)]
    for job in table.jobs:
        parts.append(f"<h2>{html.escape(job.title)}</h2>{figure(table, job)}")
        for knowledge in jobs.KNOWLEDGE:
            parts.append(f"<details><summary>{knowledge}</summary>{html_table(headings(), rows_of(table, job, knowledge))}</details>")
    return "\n".join(parts) + "\n"


def neighbours(complete):
    """Names of strategies whose points in a figure touch, with one place for all of them."""
    groups = []
    for one, found in sorted(complete, key=lambda pair: pair[1]["tip_99"]):
        x, y = found["cycle_time"], found["tip_99"]
        for names, (at_x, at_y) in groups:
            if abs(x / at_x - 1.0) < 0.02 and abs(y / at_y - 1.0) < 0.35:
                names.append(one.name)
                break
        else:
            groups.append(([one.name], (x, y)))
    return groups


def figure(table, job):
    """Cycle time and 99 % of the tip of every strategy, for each kind of knowledge; the Pareto front joined."""
    plt.rcParams.update({"svg.hashsalt": "league", "font.size": 9})
    drawn, axes = plt.subplots(1, len(jobs.KNOWLEDGE), figsize=(14, 5), sharey=True, layout="constrained")
    for axis, knowledge in zip(axes, jobs.KNOWLEDGE):
        front = sorted((table.at(job, knowledge, one)["cycle_time"], table.at(job, knowledge, one)["tip_99"])
                       for one in table.pareto(job, knowledge))
        axis.step([x for x, _ in front], [y for _, y in front], where="post", color="#999", linewidth=1, zorder=1)
        for one, found in table.complete(job, knowledge):
            axis.plot(found["cycle_time"], found["tip_99"], MARKERS[one.needs], color=COLOURS[one.needs], markersize=5, zorder=2)
        for names, (x, y) in neighbours(table.complete(job, knowledge)):
            axis.annotate("\n".join(names), (x, y), xytext=(5, 0), textcoords="offset points", fontsize=6, va="center", linespacing=0.95)
        axis.set(title=knowledge, xlabel="cycle time, s", yscale="log")
        axis.margins(x=0.25)
        axis.grid(True, alpha=0.3)
    axes[0].set_ylabel("99 % of the tip deviation, um")
    for needs, colour in COLOURS.items():
        axes[-1].plot([], [], MARKERS[needs], color=colour, label=f"needs {needs}")
    axes[-1].legend(fontsize=7, loc="best")
    text = io.StringIO()
    drawn.savefig(text, format="svg", metadata={"Date": None})
    plt.close(drawn)
    return text.getvalue()[text.getvalue().index("<svg"):]
