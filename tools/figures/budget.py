"""Error budgets: what each cause has of the largest residual, as bars."""
import matplotlib.pyplot as plt
import numpy as np

from figures import style

REMAINDER, WHOLE = style.GREY, style.BLACK
COLUMNS = 2
ADDS_UP = 5e-4  # of the residual: nothing that a number here would show


def draw(budgets):
    """A panel for each budget: signed parts at the place of the largest residual, rms beside."""
    rows = -(-len(budgets.budgets) // COLUMNS)
    columns = min(COLUMNS, len(budgets.budgets))
    most = max(len(_acting(one)) for one in budgets.budgets)
    figure, axes = plt.subplots(rows, columns, squeeze=False,
                                figsize=(6.2 * columns, 0.9 + rows * (1.3 + 0.27 * (most + 2))))
    for ax, one in zip(axes.flat, budgets.budgets):
        _panel(ax, one, budgets)
    for ax in list(axes.flat)[len(budgets.budgets):]:
        ax.axis("off")
    figure.suptitle(_message(budgets), x=0.01, ha="left", fontsize=12.5)
    return figure


def _acting(one):
    """Causes that the case has; the others are in the file, and 0."""
    return [part for part in one.parts if part.at_place != 0.0 or part.rms != 0.0]


def _panel(ax, one, budgets):
    colour = style.look_of(budgets, one.case).colour
    ranked = sorted(_acting(one), key=lambda part: -max(abs(part.at_place), part.rms))
    bars = [(part.name.replace("_", " "), part, colour) for part in ranked]
    bars += [("remainder", one.remainder, REMAINDER), ("residual", one.residual, WHOLE)]
    places = np.arange(len(bars))[::-1]
    for place, (name, part, shade) in zip(places, bars):
        ax.barh(place, part.at_place, height=0.62, color=shade)
        ax.plot([-part.rms, part.rms], [place, place], color=style.BLACK, linewidth=0.9, marker="|",
                markersize=7)
    widest = max(max(abs(part.at_place), part.rms) for _, part, _ in bars) or 1.0
    for place, (_, part, _) in zip(places, bars):
        ax.text(1.42 * widest, place, f"{round(part.at_place, 4) + 0.0:.3g}", ha="right", va="center", fontsize=9.5)
    ax.axvline(0.0, color=style.BLACK, linewidth=0.8)
    ax.set_xlim(-1.1 * widest, 1.45 * widest)
    ax.set_yticks(places, [name for name, _, _ in bars])
    ax.grid(axis="y", visible=False)
    where = f" ({one.sections})" if one.sections else ""
    ax.set_title(f"{style.spoken(one.case)}: {one.quantity.replace('_', ' ')} {one.axis}{where}")
    ax.set_xlabel(f"µm at the largest residual, s = {one.place:.1f} mm; lines: ± rms along the path", fontsize=9.5)


def _message(budgets):
    shares = [abs(one.remainder.at_place / one.residual.at_place) for one in budgets.budgets
              if one.residual.at_place != 0.0]
    if not shares:
        return "What residuals are made of"
    if max(shares) < ADDS_UP:
        return "What residuals are made of; all of it adds up"
    return f"What residuals are made of; causes together make at most {100.0 * max(shares):.2g} %"
