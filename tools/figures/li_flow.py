"""Figure 3.1 of X. Li (2024): how a nonlinear error is modelled and compensated, as servomill does it."""
from figures import style

BOXES = {   # centre, text, colour of the module
    "locations": (0.16, 0.84, "cutter locations P, U\n(tool position file)", style.GREY),
    "between": (0.16, 0.60, "interpolate P and U\nlinearly between two", style.GREY),
    "posts": (0.16, 0.36, "inverse kinematics\n(equation 3.1): posts S", style.GREY),
    "amplitude": (0.50, 0.84, "post of the middle: amplitude\na = S_mid − (S_0 + S_1) / 2", style.BLUE),
    "model": (0.50, 0.60, "model of the error\nε(t) = a sin πt   (3.3)", style.BLUE),
    "moved": (0.50, 0.36, "largest ε over the tolerance?\nS_comp = S − ε   (3.4)", style.BLUE),
    "paths": (0.84, 0.36, "paths with and without,\nstraight line", style.RED),
    "left": (0.84, 0.60, "what is left of the error", style.RED),
}
MODULES = ((0.16, "post-processing", style.GREY), (0.50, "model and compensation", style.BLUE),
           (0.84, "calculation and comparison", style.RED))
HALF_HEIGHT, HALF_WIDTH = 0.054, 0.100   # of a box, about


def draw(_):
    figure = style.plt.figure(figsize=(10.2, 4.4))
    ax = figure.add_subplot()
    ax.axis("off")
    ax.set_xlim(0, 1)
    ax.set_ylim(0.1, 1.0)
    for x, y, text, colour in BOXES.values():
        ax.text(x, y, text, ha="center", va="center", fontsize=10.5, zorder=3,
                bbox={"boxstyle": "round,pad=0.5", "facecolor": "white", "edgecolor": colour, "linewidth": 1.8})
    for x, name, colour in MODULES:
        ax.text(x, 0.99, name, ha="center", va="center", color=colour, fontweight="bold")
    for first, second in (("locations", "between"), ("between", "posts"), ("amplitude", "model"), ("model", "moved"),
                          ("paths", "left")):
        sign = 1.0 if BOXES[second][1] < BOXES[first][1] else -1.0
        _arrow(ax, [(BOXES[first][0], BOXES[first][1] - sign * HALF_HEIGHT),
                  (BOXES[second][0], BOXES[second][1] + sign * HALF_HEIGHT)])
    x, y = BOXES["posts"][:2]
    top = BOXES["amplitude"][1]
    _arrow(ax, [(x + HALF_WIDTH - 0.02, y), (0.31, y), (0.31, top), (BOXES["amplitude"][0] - HALF_WIDTH - 0.02, top)])
    _arrow(ax, [(BOXES["moved"][0] + HALF_WIDTH, y), (BOXES["paths"][0] - HALF_WIDTH, y)])
    _arrow(ax, [(x, y - HALF_HEIGHT), (x, 0.16), (BOXES["paths"][0], 0.16), (BOXES["paths"][0], y - HALF_HEIGHT)])
    ax.text(0.50, 0.17, "S, uncompensated", ha="center", va="bottom", color=style.GREY)
    style.headline(figure, "Nonlinear error of rotary axes: from cutter locations to compensated posts")
    return figure


def _arrow(ax, corners):
    xs, ys = zip(*corners[:-1])
    if len(corners) > 2:
        ax.plot(xs, ys, color=style.BLACK, linewidth=1.3, zorder=1)
    ax.annotate("", xy=corners[-1], xytext=corners[-2], zorder=1,
                arrowprops={"arrowstyle": "-|>", "color": style.BLACK, "linewidth": 1.3, "shrinkA": 0, "shrinkB": 0})
