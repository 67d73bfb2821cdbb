"""One look for all figures: colours by strategy, lines that survive a black-and-white print."""
import dataclasses
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.colors
import matplotlib.pyplot as plt
import numpy as np

DPI = 150
BLACK, BLUE, PURPLE, LIGHT_PURPLE, RED = "#000000", "#0072b2", "#6a1b9a", "#b07cd8", "#d62718"
GREY, PALE = "#6b6b6b", "#e9e9e9"
DASH, DASH_DOT, DOT = (0, (5, 2)), (0, (7, 2, 1.5, 2)), (0, (1.5, 1.5))


@dataclasses.dataclass(frozen=True)
class Look:
    label: str
    colour: str
    line: object = "-"
    marker: str = "o"
    width: float = 1.7


# Colour, line and marker of a strategy. A case takes the look of its own name where it stands here,
# else that of the strategy that acts last.
LOOKS = {
    "nominal": Look("nominal", BLACK, "-", "o", 1.4),
    "none": Look("uncompensated", BLACK, "-", "o", 1.4),
    "table": Look("table", BLUE, "-", "s"),
    "feedback": Look("feedback", PURPLE, "-", "o"),
    "feedback_lead": Look("feedback with lead", LIGHT_PURPLE, DASH, "^"),
    "gcode": Look("G-code", RED, DASH_DOT, "D"),
    "generated": Look("generated", RED, "-", "D"),
    "compensated": Look("compensated", PURPLE, "-", "o"),
    "compensated_lead": Look("compensated with lead", LIGHT_PURPLE, DASH, "^"),
}
IMPOSED = Look("imposed curve", BLACK, "-", "", 3.0)   # lies under the cases
SPARE = ["#00876c", "#b8860b", "#4d4d4d", "#8c564b"]   # strategies that have no colour yet


def look_of(result, case, shown=None):
    """The look of a case of a result file. Of several cases with one strategy the first has the
    look of the strategy, the next are paler and have other lines.
    shown: the cases of the figure, where it leaves some out: those count for nothing"""
    look = _strategy_look(result, case)
    names = [one.get("name") for one in result.scenario.get("case", [])]
    earlier = names[:names.index(case)] if case in names else []
    twins = sum(_strategy_look(result, name).colour == look.colour
                for name in earlier if shown is None or name in shown)
    if twins == 0:
        return look
    rgb = np.array(matplotlib.colors.to_rgb(look.colour))
    paler = 1.0 - (1.0 - rgb) * 0.65 ** min(twins, 3)
    return dataclasses.replace(look, colour=matplotlib.colors.to_hex(paler),
                               line=[DASH, DOT, DASH_DOT][(twins - 1) % 3])


def _strategy_look(result, case):
    if case in LOOKS:
        return LOOKS[case]
    acting = [one for one in result.strategies(case) if one.get("type") != "none"]
    kind = acting[-1].get("type", "") if acting else "none"
    if kind == "feedback" and acting[-1].get("extrapolation_time_ms", 0) not in (0, 0.0):
        kind = "feedback_lead"
    label = spoken(case)
    if kind in LOOKS:
        return dataclasses.replace(LOOKS[kind], label=label)
    # a strategy without a colour of its own gets the same spare one in every file
    return Look(label, SPARE[sum(kind.encode()) % len(SPARE)], DOT, "v")


def spoken(case):
    """The name of a case as legends have it."""
    return re.sub(r"\bgcode\b", "G-code", case.replace("_", " "))


def set_up():
    """Fonts and frames that stay legible when a README shows the figure at half its size."""
    plt.rcParams.update({
        "font.family": "DejaVu Sans", "font.size": 11, "axes.titlesize": 11.5,
        "axes.titlelocation": "left", "axes.labelsize": 11, "legend.fontsize": 10.5,
        "legend.frameon": False, "axes.spines.top": False, "axes.spines.right": False,
        "axes.grid": True, "grid.color": "#dddddd", "grid.linewidth": 0.7, "axes.axisbelow": True,
        "figure.constrained_layout.use": True, "figure.dpi": DPI, "savefig.dpi": DPI,
        "svg.hashsalt": "servomill", "svg.fonttype": "none", "pdf.fonttype": 42,
        "lines.dash_capstyle": "butt", "path.simplify_threshold": 0.2,
    })


def line(axes, x, y, look, **more):
    """Draws a curve in the look of a case."""
    settings = {"color": look.colour, "linestyle": look.line, "linewidth": look.width, **more}
    return axes.plot(x, y, **settings)[0]


def panels(heights, size, columns=1, widths=None, legend_lines=1, **more):
    """A figure with a strip for the legend above its grid of axes: (figure, strip, axes[][])."""
    figure = plt.figure(figsize=size)
    strip_height = 0.26 * legend_lines / size[1] * sum(heights)
    grid = figure.add_gridspec(len(heights) + 1, columns, width_ratios=widths,
                               height_ratios=[strip_height, *heights])
    strip = figure.add_subplot(grid[0, :])
    strip.axis("off")
    axes = [[figure.add_subplot(grid[row + 1, column], **more) for column in range(columns)]
            for row in range(len(heights))]
    return figure, strip, axes


