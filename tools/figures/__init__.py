"""Figures of servomill: each module reads result files through `results` and draws with `style`."""
