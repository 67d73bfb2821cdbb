"""Looks, texts and pictures: how tools/plot.py tells cases apart."""
import dataclasses

from plot_files import WithFiles, program

import numpy as np
from PIL import Image

from figures import five_axis, results, style


class Looks(WithFiles):
    def test_a_case_takes_the_look_of_its_name_or_of_its_last_strategy(self):
        class File:
            scenario = {"case": [
                {"name": "north", "strategy": [{"type": "gcode"}, {"type": "feedback"}]},
                {"name": "east", "strategy": [{"type": "feedback", "extrapolation_time_ms": "auto"}]},
                {"name": "plain", "strategy": [{"type": "none"}]},
                {"name": "table", "strategy": [{"type": "gcode"}]}]}
            strategies = results.ResultFile.strategies

        for case, colour in (("north", style.PURPLE), ("east", style.LIGHT_PURPLE),
                             ("plain", style.BLACK), ("table", style.BLUE)):
            self.assertEqual(style.look_of(File(), case).colour, colour, case)

    def test_cases_with_one_strategy_differ_in_line_and_shade(self):
        class File:
            scenario = {"case": [{"name": n, "strategy": [{"type": "none"}]} for n in "abcd"]}
            strategies = results.ResultFile.strategies

        looks = [style.look_of(File(), case) for case in "abcd"]
        self.assertEqual(looks[0].colour, style.BLACK)
        self.assertEqual(len({look.colour for look in looks}), 4)
        self.assertEqual(len({look.line for look in looks}), 4)

    def test_cases_that_are_not_shown_change_no_look(self):
        class File:
            scenario = {"case": [{"name": n, "strategy": [{"type": "none"}]} for n in "abc"]}
            strategies = results.ResultFile.strategies

        self.assertEqual(style.look_of(File(), "b", "bc").colour, style.BLACK)
        self.assertEqual(style.look_of(File(), "c", "bc"), dataclasses.replace(style.look_of(File(), "b"), label="c"))

    def test_strategies_differ_in_grey_or_in_line(self):
        shown = [style.LOOKS[name] for name in ("nominal", "table", "feedback", "feedback_lead",
                                                "gcode")]

        def grey(look):
            r, g, b = (int(look.colour[i:i + 2], 16) for i in (1, 3, 5))
            return 0.299 * r + 0.587 * g + 0.114 * b

        for i, one in enumerate(shown):
            for other in shown[:i]:
                self.assertTrue(abs(grey(one) - grey(other)) > 20 or one.line != other.line,
                                f"{one.label} and {other.label}")

    def test_cases_are_called_alike_in_all_figures(self):
        class File:
            scenario = {"case": [{"name": "none", "strategy": [{"type": "none"}]},
                                 {"name": "gcode_ideal", "strategy": [{"type": "gcode"}]}]}
            strategies = results.ResultFile.strategies

        self.assertEqual([style.look_of(File(), one).label for one in ("none", "nominal", "gcode_ideal")],
                         ["uncompensated", "nominal", "G-code ideal"])

    def test_a_legend_takes_as_many_lines_as_it_needs(self):
        def looks(label, count):
            return [style.Look(label, style.BLACK)] * count

        self.assertEqual(style.legend_shape(looks("table", 4), 9.6), (4, 1))
        self.assertEqual(style.legend_shape(looks("feedback with lead", 8), 9.6), (4, 2))
        self.assertEqual(style.legend_shape(looks("a name as long as it gets, and then some", 2), 3.0), (1, 2))

    def test_envelope_is_the_largest_of_three_pieces(self):
        s = np.linspace(0.0, 10.0, 1001)
        ripple = np.abs(np.sin(40.0 * s))
        ripple[550] = 7.0
        at, largest = five_axis.envelope(s, ripple, 1.0)
        self.assertEqual((at[0], at[-1], largest.max()), (0.0, 10.0, 7.0))
        np.testing.assert_allclose(at[largest == 7.0], [4.5, 5.5, 6.5], atol=0.02)
        self.assertGreater(largest.min(), 0.99)


class Pictures(WithFiles):
    PALETTE_TOL = 16   # of 255: colours of a few points and of a bar of colours are still distinguished

    def test_a_palette_leaves_rare_colours_what_they_are(self):
        style.set_up()
        figure, ax = style.plt.subplots()
        self.addCleanup(style.plt.close, figure)
        ax.scatter(range(9), range(9), c=np.linspace(-1.0, 1.0, 9), cmap="RdBu_r", s=9)
        for look in style.LOOKS.values():
            ax.plot([0.0, 1.0], [8.0, 8.0], color=look.colour)
        figure.colorbar(style.matplotlib.cm.ScalarMappable(cmap="RdBu_r"), ax=ax)
        program.save(figure, self.out / "palette.png", "png")
        drawn = np.asarray(figure.canvas.buffer_rgba())[:, :, :3].astype(int)
        with Image.open(self.out / "palette.png") as picture:
            self.assertEqual(picture.mode, "P")
            saved = np.asarray(picture.convert("RGB")).astype(int)
        self.assertLess(np.abs(saved - drawn).max(), self.PALETTE_TOL)
        colours, counts = np.unique(drawn.reshape(-1, 3), axis=0, return_counts=True)
        common = colours[np.argsort(counts)[-3:]]     # paper, grid, frame
        for colour in common:
            self.assertTrue((saved[(drawn == colour).all(axis=2)] == colour).all(), colour)
