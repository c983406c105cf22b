"""What many tests share: the command line as people call it, and a run that takes no time."""

from __future__ import annotations

import contextlib
import io
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import astuple
from pathlib import Path
from typing import Any, TypeAlias

import hypothesis
import pytest
from forking import FUZZYQ, Forks

from fuzzyq_bullet.cli import app
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.physics.camera import Lens, Mesh, Picture
from fuzzyq_bullet.video import scene
from fuzzyq_bullet.workers import Answer, WorkerPool

# Hundreds of processes start: where nobody keeps what Python compiles, each compiles all anew.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# How long an example takes is the machine's affair: no test asserts a time.
hypothesis.settings.register_profile("fuzzyq", deadline=None, max_examples=50)
hypothesis.settings.load_profile("fuzzyq")

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # A job in the background of a script ignores Ctrl-C, and what it starts would do so too.
    signal.signal(signal.SIGINT, signal.default_int_handler)

SLOW = (
    *("check", "cli", "cli_bad_input", "cli_interrupt", "cli_train", "cluster", "drives"),
    *("early_warnings", "episode", "escape", "exploration", "extend_expectation"),
    *("extend_panel", "extend_planner", "extend_sensor", "extend_study", "extend_world"),
    *("figure_panels", "gate", "ground_truth", "gym", "layouts", "learned_weights"),
    *("learning_gain", "learning_training", "outputs", "package", "pytest_plugin", "pythons"),
    *("report", "success", "sweep", "unchanged", "video", "video_picture"),
)
"""Modules of tests that take long: ``-m "not slow"`` leaves them out."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if item.path.stem.removeprefix("test_") in SLOW:
            item.add_marker("slow")


Call: TypeAlias = Callable[..., "subprocess.CompletedProcess[str]"]

SHORT = """\
name: short
arena: {size: [3.0, 2.0]}
start: {position: [0.6, 0.6]}
goal: {position: [1.4, 0.7]}
obstacles:
  - {shape: cylinder, position: [2.3, 1.4], radius: 0.2}
  - {shape: box, position: [1.2, 1.5], size: [0.3, 0.2], yaw: 0.4}
"""


@pytest.fixture(scope="session")
def installed() -> Call:
    """The installed command, in a process that starts from nothing."""

    def call(
        *args: object, cwd: Path | None = None, timeout: float = 120, **more: object
    ) -> subprocess.CompletedProcess[str]:
        command = [FUZZYQ, *map(str, args)]
        return subprocess.run(  # type: ignore[call-overload, no-any-return]
            command, cwd=cwd, capture_output=True, text=True, timeout=timeout, **more
        )

    return call


@pytest.fixture(scope="session")
def fuzzyq(installed: Call) -> Iterator[Call]:
    """The command in a process of its own, which has the libraries loaded where that can be."""
    if not hasattr(os, "fork"):
        yield installed
        return
    with Forks() as forks:

        def call(
            *args: object, cwd: Path | None = None, timeout: float = 120
        ) -> subprocess.CompletedProcess[str]:
            return forks.call([*map(str, args)], cwd, timeout)

        yield call


@pytest.fixture(scope="session")
def inside() -> Call:
    """The same command in this process, a second cheaper; a mistake is raised as it is."""

    def call(*args: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
        out, err = io.StringIO(), io.StringIO()
        with (
            pytest.MonkeyPatch.context() as patch,
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
        ):
            patch.setattr(sys, "argv", ["fuzzyq", *map(str, args)])
            if cwd is not None:
                patch.chdir(cwd)
            status = app.call()
        return subprocess.CompletedProcess(args, status, out.getvalue(), err.getvalue())

    return call


@pytest.fixture(scope="session")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A scenario of less than a metre."""
    path = tmp_path_factory.mktemp("scenario") / "short.yaml"
    path.write_text(SHORT)
    return path


@pytest.fixture(scope="session")
def filmed(fuzzyq: Call, short: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All that a run of ``short`` writes, and what it printed; not to be changed."""
    folder = tmp_path_factory.mktemp("filmed")
    done = fuzzyq("run", short, "--out", folder, "--json")
    assert done.returncode == 0, done.stderr
    (folder / "stdout").write_text(done.stdout)
    (folder / "stderr").write_text(done.stderr)
    return folder


class Here:
    """A pool that does all work in this process, one order after the other."""

    def run(
        self, function: Callable[[Any], Any], arguments: Sequence[Any], **_: object
    ) -> Iterator[tuple[int, Answer]]:
        for i, argument in enumerate(arguments):
            try:
                answer = Answer(function(argument))
            except UserError as error:
                answer = Answer(failed=error.problems)
            yield i, answer


@pytest.fixture(scope="session")
def here() -> Here:
    """A pool without workers, which need a second or two to start."""
    return Here()


@pytest.fixture
def in_this_process() -> Iterator[None]:
    """Let commands do here what workers are for, where those are not what is claimed."""
    with no_workers():
        yield


@contextlib.contextmanager
def no_workers() -> Iterator[None]:
    """Let commands do in this process what workers are for."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(WorkerPool, "run", Here.run)
        yield


@pytest.fixture(scope="module")
def still_once() -> Iterator[None]:
    """Take the picture of all that stands still once for the frames of the same world.

    It takes more than a second, and is the same each time, as
    ``test_the_same_run_gives_the_same_bytes`` claims, which takes it anew.
    """
    real, taken = scene.photograph, dict[object, Picture]()

    def photograph(meshes: Sequence[Mesh], lens: Lens, oversampling: int = 1) -> Picture:
        asked = (astuple(lens), oversampling, *(surface(mesh) for mesh in meshes))
        if asked not in taken:
            taken[asked] = real(meshes, lens, oversampling)
            for part in taken[asked]:
                part.setflags(write=False)
        return taken[asked]

    def surface(mesh: Mesh) -> object:
        corners = (mesh.vertices, mesh.normals, mesh.triangles)
        return (*(array.tobytes() for array in corners), mesh.colour)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(scene, "photograph", photograph)
        yield
