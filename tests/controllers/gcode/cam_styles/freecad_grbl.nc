(Exported by FreeCAD)
(Post Processor: grbl_post, version 2)
(Begin preamble)
G17 G90
G21
(Begin operation: T1)
(Path: T1)
(M6 T1)
M3 S1000
(Path: Drilling)
G0 Z7.000
G90
(G81 X5.000 Y5.000 Z-3.000 F60.00 R2.000)
G0 X5.000 Y5.000
G0 Z2.000
G1 Z-3.000 F60.00
G0 Z2.000
(Finish operation)
M5
G17 G90
M2
