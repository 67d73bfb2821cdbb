(1001)
(Machine)
(  vendor: Autodesk)
(T1  D=3.175 CR=0 - ZMIN=-1 - flat end mill)
G90 G94
G17
G21
(When using Fusion for Personal Use, the feedrate of rapid)
(2D Contour1)
S10000 M3
G54
G0 X5 Y-3
Z15
Z5
G1 Z1 F333.3
Z-1
G2 X6.3 Y-1.7 I1.3 J0 F1000
G1 Y20
G0 Z15
M5
M30
