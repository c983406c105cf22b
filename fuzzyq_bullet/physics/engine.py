"""The typed edge around PyBullet: an owned client and its settings."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from fuzzyq_bullet.files import temporary_folder


@contextmanager
def silenced(*descriptors: int) -> Iterator[None]:
    """Keep what PyBullet prints from C off the user's terminal.

    Args:
        descriptors: 1 for standard output, 2 for standard error.
    """
    try:
        sys.stderr.flush()
        saved = {one: os.dup(one) for one in descriptors}
    except (OSError, ValueError, AttributeError):  # not there, so nothing to protect
        yield
        return
    try:
        with Path(os.devnull).open("w") as null:
            for one in saved:
                os.dup2(null.fileno(), one)
            yield
    finally:
        for one, before in saved.items():
            os.dup2(before, one)
            os.close(before)


with silenced(2):  # its banner
    import pybullet

TIME_STEP = 1.0 / 240.0
"""Length of one physics step (s)."""
SOLVER_ITERATIONS = 50
GRAVITY = -9.81


class Contact(NamedTuple):
    """One touching pair of bodies.

    Attributes:
        body: Id of the body that was touched.
        point: Where, on that body (m).
        force: Normal force (N).
    """

    body: int
    point: tuple[float, float, float]
    force: float


class Engine:
    """One PyBullet client with this project's settings, disconnected when closed.

    Settings are set anew on every reset, because ``resetSimulation`` forgets some of them and any
    difference breaks determinism.

    Args:
        window: Options of PyBullet's own window, such as ``--width=640``; by default there is none.
            A process has one window at most, and ends where it cannot be opened: ask
            ``platforms.no_screen`` before.
    """

    def __init__(self, window: str | None = None) -> None:
        self.api: Any = pybullet
        self.client: int = (
            pybullet.connect(pybullet.DIRECT)
            if window is None
            else pybullet.connect(pybullet.GUI, options=window)
        )
        if self.client < 0:
            raise RuntimeError("PyBullet has no client left; close the worlds no longer in use")
        self.reset()

    def reset(self) -> None:
        """Empty the simulation and set every engine setting."""
        pybullet.resetSimulation(physicsClientId=self.client)
        pybullet.setGravity(0.0, 0.0, GRAVITY, physicsClientId=self.client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=TIME_STEP,
            numSolverIterations=SOLVER_ITERATIONS,
            deterministicOverlappingPairs=1,
            physicsClientId=self.client,
        )

    def load(
        self,
        path: Path,
        *,
        position: tuple[float, float, float] = (0.0, 0.0, 0.0),
        yaw: float = 0.0,
        fixed: bool = False,
        visible: bool = False,
    ) -> int:
        """Load a URDF and return its body id; its visuals only where it is to be ``visible``."""
        if not path.is_file():  # loadURDF on a directory kills the process
            raise FileNotFoundError(path)
        flags = pybullet.URDF_USE_IMPLICIT_CYLINDER | pybullet.URDF_USE_INERTIA_FROM_FILE
        if not visible:
            flags |= pybullet.URDF_IGNORE_VISUAL_SHAPES
        body: int = pybullet.loadURDF(
            str(path),
            basePosition=position,
            baseOrientation=pybullet.getQuaternionFromEuler((0.0, 0.0, yaw)),
            useFixedBase=fixed,
            useMaximalCoordinates=fixed,  # a plain rigid body costs less in every step
            flags=flags,
            physicsClientId=self.client,
        )
        return body

    def load_text(
        self,
        urdf: str,
        meshes: Mapping[str, str] | None = None,
        *,
        fixed: bool = True,
        visible: bool = False,
    ) -> int:
        """Load a body from the text of a URDF, and of the mesh files beside it; return its id.

        Raises:
            MachineError: If there is no room for temporary files.
        """
        with temporary_folder() as folder:
            path = folder / "body.urdf"
            for name, text in {"body.urdf": urdf, **(meshes or {})}.items():
                (path.parent / name).write_text(text)
            return self.load(path, fixed=fixed, visible=visible)

    def close(self) -> None:
        """Disconnect the client; a second call does nothing."""
        if self.client >= 0:
            client, self.client = self.client, -1
            if pybullet.isConnected(client):
                pybullet.disconnect(client)

    def __enter__(self) -> Engine:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        # A client that is never closed keeps 18 to 29 MB; at exit the module may be gone already.
        if pybullet is not None and getattr(self, "client", -1) >= 0:
            self.close()
