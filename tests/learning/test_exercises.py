"""The exercises in ``examples/exercises.py`` run as a student would run them."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

FILE = Path(__file__).resolve().parents[2] / "examples" / "exercises.py"


def test_a_longer_trace_tells_more_of_the_way_in_fewer_episodes() -> None:
    done = subprocess.run([sys.executable, FILE], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    off = {
        (trace, int(episodes)): float(number)
        for trace, episodes, number in re.findall(
            r"λ = (\S+), +(\d+) episodes: (\S+) off", done.stdout
        )
    }
    assert off["0.9", 1] < off["0.5", 1] < off["0.0", 1]
    assert max(off["0.9", 10], off["0.5", 10]) < off["0.0", 10]
    assert max(number for (_, episodes), number in off.items() if episodes == 100) < 0.2
