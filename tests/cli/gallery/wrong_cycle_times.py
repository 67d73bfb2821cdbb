"""Wrong inputs of time, machine and limits."""
from edits import typed

GRBL = "$110=6000\n$111=6000\n$112=600\n$120=500\n$121=500\n$122=50\n"
LOG = "time [s],X [mm]\n" + "".join(f"{0.001 * k:.3f},{0.01 * k * k:.4f}\n" for k in range(20))

CYCLE_TIMES = [
    typed("a cycle time without its machine, its program, or with options of the other", "servomill time part.ngc", "servomill time --machine machine.toml",
          "servomill time nothing.ngc --machine machine.toml", "servomill time part.ngc --machine machine.toml --case table",
          "servomill time scenario.toml --feed-override 0.5", "servomill time scenario.toml --case tabel"),
    typed("a cycle time of a program without F", "servomill time part.ngc --machine machine.toml --tool-length 1=110"),
    typed("a cycle time with a wrong value", "servomill time part.ngc --machine machine.toml --raise ten", "servomill time part.ngc --machine machine.toml --by lines",
          "servomill time part.ngc --machine machine.toml --start B", "servomill time part.ngc --machine machine.toml --top -1",
          "servomill time part.ngc --machine machine.toml --csv out.txt"),
    typed("settings of no control", "servomill machine from part.ngc", "servomill machine from nothing.txt", "servomill machine part.ngc",
          "servomill machine from part.ngc --control linuxnc"),
    typed("settings of a control with a fault, and one without limits", "servomill machine from grbl.txt", "servomill machine from short.txt",
          write={"grbl.txt": GRBL.replace("$112=600", "$112=-600").replace("$120=500", "$120=quick"), "short.txt": GRBL.replace("$120=500\n", "")},
          about={"grbl.txt": "$112=-600, $120=quick", "short.txt": "no $120"}),
    typed("a log without its machine, or with a wrong channel", "servomill limits log.csv", "servomill limits log.csv --machine machine.toml --channel X",
          "servomill limits log.csv --machine machine.toml --channel \"X=Y [mm]\"", "servomill limits log.csv --machine machine.toml --channel \"X=X [A]\"",
          "servomill limits log.csv --machine machine.toml --channel \"A=X [deg]\"", write={"log.csv": LOG}, about="a right log of X"),
]
