"""The command ``fuzzyq`` in a process of its own that need not load the libraries anew.

Loading them takes longer than most of what tests ask for. A helper process has them loaded, and
makes a copy of itself for each call: what the command does to its process, and what it leaves
behind there, is seen by nobody else. The copy ends as the installed command does: by leaving its
``__main__``.
"""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import warnings
from collections.abc import Sequence
from importlib import import_module
from multiprocessing.connection import Connection
from pathlib import Path
from tempfile import TemporaryDirectory

FUZZYQ = Path(sys.executable).with_name("fuzzyq")
LOADED = (
    *("fuzzyq_bullet.cli.app", "fuzzyq_bullet.episode", "fuzzyq_bullet.recording.metrics"),
    *("fuzzyq_bullet.outputs", "fuzzyq_bullet.video", "rich.markdown", "typer.rich_utils"),
    *("scipy.ndimage", "scipy.spatial", "matplotlib.figure", "matplotlib.backends.backend_agg"),
)


class Forks:
    """Whoever makes the copies; ended with the block."""

    def __init__(self) -> None:
        """Start the helper process."""
        here, there = os.pipe(), os.pipe()
        self._orders = Connection(here[1], readable=False)
        self._answers = Connection(there[0], writable=False)
        self._process = subprocess.Popen(
            [sys.executable, __file__, str(here[0]), str(there[1])], pass_fds=(here[0], there[1])
        )
        os.close(here[0])
        os.close(there[1])

    def __enter__(self) -> Forks:
        return self

    def __exit__(self, *_: object) -> None:
        self._orders.close()
        self._process.wait()
        self._answers.close()

    def call(
        self, args: Sequence[str], cwd: Path | None = None, timeout: float = 120.0
    ) -> subprocess.CompletedProcess[str]:
        """Do what the command line with these words does."""
        with TemporaryDirectory() as name:
            out, err = Path(name) / "out", Path(name) / "err"
            files = [os.devnull, str(out), str(err)]
            self._orders.send((args, str(cwd or Path.cwd()), dict(os.environ), files))
            child = self._answers.recv()
            if not self._answers.poll(timeout):
                os.kill(child, 9)
                self._answers.recv()
                raise subprocess.TimeoutExpired(["fuzzyq", *args], timeout)
            status = self._answers.recv()
            return subprocess.CompletedProcess(args, status, out.read_text(), err.read_text())


def _serve(orders: Connection, answers: Connection) -> None:
    """Make a copy for each order; only the copies come back from here."""
    for name in LOADED:
        import_module(name)
    gc.freeze()  # what is loaded stays shared
    while True:
        try:
            args, folder, environment, files = orders.recv()
        except EOFError:
            sys.exit()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the threads of NumPy's library know of copies
            child = os.fork()
        if not child:
            break
        answers.send(child)
        _, state = os.waitpid(child, 0)
        answers.send(os.waitstatus_to_exitcode(state))
    orders.close()
    answers.close()
    for descriptor, file in enumerate(files):
        opened = os.open(file, os.O_RDWR | os.O_CREAT)
        os.dup2(opened, descriptor)
        os.close(opened)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv[:] = [str(FUZZYQ), *args]
    sys.path[0] = str(FUZZYQ.parent)


if __name__ == "__main__":
    _serve(Connection(int(sys.argv[1])), Connection(int(sys.argv[2])))
    from fuzzyq_bullet.cli import main

    main()
