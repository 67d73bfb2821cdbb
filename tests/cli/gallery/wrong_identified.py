"""Wrong machine files with identified values, and sweeps over them."""
from edits import typed

BASED_ON = 'based_on = "machine.toml"\n'
VALUES = '[axis.X]\nmoving_mass = "95.11 kg"\n[axis.Y]\nmoving_mass = "96 kg"\n'
TABLE = '[identified]\nkeys = ["axis.X.moving_mass", "axis.Y.moving_mass"]\nunits = ["kg", "kg"]\nvalues = [95.11, 96.0]\n' \
    'covariance = [[0.36, 0.01], [0.01, 0.04]]\n'
GOOD = BASED_ON + VALUES + TABLE


def identified(title, old, new, commands=None):
    """The file identified.toml with one thing changed."""
    assert old in GOOD, old
    return typed(title, *(commands or ["servomill check identified.toml"]), write={"identified.toml": GOOD.replace(old, new, 1)},
                 about=f"with {new!r} in place of {old!r}" if old != new else "nothing wrong in it")


IDENTIFIED = [
    identified("identified: based on no file", '"machine.toml"', "true"),
    identified("identified: based on a file that is not there", '"machine.toml"', '"mill.toml"'),
    identified("identified: based on itself", '"machine.toml"', '"identified.toml"'),
    identified("identified: based on a scenario", '"machine.toml"', '"scenario.toml"'),
    identified("identified: no list of units", 'units = ["kg", "kg"]\n', ""),
    identified("identified: fewer units than keys", 'units = ["kg", "kg"]', 'units = ["kg"]'),
    identified("identified: a unit that is none", 'units = ["kg", "kg"]', 'units = ["kg", "kgs"]'),
    identified("identified: more values than keys", "96.0]", "96.0, 97.0]"),
    identified("identified: a key twice", 'keys = ["axis.X.moving_mass", "axis.Y.moving_mass"]',
               'keys = ["axis.X.moving_mass", "axis.X.moving_mass"]'),
    identified("identified: a key that the file does not set", '"axis.Y.moving_mass"]', '"axis.Z.moving_mass"]'),
    identified("identified: another value than the file sets", '"96 kg"', '"96.5 kg"'),
    identified("identified: no covariance", "covariance = [[0.36, 0.01], [0.01, 0.04]]\n", ""),
    identified("identified: a covariance of one row", "[[0.36, 0.01], [0.01, 0.04]]", "[[0.36, 0.01]]"),
    identified("identified: a covariance that is not symmetric", "[0.01, 0.04]]", "[0.02, 0.04]]"),
    identified("identified: a negative variance", "0.04]]", "-0.04]]"),
    identified("identified: correlations above 1", "[[0.36, 0.01], [0.01, 0.04]]", "[[0.36, 0.13], [0.13, 0.04]]"),
    identified("identified: a key both identified and not", "covariance", 'unidentifiable = ["axis.X.moving_mass"]\ncovariance'),
    identified("identified: an unknown key", "covariance", "covarianse = 3\ncovariance"),
    identified("identified: a value that the machine refuses", "95.11", "-95.11")
    | {"write": {"identified.toml": GOOD.replace("95.11", "-95.11")}},
    identified("identified: run as if it was a scenario", "0.01", "0.01", ["servomill run identified.toml"]),
    identified("identified: wrong, where a scenario names it", "96.0]", "97.0]",
               ["servomill check scenario.toml --set 'machine=\"identified.toml\"'",
                "servomill compensate part.ngc --machine identified.toml -o out.ngc"]),
]


def samples(title, sweep, machine="identified.toml", values=GOOD, commands=None):
    """A sweep over the samples of identified.toml."""
    assert commands is None or "sweep" in commands[0]
    return {"title": title, "write": {"identified.toml": values}, "about": repr(values) if values != GOOD else "nothing wrong in it",
            "edit": [("scenario.toml", 'machine = "machine.toml"', f'machine = "{machine}"'),
                     ("scenario.toml", '[[quantity]]', f"[sweep]\n{sweep}\n\n[[quantity]]")],
            "commands": commands or ["servomill check scenario.toml"]}


FROM = 'samples = { from = "identified.toml", count = 4 }'

IDENTIFIED += [
    samples("samples: from a file that is not there", FROM.replace("identified.toml", "gone.toml")),
    samples("samples: from a machine without identified values", FROM.replace("identified.toml", "machine.toml")),
    samples("samples: from a number", FROM.replace('"identified.toml"', "3")),
    samples("samples: twice from one file", FROM.replace('"identified.toml"', '["identified.toml", "identified.toml"]')),
    samples("samples: of a key that varies as well", FROM + "\nmachine.axis.X.moving_mass = [90.0, 100.0]"),
    samples("samples: about another machine than the one that is run", FROM, "machine.toml"),
    samples("samples: from a wrong file", FROM, values=GOOD.replace("96.0]", "97.0]")),
    samples("samples: a value of one that --set changes", FROM,
            commands=["servomill sweep scenario.toml -q -o out.h5 --set machine.axis.X.moving_mass=100"]),
]
