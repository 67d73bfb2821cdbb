(Block-name: Header)
(Block-enable: 1)
$H
G90 G21 G17 G94
M3 S12000
G4 P3
(Block-name: Rectangle)
g0 z3
g0 x0 y0
g1 z-1 f300
g1 x20 f800
g1 y10
g1 x0
g1 y0
g0 z3
(Block-name: Footer)
m5
m2
