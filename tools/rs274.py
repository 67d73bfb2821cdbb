"""Runs LinuxCNC's stand-alone interpreter, rs274, and reads what it prints as records of canonical moves.

The records are those of controllers/gcode/canon_json.h (mm, degrees). rs274 prints four decimals and is a machine in
inches: a private copy of it prints nine and is one in millimetres. It prints no line numbers but the N words of the
program: the same program runs a second time with an N word before each line. Both times it runs on copies in a folder
of their own, so that nothing is written beside the programs. Of a spline it prints only how many control points it has:
LinuxCNC's Python module `gcode`, the same interpreter, gives chords of it ("chord_x", "chord_y", where there is one).

Left out are path modes and coolant (separate calls here, fields of other records and states in servomill), the pallet
shuttle of M30, and stops at tool changes and ends of a spindle that stands already.
"""
import functools
import itertools
import json
import math
import os
import pathlib
import re
import resource
import shutil
import signal
import struct
import subprocess
import tempfile

SUFFIXES = {".ngc", ".nc", ".tap"}
LONGEST_LINE = 252             # characters that rs274 takes
LINES_OF_A_FILE = 10 ** 6      # N words are FILE x this + LINE; files count from 1, programs' own N words are less
SAID = "msg", "text", "code"    # may name lines
N_WORD = re.compile(rb"\s*(/?)\s*(?:n\s*\d[\d\s]*(?:\.\s*\d[\d\s]*)?)?(.*)$", re.IGNORECASE | re.DOTALL)
MOST_OUTPUT = 1 << 28          # bytes; beyond it a program is taken to be without end
LEAST_MOVE = 1e-7              # mm; nine decimals of an inch tell positions only so far
MM_PER_INCH = 25.4
UNPACKED = "~/.cache/rs274/root/usr/bin/rs274"
PYTHON = "/usr/bin/python3"    # Debian's, for which the module gcode is built
FEEDS = pathlib.Path(__file__).resolve().with_name("rs274_feeds.py")
CHORDS_PER_POINT = 15          # of a spline, by the module gcode; sometimes there is one more, of no length


class Missing(Exception):
    """There is no rs274; the text says how to get it."""


def find(path=None):
    """The binary: `path`, $RS274, the one on PATH, or one that is unpacked in the cache folder."""
    for place in (path, os.environ.get("RS274"), shutil.which("rs274"), os.path.expanduser(UNPACKED)):
        if place and os.access(place, os.X_OK) and os.path.isfile(place):
            return pathlib.Path(place).resolve()
        if place and place == path:
            break
    raise Missing(f"rs274 was not found{f' at {path}' if path else ''}: install Debian's linuxcnc-uspace, "
                  "or give the path with --rs274 or $RS274")


