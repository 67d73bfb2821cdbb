#!/usr/bin/python3
"""tools/plot.py draws what a result file holds, agrees with `servomill compare`, and says what is
wrong with a file in one line. Usage: plot_test.py SERVOMILL"""
import sys
import unittest

import plot_files
from plot_drawing import *
from plot_looks import *
from plot_mistakes import *
from plot_numbers import *
from plot_parts import *
from plot_windows import *

if __name__ == "__main__":
    with plot_files.shared_files(sys.argv.pop(1)):
        unittest.main(verbosity=1)
