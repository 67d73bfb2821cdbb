"""Verdicts, computed from a row's stored tolerance and the value found."""
import math

REPRODUCED = "reproduced"
WITHIN = "within bound"
IDENTIFIED = "as identified"
BUILT_IN = "built in"
GIVEN = "as given"
NOT_REPRODUCED = "not reproduced"
NOT_EXPLAINED = "not explained"
NOT_COMPARED = "cannot be compared"
MISSING = "no value here"
ALL = (REPRODUCED, WITHIN, IDENTIFIED, BUILT_IN, GIVEN, NOT_REPRODUCED, NOT_EXPLAINED, NOT_COMPARED, MISSING)


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

    Only predictions are reproduced or within a bound: what a parameter was set for, what the model contains and what was
    given hold by themselves, and what follows from a chosen input can at most lie within the limits. All of them can fail.
    A miss whose cause the paper leaves open is "not explained" rather than "not reproduced".
    """
    if value is None or not math.isfinite(value):
        return NOT_COMPARED if row.lacks and not row.here else MISSING
    if row.lacks:
        return NOT_COMPARED
    low, high = limits(row)
    if not low <= value <= high:
        return NOT_EXPLAINED if row.open else NOT_REPRODUCED
    by_themselves = {"given": GIVEN, "fitted": IDENTIFIED, "built_in": BUILT_IN}
    if row.basis in by_themselves:
        return by_themselves[row.basis]
    return REPRODUCED if row.meaning == "equal" and row.basis == "predicted" else WITHIN
