"""Figure 3.1 of X. Li (2024): how a nonlinear error is modelled and compensated, as servomill does it."""
from figures import style

BOXES = (   # x, y, text, colour of the module
    (0.16, 0.86, "cutter locations P, U\n(tool position file)", style.GREY),
    (0.16, 0.62, "interpolate P and U\nlinearly between two", style.GREY),
    (0.16, 0.38, "inverse kinematics\n(equation 3.1): posts S", style.GREY),
    (0.50, 0.62, "post of the middle: amplitude\na = S_mid − (S_0 + S_1) / 2", style.BLUE),
    (0.50, 0.38, "model of the error\nε(t) = a sin πt   (3.3)", style.BLUE),
    (0.50, 0.14, "largest ε over the tolerance?\nS_comp = S − ε   (3.4)", style.BLUE),
    (0.84, 0.38, "path with and without,\nstraight path", style.RED),
    (0.84, 0.14, "what is left of the error", style.RED),
)
ARROWS = ((0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (2, 6), (5, 7), (6, 7))
MODULES = ((0.16, "post-processing", style.GREY), (0.50, "model and compensation", style.BLUE),
           (0.84, "calculation and comparison", style.RED))


def draw(_):
    figure = style.plt.figure(figsize=(10.2, 4.6))
    ax = figure.add_subplot()
    ax.axis("off")
    ax.set_xlim(0, 1)
    ax.set_ylim(0, 1.0)
    boxes = [ax.text(x, y, text, ha="center", va="center", fontsize=10.5, zorder=3,
                     bbox={"boxstyle": "round,pad=0.5", "facecolor": "white", "edgecolor": colour, "linewidth": 1.8})
             for x, y, text, colour in BOXES]
    for x, name, colour in MODULES:
        ax.text(x, 1.0, name, ha="center", va="center", color=colour, fontweight="bold")
    figure.canvas.draw()
    for first, second in ARROWS:
        ax.annotate("", xy=BOXES[second][:2], xytext=BOXES[first][:2], zorder=1,
                    arrowprops={"arrowstyle": "-|>", "color": style.BLACK, "linewidth": 1.3,
                                "patchA": boxes[first].get_bbox_patch(), "patchB": boxes[second].get_bbox_patch(),
                                "shrinkA": 2, "shrinkB": 2})
    style.headline(figure, "Nonlinear error of rotary axes: from cutter locations to compensated posts")
    return figure
