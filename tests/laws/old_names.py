"""Names that the glossary has replaced, and where they must not come back: keys with their choices, options, quantities,
recorded names and file names. house.py looks them up in the readers' own tables.
"""
import json
import re
import subprocess

COMMANDS = ("run", "compare", "sweep", "merge", "budget", "converge", "bode", "step", "tune", "fmu", "lobes", "table", "compensate", "check", "canon",
            "post", "recording", "calibrate", "plan-calibration", "evaluate", "identify", "response", "time", "machine", "limits", "view", "list")

# Old name: what replaces it. Nowhere a key, a quantity, a recorded name, or any other word of its own in quotes.
NAMES = {
    "brought_out": "realised_ratio", "truth": "machine_errors", "differs_from": "relative_to",
    "imposed_curve_residual": "imposed_error_residual", "response_time": "lag_time", "response_time_ms": "time_constant_ms",
    "lead_ms": "extrapolation_time_ms", "one_step": "single_evaluation", "at_reference": "zero_at_reference",
    "rewritten_for": "rewrite_origin", "constant_load": "gravity_load", "motor_friction": "motor_viscous_friction",
    "slide_friction": "slide_viscous_friction", "spike_time_ms": "reversal_pulse_time_ms", "spike_distance": "reversal_pulse_distance",
    "block_time_ms": "block_processing_time_ms", "warming_time": "thermal_time_constant", "clearance_mm": "approach_mm",
    "depth_mm": "search_mm", "turned_deg": "rotation_deg", "together": "zip", "one_of": "choice", "lattice": "grid",
    "fit_place": "aligned_position", "fit_deviation": "aligned_deviation", "fit_shift_um": "alignment_shift_um",
    "fit_rotation_urad": "alignment_rotation_urad", "fit_rms_um": "alignment_rms_um", "circular_deviation": "circular_error",
    "bidirectional_circular_deviation": "bidirectional_circular_error", "radial_deviation_max": "radial_error_max",
    "radial_deviation_min": "radial_error_min", "mean_bidirectional_radial_deviation": "mean_bidirectional_radial_error",
    "tool_tip_deviation": "tcp_deviation", "tip_is_known": "tcp_is_known", "uncorrectable_tip": "uncorrectable_tcp",
    "read_linear": "fb_linear", "read_rotary": "fb_rotary", "posted_location": "post_processed_location",
    "part-zero": "work-offset", "turn-feed": "rotary-feed", "split-rapids": "correct-rapids",
}
# Section of the keys (a regular expression): old key: what replaces it. These words mean something else elsewhere.
KEYS = {
    r"case\.strategy.*": {"sign": "action", "form": "layout", "lines": "layout"},
    r"case\.strategy\.table": {"axis": "base_axis", "output": "compensated_axis", "grid": "spacing_rule", "entry": "injection_point"},
    r"quantity": {"base": "baseline", "kind": "basis"},
    r"machine\.axis\.X": {"load": "moving_mass"},
    r"machine\.axis\.X\.friction_compensation": {"spike": "reversal_pulse"},
}
# Key: choices that others have replaced.
CHOICES = {
    "action": {"generate": "impose", "correct": "compensate"},
    "layout": {"lines": "axis_tables", "exact": "continuous"},
    "basis": {"identified": "fitted", "chosen": "assumed", "bound": "upper_bound"},
}
# Command: old option: what replaces it.
OPTIONS = {
    "bode": {"from": "f-min", "to": "f-max"}, "response": {"from": "f-min", "to": "f-max"},
    "step": {"height": "amplitude"}, "sweep": {"series": "keep-signals"}, "calibrate": {"truth": "machine-errors"},
}
# Endings of recorded names.
ENDINGS = {"_least": "_min", "_greatest": "_max"}
FILES = {
    "read_ball": "r_test_keys", "ball_quantities": "r_test_quantities", "cutting": "cutting_load", "plan_cutting": "cutting_force_plan",
    "case_faults": "refusals", "case_notes": "case_warnings", "uncorrected": "residual_errors", "left_over": "table_residuals",
    "background": "worker_thread", "memo": "shared_cache", "memory": "memory_limit", "catalogue": "listings", "canon": "canonical_moves",
    "walk": "program_corrector", "woven_line": "edited_line", "line_pieces": "line_tokens", "batch": "point_batch",
    "axis_stand": "axis_test_bench", "left_tables": "table_ends", "turn": "rotation_vector", "travel_memory": "reversal_memory",
    "volumetric_faults": "geometric_errors_kernel", "straightening": "linearisation", "compensation": "axis_displacement",
    "quicken": "time_optimal_law", "slowed_motion": "feed_reduction", "stretch_limits": "segment_limits", "tip_motion": "tcp_motion",
    "tip_control": "tcp_control", "compensated_motion": "cutter_radius_motion", "table_entry": "injection_point",
}
# Where an old name is the right one, with the reason.
EXCEPTIONS = {
    ("tools/figures/catalogue.py", "catalogue"): "the list of figures; listings are those of `servomill list`",
}
LITERAL = re.compile(r'"([a-z][a-z0-9]*(?:[_-][a-z0-9]+)*)"')


def old_keys(entries):
    """Old keys and choices among the entries of `servomill list keys --json`."""
    for entry in entries:
        section, key = entry["section"] or "", entry["key"]
        if key in NAMES:
            yield f"key {section}.{key}: say {NAMES[key]}"
        for pattern, names in KEYS.items():
            if re.fullmatch(pattern, section) and key in names:
                yield f"key {section}.{key}: say {names[key]}"
        for choice in re.findall(r'"(\w+)"', entry["type"]):
            if choice in CHOICES.get(key, {}):
                yield f'choice {section}.{key} = "{choice}": say {CHOICES[key][choice]}'


def old_options(command, help_text):
    """Old options in the help of a command."""
    for option in re.findall(r"--([a-z][\w-]*)", help_text):
        new = OPTIONS.get(command, {}).get(option) or NAMES.get(option)
        if new:
            yield f"servomill {command} --{option}: say --{new}"


def old_quantities(listing):
    """Old quantities in the output of `servomill list quantities`."""
    for line in listing.splitlines():
        name = line.split(" ")[0]
        if name in NAMES:
            yield f"quantity {name}: say {NAMES[name]}"


def old_literals(file, text):
    """Old recorded names, keys and options in quotes in a source."""
    for name in LITERAL.findall(text):
        new = NAMES.get(name) or next((name[:-len(end)] + to for end, to in ENDINGS.items() if name.endswith(end)), None)
        if new and (file, name) not in EXCEPTIONS:
            yield f'{file}: "{name}": say {new}'


def old_files(files):
    """Files that still have a name which the glossary has replaced."""
    for file in files:
        stem = re.sub(r"(_test)?\.\w+$", "", file.split("/")[-1])
        if stem in FILES and file.split("/")[0] != "build" and (file, stem) not in EXCEPTIONS:
            yield f"{file}: say {FILES[stem]}"


def old_names(servomill):
    """All old names that the program itself lists."""
    def said(*arguments):
        return subprocess.run([servomill, *arguments], capture_output=True, text=True, check=True).stdout
    out = list(old_keys(json.loads(said("list", "keys", "--json"))))
    for command in COMMANDS:
        out += old_options(command, said(command, "--help"))
    return out + list(old_quantities(said("list", "quantities")))
