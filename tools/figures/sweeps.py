"""The table of a sweep: quantities over one parameter, over two, over random samples."""
import numpy as np

from figures import style
from figures.results import NotInFile

MOST_PANELS = 6
MOST_MAPS = 9
MOST_LINES = 6        # of one case in a panel
MOST_SAMPLED = 4      # parameters beside each other
RATIO_FOR_LOG = 8.0   # largest over smallest value from which on an axis is logarithmic
BINS = 40


def questions(sweep):
    """{(quantity, axis, statistic, sections): its columns, one a case}, without empty ones."""
    found = {}
    for one in sweep.quantities:
        if np.isfinite(one["value"]).any():
            found.setdefault((one["quantity"], one["axis"], one["statistic"], one["sections"]), []).append(one)
    if not found:
        raise NotInFile("no point has a value of any quantity")
    return found


def title_of(question):
    quantity, axis, statistic, sections = question
    about = ", ".join(part for part in (axis, statistic, sections) if part)
    return quantity.replace("_", " ") + (f" ({about})" if about else "")


def unit_of(columns):
    return columns[0]["unit"].replace("um", "µm").replace("urad", "µrad")


def short(parameter):
    """The end of a key that tells what it is."""
    return ".".join(parameter.key.split(".")[-2:])


def tell(parameter, value):
    return parameter.texts[int(value)] if parameter.texts else f"{value:.3g}"


def tell_with_name(parameter, value):
    """The same where no axis says what it is a value of."""
    if parameter.texts:
        return tell(parameter, value)
    unit = "" if parameter.unit == "1" else f" {parameter.unit}"
    return f"{parameter.key.split('.')[-1]} {tell(parameter, value)}{unit}"


def first_panels(found, most=MOST_PANELS):
    """As many questions as fit; the others are named where they are left out."""
    shown = list(found.items())[:most]
    return shown, len(found) - len(shown)


def headline(sweep, left_out):
    lost = int((~sweep.done).sum())
    notes = [f"{lost} of {len(sweep.done)} points not done"] if lost else []
    if left_out:
        notes.append(f"{left_out} more quantities in the file")
    return sweep.title + (f" ({'; '.join(notes)})" if notes else "")


def logarithmic(values):
    values = values[np.isfinite(values)]
    return len(values) > 2 and values.min() > 0.0 and values.max() > RATIO_FOR_LOG * values.min()


