"""What ``run``, ``replay`` and ``race`` share: the options of a film, and how one is made."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from fuzzyq_bullet.cli.options import progress_bar, say
from fuzzyq_bullet.errors import Stopped, UserError
from fuzzyq_bullet.filming import (
    FORMATS,
    MOST_ANIMATION_FPS,
    VIEWS,
    Filming,
    check_fps,
    check_speed,
    check_time,
    size_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from fuzzyq_bullet.recording.trajectory import Trajectory

_MEDIA = {".mp4", ".gif", ".webp", ".png", ".avi", ".mov", ".mkv", ".webm", ".m4v", ".jpg", ".ogv"}


def _checked(check: Callable[[Any], object]) -> Callable[[Any], Any]:
    """Return the callback of an option whose value is checked."""

    def callback(value: Any) -> Any:
        try:
            check(value)
        except ValueError as error:
            raise typer.BadParameter(str(error)) from error
        return value

    return callback


def _size(text: str) -> tuple[int, int]:
    try:
        return size_of(text)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from error


def _format(value: str) -> str:
    if value not in FORMATS:
        raise typer.BadParameter(f"must be one of {', '.join(FORMATS)}; got {value!r}")
    return value


SpeedOption: TypeAlias = Annotated[
    float,
    typer.Option(help="Playback speed; 1 is real time.", callback=_checked(check_speed)),
]
SizeOption: TypeAlias = Annotated[
    Any,
    typer.Option(
        parser=_size,
        metavar="WIDTHxHEIGHT",
        help="Size of the video in pixels, 1280x720 by default; 1080x1080 is square.",
    ),
]
FpsOption: TypeAlias = Annotated[
    int | None,
    typer.Option(help="Frames a second: 30 by default, of a GIF 10.", callback=_checked(check_fps)),
]
FromOption: TypeAlias = Annotated[
    float | None,
    typer.Option(
        "--from",
        help="Time of the run at which the video begins (s).",
        callback=_checked(check_time),
    ),
]
ToOption: TypeAlias = Annotated[
    float | None,
    typer.Option(
        "--to", help="Time of the run at which it ends (s).", callback=_checked(check_time)
    ),
]
ViewOption: TypeAlias = Annotated[
    str, typer.Option(help=f"What it shows: {', '.join(VIEWS)}, or a plugin's view.")
]
FormatOption: TypeAlias = Annotated[
    str, typer.Option("--format", help=f"{' or '.join(FORMATS)}.", callback=_format)
]
StillOption: TypeAlias = Annotated[
    float | None,
    typer.Option(
        metavar="TIME",
        help="Write one picture (PNG) of this time (s) instead of a video.",
        callback=_checked(check_time),
    ),
]


@dataclass(frozen=True)
class FilmRequest:
    """A film, or one picture, as the command line asks for it.

    Attributes:
        filming: How it is filmed.
        form: ``mp4`` or ``gif``.
        still: Time of the one picture that is wanted instead (s).
    """

    filming: Filming
    form: str = "mp4"
    still: float | None = None

    def name(self, run: str) -> str:
        """Return what the file of a run, or of a race, is called."""
        from fuzzyq_bullet.outputs import film_name

        return film_name(run, self.filming, self.form, self.still)

    def options(self) -> list[str]:
        """Return the words of a command line that ask for it; none for the usual film."""
        film, usual = self.filming, Filming()
        size = None if film.size is None else "x".join(map(str, film.size))
        told = {
            "view": None if film.view == usual.view else film.view,
            "size": size,
            "fps": film.fps,
            "speed": None if film.speed == usual.speed else film.speed,
            "from": film.start,
            "to": film.end,
            "format": None if self.form == "mp4" else self.form,
            "still": self.still,
        }
        given = [(f"--{name}", f"{value}") for name, value in told.items() if value is not None]
        return [word for pair in given for word in pair]

    def make(
        self,
        runs: Trajectory | Sequence[Trajectory],
        path: Path,
        names: Sequence[str] | None = None,
    ) -> Path:
        """Make it, showing how far it is, and return its path.

        Raises:
            UserError: If it cannot be made, or written.
        """
        from fuzzyq_bullet.video import record, write_still

        film = self.filming
        if self.still is not None:
            end = max(
                one.ticks.time[-1] for one in (runs if isinstance(runs, Sequence) else [runs])
            )
            if self.still > end + 0.05:  # a result tells tenths of a second
                raise UserError(
                    f"--still: {self.still:g} s is after the end of the run, {end:.2f} s"
                )
            write_still(runs, path, self.still, size=film.size, view=film.view, names=names)
            return path
        with progress_bar("filming") as (progress, bar), _options_named():
            record(
                runs,
                path,
                speed=film.speed,
                size=film.size,
                fps=film.fps,
                start=film.start,
                end=film.end,
                view=film.view,
                names=names,
                progress=lambda done, total: progress.update(
                    bar, completed=done, total=total, note=f"{done} of {total} frames"
                ),
            )
        return path


def film_request(
    out: Path | None,
    form: str,
    still: float | None,
    *,
    race: bool = False,
    **filming: Any,
) -> FilmRequest:
    """Return what the options ask for.

    Args:
        out: The folder to write into.
        form: The format.
        still: Time of a single picture (s).
        race: Whether several runs are filmed, of which a plugin's view knows nothing.
        **filming: The arguments of ``Filming``.

    Raises:
        UserError: If two of them do not go together, or there is no such view.
    """
    fps, view = filming["fps"], filming["view"]
    if out is not None and out.suffix.lower() in _MEDIA and not out.is_dir():
        raise UserError(
            f"--out: {out} must be a folder; the video gets its name from the run, "
            f"and --format is one of {', '.join(FORMATS)}"
        )
    if still is not None and (
        form != "mp4" or (fps, filming["start"], filming["end"]) != (None,) * 3
    ):
        raise UserError("--still: makes one picture; leave out --format, --fps, --from and --to")
    if form == "gif" and (fps or 0) > MOST_ANIMATION_FPS:
        raise UserError(f"--fps: a GIF has at most {MOST_ANIMATION_FPS}; got {fps}")
    if view not in VIEWS:
        from fuzzyq_bullet.video.views import view_names

        known = VIEWS if race else view_names()
        if view not in known:
            raise UserError(f"--view: must be one of {', '.join(known)}; got {view!r}")
    with _options_named():
        return FilmRequest(Filming(**filming), form, still)


@contextmanager
def kept_if_stopped(
    film: FilmRequest, command: str, records: Sequence[Path], plugins: Sequence[str]
) -> Iterator[None]:
    """Say, if a signal ends the block, that the records are there, and how to make the film.

    Args:
        film: The film that is made in the block.
        command: The command that makes it of records: ``replay`` or ``race``.
        records: What was written before.
        plugins: Modules that it needs.
    """
    try:
        yield
    except Stopped:
        files = [str(path) for path in records]
        words = [word for plugin in plugins for word in ("--plugin", plugin)]
        again = shlex.join(["fuzzyq", command, *files, *film.options(), *words])
        say(f"kept: {', '.join(files)}; to film: {again}")
        raise


@contextmanager
def _options_named() -> Iterator[None]:
    """Name the options in what is said of the arguments that they become."""
    try:
        yield
    except UserError as error:
        raise UserError(*map(_as_option, error.problems)) from error


def _as_option(problem: str) -> str:
    for argument, option in (("start", "--from"), ("end", "--to")):
        if problem.startswith(f"{argument}: "):
            return problem.replace(argument, option, 1).replace("than start", "than --from")
    return problem
