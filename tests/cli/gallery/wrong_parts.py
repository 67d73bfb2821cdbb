"""Wrong parts: stock, cutting, nominal part and probes."""
from edits import CHECK, line
from wrong_machines import axis


def cut(title, text, tool="diameter_mm = 8.0", case="", program=(), commands=None):
    """A scenario with what it says of stock and cutting, the rest of its tool and of its first case, and changes of its program."""
    return {"title": title, "commands": commands or CHECK,
            "edit": [("scenario.toml", "length_mm = 110.0", "length_mm = 110.0\n" + tool),
                     ("scenario.toml", "[record]", text + "\n[record]"),
                     ("scenario.toml", 'name = "nominal"', 'name = "nominal"' + case)]
            + [("part.ngc", old, new) for old, new in program]}


BLOCK = "[[part.stock]]\nbox = { from_mm = [-50.0, -50.0, -130.0], to_mm = [50.0, 50.0, -100.0] }\n"
STEEL = '[cutting]\nmaterial = "42CrMo4"\n'

CUTTING = [
    cut("cutting without stock", STEEL),
    cut("a material that is not known", BLOCK + '[cutting]\nmaterial = "42CrMo"'),
    cut("some coefficients of a material are missing", BLOCK + '[cutting]\nKtc = "2300 N/mm^2"\nKrc = "900 N/mm"'),
    cut("stock of impossible shapes", "[[part.stock]]\nbox = { from_mm = [0.0, 0.0, 0.0], to_mm = [1.0, 1.0, -1.0] }\n[[part.stock]]\n"
        "cylinder = { centre_mm = [0.0], radius_mm = 0.0, from_mm = 0.0, to_mm = 1.0 }\n[[part.stock]]\n" + STEEL),
    cut("wear of a case in air", BLOCK + STEEL, case="\ncutting = false\nwear = 2.0"),
    cut("a case that cuts without cutting", "", case="\ncutting = true"),
    cut("stock that is never touched", BLOCK.replace("-50.0, -50.0", "-900.0, -900.0").replace("[50.0, 50.0", "[-800.0, -800.0") + STEEL),
    cut("a cut with the spindle standing", BLOCK + STEEL),
    cut("a tool without diameter in the stock", BLOCK + STEEL, tool=""),
    cut("cuts and coordinates that are odd, and run all the same", BLOCK + STEEL, tool="diameter_mm = 8.0\nflute_length_mm = 5.0",
        program=[("G43 H1", "G43 H1\nS4775 M3"), ("G1 Y5", "G52 X1\nG1 Y5\nG0 Y10")], commands=["servomill run scenario.toml -q -o out.h5"]),
    cut("forces of teeth whose number is unknown, of a tool that nothing clamps", BLOCK + STEEL + 'force = "instantaneous"',
        tool="diameter_mm = 8.0\nrunout_um = 500.0"),
    cut("forces of teeth that pass faster than the tick resolves", BLOCK + STEEL + 'force = "instantaneous"',
        tool="diameter_mm = 8.0\nteeth = 4", program=[("G43 H1", "G43 H1\nS80000 M3")]),
    cut("regeneration of an average force", BLOCK + STEEL + "regeneration = true"),
    cut("regeneration at the actual depth of cut", BLOCK + STEEL + 'force = "instantaneous"\nregeneration = true\ndepth_of_cut = "actual"',
        tool="diameter_mm = 8.0\nteeth = 4"),
    cut("regeneration of a tool point that does not vibrate", BLOCK + STEEL + 'force = "instantaneous"\nregeneration = true',
        tool="diameter_mm = 8.0\nteeth = 4", program=[("G43 H1", "G43 H1\nS4775 M3")]),
    axis("a structure that gives way to nothing", "structural_stiffness = 0.0"),
]

FACE = "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex {} 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
PROBE = '[[probe]]\nname = "top"\npoints_mm = [[5.0, 5.0, 0.0, 0.0, 0.0, 1.0]]\n'


def cuboid(x, y, z):
    """ASCII STL from the origin to x, y, z."""
    corner = [((i & 1) * x, (i >> 1 & 1) * y, (i >> 2) * z) for i in range(8)]
    faces = ((0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2),
             (1, 3, 7), (1, 7, 5))
    return "solid\n" + "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % corner[i] for i in face) + "endloop\nendfacet\n"
        for face in faces) + "endsolid\n"


def stl(title, content, probe="", about=None):
    """A scenario with an STL of the nominal part."""
    shown = {"about": about} if about else {}
    return {**cut(title, '[part]\nstl = "part.stl"\n' + probe), "write": {"part.stl": content} if content is not None else {}, **shown}


