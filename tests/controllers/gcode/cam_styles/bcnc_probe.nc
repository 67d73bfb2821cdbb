(Block-name: Probe)
G21 G90
G38.2 Z-10 F50
G92 Z0
G0 Z3
M2
