"""Ways to name what is changed in the files of the gallery, and what is typed."""

CHECK = ["servomill check scenario.toml"]
RUN = ["servomill run scenario.toml -o out.h5"]


def line(title, old, new, file="scenario.toml", commands=None):
    return {"title": title, "edit": [(file, old, new)], "commands": commands or CHECK}


def typed(title, *commands, **more):
    return {"title": title, "commands": list(commands), **more}


def machine(title, old, new, commands=None):
    return line(title, old, new, "machine.toml", commands)


def program(title, old, new, commands=None):
    return line(title, old, new, "part.ngc", commands)
