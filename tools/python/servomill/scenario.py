"""Scenarios: read, checked, and changed."""
import os
import pathlib
import tomllib
from typing import Any, Dict, List, Mapping, Optional, Union

from . import _core, toml

Changes = Optional[Mapping[str, Any]]


class Scenario:
    """A scenario that has been read with all files that it names, and checked. Made by `load`."""

    def __init__(self, core: _core.Scenario):
        self._core = core

    @property
    def name(self) -> str:
        return self._core.name

    @property
    def title(self) -> str:
        return self._core.title

    @property
    def path(self) -> str:
        return self._core.path

    @property
    def cases(self) -> List[str]:
        """Names of the cases."""
        return self._core.cases

    @property
    def text(self) -> str:
        """The scenario as it was written."""
        return self._core.text

    @property
    def resolved(self) -> str:
        """One TOML document with the machine and all changes in it, complete by itself."""
        return self._core.resolved

    @property
    def keys(self) -> Dict[str, Any]:
        """`resolved` as nested dictionaries."""
        return tomllib.loads(self.resolved)

    def __getitem__(self, key: str) -> Any:
        """The value of a dotted key of `keys`: `scenario["machine.nc.Kv"]`."""
        value: Any = self.keys
        for part in key.split("."):
            value = value[part]
        return value

    def estimate(self) -> Dict[str, float]:
        """Prepares every case and returns what a run would take: motion_s, rows, size_bytes, memory_bytes, computing_s, and
        trial_runs, which are part of that: strategies have yet to learn from them."""
        return self._core.estimate()

    def __repr__(self) -> str:
        return f"<scenario {self.name}: {', '.join(self.cases)}>"


def _installed() -> str:
    """Folder with `scenarios` that this module belongs to: share/servomill of its installation, or the source tree of its build."""
    share = os.path.normpath(os.path.join(os.path.dirname(_core.__file__), _core.share))
    source = pathlib.Path(__file__).resolve().parents[3]  # a build has links to this file
    if not os.path.isdir(os.path.join(share, "scenarios")) and (source / "scenarios" / "machines").is_dir():
        return str(source)
    return share


def scenario_folder() -> pathlib.Path:
    """Folder of the scenarios that this module brings, with the machines, programs and readings that they name.

    >>> import servomill
    >>> (servomill.scenario_folder() / "machines" / "hsm600u.toml").exists()
    True
    """
    return pathlib.Path(_installed(), "scenarios")


def scenarios() -> List[str]:
    """Names of the scenarios in the folder `scenarios` of the current folder, and of those that are installed.

    A name stands for its file wherever a scenario is asked for: `servomill.run("guevel2025/experiment1")`.
    """
    return sorted({*_core.scenario_names(_installed())})


Loadable = Union[Scenario, str, os.PathLike, Mapping[str, Any]]


def load(scenario: Loadable, set: Changes = None, folder: Union[str, os.PathLike] = "",
         name: str = "scenario") -> Scenario:
    """Reads a scenario and checks it.

    scenario: name of a TOML file or one of `scenarios()`; or a dictionary with the same keys; or the text itself, which has
        a line break.
    set: changes of keys, as `--set` takes them: {"program.feed_override": 0.5, "machine.nc.Kv": "60 1/s"}.
    folder, name: of a dictionary or text: files that it names are relative to this folder; messages call it `name`.toml.

    Raises InputError with all faults of the file.

    >>> import servomill
    >>> scenario = servomill.load(example)
    >>> scenario.cases
    ['nominal', 'table', 'feedback', 'gcode']
    >>> servomill.load(example, set={"program.feed_override": 0.5})["program.feed_override"]
    0.5
    """
    if isinstance(scenario, Scenario):
        if not set:
            return scenario
        core = scenario._core
        changes = [*core.changes, *toml.assignments(set)]
        return Scenario(_core.load(core.path, changes, core.given_text))
    text = None
    if isinstance(scenario, Mapping):
        text = toml.document(scenario)
    elif isinstance(scenario, str) and "\n" in scenario:
        text = scenario
    if text is None:
        return Scenario(_core.load(_core.scenario_file(os.fspath(scenario), _installed()), set, None))
    return Scenario(_core.load(os.path.join(os.fspath(folder), f"{name}.toml"), set, text))
