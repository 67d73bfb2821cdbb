#!/usr/bin/python3
"""Prints [visit, x, y] for every straight feed of a program, by LinuxCNC's Python module `gcode`: a spline is many of them.

    rs274_feeds.py PROGRAM PARAMETER_FILE BLOCK_DELETE

Inches. Visits of lines are counted.
"""
import json
import sys

import gcode


class Canon:
    """Prints feeds, has no tools, and takes no notice of everything else."""

    parameter_file = sys.argv[2]
    visits = 0

    def next_line(self, _):
        self.visits += 1

    def straight_feed(self, x, y, *_):
        print(json.dumps([self.visits, x, y]))

    def get_block_delete(self):
        return int(sys.argv[3])

    def get_tool(self, _):
        return (-1,) + (0.0,) * 12 + (0,)

    def check_abort(self):
        return False

    def get_external_angular_units(self):
        return 1.0

    def get_external_length_units(self):
        return 1.0

    def get_axis_mask(self):
        return 0x3f

    def __getattr__(self, name):
        if name.startswith("__") or name in ("use_move_batches", "move_batch"):
            raise AttributeError(name)
        return lambda *_: None


gcode.parse(sys.argv[1], Canon(), "G21", "")
