"""A compensated program: its path with the correction magnified, and the correction along it."""
import numpy as np

from figures import style

AXES = (("X", style.BLUE, "-"), ("Y", style.RED, style.DASH_DOT), ("Z", style.PURPLE, style.DASH))
PROGRAMMED = style.Look("programmed", style.GREY, "-", "", 1.2)
CORRECTED = style.Look("corrected, magnified", style.RED, "-", "", 1.4)
POINTS = style.Look("ends of blocks", style.BLACK, "-", "o")
SHARE = 0.05      # of the path's size: what the largest correction is magnified to
MOST_POINTS = 400  # ends of blocks that can be distinguished


def draw(result):
    """Plan view, correction over the length of the path."""
    path = result.compensate
    looks = [style.Look(f"correction of {name}", colour, line) for name, colour, line in AXES]
    figure, strip, grid = style.panels([1.75, 1.0], (9.0, 9.6), legend_lines=2)
    style.legend(strip, [PROGRAMMED, CORRECTED] + looks, columns=3)
    gain = _plan(grid[0][0], path)
    _along(grid[1][0], path)
    d = path["correction"]
    worst = np.argmax(np.linalg.norm(d, axis=1)) if len(d) else 0
    size = np.linalg.norm(d[worst]) if len(d) else 0.0
    style.headline(figure, f"{result.title}: corrected by up to {style.number(size)} µm, "
                           f"magnified {style.number(gain)} times")
    return figure


def _feeds(path):
    """Pieces of the path without rapids, as slices."""
    rapid = path["rapid"] != 0.0
    edges = np.flatnonzero(np.diff(rapid.astype(int)))
    starts, ends = np.r_[0, edges + 1], np.r_[edges, len(rapid) - 1] + 1
    # a piece begins where the rapid before it ends
    return [slice(max(0, a - 1), b) for a, b in zip(starts, ends) if not rapid[a]]


def _plan(ax, path):
    p, d = path["position"], path["correction"]
    size = np.ptp(p[:, :2], axis=0).max() if len(p) else 1.0
    largest = np.linalg.norm(d[:, :2], axis=1).max() if len(d) else 0.0
    gain = SHARE * size / (1e-3 * largest) if largest > 0.0 else 1.0
    gain = 10.0 ** np.floor(np.log10(gain)) * np.floor(gain / 10.0 ** np.floor(np.log10(gain)))
    shown = p[:, :2] + gain * 1e-3 * d[:, :2]
    for piece in _feeds(path):
        style.line(ax, p[piece, 0], p[piece, 1], PROGRAMMED)
        style.line(ax, shown[piece, 0], shown[piece, 1], CORRECTED)
    ends = np.flatnonzero((path["block_end"] != 0.0) & (path["rapid"] == 0.0))
    if len(ends) <= MOST_POINTS:
        ax.plot(shown[ends, 0], shown[ends, 1], ".", color=CORRECTED.colour, markersize=4)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel("X of the machine, mm")
    ax.set_ylabel("Y of the machine, mm")
    dots = "; dots: ends of blocks" if len(ends) <= MOST_POINTS else ""
    ax.set_title(f"seen from above{dots}")
    return gain


def _along(ax, path):
    s = path["s"] * 1e-3
    for column, (_, colour, line) in enumerate(AXES):
        for piece in _feeds(path):
            x, y = style.thin(s[piece], path["correction"][piece, column])
            ax.plot(x, y, color=colour, linestyle=line, linewidth=1.5)
    ax.axhline(0.0, color=style.BLACK, linewidth=0.8)
    ax.set_xlabel("length of the programmed path, m (gaps: rapids)")
    ax.set_ylabel("correction, µm")
