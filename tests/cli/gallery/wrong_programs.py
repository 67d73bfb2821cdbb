"""Wrong programs: of the scenario, to be compensated, to be post-processed; tables for controls."""
from edits import line, program, typed

PROGRAM = [
    program("a tool offset that no tool has", "G43 H1", "G43.1 Z10"),
    program("a program that ends in the middle of a block", "G1 Y5\nM30\n", "G1 Y"),
    program("a comment that does not end", "G1 X10", "G1 X10 (to the corner"),
    program("a G-code that there is not", "G1 X10", "G1.5 X10"),
    program("two codes of one modal group", "G1 X10", "G0 G1 X10"),
    program("a feed of nothing", "F#101", ""),
    program("an unknown tool", "T1 M6\nG43 H1", "T7 M6\nG43 H7"),
    program("a parameter that was never set", "F#101", "F#<feed>"),
    program("an arc that misses its end", "G1 Y5", "G2 X20 Y5 I3 J0"),
    program("several faults", "G1 X10\nG1 Y5", "G1 X10 Q\nG1 Y[5 / ]\nG99\nG1 X1O", ["servomill check part.ngc"]),
    program("the same, run", "G1 X10\nG1 Y5", "G1 X10 Q\nG1 Y[5 / ]\nG99\nG1 X1O",
            ["servomill check scenario.toml", "servomill canon part.ngc > moves.json"]),
    program("a feed of zero", "F#101", "F0"),
    typed("programs that are none", "servomill canon moves.toml", "servomill check binary.ngc", "servomill canon comment.ngc",
          write={"moves.toml": "title = 'x'\n", "binary.ngc": bytes(range(1, 32)) * 20, "comment.ngc": "(nothing yet)\n"},
          about={"moves.toml": "title = 'x'", "binary.ngc": "bytes from 1 to 31, and again", "comment.ngc": "(nothing yet)"}),
    typed("a subprogram that calls itself", "servomill canon again.ngc",
          write={"again.ngc": "O1\nG21 G90\nM98 P2\nM30\nO2\nG0 X1\nM98 P2\nM99\n"}),
    typed("F0, and a feed move lines later", "servomill canon slow.ngc", write={"slow.ngc": "G21 G90\nF0\nG0 X1.\nG1 X10.\nM2\n"}),
    typed("a cycle with a count, without a decimal point", "servomill check holes.ngc -q",
          write={"holes.ngc": "G21 G90\nG0 Z5.\nG91 G99 G81 X1. Z-2. R-4. F100. K3\nG80\nM30\n"}),
    program("a program that moves nothing", "G1 X10\nG1 Y5\n", ""),
    typed("a program that is not UTF-8", "servomill check scenario.toml", "servomill run scenario.toml -o out.h5",
          write={"part.ngc": b"(pi\xe8ce)\nG1 X10 F100\nM30\n"}, about="(pi\\xe8ce) in Latin-1"),
    typed("a program that holds a NUL", "servomill check scenario.toml", write={"part.ngc": b"G1 X10 F100\n\0\nM30\n"},
          about="G1 X10 F100 and a byte of 0"),
]

ERRORS = "[errors.measured]\nEC0Y = { um_per_m = 120.0 }\n"
COMPENSATE_IT = "servomill compensate cut.ngc --machine machine.toml --errors errors.toml -o out.ngc"
AT_ZERO = COMPENSATE_IT + " --work-offset X=0,Y=0,Z=0"
FOR_FANUC = AT_ZERO + " --dialect fanuc --retract Z=0 --program-number 12"
CUT = "G21 G90\nG0 X0 Y0 Z5\nG1 X10 F100\nM2\n"


def compensated(title, cut, *commands, **more):
    """A program that cannot be compensated."""
    return typed(title, *(commands or [COMPENSATE_IT]), write={"cut.ngc": cut, "errors.toml": ERRORS, **more})


