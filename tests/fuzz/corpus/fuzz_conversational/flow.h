BEGIN PGM T MM TOOL CALL 1 Z S1000 L X + 0 Y + 0 Z + 0 R0 FMAX Q1 = 0 LBL 1 Q1 = Q1 + 1 L X +
                                                                                 Q1 F100 FN 12
    : IF +
      Q1 LT + 3 GOTO LBL 1 CALL LBL 2 CALL LBL 1 REP 2 / 2 L M2 LBL 2 L IY + 2 LBL 0 END PGM T MM
