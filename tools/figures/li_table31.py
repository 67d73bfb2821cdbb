"""Table 3.1 of X. Li (2024) compared with the error of the same segment here, in micrometres."""
import numpy as np

from figures import nonlinear, style


def draw(run, table):
    """@param table  the paper's values (mm) at points 0.1 mm apart, the last one at the end"""
    way, error = nonlinear.Segments(run).off_the_chord()
    points = np.append(np.arange(0.0, way[-1], nonlinear.SPACING), way[-1])
    here = np.interp(points, way, np.linalg.norm(error, axis=1))
    t = points / way[-1]
    paper = 1000.0 * table
    curves = [(style.Look("sine through the table's peak", style.BLUE, style.DASH, ""), paper.max() * np.sin(np.pi * t)),
              (style.Look("parabola", style.RED, style.DASH_DOT, ""), 4.0 * paper.max() * t * (1.0 - t)),
              (style.Look("here", style.PURPLE, "-", "o", 1.4), here)]
    table_look = style.Look("table 3.1 of the paper", style.BLACK, "-", "s", 1.0)
    figure, strip, grid = style.panels([1.0], (12.6, 4.4), columns=3)
    style.legend(strip, [table_look] + [look for look, _ in curves], points=True)
    values, models, apart = grid[0]
    values.plot(points, paper, "s", color=style.BLACK, markersize=7, markerfacecolor="none", zorder=3.5)
    for look, curve in curves:
        style.line(values, points, curve, look, marker=look.marker, markersize=3.5)
        style.line(models, points, curve - paper, look, marker=look.marker, markersize=3.5)
    look, curve = curves[-1]
    style.line(apart, points, curve - paper, look, marker=look.marker, markersize=3.5)
    values.set_title(f"Values: paper's peak {paper.max():.1f} µm, here {here.max():.1f} µm")
    values.set_ylabel("error, µm")
    models.set_title("Difference to table 3.1")
    apart.set_title("Here alone")
    for ax in (models, apart):
        ax.axhline(0.0, color=style.BLACK, linewidth=0.8)
        ax.set_ylabel("minus table, µm")
    for ax in grid[0]:
        ax.set_xlabel("distance along the chord, mm")
    style.headline(figure, f"Table 3.1 from tool axes of unit length: within {np.abs(here - paper).max():.1f} µm; "
                           f"a sine is {np.abs(curves[0][1] - paper).max():.0f} µm off")
    return figure