PART = [
    stl("an STL that is not there", None),
    stl("an STL without triangles", "solid part\nendsolid part\n"),
    stl("an STL with holes", "solid\n" + FACE.format(1) + "endsolid\n"),
    stl("a triangle without area", "solid\n" + FACE.format(0) + "endsolid\n"),
    stl("an STL that breaks off", "solid\n" + FACE.format(1)[:60]),
    stl("a STEP file for an STL", "ISO-10303-21;\nHEADER;\n"),
    stl("a binary STL that breaks off", bytes(80) + b"\x02\0\0\0" + bytes(50), about="80 bytes, the number 2, one triangle"),
    stl("a probe that faces into the part, and one that misses it", cuboid(10, 10, 10),
        PROBE + PROBE.replace("top", "middle").replace("0.0, 0.0, 0.0", "5.0, 0.0, 0.0"), about="a cuboid of 10 mm"),
    line("an STL that is no name", "[record]", "[part]\nstl = 1\n[record]"),
    line("stock in STL", "[record]", '[[part.stock]]\nstl = "raw.stl"\n[record]'),
]

CASES = '[[case]]\nname = "nominal"'
LINE = 'line = { from_mm = [0, 0, -1], to_mm = [50, 0, -1], normal = [0, -1, 0], points = 6 }'

OTHER = '[[quantity]]\nname = "imposed_error_residual"\naxis = "Y"'


def probed(title, probes, *quantities, diameter="\ndiameter_mm = 8.0"):
    """A scenario with these tables before its cases, and quantities behind them."""
    edits = [("scenario.toml", "length_mm = 110.0", "length_mm = 110.0" + diameter),
             ("scenario.toml", CASES, probes + "\n" + CASES)]
    edits += [("scenario.toml", 'name = "imposed_error_residual"\naxis = "Y"', one) for one in quantities]
    return {"title": title, "edit": edits, "commands": CHECK}


def probe(keys, name="flank"):
    return f'[[probe]]\nname = "{name}"\n{keys}\n'


PROBES = [
    probed("a probe where nothing is cut", probe(LINE), diameter=""),
    probed("a probe that says nothing, and one that says too much", probe("") + probe(LINE + "\npoints_mm = []", "top")),
    probed("probes without names of their own", probe(LINE) + probe(LINE) + probe(LINE, "a/b")),
    probed("a line that is none", probe(LINE.replace("50,", "0,")) + probe(LINE.replace("points = 6", "points = 1"), "two")
           + probe(LINE.replace("[0, -1, 0]", "[1, 0, 0]"), "three") + probe(LINE.replace("[0, -1, 0]", "[0, 0, 0]"), "four")
           + probe(LINE.replace("[50, 0, -1]", "[50, 0]"), "five")),
    probed("a plane that is none", probe("plane = { corner_mm = [0, 0, 0], u_mm = [1, 0, 0], v_mm = [2, 0, 0], normal = [0, 0, 1], "
                                         "points = [3, 3] }")
           + probe("plane = { corner_mm = [0, 0, 0], u_mm = [1, 0, 0], v_mm = [0, 1, 0], normal = [0, 0, 1], points = [3, 1] }", "top")),
    probed("a circle that is none", probe("circle = { centre_mm = [0, 0, 0], radius_mm = 0, outside = true, points = 2 }")
           + probe("circle = { centre_mm = [0, 0, 0], radius_mm = 5, outside = true, points = 8, from_deg = 90, to_deg = 0 }", "two")
           + probe("cylinder = { centre_mm = [0, 0, 0], radius_mm = 5, outside = true, points = [8, 2], to_mm = 0 }", "three")),
    probed("points that are none", probe("points_mm = [[0, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 0]]")),
    probed("a CMM that is none", probe(LINE) + "[cmm]\nuncertainty_um = -1\nrepetitions = 0\nprobe_radius = 1"),
    probed("quantities of probes that are wrong themselves", probe(LINE.replace("points = 6", "points = 1"))
           + probe(LINE.replace("[0, -1, 0]", "[0, 0, 0]"), "side") + probe("", "top"),
           'name = "straightness"\nprobe = "flank"\n[[quantity]]\nname = "angle"\nprobe = "side"\nto = "top"\n' + OTHER),
    probed("quantities where a probe has no name", probe(LINE, ""), 'name = "straightness"\nprobe = "flank"\n' + OTHER),
    probed("a quantity of a probe that is not there", probe(LINE), 'name = "straightness"\nprobe = "flnak"'),
    probed("a quantity of another kind of probe", probe(LINE), 'name = "flatness"\nprobe = "flank"'),
]
