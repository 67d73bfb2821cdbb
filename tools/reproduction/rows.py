"""Rows of the comparison: a number of a paper, where ours comes from, and what counts as the same.

The rows are data (rows.toml); every tolerance is stored there with its reason.
"""
import dataclasses
import pathlib
import tomllib

from command_line import InputError

ROWS = pathlib.Path(__file__).with_name("rows.toml")

PAPERS = {"G": "Guevel et al. 2025", "L": "Li 2024"}
# What a paper's number means: the value itself, an upper limit of the magnitude, a lower limit, or limits within which it
# lies.
MEANINGS = ("equal", "below", "above", "between")
# What our number is worth. fitted: a parameter was fixed with the paper's number; predicted: it followed;
# assumed: it follows from an input that the paper does not give; built_in: the model contains it and could not say
# otherwise; given: an input that is the paper's, or what follows from its numbers alone.
BASES = ("fitted", "predicted", "assumed", "built_in", "given")


@dataclasses.dataclass(frozen=True)
class Row:
    id: str
    paper: str              # of PAPERS
    group: str              # heading
    quantity: str
    printed: str            # as the paper has it, with its place
    unit: str
    why: str                # why the two differ, or what the agreement is worth
    basis: str               # of BASES
    here: dict              # where our number comes from; see values.find
    meaning: str = "equal"  # of MEANINGS
    value: float | None = None       # None: the paper gives no number
    limits: tuple = ()      # of "between"
    tolerance: float = 0.0  # in the row's unit; of "equal" to both sides, of limits beyond them
    tolerance_reason: str = ""
    lacks: str = ""         # what the paper does not give, so that the two cannot be compared
    part_of: str = ""       # the series that it is one value of; a summary counts a series once
    open: bool = False      # the paper leaves the cause open: a miss is "not explained"


def _row(table, where):
    names = {field.name: field for field in dataclasses.fields(Row)}
    for key in table:
        if key not in names:
            raise InputError(f"{where}: error: {key} is not a key of a row; must be one of {', '.join(names)}")
    for name, field in names.items():
        if field.default is dataclasses.MISSING and name not in table:
            raise InputError(f"{where}: error: {name} is missing")
    row = Row(**{key: tuple(value) if key == "limits" else value for key, value in table.items()})
    for key, value, allowed in (("paper", row.paper, PAPERS), ("meaning", row.meaning, MEANINGS), ("basis", row.basis, BASES)):
        if value not in allowed:
            raise InputError(f"{where}: error: {key} = {value!r}; must be one of {', '.join(allowed)}")
    compared = not row.lacks
    if compared and row.meaning == "between" and len(row.limits) != 2:
        raise InputError(f"{where}: error: limits must have two numbers")
    if compared and row.meaning != "between" and row.value is None:
        raise InputError(f"{where}: error: value is missing; if the paper gives none, lacks must name what is missing")
    if compared and row.meaning == "below" and row.value < 0.0:
        raise InputError(f"{where}: error: value = {row.value:g}; must be >= 0 where it limits a magnitude")
    if compared and not row.tolerance_reason:
        raise InputError(f"{where}: error: tolerance_reason is missing")
    return row


def _expanded(table):
    # a series stands for one row a value: {k} and {value} in its texts; some of its points may be identified or built in
    if "series" not in table:
        return [table]
    series, scale = table["series"], table.get("scale", 1.0)
    bases = {k: basis for key, basis in (("identified", "fitted"), ("built_in", "built_in")) for k in table.get(key, [])}
    rest = {key: value for key, value in table.items() if key not in ("series", "scale", "identified", "built_in")}
    found = []
    for k, value in enumerate(series, 1):
        one = {key: text.replace("{k}", str(k)).replace("{value}", f"{value:g}") if isinstance(text, str) else text
               for key, text in rest.items()}
        one["here"] = {**rest["here"], "k": k}
        one["part_of"] = rest["id"]
        one["value"] = scale * value
        one["basis"] = bases.get(k, rest["basis"])
        found.append(one)
    return found


def read(path=ROWS):
    """All rows, in the order of the file. InputError names the row that is wrong."""
    try:
        tables = tomllib.loads(pathlib.Path(path).read_text(encoding="utf-8")).get("row", [])
    except tomllib.TOMLDecodeError as fault:
        raise InputError(f"{path}: error: {fault}") from None
    rows = [_row(one, f"{pathlib.Path(path).name}: row {one.get('id', number)}")
            for number, table in enumerate(tables, 1) for one in _expanded(table)]
    ids = [row.id for row in rows]
    for one in ids:
        if ids.count(one) > 1:
            raise InputError(f"{pathlib.Path(path).name}: row {one}: error: appears {ids.count(one)} times")
    return rows
