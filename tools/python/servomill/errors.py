"""Exceptions: what a user wrote wrong, and what the system could not do."""
import re
from typing import Iterable, List, NamedTuple, Optional, Tuple

# "axis.Y.lead_mm = -10; must be > 0", "record.perid_ms is not known; did you mean 'period_ms'?"
_OF_VALUE = re.compile(r"(?P<key>[\w.\[\]\"#-]+) = (?P<value>.*?); (?P<rule>.*)", re.DOTALL)
_OF_KEY = re.compile(r"(?P<key>[\w.\[\]\"#-]+) (?P<rule>(?:is not known|is missing).*)", re.DOTALL)


class Fault(NamedTuple):
    """One fault of an input: its place and a sentence that names key, value and rule.

    >>> fault = Fault("mill.toml", 14, 11, "axis.Y.lead_mm = -10; must be > 0")
    >>> fault.key, fault.value, fault.rule
    ('axis.Y.lead_mm', '-10', 'must be > 0')
    >>> print(fault)
    mill.toml:14:11: error: axis.Y.lead_mm = -10; must be > 0
    """

    file: str
    line: int      #: from 1; 0: not known
    column: int    #: from 1; 0: not known
    message: str

    def _part(self, name: str) -> Optional[str]:
        found = _OF_VALUE.fullmatch(self.message) or _OF_KEY.fullmatch(self.message)
        return found.groupdict().get(name) if found else None

    @property
    def key(self) -> Optional[str]:
        """The key as the message names it, or None where the fault is no key's."""
        return self._part("key")

    @property
    def value(self) -> Optional[str]:
        """The value as it was written, or None."""
        return self._part("value")

    @property
    def rule(self) -> str:
        """The rule that is violated; the whole message where it names no key."""
        return self._part("rule") or self.message

    def __str__(self) -> str:
        place = ":".join([self.file, *(str(number) for number in (self.line, self.column) if number)])
        return f"{place}: error: {self.message}" if place else self.message


class InputError(ValueError):
    """An input is wrong: a scenario, a machine, a program, readings, or an argument.

    `faults` has all faults of the file, in their order; the other attributes are those of the first.

    >>> error = InputError([("a.toml", 2, 5, "case[1].name = \\"\\"; is empty"), ("a.toml", 9, 1, "program is missing")])
    >>> error.line, error.key, error.rule, len(error.faults)
    (2, 'case[1].name', 'is empty', 2)
    """

    def __init__(self, faults: Iterable[Tuple[str, int, int, str]]):
        self.faults: List[Fault] = [Fault(*fault) for fault in faults]
        super().__init__("\n".join(map(str, self.faults)))

    def __reduce__(self):
        return type(self), ([tuple(fault) for fault in self.faults],)

    @property
    def file(self) -> str:
        return self.faults[0].file

    @property
    def line(self) -> int:
        return self.faults[0].line

    @property
    def column(self) -> int:
        return self.faults[0].column

    @property
    def key(self) -> Optional[str]:
        return self.faults[0].key

    @property
    def value(self) -> Optional[str]:
        return self.faults[0].value

    @property
    def rule(self) -> str:
        return self.faults[0].rule


class SystemFailed(OSError):
    """The system failed: a disk is full, a folder cannot be written."""
