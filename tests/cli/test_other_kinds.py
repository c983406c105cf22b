"""A file of one kind where another belongs: one line that says what it is and what to do."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from fuzzyq_bullet import UserError
from fuzzyq_bullet.platforms import asset
from tests.helpers.commands import SHORT, Call


@pytest.fixture(scope="module")
def folder(filmed: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Files of all kinds; those of a run of ``short.yaml`` lie in ``out``."""
    folder = tmp_path_factory.mktemp("kinds")
    shutil.copytree(filmed, folder / "out")
    (folder / "out" / "short-map.gif").write_bytes(b"GIF89a" + bytes(20))
    (folder / "short.yaml").write_text(SHORT)
    (folder / "other.yaml").write_text(SHORT.replace("name: short", "name: other"))
    shutil.copy(asset("controllers") / "paper.yaml", folder / "rules.yaml")
    (folder / "rules.fll").write_text("Engine: rules\n")
    shutil.copy(asset("policies") / "q-lambda.json", folder / "q.json")
    shutil.copy(folder / "out" / "short.json", folder / "result.json")
    (folder / "learned.yaml").write_text(
        SHORT + "planner: {name: q-lambda, policy: out/short.json}\n"
    )
    return folder


RULES = "a file of rules, not a scenario; name it in a scenario: planner: {name: improved-fuzzy, "
TOLD = {
    ("run", "rules.yaml"): f"rules.yaml: is {RULES}rules: rules.yaml}}",
    ("validate", "rules.yaml"): f"rules.yaml: is {RULES}rules: rules.yaml}}",
    ("run", "rules.fll"): f"rules.fll: is {RULES}rules: rules.fll}}",
    ("validate", "q.json"): "q.json: is a policy, not a scenario; name it in a scenario: "
    "planner: {name: PLANNER, policy: q.json}",
    ("run", "result.json"): "result.json: is the result of a run, not a scenario",
    ("run", "out/short.npz"): "out/short.npz: is a record, not a scenario; "
    "fuzzyq replay out/short.npz films it",
    ("explain", "1", "0", "--rules", "short.yaml"): "--rules: short.yaml: is a scenario, not a "
    "file of rules; fuzzyq run short.yaml drives it",
    ("replay", "short.yaml"): "short.yaml: is a scenario, not a record (.npz); "
    "its record is out/short.npz",
    ("page", "other.yaml"): "other.yaml: is a scenario, not a record (.npz); "
    "fuzzyq run other.yaml makes one",
    ("replay", "out/short.mp4"): "out/short.mp4: is a video, not a record (.npz); "
    "its record is out/short.npz",
    ("replay", "out/short-map.gif"): "out/short-map.gif: is a video, not a record (.npz); "
    "its record is out/short.npz",
    ("page", "out/short.json"): "out/short.json: is the result of a run, not a record (.npz); "
    "its record is out/short.npz",
    ("replay", "rules.yaml"): "rules.yaml: is a file of rules, not a record (.npz)",
    ("validate", "learned.yaml"): "learned.yaml:8: planner.policy: {0}/out/short.json: is the "
    "result of a run, not a policy",
}


@pytest.mark.parametrize("args", TOLD, ids=" ".join)
def test_a_file_of_another_kind_is_one_line(
    args: tuple[str, ...], inside: Call, folder: Path
) -> None:
    with pytest.raises(UserError) as caught:
        inside(*args, cwd=folder)
    assert caught.value.problems == (TOLD[args].replace("{0}", str(folder)),)


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("start: [1, 1]\nrules: {}\n", "name: is required"),
        ("inputs: {}\noutputs: {}\nrule: {}\n", "rule: unknown key"),
    ],
)
def test_a_file_with_a_few_keys_of_another_kind_has_its_mistakes_told(
    content: str, told: str, inside: Call, tmp_path: Path
) -> None:
    (tmp_path / "half.yaml").write_text(content)
    with pytest.raises(UserError, match=told):
        inside("validate", "half.yaml", cwd=tmp_path)
