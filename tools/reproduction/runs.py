"""The scenarios of both papers, run one after the other."""
import dataclasses
import pathlib
import subprocess
import time

SCENARIOS = pathlib.Path(__file__).resolve().parents[2] / "scenarios"


@dataclasses.dataclass(frozen=True)
class Run:
    name: str          # of the result file
    scenario: str      # below scenarios/
    what: str
    command: str = "run"


RUNS = (
    Run("signal_delay", "guevel2025/signal_delay.toml", "[G] signal delay of the feedback hardware"),
    Run("experiment1", "guevel2025/experiment1.toml", "[G] experiment 1: errors imposed along X"),
    Run("experiment1_feed", "guevel2025/experiment1_feed.toml", "[G] experiment 1 over the feed", "sweep"),
    Run("experiment1_friction", "guevel2025/experiment1_friction.toml", "[G] experiment 1 with dry friction"),
    Run("experiment1_part", "guevel2025/experiment1_part.toml", "[G] experiment 1 on the part: cut and probed"),
    Run("experiment2", "guevel2025/experiment2.toml", "[G] experiment 2: three parts in air, cut, probed"),
    Run("z_hypotheses", "guevel2025/z_hypotheses.toml", "[G] experiment 2: hypotheses for Z while cutting"),
    Run("experiment2_workspace", "guevel2025/experiment2_workspace.toml", "[G] experiment 2: the errors over the workspace"),
    Run("rotation_of_c", "statements/rotation_of_c.toml", "[G] the table C turned"),
    Run("sudden_error", "statements/sudden_error.toml", "[G] a sudden error"),
    Run("short_blocks", "statements/short_blocks.toml", "[G] short blocks"),
    Run("example1", "li2024/example1.toml", "[L] example 1: one segment, as printed"),
    Run("example1_unit", "li2024/example1_unit.toml", "[L] example 1: the same with tool axes of unit length"),
    Run("example1_centre", "li2024/example1_centre.toml", "[L] example 1: tool axis and centre of rotation identified"),
    Run("table32", "li2024/table32.toml", "[L] example 2: 20 locations of an impeller blade"),
    Run("table32_low", "li2024/table32_low.toml", "[L] example 2, centre of rotation 150 mm below"),
    Run("table32_identified", "li2024/table32_identified.toml", "[L] example 2, centre of rotation identified"),
)


def run_all(runs, servomill, folder, tell):
    """Runs them, keeps what they print in NAME.txt; returns {name: why there is no complete result}. A scenario that
    fails does not stop the others."""
    failed = {}
    for number, one in enumerate(runs, 1):
        tell(f"[{number}/{len(runs)}] {one.what}")
        begin = time.monotonic()
        result = folder / f"{one.name}.h5"
        result.unlink(missing_ok=True)   # a result of an earlier run must not pass for one of this
        done = subprocess.run([servomill, one.command, SCENARIOS / one.scenario, "--force", "-o", result],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        (folder / f"{one.name}.txt").write_text(done.stdout + done.stderr, encoding="utf-8")
        if done.returncode != 0:
            lines = done.stderr.strip().splitlines() or done.stdout.strip().splitlines() or ["printed nothing"]
            failed[one.name] = f"servomill {one.command} ended with {done.returncode}: {lines[-1]}"
            tell(f"      {failed[one.name]}")
            if result.exists():   # nor may an incomplete one, with --report-only
                result.replace(folder / f"{one.name}.failed.h5")
        else:
            tell(f"      {time.monotonic() - begin:.1f} s")
    return failed