# ------------------------------------------------------------------------------------------------ reading its output
class Canon:
    """The state that canonical calls refer to, and the records that they make."""

    CALL = re.compile(r"\s*\d+ N(\d+|\.*)\s*([A-Z][A-Z0-9_]*(?:\.[0-9A-Z_]+)*)\((.*)\)(?:executing)?\s*$")
    PLANES = {"XY": (0, 1, 2), "YZ": (1, 2, 0), "XZ": (2, 0, 1)}

    def __init__(self, splines=()):
        self.splines = iter(splines)                  # chords of each, as lists of [x, y] in mm
        self.scale = 1.0                              # mm in a program unit
        self.system, self.shift, self.tool_offset = [0.0] * 6, [0.0] * 6, [0.0] * 6
        self.rotation = 0.0                           # degrees, about Z
        self.plane = "XY"
        self.feed = {"linear": 0.0, "rotary": 0.0}    # mm/min and deg/min; per revolution with "upr"
        self.feed_mode = "upm"
        self.sync = None                              # mm per revolution
        self.delayed = False                          # under G41 and G42 calls come lines later: theirs are not known
        self.at = [0.0] * 6
        self.direction, self.rpm, self.selected = 0, 0.0, 0

    def records(self, text):
        """All records of what rs274 printed, with "line" as the N word says it."""
        held = None                                   # a stop of the standing spindle
        for printed in text.splitlines():
            call = self.CALL.match(printed)
            if held and not (call and call[2] in ("CHANGE_TOOL", "SET_SPINDLE_MODE", "PROGRAM_END")):
                yield held
            held = None
            if call is None:
                if printed.strip():                   # (PRINT,) writes bare text
                    yield {"t": "print", "text": " ".join(printed.split())}
                continue
            number, name, arguments = call.groups()
            stood = self.direction == 0
            record = getattr(self, "on_" + name.lower(), lambda _: None)(arguments)
            if record:
                line = {"line": int(number)} if number.isdigit() and not self.delayed else {}
                record = {"t": record.pop("t"), **line, **record}
                if name == "STOP_SPINDLE_TURNING" and stood:
                    held = record
                else:
                    yield record

    def mm(self, values):
        return [x * self.scale for x in values[:3]] + list(values[3:6])

    def in_machine(self, point):
        x, y, *others = (p + s for p, s in zip(point, self.shift))
        cos, sin = math.cos(math.radians(self.rotation)), math.sin(math.radians(self.rotation))
        turned = [x * cos - y * sin, x * sin + y * cos, *others] if self.rotation else [x, y, *others]
        return [p + s + t for p, s, t in zip(turned, self.system, self.tool_offset)]

    def motion(self, kind, end, **more):
        linear = kind == "arc" or any(abs(p - q) > LEAST_MOVE for p, q in zip(end[:3], self.at[:3]))
        record = {"t": kind, "end": end, "mend": self.in_machine(end)}
        if kind in ("feed", "arc", "probe") and self.sync is None:
            record.update(feed=self.feed["linear" if linear else "rotary"], fmode=self.feed_mode)
        if self.sync is not None and kind in ("feed", "arc", "tap"):
            record["sync"] = self.sync
        self.at = end
        return {**record, **more}

    # calls that move
    def on_straight_traverse(self, arguments):
        return self.motion("rapid", self.mm(numbers(arguments)))

    def on_straight_feed(self, arguments):
        return self.motion("feed", self.mm(numbers(arguments)))

    def on_straight_probe(self, arguments):
        return self.motion("probe", self.mm(numbers(arguments)))

    def on_rigid_tap(self, arguments):
        return self.motion("tap", self.mm(numbers(arguments)[:3]) + self.at[3:])

    def on_arc_feed(self, arguments):
        first, second, centre1, centre2, turns, third, *rotary = numbers(arguments)
        end, centre = [0.0] * 3, [0.0] * 3
        for axis, p, c in zip(self.PLANES[self.plane], (first, second, third), (centre1, centre2, third)):
            end[axis], centre[axis] = p, c
        end, centre = self.mm(end + rotary), self.mm(centre + rotary)
        return self.motion("arc", end, plane=self.plane, center=[centre1 * self.scale, centre2 * self.scale],
                           mcenter=self.in_machine(centre)[:3], turns=int(turns))

    def on_nurbs_feed(self, arguments):
        record = {"t": "nurbs", "npts": int(arguments.split(",")[0])}
        chords = next(self.splines, None)
        if chords is None:
            self.at = [math.inf, math.inf, *self.at[2:]]
            return record
        feed = {} if self.feed_mode == "inv" else {"feed": self.feed["linear"], "fmode": self.feed_mode}
        x, y = ([point[i] for point in chords] for i in (0, 1))
        self.at = [x[-1], y[-1], *self.at[2:]]
        return {**record, **feed, "chord_x": x, "chord_y": y}

    on_nurbs_g5_feed = on_nurbs_feed

    def on_dwell(self, arguments):
        return {"t": "dwell", "sec": float(arguments)}

    # calls that tell something
    def on_change_tool(self, _):
        return {"t": "tool", "n": self.selected}

    def on_set_spindle_speed(self, arguments):
        self.rpm = numbers(arguments)[-1]
        return {"t": "spindle", "rpm": self.rpm}

    def turning(self, direction):
        self.direction = direction
        return {"t": "spindle", "dir": direction, "rpm": self.rpm}

    def on_start_spindle_clockwise(self, _):
        return self.turning(1)

    def on_start_spindle_counterclockwise(self, _):
        return self.turning(-1)

    def on_stop_spindle_turning(self, _):
        return self.turning(0)

    def on_program_stop(self, _):
        return {"t": "stop", "kind": "PROGRAM_STOP"}

    def on_optional_program_stop(self, _):
        return {"t": "stop", "kind": "OPTIONAL_PROGRAM_STOP"}

    def on_program_end(self, _):
        return {"t": "end"}

    def on_message(self, arguments):
        return {"t": "msg", "text": " ".join(arguments.strip()[1:-1].split())}

    # calls that only change the state
    def on_set_feed_rate(self, arguments):
        rate = float(arguments)
        self.feed = {"linear": rate * self.scale, "rotary": rate}

    def on_set_feed_mode(self, arguments):
        per_revolution = numbers(arguments)[-1] != 0.0
        self.feed_mode = "upr" if per_revolution else "upm" if self.feed_mode == "upr" else self.feed_mode

    def on_comment(self, arguments):
        if arguments.startswith('"interpreter: cutter radius compensation'):
            self.delayed = not arguments.endswith('off"')
        for text, mode in (("inverse time", "inv"), ("units per minute", "upm")):
            if arguments == f'"interpreter: feed mode set to {text}"':
                self.feed_mode = mode

    def on_use_length_units(self, arguments):
        self.scale = MM_PER_INCH if "INCHES" in arguments else 1.0

    def on_select_plane(self, arguments):
        self.plane = arguments.removeprefix("CANON_PLANE_")

    def on_set_g5x_offset(self, arguments):
        self.system = self.mm(numbers(arguments)[1:])

    def on_set_g92_offset(self, arguments):
        self.shift = self.mm(numbers(arguments))

    def on_set_xy_rotation(self, arguments):
        self.rotation = float(arguments)

    def on_use_tool_length_offset(self, arguments):
        self.tool_offset = self.mm(numbers(arguments))

    def on_start_speed_feed_sync(self, arguments):
        self.sync = numbers(arguments)[0] * self.scale

    def on_stop_speed_feed_synch(self, _):
        self.sync = None

    def on_select_tool(self, arguments):
        self.selected = int(arguments)


