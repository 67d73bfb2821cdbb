"""Mistakes of users, which tools/plot.py reports in one line."""
import dataclasses
import os
import shutil
import signal
import subprocess
import sys
import unittest.mock

from plot_files import PLOT, WithFiles, plot, plot_names, program

import h5py
import numpy as np


class OutputFiles(WithFiles):
    """-o with the name of a file."""

    def test_one_figure_into_a_file_of_that_name(self):
        for name, start in (("a.png", b"\x89PNG"), ("b.svg", b"<?xml"), ("new/c.PDF", b"%PDF")):
            path = self.out / name
            done = plot(self.side, "--figures", "figure6", "-o", path)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (0, f"{path}\n", ""))
            self.assertTrue(path.read_bytes().startswith(start), name)
        done = plot(self.side, "--figures", "figure6", "-o", self.out / "a.png")
        self.assertEqual((done.returncode, done.stderr), (2, f"{self.out / 'a.png'}: error: exists; use --force to overwrite\n"))

    def refuses(self, message, target, *arguments):
        done = plot(*arguments, "-o", target)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (2, "", f"{target}: error: {message}\n"))

    def test_what_cannot_be_one(self):
        self.refuses("takes one figure, not 2 (side-figure6, side-figure9); name one with --figures, or a folder with -o",
                     self.out / "a.png", self.side, "--figures", "figure6,figure9")
        self.refuses("ends in .png, but --format is svg", self.out / "a.png", self.side, "--format", "svg")
        self.refuses("figures are written as png, svg, pdf", self.out / "a.jpg", self.side)
        self.refuses(".txt is not a figure format; must be one of png, svg, pdf; make a folder of that name first",
                     self.out / "one.txt", self.side)
        self.refuses("is a file; figures go into a folder, or into a file that ends in .png, .svg, .pdf",
                     self.side, self.side, "--force")
        self.assertEqual(self.drawn(), [])
        before = self.side.read_bytes()
        alias = self.out / "alias.png"
        alias.symlink_to(self.side)
        self.refuses("is an input of this command", alias, self.side, "--figures", "figure6", "--force")
        self.assertEqual(self.side.read_bytes(), before)


