#!/usr/bin/env python3
"""Records what LinuxCNC's stand-alone interpreter makes of programs/*.ngc, one PROGRAM.jsonl each.

    record.py [PROGRAM.ngc ...]

Needs rs274 (tools/rs274.py says where it is looked for). All programs run with programs/tools.tbl and find subroutines
in programs/subs; those whose names end in block_delete_on leave out lines that begin with "/"; PROGRAM.var beside a
program is its parameter file. Of an error its line is kept: the wording is our own.
"""
import json
import pathlib
import sys

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent / "programs"
sys.path.insert(0, str(HERE.parents[2] / "tools"))
import rs274  # noqa: E402


def rounded(value):
    """rs274 printed nine decimals; the last ones of a product with 25.4 or a cosine mean nothing."""
    if isinstance(value, list):
        return [rounded(x) for x in value]
    return round(value, 12) + 0.0 if isinstance(value, float) else value


def record(interpreter, program):
    parameters = program.with_suffix(".var")
    records = interpreter.records(program, tools=HERE / "tools.tbl", subs=HERE / "subs",
                                  parameter_file=parameters if parameters.exists() else None,
                                  block_delete=program.stem.endswith("block_delete_on"))
    if records is None:
        sys.exit(f"{program}: rs274 did not come to an end")
    kept = [{key: rounded(value) for key, value in rs274.without(r, "msg").items()} for r in records]
    program.with_suffix(".jsonl").write_text("".join(json.dumps(r, ensure_ascii=False) + "\n" for r in kept), encoding="utf-8")


def main():
    programs = [pathlib.Path(p).resolve() for p in sys.argv[1:]] or sorted(HERE.glob("*.ngc"))
    try:
        with rs274.Interpreter() as interpreter:
            for program in programs:
                record(interpreter, program)
    except rs274.Missing as fault:
        sys.exit(str(fault))


if __name__ == "__main__":
    main()
