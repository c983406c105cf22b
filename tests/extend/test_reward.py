"""A reward of a user's own: one file, and what was learned says so."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyq_bullet.learning import load_policy

if TYPE_CHECKING:
    from tests.helpers.commands import Call

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "extend" / "reward.py"
ASKED = ("train", "fuzzy-q-lambda", "--episodes", 2, "--trace", 0.8)


def test_a_training_is_rewarded_by_the_example_and_its_policy_says_so(
    fuzzyq: Call, tmp_path: Path
) -> None:
    own, usual = tmp_path / "own.json", tmp_path / "usual.json"
    done = fuzzyq(*ASKED, "--reward", "gentle", "--plugin", EXAMPLE, "--out", own)
    assert done.returncode == 0, done.stderr
    assert fuzzyq(*ASKED, "--out", usual).returncode == 0
    policy = load_policy(own)
    assert policy.parameters["reward"] == "gentle"
    assert policy.parameters["trace_decay.start"] == 0.8
    assert policy.command.endswith(f"--trace 0.8 --reward gentle --plugin {EXAMPLE}")
    assert policy.table != load_policy(usual).table


def test_a_planner_whose_learner_takes_no_discount_says_so(fuzzyq: Call, tmp_path: Path) -> None:
    plugin = EXAMPLE.with_name("policy.py")
    done = fuzzyq(
        *("train", "long-memory", "--plugin", plugin, "--discount", 0.5),
        *("--out", tmp_path / "policy.json"),
    )
    assert done.returncode == 2
    assert done.stderr == "error: --discount: what long-memory learns with takes none\n"
