"""Figures 6 and 12: the imposed error functions of one axis."""
import numpy as np

from figures import style
from figures.results import NotInFile

DIRECTION_LINES = ["-", style.DASH, style.DOT]
UNITS = {"um": "µm", "urad": "µrad"}


def used_range(run, axis):
    """Lowest and highest programmed position of an axis in feed motion (mm), over all cases."""
    low, high = np.inf, -np.inf
    for case in run.cases.values():
        rows = case.samples()
        if len(rows) and axis in case.labels("ref_linear"):
            q = case.column("ref_linear", axis)[rows]
            low, high = min(low, q.min()), max(high, q.max())
    return (low, high) if low <= high else None


def draw(run, axis):
    functions = run.error_functions(axis)
    used = used_range(run, axis)
    if used is None:
        raise NotInFile("no feed motion")
    units = [unit for unit in ("um", "urad") if any(f[2] == unit for f in functions.values())]
    size = (10.5, 3.4 * len(units) + 0.6)
    figure, axes = style.plt.subplots(len(units), 2, figsize=size, squeeze=False)
    for row, unit in enumerate(units):
        curves = _merged({n: f for n, f in functions.items() if f[2] == unit})
        for column, ax in enumerate(axes[row]):
            for number, (names, (position, values)) in enumerate(curves):
                inside = slice(None)
                if column == 0:
                    inside = (position >= used[0] - 1e-9) & (position <= used[1] + 1e-9)
                    if inside.sum() < 2:       # the axis hardly moves: one step to either side
                        inside = np.argsort(np.abs(position - np.mean(used)))[:3]
                        inside.sort()
                label = " = ".join(names)
                ax.plot(position[inside], values[inside], color=style.BLACK, label=label,
                        linestyle=DIRECTION_LINES[number % 3],
                        linewidth=1.8 if number % 3 == 0 else 2.0)
            ax.set_ylabel(f"error, {UNITS[unit]}")
            ax.margins(x=0.01)
            if column == 1:
                ax.axvspan(*used, color=style.PALE, zorder=0)
                ax.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0,
                          handlelength=2.6)
        axes[row][0].set_title("Where the program goes" if row == 0 else "")
        axes[row][1].set_title("Whole travel (grey: where the program goes)" if row == 0 else "")
    for ax in axes[-1]:
        ax.set_xlabel(f"{axis} of the machine, mm")
    style.headline(figure, f"Imposed error functions of {axis}: {_units_in_words(functions, used)}")
    return figure


def _merged(functions):
    # functions with the same values share one line and one name
    groups = []
    for name, (position, values, _) in functions.items():
        for names, (_, known) in groups:
            if np.array_equal(known, values):
                names.append(name)
                break
        else:
            groups.append(([name], (position, values)))
    return groups


def _units_in_words(functions, used):
    parts = []
    for unit in ("um", "urad"):
        sizes = [np.abs(np.interp(np.linspace(*used, 200), f[0], f[1])).max()
                 for f in functions.values() if f[2] == unit]
        if sizes:
            parts.append(f"up to {max(sizes):.3g} {UNITS[unit]}")
    return " and ".join(parts) + " where the program goes"
