"""Lag against feed: residual and response time of each strategy over a sweep of the feed."""
import re

import numpy as np

from figures import style
from figures.results import NotInFile

FEED_KEY = "program.feed_override"
WIDTH = 10.2   # inches


def feeds(sweep):
    """The axis of the sweep as (values, label): mm/min where the program has one feed."""
    if FEED_KEY not in sweep.keys:
        raise NotInFile(f"the sweep does not vary {FEED_KEY}")
    if len(sweep.keys) > 1:
        raise NotInFile("the sweep varies more than the feed: " + ", ".join(sweep.keys))
    override = sweep.keys[FEED_KEY]
    program = sweep.scenario.get("program", {})
    code = re.sub(r"\([^)]*\)|;.*", "", program.get("text", ""))
    words = set(re.findall(r"F\s*(#\d+|[\d.]+)", code, re.IGNORECASE))
    if len(words) == 1:
        word = words.pop()
        value = program.get("parameters", {}).get(word) if word.startswith("#") else word
        if value is not None:
            return override * float(value), "feed, mm/min"
    return override, "feed override"


def curves(sweep, quantity):
    """{(case, axis): values} of a quantity, in the order of the file."""
    return {(q["case"], q["axis"]): q for q in sweep.quantities if q["quantity"] == quantity}


def draw(sweep):
    feed, label = feeds(sweep)
    residual, delay = curves(sweep, "imposed_error_residual"), curves(sweep, "lag_time")
    if not residual and not delay:
        raise NotInFile("the sweep holds neither imposed_error_residual nor lag_time")
    shown = [q for q in ("imposed_error_residual", "lag_time")
             if curves(sweep, q)]
    cases = dict.fromkeys(case for case, _ in [*residual, *delay])
    looks = [style.look_of(sweep, case) for case in cases]
    columns, lines = style.legend_shape(looks, WIDTH)
    figure, strip, grid = style.panels([1.0], (WIDTH, 4.34 + 0.26 * lines), columns=len(shown), legend_lines=lines)
    style.legend(strip, looks, points=True, columns=columns)
    order = np.argsort(feed)
    for ax, quantity in zip(grid[0], shown):
        for (case, _), q in curves(sweep, quantity).items():
            look = style.look_of(sweep, case)
            hollow = style.face(look) == "white"
            style.line(ax, feed[order], q["value"][order], look, marker=look.marker, markersize=6,
                       markerfacecolor=style.face(look), clip_on=False, zorder=4 if hollow else 3)
            if quantity == "imposed_error_residual":
                _proportional(ax, feed[order], q["value"][order])
        ax.set_xlim(0.0, feed.max() * 1.03)
        ax.set_xlabel(label)
        ax.axhline(0.0, color=style.BLACK, linewidth=0.8)
    for ax, quantity in zip(grid[0], shown):
        if quantity == "imposed_error_residual":
            axis = ", ".join(sorted({axis for _, axis in residual}))
            ax.set_ylabel(f"residual in {axis}, µm")
            ax.set_title("Largest residual (grey: proportional to the feed)")
        else:
            ax.set_ylabel("response time, ms")
            ax.set_title("Response time")
    style.headline(figure, _message(sweep, delay))
    return figure


def _proportional(ax, feed, values):
    good = np.isfinite(values)
    if good.any() and values[good][-1] > 0.02 * ax.get_ylim()[1]:
        end = np.flatnonzero(good)[-1]
        ax.plot([0.0, feed[end]], [0.0, values[end]], color="#9a9a9a", linewidth=1.1, zorder=2)


LAGS = 1.0        # ms: delays that are never larger are not reported
CONSTANT = 0.1    # of the mean: delays that vary by no more are one number


def _message(sweep, delay):
    """Delays that are the same at every feed as one number each, the others with their range."""
    constant, spread, varying = [], 0.0, []
    for (case, _), q in delay.items():
        values, label = q["value"][np.isfinite(q["value"])], style.look_of(sweep, case).label
        if not len(values) or np.abs(values).max() <= LAGS:
            continue
        off = np.abs(values - values.mean()).max() / max(abs(values.mean()), 1e-12)
        if off <= CONSTANT:
            constant.append(f"{label} {values.mean():.1f} ms")
            spread = max(spread, off)
        else:
            low, high = (f"{value:.1f}".replace("-", "−") for value in (values.min(), values.max()))
            varying.append(f"{label} {low} to {high} ms")
    within = f"{max(1.0, np.ceil(100 * spread)):.0f} %: " + ", ".join(constant)
    if not constant:
        return "Delay over the feed: " + ", ".join(varying) if varying else "Lag against feed"
    if varying:
        return f"Delay the same at every feed within {within}; not of " + ", ".join(varying)
    return "The delay is the same at every feed within " + within