def paler(colour, share):
    """A colour on its way to white, of which it stays well clear."""
    rgb = np.array(matplotlib.colors.to_rgb(colour))
    return matplotlib.colors.to_hex(1.0 - (1.0 - rgb) * (1.0 - 0.75 * share))


def plain_log_ticks(axis):
    """Ticks of a logarithmic axis as numbers, 2 and 5 between the powers of ten where there is room."""
    axis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1.0, 2.0, 5.0), numticks=8))
    axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(matplotlib.ticker.NullFormatter())


def face(look):
    """Inside of a marker: white for the dashed looks, so that what lies below shows."""
    return "white" if look.line == DASH else look.colour


MISSED = Look("met nothing", GREY, DASH, "X")   # where the CMM probed and found no surface


def missed(axes, x, y, look, **more):
    """Marks places at which a case has no value, so that they are not taken for good ones."""
    axes.plot(x, y, linestyle="none", marker=MISSED.marker, markersize=8, markerfacecolor="white",
              markeredgecolor=look.colour, markeredgewidth=1.3, zorder=4, **more)


EDGE = 0.04   # of the height of the axes: where such marks stand under a curve


def missed_below(axes, x, look):
    """The same at the lower edge of axes, for a quantity over x."""
    missed(axes, x, np.full(len(x), EDGE), look, transform=axes.get_xaxis_transform())


LETTER, MARGIN = 0.082, 0.3   # inches: of a legend, about; beside the axes


def legend_shape(looks, width):
    """Columns and lines of a legend of these looks in a figure of that width (inches)."""
    entry = 0.65 + LETTER * max(len(look.label) for look in looks)
    columns = min(len(looks), 6, max(1, int((width - MARGIN) / entry)))
    return columns, -(-len(looks) // columns)


def legend(strip, looks, lines=True, points=False, columns=6):
    """One legend for the whole figure in the strip above the axes, where it covers no data."""
    handles = []
    for look in looks:
        with_line = lines or not look.marker
        handles.append(plt.Line2D([], [], color=look.colour, linewidth=look.width, markersize=6,
                                  linestyle=look.line if with_line else "none",
                                  marker=look.marker if points else "",
                                  markerfacecolor=face(look), label=look.label))
    box = strip.legend(handles=handles, loc="center left", bbox_to_anchor=(-0.01, 0.5), ncol=columns,
                       handlelength=2.6 if lines else 1.6, columnspacing=1.3, borderpad=0,
                       handletextpad=0.6)
    box.set_in_layout(False)


def headline(figure, text):
    """The message of the figure."""
    room = 72.0 * 0.98 * figure.get_figwidth()       # points; a bold letter is about 0.62 em wide
    figure.suptitle(text, fontsize=min(13.0, room / (0.62 * len(text))), fontweight="bold", x=0.01, ha="left")


def number(value):
    """A number for a title: three digits at most, no trailing noise."""
    size = abs(value)
    return f"{value:.0f}" if size >= 100 else f"{value:.1f}" if size >= 1 else f"{value:.2f}"


SAMPLES_A_PIECE = 8   # at least, of noisy_line


def noisy_line(axes, x, y, look, buckets=300, **more):
    """Draws a curve that may carry noise: its mean over short pieces in the look of the case, so
    that dashes stay dashes, and a pale band from the lowest to the highest sample."""
    buckets = min(buckets, len(y) // SAMPLES_A_PIECE)
    if buckets > 1:
        starts = np.linspace(0, len(y), buckets, endpoint=False).astype(int)
        count = np.diff(np.append(starts, len(y)))
        middle, mean = (np.add.reduceat(v, starts) / count for v in (x, y))
        axes.fill_between(middle, np.minimum.reduceat(y, starts), np.maximum.reduceat(y, starts),
                          color=look.colour, alpha=0.25, linewidth=0,
                          zorder=more.get("zorder", 2) - 0.05)
        x, y = (np.concatenate([v[:1], m, v[-1:]]) for v, m in ((x, middle), (y, mean)))
    return line(axes, x, y, look, **more)


def thin(x, y, buckets=1500):
    """Fewer points for drawing; each bucket keeps its lowest and highest, so peaks stay, and gaps (NaN)."""
    if len(y) <= 4 * buckets:
        return x, y
    size = len(y) // buckets
    cut = size * (len(y) // size)
    blocks = np.asarray(y[:cut], float).reshape(-1, size)
    blank = np.isnan(blocks)
    start = np.arange(len(blocks)) * size
    least, greatest = np.where(blank, np.inf, blocks).argmin(1), np.where(blank, -np.inf, blocks).argmax(1)
    keep = np.unique(np.concatenate([start + least, start + greatest, np.flatnonzero(np.isnan(y)), [len(y) - 1]]))
    return x[keep], y[keep]


def band(x, least, greatest, buckets=1500):
    """Fewer points of a band for drawing: of each bucket the lowest and the highest value."""
    if len(x) <= 4 * buckets:
        return x, least, greatest
    starts = np.arange(0, len(x), len(x) // buckets)
    blank = np.logical_and.reduceat(np.isnan(least), starts)
    low, high = np.fmin.reduceat(least, starts), np.fmax.reduceat(greatest, starts)
    return x[starts], np.where(blank, np.nan, low), np.where(blank, np.nan, high)
