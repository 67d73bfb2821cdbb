"""Verdicts, computed from a row's stored tolerance and the value found."""
import math

REPRODUCED = "reproduced"
WITHIN = "within bound"
GIVEN = "as given"
NOT_REPRODUCED = "not reproduced"
NOT_EXPLAINED = "not explained"
NOT_COMPARED = "cannot be compared"
MISSING = "no value here"
ALL = (REPRODUCED, WITHIN, GIVEN, NOT_REPRODUCED, NOT_EXPLAINED, NOT_COMPARED, MISSING)


def limits(row):
    """Lowest and highest value that the row's meaning and tolerance accept (infinite where open). "below" is said of a
    magnitude: what lies far on the other side of zero is no less of an error."""
    if row.meaning == "equal":
        low, high = row.value, row.value
    elif row.meaning == "below":
        low, high = -row.value, row.value
    elif row.meaning == "above":
        low, high = row.value, math.inf
    else:
        low, high = row.limits
    return low - row.tolerance, high + row.tolerance


def verdict(row, value):
    """The verdict over our value (None: there is none).

    What follows from a chosen input is never "reproduced": lying within the limits is all that can be said.
    A miss whose cause the paper leaves open is "not explained" rather than "not reproduced".
    """
    if value is None or not math.isfinite(value):
        return NOT_COMPARED if row.lacks and not row.here else MISSING
    if row.lacks:
        return NOT_COMPARED
    low, high = limits(row)
    if low <= value <= high and row.kind == "given":
        return GIVEN
    if low <= value <= high:
        return REPRODUCED if row.meaning == "equal" and row.kind != "chosen" else WITHIN
    return NOT_EXPLAINED if row.open else NOT_REPRODUCED
