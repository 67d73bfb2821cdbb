"""Table 3.1 of X. Li (2024) beside the error of the same segment here: shapes, each in % of its largest value."""
import numpy as np

from figures import nonlinear, style


def draw(run, table):
    """@param table  the paper's values (mm) at points 0.1 mm apart, the last one at the end"""
    segments = nonlinear.Segments(run)
    places = segments.longest_error()
    way = segments.chord(places)
    error = np.linalg.norm(segments.tip_error(segments.plain)[places], axis=1)
    points = np.append(np.arange(0.0, way[-1], nonlinear.SPACING), way[-1])
    here = np.interp(points, way, error)
    t = points / way[-1]
    paper, ours = 100.0 * table / table.max(), 100.0 * here / here.max()
    curves = [(style.Look("sine through the peak", style.BLUE, style.DASH, ""), 100.0 * np.sin(np.pi * t)),
              (style.Look("parabola", style.RED, style.DASH_DOT, ""), 400.0 * t * (1.0 - t)),
              (style.Look("here", style.PURPLE, "-", "o", 1.4), ours)]
    table_look = style.Look("table 3.1 of the paper", style.BLACK, "-", "s", 1.0)
    figure, strip, grid = style.panels([1.0], (10.2, 4.4), columns=2)
    style.legend(strip, [table_look] + [look for look, _ in curves], points=True)
    shape, apart = grid[0]
    shape.plot(points, paper, "s", color=style.BLACK, markersize=7, markerfacecolor="none", zorder=3.5)
    for look, values in curves:
        style.line(shape, points, values, look, marker=look.marker, markersize=3.5)
        style.line(apart, points, values - paper, look, marker=look.marker, markersize=3.5)
    apart.axhline(0.0, color=style.BLACK, linewidth=0.8)
    shape.set_title(f"Shape: paper's peak {1000.0 * table.max():.0f} µm, here {here.max():.0f} µm")
    shape.set_ylabel("error, % of the peak")
    apart.set_title("Difference to table 3.1")
    apart.set_ylabel("% of the peak")
    for ax in (shape, apart):
        ax.set_xlabel("way along the chord, mm")
    style.headline(figure, f"The paper's table is a parabola: here within {np.abs(ours - paper).max():.2f} % of its shape, "
                           f"a sine {np.abs(curves[0][1] - paper).max():.1f} % off")
    return figure
