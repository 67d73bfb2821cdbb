; square with feed from a macro
%wait
G21 G90
G0 Z5
G0 X0 Y0
G1 Z-1 F150
G1 X10 F600
G1 Y10
G1 X0
G1 Y0
G0 Z5
M30