class Mistakes(WithFiles):
    def test_a_figure_that_is_asked_for_and_not_held(self):
        self.fails(f"{self.side}: error: lag: the file contains a run, not a sweep", self.side, "--figures", "lag")
        self.fails(f"{self.contour}: error: figure9: the imposed errors are functions of X, Y, Z, "
                   "not of X alone", self.contour, "--figures", "figure9")
        self.fails(f"{self.side}: error: lag: the file contains a run, not a sweep\n"
                   f"{self.side}: error: nest: the scenario asks for no radial_ball_deviation", self.side, "--figures", "lag,nest")

    def test_of_several_figures_those_are_drawn_that_the_file_holds(self):
        done = plot_names(self.side, "-o", self.out, "--figures", "figure6,lag,nest")
        self.assertEqual((done.returncode, done.stderr.splitlines()), (0, [
            "lag: not drawn, the file contains a run, not a sweep",
            "nest: not drawn, the scenario asks for no radial_ball_deviation"]))
        self.assertEqual(self.drawn(), ["side-figure6.png"])

    def test_a_figure_that_fails_costs_no_other(self):
        def fail(_):
            raise np.linalg.LinAlgError("SVD did not converge")

        figures = [dataclasses.replace(one, draw=fail) if one.name == "figure9" else one for one in program.FIGURES]
        with unittest.mock.patch.object(program, "FIGURES", figures):
            done = plot_names(self.side, "-o", self.out, "--figures", "figure6,figure9")
            self.assertEqual((done.returncode, done.stderr), (
                0, "figure9: not drawn, drawing it failed (LinAlgError: SVD did not converge)\n"))
            self.assertEqual(self.drawn(), ["side-figure6.png"])
            done = plot_names(self.side, "-o", self.out / "all")
            self.assertEqual((done.returncode, done.stderr.splitlines()), (0, [   # a failure is reported unasked
                "figure9: not drawn, drawing it failed (LinAlgError: SVD did not converge)",
                "18 figures skipped: the file lacks their data (--why)"]))

    def test_a_file_that_cannot_be_read_costs_no_other(self):
        missing = self.root / "missing.h5"
        done = plot_names(missing, self.side, "-o", self.out, "--figures", "figure6")
        self.assertEqual((done.returncode, done.stderr), (2, f"{missing}: error: no such file\n"))
        self.assertEqual(self.drawn(), ["side-figure6.png"])

    def test_status_of_the_process(self):
        done = subprocess.run([PLOT, self.root / "missing.h5"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (2, ""))

    def test_files_whose_figures_would_have_the_same_name(self):
        self.fails("plot.py: error: two files are named side; draw them separately",
                   self.side, self.root / "elsewhere" / "side.h5")

    def test_names_that_do_not_exist(self):
        self.fails("plot.py: error: no figure is named figur9; did you mean figure9?",
                   self.side, "--figures", "figur9")
        self.fails("plot.py: error: no format is named jpeg; there are png, svg, pdf",
                   self.side, "--format", "jpeg")
        self.fails("plot.py: error: expected at least one result file; see plot.py --help")

    def test_files_that_are_not_results(self):
        missing, text, foreign, newer = (self.root / name for name in
                                         ("missing.h5", "text.h5", "foreign.h5", "newer.h5"))
        text.write_text("no HDF5\n")
        with h5py.File(foreign, "w") as file:
            file["data"] = 1.0
        shutil.copy(self.sweep, newer)
        with h5py.File(newer, "a") as file:
            file.attrs["schema_version"] = 99
        self.fails(f"{missing}: error: no such file", missing)
        self.fails(f"{text}: error: is not an HDF5 file", text)
        self.fails(f"{foreign}: error: is not a result file of servomill", foreign)
        self.fails(f"{newer}: error: has schema version 99; this program reads version 3", newer)

    def test_a_pipe_is_refused_at_once(self):
        pipe = self.root / "pipe.h5"
        os.mkfifo(pipe)
        done = subprocess.run([PLOT, pipe], capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stdout, done.stderr),
                         (2, "", f"{pipe}: error: is not a regular file\n"))

    def test_an_interrupt_ends_it_without_a_traceback(self):
        # an interrupt from a terminal goes to the whole group: the process that waits and the one that draws
        process = subprocess.Popen([PLOT, self.side, "-o", self.out, "--format", "png,svg,pdf"], start_new_session=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        process.stdout.readline()   # it draws
        os.killpg(process.pid, signal.SIGINT)
        _, said = process.communicate(timeout=60)
        self.assertEqual((process.returncode, said.count("Traceback"), said.count("KeyboardInterrupt")), (130, 0, 0))

    def test_a_damaged_file(self):
        cut, hollow = self.root / "cut.h5", self.root / "hollow.h5"
        cut.write_bytes(self.side.read_bytes()[:100_000])
        done = plot(cut, "-o", self.out)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"^\S+cut.h5: error: cannot be read as HDF5: .*\n$")
        shutil.copy(self.side, hollow)
        with h5py.File(hollow, "a") as file:
            del file["cases/table/servo/s"]
        self.fails(f"{hollow}: error: figure9: case table has no s", hollow, "--figures", "figure9")

    def test_a_file_on_which_the_library_crashes(self):
        crash = ("import os, signal, sys; sys.path.insert(0, sys.argv.pop(1)); import plot; "
                 "plot.open_result = lambda file: os.kill(os.getpid(), signal.SIGSEGV); sys.exit(plot.run_apart(sys.argv[1:]))")
        done = subprocess.run([sys.executable, "-B", "-c", crash, PLOT.parent, self.side, "-o", self.out],
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout, done.stderr),
                         (2, "", f"{self.side}: error: is damaged (reading it ended with SIGSEGV)\n"))
        done = subprocess.run([PLOT, self.side, "-o", self.out, "--figures", "figure6"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, f"{self.out}/side-figure6.png\n", ""))

    def test_files_that_lack_what_every_one_holds(self):
        def damaged(source, change):
            path = self.root / "damaged.h5"
            shutil.copy(source, path)
            with h5py.File(path, "a") as file:
                change(file)
            done = plot(path, "-o", self.out)
            self.assertEqual((done.returncode, done.stdout, self.drawn()), (2, "", []), done.stderr)
            return done.stderr.replace(str(path), "FILE")

        def set_version(file):
            file.attrs["schema_version"] = "one"

        def lose(name, attribute=None):
            def change(file):
                del (file[name].attrs if attribute else file)[attribute or name]
            return change

        self.assertRegex(damaged(self.side, set_version), r"^FILE: error: is damaged \(.*'one'.*\)\n$")
        self.assertRegex(damaged(self.side, lose("cases/table", "finished")), r"^FILE: error: is damaged \(.*finished.*\)\n$")
        self.assertRegex(damaged(self.side, lose("cases/table/servo")), r"^FILE: error: is damaged \(.*servo.*\)\n$")
        self.assertRegex(damaged(self.sweep, lose("sweep/program_feed_override", "key")),
                         r"^FILE: error: is damaged \(.*key.*\)\n$")