def grid_of(count):
    columns = min(count, 3 if count > 4 else 2)
    return -(-count // columns), columns


def draw_curves(sweep):
    if sweep.varied(sampled=True):
        raise NotInFile("the sweep samples its parameters")
    parameters = sweep.varied(sampled=False)
    numbers = [one for one in parameters if not one.texts]
    if not numbers:
        raise NotInFile("the sweep varies no number")
    x = max(numbers, key=lambda one: len(one.distinct()))
    groups = groups_of([one for one in parameters if one is not x], len(x.values))
    if len(groups) > MOST_LINES:
        raise NotInFile(f"the sweep varies too many keys in addition to {x.key}: {len(groups)} lines per case" +
                        "".join(f"; {one.key}" for one in parameters if one is not x))
    shown, left_out = first_panels(questions(sweep))
    rows, columns = grid_of(len(shown))
    width = 5.1 * columns
    entries, across = legend_size(sweep, shown, groups, width)
    lines = -(-entries // across)
    figure, strip, axes = style.panels([1.0] * rows, (width, 3.6 * rows + 0.35 + 0.25 * lines), columns=columns,
                                       legend_lines=lines)
    flat = [one for row in axes for one in row]
    looks = {}
    for ax, (question, cases) in zip(flat, shown):
        for column in cases:
            for n, (name, chosen) in enumerate(groups):
                look = style.look_of(sweep, column["case"])
                if name:
                    look = style.dataclasses.replace(
                        look, label=f"{look.label}, {name}", line=["-", style.DASH, style.DASH_DOT, style.DOT][n % 4],
                        colour=style.paler(look.colour, n / len(groups)))
                looks[look.label] = look
                order = chosen[np.argsort(x.values[chosen])]
                style.line(ax, x.values[order], column["value"][order], look, marker=look.marker, markersize=5,
                           markerfacecolor=style.face(look))
        ax.set_title(title_of(question))
        ax.set_ylabel(unit_of(cases))
        ax.set_xlabel(x.label())
        if logarithmic(x.values):
            ax.set_xscale("log", base=2)
            ax.set_xticks(x.distinct() if len(x.distinct()) <= 8 else x.distinct()[::2],
                          [tell(x, v) for v in (x.distinct() if len(x.distinct()) <= 8 else x.distinct()[::2])])
            ax.minorticks_off()
        if logarithmic(np.concatenate([column["value"] for column in cases])):
            ax.set_yscale("log")
            style.plain_log_ticks(ax.yaxis)
        else:
            ax.axhline(0.0, color=style.BLACK, linewidth=0.8)
    for ax in flat[len(shown):]:
        ax.axis("off")
    style.legend(strip, looks.values(), points=True, columns=across)
    style.headline(figure, headline(sweep, left_out))
    return figure


def legend_size(sweep, shown, groups, width):
    """How many entries the legend of lines has, and how many of them stand beside each other in so many inches."""
    cases = {column["case"] for _, columns in shown for column in columns}
    labels = [f"{style.look_of(sweep, case).label}, {name}" for case in cases for name, _ in groups]
    characters = 6 + max(map(len, labels))  # with the piece of line before it
    return len(labels), max(1, int(11 * width / characters))


def groups_of(parameters, points):
    """[(name, places of the points)] for each combination of the values."""
    groups = [("", np.arange(points))]
    for one in parameters:
        groups = [(", ".join(part for part in (name, tell_with_name(one, value)) if part),
                   chosen[one.values[chosen] == value])
                  for name, chosen in groups for value in one.distinct()]
    return groups


def draw_maps(sweep):
    if sweep.varied(sampled=True):
        raise NotInFile("the sweep samples its parameters")
    parameters = sweep.varied(sampled=False)
    if len(parameters) < 2:
        raise NotInFile(f"the sweep varies {len(parameters)} parameters, not two")
    # over the two that have most values, one map for each value of the others
    most = sorted(parameters, key=lambda one: (bool(one.texts), -len(one.distinct())))[:2]
    y, x = (one for one in parameters if one in most)
    others = [one for one in parameters if one not in most]
    found = {(*question, column["case"], name): (column, chosen) for question, columns in questions(sweep).items()
             for column in columns for name, chosen in groups_of(others, len(x.values))}
    shown, left_out = first_panels(found, MOST_MAPS)
    rows, columns = grid_of(len(shown))
    figure, axes = style.plt.subplots(rows, columns, figsize=(4.9 * columns, 3.7 * rows + 0.4), squeeze=False)
    for ax, ((*question, case, name), (column, chosen)) in zip(axes.flat, shown):
        picture = as_picture(x, y, column["value"], chosen)
        ends = (np.nanmin(column["value"]), np.nanmax(column["value"])) if name else (None, None)  # one scale for all names
        mesh = ax.pcolormesh(np.arange(picture.shape[1] + 1), np.arange(picture.shape[0] + 1), picture, cmap="viridis",
                             vmin=ends[0], vmax=ends[1])
        figure.colorbar(mesh, ax=ax, label=unit_of([column]))
        few = picture.size <= 64
        for (row, place), value in np.ndenumerate(picture) if few else []:
            bright = mesh.norm(value) > 0.6
            ax.text(place + 0.5, row + 0.5, style.number(value) if np.isfinite(value) else "-", ha="center", va="center",
                    fontsize=8.5, color=style.BLACK if bright else "white")
        for parameter, axis in ((x, ax.xaxis), (y, ax.yaxis)):
            values = parameter.distinct()
            step = -(-len(values) // 8)
            places = np.arange(0, len(values), step)
            axis.set_ticks(places + 0.5, [tell(parameter, values[i]) for i in places])
            axis.set_label_text(parameter.label())
        ax.grid(False)
        ax.set_title(f"{case}, {name}:\n{title_of(question)}" if name else f"{case}: {title_of(question)}")
    for ax in list(axes.flat)[len(shown):]:
        ax.axis("off")
    style.headline(figure, headline(sweep, left_out))
    return figure


def as_picture(x, y, values, chosen=slice(None)):
    """The values, all or those of chosen points, as a matrix (y, x) over the distinct values of both parameters."""
    picture = np.full((len(y.distinct()), len(x.distinct())), np.nan)
    at_x, at_y, values = (one[chosen] for one in (x.values, y.values, values))
    good = np.isfinite(at_x) & np.isfinite(at_y)
    picture[np.searchsorted(y.distinct(), at_y[good]), np.searchsorted(x.distinct(), at_x[good])] = values[good]
    return picture


def draw_samples(sweep):
    parameters = [one for one in sweep.varied(sampled=True) if not one.texts]
    if not parameters:
        raise NotInFile("the sweep samples no number")
    shown, left_out = first_panels(questions(sweep))
    drawn = parameters[:MOST_SAMPLED]
    figure, strip, axes = style.panels([1.0] * len(shown), (3.4 * (len(drawn) + 1), 2.9 * len(shown) + 0.7),
                                       columns=len(drawn) + 1)
    looks = {}
    for row, (question, cases) in zip(axes, shown):
        everything = np.concatenate([column["value"] for column in cases])
        everything = everything[np.isfinite(everything)]
        log = logarithmic(everything)
        ends = (np.log10(everything.min()), np.log10(everything.max())) if log else (everything.min(), everything.max())
        bins = np.logspace(*ends, BINS) if log else np.linspace(ends[0], ends[1] if ends[1] > ends[0] else ends[0] + 1.0, BINS)
        for column in cases:
            look = style.look_of(sweep, column["case"])
            looks[look.label] = look
            value = column["value"]
            row[0].hist(value[np.isfinite(value)], bins=bins, color=look.colour, alpha=0.45, orientation="horizontal")
            for ax, parameter in zip(row[1:], drawn):
                ax.plot(parameter.values, value, linestyle="none", marker=".", markersize=2.5, alpha=0.5,
                        color=look.colour, rasterized=True)
        row[0].set_title(title_of(question))
        row[0].set_ylabel(unit_of(cases))
        row[0].set_xlabel("points")
        for ax in row:
            if log:
                ax.set_yscale("log")
                style.plain_log_ticks(ax.yaxis)
            low, high = np.log10(bins[[0, -1]]) if log else bins[[0, -1]]
            margin = 0.04 * (high - low)  # or the outermost points are cut
            ax.set_ylim(*(10.0 ** np.array([low - margin, high + margin]) if log else (low - margin, high + margin)))
        for ax, parameter in zip(row[1:], drawn):
            ax.set_xlabel(short(parameter) if parameter.unit == "1" else f"{short(parameter)}, {parameter.unit}")
    style.legend(strip, looks.values(), lines=False, points=True)
    more = f"; {len(parameters) - len(drawn)} more parameters" if len(parameters) > len(drawn) else ""
    style.headline(figure, headline(sweep, left_out) + more)
    return figure
