"""What many tests are given: the command line, a run that takes no time, workers or none."""

from __future__ import annotations

import contextlib
import io
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import astuple
from pathlib import Path

import hypothesis
import pytest

from fuzzyq_bullet.cli import app
from fuzzyq_bullet.physics.camera import Lens, Mesh, Picture
from fuzzyq_bullet.video.scene import scene
from tests.helpers.commands import FUZZYQ, SHORT, Call, Here, no_workers
from tests.helpers.forking import Forks

# Hundreds of processes start: where nobody keeps what Python compiles, each compiles all anew.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# How long an example takes is the machine's affair: no test asserts a time.
hypothesis.settings.register_profile("fuzzyq", deadline=None, max_examples=50)
hypothesis.settings.load_profile("fuzzyq")

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # A job in the background of a script ignores Ctrl-C, and what it starts would do so too.
    signal.signal(signal.SIGINT, signal.default_int_handler)


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


@pytest.fixture(scope="session")
def here() -> Here:
    """A pool without workers, which need a second or two to start."""
    return Here()


@pytest.fixture
def in_this_process() -> Iterator[None]:
    """Let commands do here what workers are for, where those are not what is claimed."""
    with no_workers():
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