COMPENSATE = [
    compensated("compensate without its inputs", CUT, "servomill compensate", "servomill compensate cut.ngc",
                "servomill compensate cut.ngc --machine machin.toml", "servomill compensate cut.ngc --machine machine.toml",
                COMPENSATE_IT + " --model mesured", COMPENSATE_IT.replace("errors.toml", "cut.ngc")),
    compensated("options of compensate that cannot be", CUT, COMPENSATE_IT + " --tolerance -1", COMPENSATE_IT + " --cutoff '30 Hz'",
                COMPENSATE_IT + " --tolerance '0 um'",
                COMPENSATE_IT + " --max-block '1 s'", COMPENSATE_IT + " --dialect fanuk", COMPENSATE_IT + " --axes rotary",
                COMPENSATE_IT + " --work-offset X10", COMPENSATE_IT + " --work-offset G60:X=10",
                COMPENSATE_IT + " --work-offset A=10", COMPENSATE_IT + " --start X=one", COMPENSATE_IT + " --parameter '#101'"),
    compensated("a program that is there", CUT, "servomill compensate cut.ngc --machine machine.toml --errors errors.toml -o cut.ngc"),
    compensated("a feed from nobody knows where", CUT.replace(" Y0", ""), AT_ZERO),
    compensated("an axis that the machine lacks", CUT.replace("X10", "A10"), AT_ZERO),
    compensated("a work system that nobody said the place of", CUT.replace("G1", "G55 G1"), COMPENSATE_IT,
                COMPENSATE_IT + " --work-offset X=10", AT_ZERO + " --work-offset X=10"),
    compensated("moves under tool-centre-point control", CUT.replace("G1", "G43.4 H1\nG1"),
                AT_ZERO + " --tools tools.tbl", **{"tools.tbl": "T1 P1 Z+40\n"}),
    compensated("a tapped hole", CUT.replace("G1 X10 F100", "S100 M3\nG33.1 Z-2 K1"), AT_ZERO, FOR_FANUC),
    compensated("a spline", CUT.replace("G1 X10", "G5 X10 Y0 I1 J1 P1 Q1"), AT_ZERO, FOR_FANUC),
    compensated("a NURBS", CUT.replace("G1 X10 F100", "F100\nG5.2 P1\nX5 Y5 P1\nX10 Y0 P1\nG5.3"), AT_ZERO, FOR_FANUC),
    compensated("parameter files of compensate", CUT, COMPENSATE_IT + " --parameter-file none.var",
                COMPENSATE_IT + " --parameter-file wrong.var",
                **{"wrong.var": "5221 1.5\n5222\n12 1\n5220 10\n5210 1\n"}),
    compensated("what a dialect cannot express", CUT.replace("G1", "G59.1\nG1"), FOR_FANUC + " --work-offset G59.1:X=0,Y=0,Z=0"),
    compensated("options of other dialects that are missing or cannot be", CUT, AT_ZERO + " --dialect fanuc",
                AT_ZERO + " --dialect fanuc --retract Z=0", FOR_FANUC + "345", FOR_FANUC + " --resolution '3 um'",
                FOR_FANUC + " --correct-rapids", AT_ZERO + " --retract 5", AT_ZERO + " --preset -1",
                FOR_FANUC + " --without mirorr", AT_ZERO + " --dialect siemens --retract Z=0 --without mirror",
                AT_ZERO + " --tool-length 50", COMPENSATE_IT.replace("out.ngc", "my-part.h") + " --dialect heidenhain"),
    compensated("unknown positions for another control", "G21 G90\nG91 G0 Z5\nM2\n", FOR_FANUC),
    compensated("a feed behind a stop", CUT.replace("G1", "M0\nG1"), FOR_FANUC),
    compensated("a tool change that the operator may leave out", CUT.replace("G1", "/ T1 M6\nG1"), FOR_FANUC),
    compensated("a program in two units for a control that changes its offsets with the unit",
                CUT.replace("G1", "G20\nG1"), FOR_FANUC),
]

POST_IT = "servomill post part.cls --machine machine.toml -o out.ngc"
POST_T = POST_IT + " --tool-length 0"
RIGHT = "FEDRAT/600\nRAPID\nGOTO/0,0,10\nGOTO/0,0,0\n"

