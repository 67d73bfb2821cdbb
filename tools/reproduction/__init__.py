"""Numbers and figures of Guevel et al. 2025 [G] and Li 2024 [L] beside those of servomill; see tools/reproduce."""
