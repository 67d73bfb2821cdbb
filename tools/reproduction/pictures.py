"""Figures of both papers, drawn from our results with the figures of tools/plot.py."""
import dataclasses
import pathlib

import plot
from command_line import InputError
from figures import li_flow, li_table31, style
from figures.catalogue import FIGURES
from figures.results import NotInFile
from reproduction import derived


@dataclasses.dataclass(frozen=True)
class Picture:
    paper: str       # "G" or "L"
    number: str      # of the paper's figure
    figure: str      # of figures.catalogue
    runs: tuple      # results that it is drawn from: the first that holds what it needs
    shows: str       # what the paper's figure shows
    here: str = ""   # what is different in ours

    def name(self):
        return f"{self.paper}_{self.number.replace('.', '_').replace(' ', '_')}"


PICTURES = (
    Picture("G", "6", "figure6", ("experiment1",),
            "the error functions imposed along X: straightness (one curve for Y and Z, -150 to +150 µm) and positioning.",
            "the paper's curves have no numbers; ours are chosen."),
    Picture("G", "9", "figure9", ("experiment1_part", "experiment1"),
            "horizontal straightness: (a) trajectory of Y, probed points with bars of 2σ and imposed curve for table, "
            "feedback and G-code; (b) differences to the imposed curve; (c) feedback and G-code enlarged."),
    Picture("G", "10", "figure10", ("experiment1_part", "experiment1"),
            "the same for Z over the horizontal plane; the probed points suffer from back-cutting."),
    Picture("G", "11", "figure11", ("experiment1_part", "experiment1"),
            "positions of the notches along X against the imposed positioning error; all strategies within 2 µm."),
    Picture("G", "lag", "lag", ("experiment1_feed",),
            "no figure, but the words that the table's response time is constant whatever the feed.",
            "residual and response time over the feed."),
    Picture("G", "12", "figure12", ("experiment2",),
            "some of the polynomials of Z among the 21 imposed errors.", "all six of Z; coefficients are chosen."),
    Picture("G", "14", "figure14", ("experiment2",),
            "trajectories of the contours, nominal, generated, compensated, and difference vectors in X, Y, Z."),
    Picture("G", "15", "figure15", ("experiment2",),
            "the same for the top plane."),
    Picture("G", "16", "figure16", ("experiment2",),
            "Z of the circle in air (dashed, nominal and compensated coincide) and while cutting (shifted, each part "
            "differently: forces, wear, an elastic Z axis)."),
    Picture("G", "17", "figure17", ("experiment2",),
            "top plane: trajectory, probed points and least-squares planes of the three parts; table 2 has their rotations."),
    Picture("G", "18", "figure18", ("experiment2",),
            "quiver plots of the three parts in XY after best fit: distances of the probed points to the CAD model, up to "
            "86 µm on the modified part."),
    Picture("G", "19", "figure19", ("experiment2",),
            "the three parts superposed, distances x 100: nominal and compensated lie on each other."),
    Picture("L", "3.1", "li_3_1", (), "flow of modelling and compensation."),
    Picture("L", "3.2", "li_3_2", ("example1_unit",),
            "error at the 23 points of table 3.1, largest 0.973 mm.", "tool axes of unit length."),
    Picture("L", "table 3.1", "li_table31", ("example1_unit",),
            "the values behind figure 3.2.", "tool axes of unit length; how far a sine and a parabola are from the table."),
    Picture("L", "3.3", "li_3_3", ("example1_unit",),
            "example 1 in the machine: path uncompensated, compensated and ideal; error before and after."),
    Picture("L", "4.1", "li_4_1", ("table32_identified", "table32_low"),
            "example 2 in the machine: path uncompensated, compensated and ideal, with an enlargement."),
)

NOT_DRAWN = ("Not drawn, since they are sketches and photographs: [G] figures 1 to 5, 7, 8, 13.",)


@dataclasses.dataclass(frozen=True)
class Drawn:
    picture: Picture
    file: pathlib.Path | None
    run: str = ""
    reason: str = ""     # why there is no file


def _draw(picture, results):
    if not picture.runs:
        return li_flow.draw(None), ""
    drawers = {figure.name: figure.draw for figure in FIGURES}
    drawers["li_table31"] = lambda run: li_table31.draw(run, derived.table31())
    if picture.figure not in drawers:
        raise NotInFile(f"no figure is named {picture.figure}")
    reasons = []
    for run in picture.runs:
        try:
            return drawers[picture.figure](results.opened(run)), run
        except NotInFile as reason:
            reasons.append(f"{run}: {reason}")
    raise NotInFile("; ".join(reasons))


def draw_all(results, folder, tell):
    """Draws what can be drawn as PNG into the folder: [Drawn]."""
    style.set_up()
    folder.mkdir(parents=True, exist_ok=True)
    found = []
    for picture in PICTURES:
        try:
            figure, run = _draw(picture, results)
            file = folder / f"{picture.name()}.png"
            plot.save(figure, file, "png")
            found.append(Drawn(picture, file, run))
        except (NotInFile, InputError) as reason:
            found.append(Drawn(picture, None, reason=f"{reason}"))
        except Exception as fault:   # one that fails must not cost the others
            found.append(Drawn(picture, None, reason=plot.failure(fault)))
        if found[-1].reason:
            tell(f"      figure {picture.number} of [{picture.paper}] is not drawn: {found[-1].reason}")
        style.plt.close("all")
    return found