POST = [
    typed("cutter locations that cannot be read", POST_IT,
          write={"part.cls": "UNITS/CM\nFEDRAT/0\nFEDRAT/10,MPM\nGOTO/1,2\nGOTO/1,2,3,0,0,0\nGOTO/1,2,three\nGTO/1,2,3\n"
                             "CIRCLE/0,0,0,0,0,1,5\nSPINDL/ON\nLOADTL/1.5\nGOTO/1,2,$"}),
    typed("cutter locations to be checked", "servomill check part.cls part.csv",
          write={"part.cls": "GOTO/1,2,3,0,0,0\n", "part.csv": "x,y,z,i,j,k\n1,2,3,0,0\n"}),
    typed("no cutter locations", POST_IT, write={"part.cls": "PARTNO empty\nFINI\n"}),
    typed("a CSV table without a column", POST_IT.replace("cls", "csv"), write={"part.csv": "x,y,z,i,j\n"}),
    typed("a CSV table with wrong lines", POST_IT.replace("cls", "csv"),
          write={"part.csv": "x,y,z,i,j,k\n1,2,3,0,0\n1,2,3,0,0,0\n1,2,3,0,0,up\n"}),
    typed("odd cutter locations, which are post-processed all the same", POST_T + " -q --force",
          write={"part.cls": "MACHIN/ANY\nPAINT/PATH\nCOOLNT/THRU\nPAINT/PATH\nGOTO/0,0,10,0,0,1.1\nFINI\nGOTO/1,1,1\n",
                 "out.ngc": "(old)\n"}),
    typed("more odd tool axes than one wants to read of", POST_T + " -q",
          write={"part.cls": "FEDRAT/600\n" + "GOTO/0,0,10,0,0,1.1\n" * 23}, about="23 tool axes of length 1.1"),
    typed("a tool axis and a place that the machine does not have", POST_T,
          write={"part.cls": RIGHT + "GOTO/0,0,0,0,1,1\nGOTO/9999,0,0,0,0,1\n"}),
    typed("a place that the machine does not have behind an odd tool axis, which is reported, too", POST_T,
          write={"part.cls": "FEDRAT/600\nGOTO/0,0,10,0,0,2\nGOTO/9999,0,0\n"}),
    typed("no feed", POST_T, write={"part.cls": "GOTO/0,0,10\nGOTO/0,0,0\n"}),
    typed("a tool that the table lacks", POST_IT + " --tools tools.tbl", write={"part.cls": "LOADTL/7\n" + RIGHT,
                                                                              "tools.tbl": "T1 P1 Z100\n"}),
    typed("a tool without a length, and one that comes late", POST_IT, POST_IT.replace("part", "late") + " --tool-length 100",
          write={"part.cls": "LOADTL/7\n" + RIGHT, "late.cls": RIGHT + "LOADTL/7\nGOTO/1,0,0\n"}),
    typed("a program that is there already", "servomill post part.cls --machine machine.toml", POST_IT.replace("out.ngc", "''"),
          POST_IT.replace("out.ngc", "."), POST_IT.replace("out.ngc", "nowhere/out.ngc"), write={"part.cls": RIGHT}),
    typed("options of post that cannot be", "servomill post part.cls", "servomill post", POST_IT + " --tcp --classical",
          POST_IT + " --tools a.tbl --tool-length 100", POST_IT + " --tolerance 0", POST_IT + " --axis-tolerance nan",
          POST_IT + " --work-offset 1,2", POST_IT + " --work-offset 1,2,x", POST_IT + " --start Q=1", POST_IT + " --start A=10",
          POST_IT + " --start X=ten", POST_IT + " --work-system 60", POST_IT + " --feed -1", POST_IT + " --tool -1",
          POST_IT + " --approach sideways", POST_IT + " --clearance '0 mm'", POST_IT + " --retract up", POST_IT + " --retract Z=9999",
          POST_IT + " --approach direct --retract Z=10", POST_T + " --clearance '2 m'", POST_T + " --retract Z=15",
          POST_IT + " --tool-length '5 deg'", POST_IT + " --set structure=3", POST_IT + " --set axis.X.lead=3", POST_IT, POST_IT + " --tool 3",
          POST_IT + " --tool 0 --tool-length 5", write={"part.cls": RIGHT}),
    typed("a part and a tool that are nowhere on a machine with rotary axes", POST_IT, POST_IT + " --work-offset 0,0,0 --approach direct",
          write={"part.cls": RIGHT, "machine.toml": 'structure = "[w C\' A\' b X Y Z t]"\n'}),
    typed("a height that nobody has named", POST_IT, write={"part.cls": RIGHT, "machine.toml": 'structure = "[w b X Y Z t]"\n'}),
    typed("the machine of post", POST_IT.replace("machine.toml", "machin.toml"), POST_IT.replace("machine.toml", "part.ngc"),
          POST_IT.replace("machine.toml", "scenario.toml"), write={"part.cls": RIGHT}),
]

TABLE = "servomill table scenario.toml --format siemens -o out"

