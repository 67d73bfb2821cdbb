"""Dictionaries as TOML: scenarios that a program writes, and the values of `set`."""
import json
import math
from typing import Any, List, Mapping


def value_text(value: Any) -> str:
    """A value as TOML has it.

    >>> value_text({"EYX": {"harmonic": {"amplitude_um": 150.0}}, "flags": [True, "4 m/min"]})
    '{EYX = {harmonic = {amplitude_um = 150.0}}, flags = [true, "4 m/min"]}'
    """
    if hasattr(value, "tolist"):  # numbers and arrays of numpy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else str(value)
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key_text(key)} = {value_text(one)}" for key, one in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(value_text, value)) + "]"
    if hasattr(value, "__fspath__") or isinstance(value, str):
        return json.dumps(str(value), ensure_ascii=False).replace("\x7f", "\\u007f")
    raise TypeError(f"{value!r} has no form in TOML")


def key_text(key: str) -> str:
    """A key, in quotes where it needs them: `#101` does."""
    plain = key.isascii() and key.replace("_", "").replace("-", "").isalnum()
    return key if plain else value_text(key)


def document(table: Mapping[str, Any]) -> str:
    """A dictionary as a TOML document, one line a key; lists of dictionaries are [[tables]].

    >>> print(document({"title": "one", "case": [{"name": "a"}, {"name": "b"}], "record": {"period_ms": 1}}))
    title = "one"
    <BLANKLINE>
    [[case]]
    name = "a"
    <BLANKLINE>
    [[case]]
    name = "b"
    <BLANKLINE>
    [record]
    period_ms = 1
    """
    return "\n".join(_lines(table, [])).strip("\n")


def _lines(table: Mapping[str, Any], path: List[str]) -> List[str]:
    below = {key: value for key, value in table.items() if _is_table(value) or _is_list_of_tables(value)}
    lines = [f"{key_text(key)} = {value_text(value)}" for key, value in table.items() if key not in below]
    for key, value in below.items():
        inner = [*path, key_text(key)]
        name = ".".join(inner)
        for one in value if isinstance(value, (list, tuple)) else [value]:
            lines += ["", f"[[{name}]]" if isinstance(value, (list, tuple)) else f"[{name}]", *_lines(one, inner)]
    return lines


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping)


def _is_list_of_tables(value: Any) -> bool:
    return isinstance(value, (list, tuple)) and len(value) > 0 and all(map(_is_table, value))


def assignments(changes: Mapping[str, Any]) -> List[str]:
    """Changes as `--set` of the commands takes them.

    >>> assignments({"program.feed_override": 0.5, "machine.nc.Kv": "60 1/s"})
    ['program.feed_override=0.5', 'machine.nc.Kv="60 1/s"']
    """
    if isinstance(changes, list):  # such already
        return changes
    return [f"{key}={value_text(value)}" for key, value in changes.items()]
