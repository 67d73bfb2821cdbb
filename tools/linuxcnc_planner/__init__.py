"""LinuxCNC's own trajectory planner, run headless, next to servomill time."""