def numbers(arguments):
    return [float(word) for word in re.split(r"[,\s]+", arguments.strip()) if word]


# ---------------------------------------------------------------------------------------------------------- running it
class Interpreter:
    """rs274, made precise; to be used in a `with`, for it keeps copies of programs in a folder of its own."""

    def __init__(self, path=None):
        self.binary = find(path)
        self.folder = tempfile.TemporaryDirectory(prefix="rs274-")
        self.home = pathlib.Path(self.folder.name)
        self.precise, self.resolution = self._precise_copy()
        self.environment = self._environment()
        self.places, self.files = {}, []    # folder: its copies; all files in the order of their numbers

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.folder.cleanup()

    def _precise_copy(self):
        """A copy that prints nine decimals in mm, and what half its last decimal is in mm, in inches at worst."""
        code = self.binary.read_bytes()
        inches = struct.pack("<d", 0.03937007874016)
        if b"%.4f" not in code or code.count(inches) != 1:
            return self.binary, 0.5e-4 * MM_PER_INCH
        copy = self.home / "rs274"
        copy.write_bytes(code.replace(b"%.4f", b"%.9f").replace(inches, struct.pack("<d", 1.0)))
        copy.chmod(0o700)
        return copy, 0.5e-9 * MM_PER_INCH

    def _environment(self):
        """Lets a binary that is unpacked below some root find its libraries; it writes a tool memory into HOME."""
        environment = {key: value for key, value in os.environ.items() if key != "PYTHONHOME"}
        root = self.binary.parents[2]
        libraries = [str(root / "usr/lib"), *map(str, (root / "usr/lib").glob("*-linux-gnu"))]
        if root != pathlib.Path("/"):
            environment["LD_LIBRARY_PATH"] = ":".join(libraries)
            environment["PYTHONPATH"] = str(root / "usr/lib/python3/dist-packages")
        return {**environment, "HOME": str(self.home)}

    def _stage(self, folder, more=()):
        """The folder that holds copies of the programs of `folder`, "plain" and "numbered"."""
        place = self.places.setdefault(folder, self.home / f"programs{len(self.places)}")
        programs = {path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES and path.is_file()}
        for path in sorted(programs.union(more).difference(self.files)):
            text = path.read_bytes()
            for kind, code in (("plain", text), ("numbered", numbered(text, len(self.files) + 1))):
                (place / kind).mkdir(parents=True, exist_ok=True)
                (place / kind / path.name).write_bytes(code)
            self.files.append(path)
        return place

    def records(self, program, *, tools=None, parameter_file=None, subs=None, block_delete=False, timeout=60.0):
        """What rs274 makes of a program; a record "error" with "msg" comes last if it refuses the program.

        "line" counts in the file that "file" names, where that is not the program itself. It is missing where rs274
        does not tell it. None if the program did not end within `timeout` seconds, or wrote far too much.
        """
        program = pathlib.Path(program).resolve()
        place = self._stage(program.parent, [program])
        subs = self._stage(pathlib.Path(subs).resolve()) if subs else None
        run = functools.partial(self._run, program.name, place, tools=tools, parameter_file=parameter_file, subs=subs,
                                block_delete=block_delete, timeout=timeout)
        plain, with_lines = run("plain"), run("numbered")
        if plain is None or with_lines is None:
            return None
        if any(record["t"] == "nurbs" for record in plain):
            splines = self._splines(place / "plain" / program.name, plain, block_delete, timeout)
            plain, with_lines = run("plain", splines=splines), run("numbered", splines=splines)
        records = [without(record, "line") for record in plain]
        if [without(r, *SAID) for r in records] == [without(r, "line", *SAID) for r in with_lines]:
            records = [{**record, **only(counted, "line")} for record, counted in zip(records, with_lines)]
        return [self._placed(record, program) for record in records]

    def _placed(self, record, program):
        """With "line" split into file and line."""
        if "code" in record:
            code = record.pop("code")
            lines = program.read_text(errors="replace").split("\n")
            like = [i for i, line in enumerate(lines, 1) if code and line.startswith(code)]
            if record.get("line", 0) < LINES_OF_A_FILE and len(like) == 1:
                return {"t": "error", "line": like[0], "msg": record["msg"]}
        index, line = divmod(record.get("line", 0), LINES_OF_A_FILE)
        if not 0 < index <= len(self.files):
            return without(record, "line")
        file = {} if self.files[index - 1] == program else {"file": self.files[index - 1].name}
        return {"t": record["t"], "line": line, **file, **without(record, "t", "line")}

    def _splines(self, program, records, block_delete, timeout):
        """Chords of the splines among the records, as far as they can be found among the straight feeds of the module."""
        command = [PYTHON, "-B", FEEDS, program.name, self.home / "module.var", str(int(block_delete))]
        (self.home / "module.var").touch()
        try:
            done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, env=self.environment,
                                  cwd=program.parent, timeout=timeout, check=False)
        except (subprocess.TimeoutExpired, OSError):
            return []
        feeds = [json.loads(line) for line in done.stdout.decode(errors="replace").splitlines() if line.startswith("[")]
        splines = []
        for record in records:
            if record["t"] not in ("feed", "nurbs") or not feeds:
                continue
            visit = feeds[0][0]
            count = 1 if record["t"] == "feed" else len(list(itertools.takewhile(lambda feed: feed[0] == visit, feeds)))
            if record["t"] == "nurbs":
                if count - CHORDS_PER_POINT * record["npts"] not in (0, 1):
                    break
                splines.append([[x * MM_PER_INCH, y * MM_PER_INCH] for _, x, y in feeds[:count]])
            feeds = feeds[count:]
        return splines

    def _run(self, name, place, kind, *, tools, parameter_file, subs, block_delete, timeout, splines=()):
        for given, copy in ((tools, "tools.tbl"), (parameter_file, "parameters.var")):
            shutil.copyfile(given or os.devnull, self.home / copy)
        command = [self.precise, "-t", self.home / "tools.tbl", "-v", self.home / "parameters.var", "-g"]
        command += ["-b"] if block_delete else []
        if subs:
            ini = self.home / f"{kind}.ini"
            ini.write_text(f"[RS274NGC]\nSUBROUTINE_PATH = {subs / kind}\n")
            command += ["-i", ini]
        with open(self.home / "canon", "w+b") as out:
            try:
                run = subprocess.run([*command, name], stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.PIPE,
                                     timeout=timeout, env=self.environment, cwd=place / kind, check=False,
                                     preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (MOST_OUTPUT,) * 2))
            except subprocess.TimeoutExpired:
                return None
            if run.returncode == -signal.SIGXFSZ:
                return None
            out.seek(0)
            records = list(Canon(splines).records(out.read().decode(errors="replace")))
        return records + ([fault(run)] if run.returncode != 0 else [])


