"""Programs and scenarios at random. The keys, types and ranges of scenarios are those that `servomill list keys` prints."""
import dataclasses
import json
import math
import re

AXES = "XYZBC"
SLOW = {"integrator"}  # CVODE: a law of its own
LARGEST = {"settle_ms": 1e4}  # up to an hour is allowed: too long under sanitizers
NUMBER = re.compile(r"[<>]=? ?([-+\d.e]+)")


# ------------------------------------------------------------------------------------------------------------ programs
def program(rng, moves=12):
    """A program for the HSM 600U within its travel: lines, arcs, dwells, path modes; sometimes rotary axes."""
    rotary = rng.random() < 0.4
    lines = ["%", "G21 G90 G94 G17", f"F{rng.uniform(1000, 10000):.0f}"]
    x = y = 0.0
    for _ in range(moves):
        kind = rng.random()
        if kind < 0.15:
            lines.append(rng.choice(["G64", f"G64 P{rng.uniform(0.001, 0.2):.4f}", "G61", "G61.1", f"F{rng.uniform(500, 12000):.0f}"]))
        elif kind < 0.2:
            lines.append(f"G4 P{rng.uniform(0, 0.1):.3f}")
        elif kind < 0.4:  # an arc about a centre that both ends are equally far from
            radius, begin, turn = rng.uniform(0.5, 12), rng.uniform(0, math.tau), rng.uniform(0.2, 6.0)
            i, j = -radius * math.cos(begin), -radius * math.sin(begin)
            end = begin + turn
            x, y = x + i + radius * math.cos(end), y + j + radius * math.sin(end)
            lines.append(f"G3 X{x:.9f} Y{y:.9f} I{i:.9f} J{j:.9f}")
        else:
            words = []
            if rng.random() < 0.8:
                x = rng.uniform(-30, 30)
                words.append(f"X{x:.4f}")
            if rng.random() < 0.8:
                y = rng.uniform(-30, 30)
                words.append(f"Y{y:.4f}")
            if rng.random() < 0.4:
                words.append(f"Z{rng.uniform(-10, 10):.4f}")
            if rotary and rng.random() < 0.5:
                words.append(f"B{rng.uniform(-20, 20):.3f}")
            if rotary and rng.random() < 0.5:
                words.append(f"C{rng.uniform(-40, 40):.3f}")
            if words:
                lines.append(" ".join([rng.choice(["G1", "G1", "G1", "G0"]), *words]))
    if not any(re.match(r"G[013] ", line) for line in lines):  # refused without motion
        lines.append(f"G1 X{rng.uniform(1, 30):.4f}")
    return "\n".join([*lines, "M2", "%", ""])


def mutated(rng, text):
    """The text with some lines or characters cut, doubled, exchanged or taken from elsewhere in it."""
    lines = text.split("\n")
    for _ in range(rng.randint(1, 6)):
        at = rng.randrange(len(lines))
        line = lines[at]
        change = rng.randrange(5)
        if change == 0:
            del lines[at]
        elif change == 1:
            lines.insert(at, rng.choice(lines))
        elif change == 2 and line:
            k = rng.randrange(len(line))
            lines[at] = line[:k] + rng.choice("GMXYZIJKRPQFSTHDLN#[]()%/;,.=+-*0123456789 ") + line[k + rng.randint(0, 1):]
        elif change == 3:
            other = rng.choice(lines)
            lines[at] = line[: rng.randint(0, len(line))] + other[rng.randint(0, len(other)):]
        else:
            lines[at] = re.sub(r"-?\d+\.?\d*", lambda _: rng.choice(["0", "-1", "1e9", "99999", "0.0001", "3"]), line, count=1)
        if not lines:
            lines = [""]
    return "\n".join(lines)


# ------------------------------------------------------------------------------------------------------------ scenarios
@dataclasses.dataclass(frozen=True)
class Key:
    section: str
    key: str
    type: str
    range: str
    default: str


def keys_of(printed):
    """Keys of `servomill list keys --json`."""
    return [Key(row["section"] or "", row["key"], row["type"], row["range"] or "", row["default"]) for row in json.loads(printed)]


def number(rng, key):
    """Mostly within the range, near the default; sometimes at its ends, sometimes beyond them."""
    return min(any_number(rng, key), LARGEST.get(key.key, math.inf))


def any_number(rng, key):
    ends = [float(end) for end in NUMBER.findall(key.range)]
    numbers = re.findall(r"^-?[\d.e+-]+$", key.default or "")
    usual = float(numbers[0]) if numbers else 1.0
    draw = rng.random()
    if draw < 0.1 and ends:
        return rng.choice(ends)
    if draw < 0.15:
        return rng.choice([0.0, -1.0, 1e12, 1e-12, -usual])
    return (usual or 1.0) * 10 ** rng.uniform(-1.5, 1.5)


