"""Rows of long recordings: few of many, so that a figure takes the same memory for a minute and for hours.

Of a recording with more than MOST rows those are read at which a deciding signal is least or greatest among its
neighbours, where feed and rapid or sections change, and all of the short sections. So peaks, ranges and circles are those of
all rows; means and rms of what is drawn are not.
"""
import numpy as np

MOST = 200_000      # rows that are held
BLOCK = 1 << 18     # rows that are read at once, about
DECIDING = ("contour_error", "tool_deviation", "following_error_linear", "following_error_rotary")
FLAGS = ("section", "rapid", "window", "in_window")


def blocks(rows, size):
    """(begin, end) of blocks of `size` rows."""
    return [(begin, min(begin + size, rows)) for begin in range(0, rows, size)]


def extreme_rows(values, first, width):
    """Of each group of `width` rows (values begin at row `first`) those with the least and the greatest value."""
    groups = -(-len(values) // width)
    padded = np.full(groups * width, np.nan)
    padded[:len(values)] = values
    padded = padded.reshape(groups, width)
    empty = np.isnan(padded)
    begin = first + width * np.arange(groups)
    least = begin + np.argmin(np.where(empty, np.inf, padded), axis=1)
    greatest = begin + np.argmax(np.where(empty, -np.inf, padded), axis=1)
    return np.concatenate([least, greatest])


def changes(values, first):
    """Rows on both sides of each change, and the first one."""
    at = first + np.flatnonzero(np.diff(values))
    return np.concatenate([[first], at, at + 1])


def short_sections(section, most):
    """Numbers of sections that are kept whole, the shortest first, as long as they have no more than `most` rows."""
    counts = np.zeros(0, dtype=np.int64)
    for begin, end in blocks(len(section), BLOCK):
        found = np.bincount(section[begin:end].astype(np.int64))
        counts = np.pad(counts, (0, max(0, len(found) - len(counts))))
        counts[:len(found)] += found
    order = [k for k in np.argsort(counts, kind="stable") if counts[k] > 0]
    fits = np.cumsum(counts[order]) <= most
    return [k for k, one in zip(order, fits) if one]


def kept_rows(group, most=MOST, deciding=DECIDING):
    """Rising numbers of the rows to hold of the datasets of a group; None: all."""
    rows = group["s"].shape[0]
    if rows <= most:
        return None
    deciding = [group[name] for name in deciding if name in group]
    columns = sum(data.shape[1] if data.ndim > 1 else 1 for data in deciding)
    whole = short_sections(group["section"], most // 2) if "section" in group else []
    width = -(-rows * (2 * columns + 1) // (most // 2))
    found = [np.array([0, rows - 1])]
    for begin, end in blocks(rows, width * max(1, BLOCK // width)):
        found.append(np.arange(begin, end, width))
        for data in deciding:
            values = data[begin:end].reshape(end - begin, -1)
            found += [extreme_rows(column, begin, width) for column in values.T]
        for name in FLAGS:
            if name in group:
                found.append(changes(group[name][max(0, begin - 1):end], max(0, begin - 1)))
        if whole:
            found.append(begin + np.flatnonzero(np.isin(group["section"][begin:end], whole)))
    kept = np.unique(np.concatenate(found))
    return kept[kept < rows]


def read(data, kept, column=None):
    """Those rows of a dataset, or of one column of it; kept None: all."""
    where = (slice(None),) if column is None else (slice(None), column)
    if kept is None:
        return data[where]
    out = []
    for begin, end in blocks(data.shape[0], BLOCK):
        here = kept[np.searchsorted(kept, begin):np.searchsorted(kept, end)]
        if len(here):
            out.append(data[(slice(begin, end), *where[1:])][here - begin])
    return np.concatenate(out)


def gaps(window):
    """Rows before which rows were left out, from the numbers of their windows."""
    return np.flatnonzero(np.diff(window)) + 1


def with_blank_rows(name, values, rows):
    """Values of a dataset with a blank row before each of some rows, so that no line joins two windows: NaN, in no section,
    at the time and place of the row before."""
    if not len(rows):
        return values
    fill = values[rows - 1] if name in ("time", "s", "line") else -1.0 if name == "section" else np.nan
    return np.insert(values.astype(float), rows, fill, axis=0)


def interpolated(s_base, values, s):
    """Linear between the value at or before s and the next one, the last of those at the same s."""
    row = np.clip(np.searchsorted(s_base, s, side="right") - 1, 0, len(s_base) - 1)
    after = np.minimum(row + 1, len(s_base) - 1)
    length = s_base[after] - s_base[row]
    weight = np.divide(s - s_base[row], length, out=np.zeros_like(s), where=length > 0.0)
    weight = np.clip(weight, 0.0, 1.0)
    return (1.0 - weight) * values[row] + weight * values[after]


def along_path(base, values, s):
    """Values of the base case's samples at other arc lengths: linear between the sample at or
    before s and the next one; where the base stands still the last of its samples counts."""
    return interpolated(base.column("s"), values, s)


def values_along(s_data, data, column, s, window=None):
    """What along_path finds in all rows, read in blocks; `s` in any order. NaN between two windows of the recording."""
    rows = s_data.shape[0]
    order = np.argsort(s, kind="stable")
    wanted, out = s[order], np.empty(len(s))
    for begin, end in blocks(rows, BLOCK):
        s_here = s_data[begin:min(end + 1, rows)]      # the row behind, too
        first = 0 if begin == 0 else np.searchsorted(wanted, s_here[0], side="left")
        last = len(wanted) if end == rows else np.searchsorted(wanted, s_data[end], side="left")
        if first >= last:
            continue
        values = data[begin:min(end + 1, rows)] if column is None else data[begin:min(end + 1, rows), column]
        if window is not None:
            between = gaps(window[begin:min(end + 1, rows)])
            s_here, values = (with_blank_rows(name, one, between) for name, one in (("s", s_here), ("", values)))
        out[first:last] = interpolated(s_here, values, wanted[first:last])
    found = np.empty(len(s))
    found[order] = out
    return found