def numbered(text, index):
    """A program with N words that tell file and line, where there is room for them."""
    lines = text.split(b"\n")
    marked = next((line for line in lines if line.strip()), b"").strip() == b"%"    # lines with % enclose it
    for i, line in enumerate(lines):
        slash, code = N_WORD.match(line).groups()
        line = b"%sN%d %s" % (slash, index * LINES_OF_A_FILE + i + 1, code)
        joins = code.strip()[:1] in b"0123456789."    # would be part of the number; also where nothing is left
        if not joins and len(line) <= LONGEST_LINE and not (marked and lines[i].strip() == b"%"):
            lines[i] = line
    return b"\n".join(lines)


def fault(run):
    """The last two lines on standard error are the message and the text of the line."""
    said = [line for line in run.stderr.decode(errors="replace").splitlines() if line.strip() not in ("", "executing")]
    number = re.match(r"/?N(\d+)", said[-1]) if len(said) > 1 else None
    line = {"line": int(number[1])} if number else {}
    message = said[-2] if len(said) > 1 else said[-1] if said else f"exit status {run.returncode}"
    return {"t": "error", **line, "msg": message.strip(), "code": said[-1].rstrip() if len(said) > 1 else ""}


def only(record, *keys):
    return {key: record[key] for key in keys if key in record}


def without(record, *keys):
    return {key: value for key, value in record.items() if key not in keys}
