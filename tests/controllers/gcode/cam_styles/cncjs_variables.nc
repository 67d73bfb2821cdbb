; corners of a rectangle about the present position
%x0=posx
%y0=posy
G21 G90
G0 X[x0] Y[y0]
G1 X[x0+10] F500
M30
