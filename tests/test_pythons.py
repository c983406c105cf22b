"""Every CPython from 3.10 to 3.13 drives alike: the same digests, whichever PyBullet and NumPy."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
LOCK = ROOT / "requirements.lock"
MINORS = (10, 11, 12, 13)
DRIVES = """\
from fuzzyq_bullet import load_scenario, result_of, run, with_options
for name, drive in (("boxes", "wheels"), ("semicircle", "kinematic"), ("figure-9a", "wheels")):
    print(result_of(run(with_options(load_scenario(name), drive=drive))).digest)
"""


def interpreters() -> dict[int, Path]:
    """Find one interpreter of each version, on the path or where pyenv keeps them."""
    versions = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    found = {}
    for minor in MINORS:
        on_path = shutil.which(f"python3.{minor}")
        places = [Path(on_path)] if on_path else []
        for place in (*places, *sorted(versions.glob(f"3.{minor}.*/bin/python"))):
            told = subprocess.run([place, "-c", SELF], capture_output=True, text=True)
            if told.returncode == 0 and told.stdout == f"cpython 3.{minor}\n":
                found[minor] = place
                break
    return found


SELF = "import sys, venv; v = sys.version_info; print(sys.implementation.name, f'{v[0]}.{v[1]}')"
OTHERS = {minor: path for minor, path in interpreters().items() if minor != sys.version_info.minor}


def environment(minor: int) -> Path:
    """Return an interpreter with all that the lock holds for it, kept for the next time."""
    folder = ROOT / ".venvs" / f"3.{minor}"
    python, stamp = folder / "bin" / "python", folder / "lock"
    lock = hashlib.sha256(LOCK.read_bytes()).hexdigest()
    if not stamp.exists() or stamp.read_text() != lock:
        uv = [sys.executable, "-m", "uv", "--quiet"]
        make = [*uv, "venv", "--clear", "--python", str(OTHERS[minor]), str(folder)]
        fill = [*uv, "pip", "install", "--python", str(python), "--only-binary", "numpy"]
        for command in (make, [*fill, "--require-hashes", "--requirement", str(LOCK)]):
            done = subprocess.run(command, capture_output=True, text=True)
            assert done.returncode == 0, done.stderr
        stamp.write_text(lock)
    return python


def digests(python: str | Path) -> list[str]:
    environ = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [python, "-c", DRIVES], capture_output=True, text=True, env=environ, cwd=ROOT
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


@pytest.mark.slow
@pytest.mark.skipif(not OTHERS, reason="there is one interpreter alone")
def test_all_pythons_give_the_same_digests() -> None:
    here = digests(sys.executable)
    assert len(set(here)) == 3
    for minor in OTHERS:
        assert digests(environment(minor)) == here, f"CPython 3.{minor}"