IMPORT = "servomill table --import volcomp.csv --format isg --machine machine.toml -o errors.toml"

TABLES = [
    typed("tables in no format, to no folder, of no model", "servomill table scenario.toml -o out",
          "servomill table scenario.toml --format heidenhein -o out", "servomill table scenario.toml --format csv",
          TABLE + " --model imposd", "servomill table machine.toml --format csv -o out"),
    line("one of several error models", "[errors.imposed]", "[errors.true]\nEXX = { constant_um = 1.0 }\n[errors.imposed]",
         commands=[TABLE]),
    line("no error model for a table", '[errors.imposed]\nEYX = { harmonic = { amplitude_um = 150.0, period_mm = 62.0 } }', "",
         commands=["servomill table scenario.toml --format csv -o out --set 'imposed=\"\"' --set 'case=[{name=\"nominal\"}]' --set 'quantity=[]'"]),
    typed("tables of more points than the control takes", TABLE + " --spacing '4 mm'",
          "servomill table scenario.toml --format heidenhain -o out --spacing '3 mm'",
          TABLE + " --max-points 1", "servomill table scenario.toml --format heidenhain -o out --max-points 257"),
    typed("a spacing that is none", TABLE + " --spacing -5", TABLE + " --spacing '0 mm'", TABLE + " --spacing '5 deg'",
          TABLE + " --tool-length '-1 mm'"),
    typed("positions of axes that are none", TABLE + " --travel X", TABLE + " --travel X=10:-10", TABLE + " --travel C=0:10",
          TABLE + " --at X=middle", TABLE + " --at X=500", TABLE + " --axis Q"),
    typed("tables that can hold nothing of the model", "servomill table scenario.toml --format linuxcnc -o out",
          TABLE + " --axis Y"),
    typed("options that mean nothing", "servomill table scenario.toml --format linuxcnc -o out --comp-file-type 2",
          TABLE + " --comp-file-type 1", TABLE + " --rotary-spacing '1 deg'",
          "servomill table scenario.toml --format csv -o out --at Z=10", "servomill table scenario.toml --format csv -o out --tool-length '1 mm'"),
    typed("a file of error models that holds something else", "servomill table scenario.toml --machine machine.toml --format csv -o out",
          "servomill table errors.toml --machine machine.toml --format csv -o out --set a=1",
          "servomill table errors.toml --machine machine.toml --format csv -o out",
          write={"errors.toml": "[errors.found]\nEXC = { constant_um = 1.0 }\n"}),
    typed("formats that no document found defines", TABLE.replace("siemens", "fanuc"), TABLE.replace("siemens", "vcs")),
    typed("bed meshes of too few points, of no points and of a control that takes none", TABLE.replace("siemens", "klipper") + " --bed-mesh 2x5",
          TABLE.replace("siemens", "marlin") + " --bed-mesh 7", TABLE + " --bed-mesh 7x5"),
    typed("a skew correction of axes at right angles", TABLE.replace("siemens", "marlin"), TABLE.replace("siemens", "klipper") + " --spacing 5",
          TABLE.replace("siemens", "reprapfirmware") + " --max-points 9"),
    typed("a parameter file that holds something else", IMPORT, write={"volcomp.csv": "X,EXX\n0,0\n1,0\n"}),
    typed("a parameter file of two arguments that is no grid", IMPORT, write={"volcomp.csv": "Z X EXX\n0 0 0\n0 10 0.01\n"}),
    typed("a parameter file in other units", IMPORT, write={"volcomp.csv": "C0Y\n0.2\n"}),
    typed("a parameter file of another machine", IMPORT, write={"volcomp.csv": "C ECC\n0 0\n90 1e-5\n"}),
    typed("options of --import that cannot be", IMPORT.replace(" --machine machine.toml", ""), IMPORT.replace(" --format isg", ""),
          IMPORT.replace("isg", "siemens"), IMPORT.replace("isg", "etalon"), IMPORT + " --spacing 5", IMPORT + " --model 'a b'",
          IMPORT + " --import volcomp.csv", IMPORT + " scenario.toml", IMPORT.replace("volcomp", "volcom"), IMPORT + " -a X",
          write={"volcomp.csv": "C0Y\n0.0001\n"}),
    typed("tables where something stands already", TABLE + " -q", "servomill table scenario.toml --format siemens -o part.ngc",
          write={"out/NC_CEC.INI": "precious"}, about="a file"),
]