def value(rng, key):
    """A TOML value of that type, or None for types that are not drawn."""
    kinds = [kind.strip() for kind in key.type.split("|")]
    kind = rng.choice(kinds)
    if kind.startswith('"') or kind in ("true", "false"):
        return kind
    if kind == "integer":
        return str(int(number(rng, key)))
    if kind.startswith("number"):
        unit = kind.removeprefix("number in").removeprefix("number").strip()
        text = f"{number(rng, key):.6g}"
        # a key without unit in its name takes "4 N m"
        return f'"{text} {unit}"' if unit and len(kinds) > 1 and not key.key.endswith(unit.split()[0]) else text
    return None


def settings(rng, keys, section, path, count):
    """Lines `path.key = value` of some keys of a section."""
    chosen = [key for key in keys if key.section == section and key.key not in SLOW]
    out = {}
    for key in rng.sample(chosen, min(count, len(chosen))):
        drawn = value(rng, key)
        if drawn is not None:
            out[f"{path}.{key.key}"] = drawn
    return out


ERRORS = """
[errors.actual]
EYX = { harmonic = { amplitude_um = 20.0, period_mm = 31.0 } }
EXY = { polynomial_um = [0.0, 40.0] }
EC0Y = "60 urad"
EBX = { polynomial_urad = [0.0, 90.0] }
"""


STRATEGY = re.compile(r"case\[(\d+)\]\.strategy\[(\d+)\](?:\.(\w+))?")


@dataclasses.dataclass
class Scenario:
    """Keys that differ from their defaults, and cases with their strategies."""

    settings: dict[str, str]
    cases: list[list[tuple[str, dict[str, str]]]]
    program: str
    smooth: bool  # linear drives, ideal encoders: two integrators must agree

    def text(self, machine):
        lines = [f'machine = "{machine}"', 'machine_errors = "actual"']
        lines += [f"{key} = {drawn}" for key, drawn in self.settings.items()]
        lines += ['program.file = "program.ngc"', ERRORS]
        for n, strategies in enumerate(self.cases, 1):
            lines.append(f'[[case]]\nname = "case {n}"')
            for name, keys in strategies:
                lines += ["[[case.strategy]]", f'type = "{name}"']
                lines += [f"{key} = {drawn}" for key, drawn in keys.items()]
        lines += ['[[quantity]]\nname = "contour_error"\nstatistic = "max"']
        return "\n".join(lines) + "\n"

    def write(self, folder, machine):
        (folder / "program.ngc").write_text(self.program, encoding="utf-8")
        path = folder / "scenario.toml"
        path.write_text(self.text(machine), encoding="utf-8")
        return path

    def without(self, rng, faults):
        """The scenario without what the faults name; without one setting or strategy if they name none of them."""
        named = [key for key in self.settings if ".".join(key.replace("machine_override.", "machine.").split(".")[:4]) in faults]
        settings = {key: drawn for key, drawn in self.settings.items() if key not in named}
        cases = [list(strategies) for strategies in self.cases]
        places = [(int(n), int(k), key) for n, k, key in STRATEGY.findall(faults)]
        for n, k, key in sorted(places, reverse=True):
            name, keys = cases[n][k] if k < len(cases[n]) else ("", {})
            if key in keys:
                cases[n][k] = name, {one: drawn for one, drawn in keys.items() if one != key}
            elif name:
                del cases[n][k]
        if not named and not places and settings:
            del settings[rng.choice(list(settings))]
        elif not named and not places:
            cases = [[] for _ in cases]
        return dataclasses.replace(self, settings=settings, cases=cases)


def scenario(rng, keys, smooth=False):
    """Some cases with strategies, and some keys of machine, NC and axes at random, for a random program."""
    drawn = {"record.period_ms": "2.0"}
    cases = [[]]
    if not smooth:
        drawn.update(settings(rng, keys, "machine", "machine_override", rng.randint(0, 1)))
        drawn.update(settings(rng, keys, "machine.nc", "machine_override.nc", rng.randint(0, 3)))
        drawn.update(settings(rng, keys, "record", "record", rng.randint(0, 2)))
        for axis in rng.sample(AXES, 2):
            for part in ("", ".friction", ".scale", ".motor", ".friction_compensation", ".backlash_compensation", ".winding", ".cogging"):
                if rng.random() < 0.3:
                    drawn.update(settings(rng, keys, f"machine.axis.X{part}", f"machine_override.axis.{axis}{part}", rng.randint(1, 4)))
        strategies = sorted({key.section.split(".")[2] for key in keys if key.section.startswith("case.strategy.")})
        cases = [
            [
                (name, {"model": '"actual"'} | {key[1:]: one for key, one in settings(rng, keys, f"case.strategy.{name}", "", rng.randint(0, 4)).items()})
                for name in rng.sample(strategies, rng.choice([0, 1, 1, 2]))
            ]
            for _ in range(rng.randint(1, 2))
        ]
    return Scenario(drawn, cases, program(rng, 3 if smooth else rng.randint(3, 10)), smooth)
