"""Cases, sections and probed features that figures of the paper are about, and their names in other scenarios."""
import dataclasses
import difflib

from command_line import InputError

CASES = ("nominal", "generated", "compensated", "compensated_lead", "nominal_air", "generated_air", "compensated_air")
SECTIONS = ("flank", "plane", "notch", "circle", "diamond", "square", "top")


@dataclasses.dataclass(frozen=True)
class Names:
    """Names that stand for the paper's: {paper's: the scenario's}."""
    cases: dict = dataclasses.field(default_factory=dict)
    sections: dict = dataclasses.field(default_factory=dict)

    def case(self, name):
        return self.cases.get(name, name)

    def section(self, name):
        return self.sections.get(name, name)


def hint(option, name, own, there):
    """End of a sentence about a name that a file lacks: what is near, or how another is given."""
    near = difflib.get_close_matches(own, there, 1) if own != name else []
    return f"; did you mean {near[0]}?" if near else f"; --{option} {name}=NAME draws another"


def parse(texts, allowed, option):
    """{paper's: the scenario's} from ["flank=side"]."""
    found = {}
    for text in texts or []:
        name, separator, own = text.partition("=")
        if not separator or not own:
            raise InputError(f"plot.py: error: --{option} {text}: must be NAME=YOURS, NAME one of " + ", ".join(allowed))
        if name not in allowed:
            near = difflib.get_close_matches(name, allowed, 1)
            raise InputError(f"plot.py: error: --{option} {text}: no figure is about a {option} named {name}; " +
                             (f"did you mean {near[0]}?" if near else "there are " + ", ".join(allowed)))
        if found.setdefault(name, own) != own:
            raise InputError(f"plot.py: error: --{option} lists {name} twice: {found[name]} and {own}")
    return found


DISTRIBUTIONS = {"uniform", "log_uniform", "normal", "choice"}


def is_sampled(table, key):
    """Whether the table [sweep] gives this key a distribution, nested or quoted as it may be, or draws it as identified."""
    if not isinstance(table, dict):
        return False
    for name, value in table.items():
        if name == key and isinstance(value, dict) and DISTRIBUTIONS & value.keys():
            return True
        if name == "samples" and any(key == f"machine.{one}" for drawn in value.get("identified", []) for one in drawn["keys"]):
            return True
        if key.startswith(name + ".") and is_sampled(value, key[len(name) + 1:]):
            return True
    return False
