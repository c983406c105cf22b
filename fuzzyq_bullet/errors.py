"""The one kind of error that is the user's to mend: it says what, where, and what is right."""

from __future__ import annotations


class UserError(Exception):
    """A mistake in what the user gave: a file, a key, a value, a path, an option.

    Doors print it as one line per problem, without a traceback, and exit with code 2.

    Attributes:
        problems: One readable line per mistake, each naming place and remedy.
    """

    def __init__(self, *problems: str) -> None:
        super().__init__("\n".join(problems))
        self.problems: tuple[str, ...] = problems

    def under(self, place: str) -> UserError:
        """Return the same mistakes under the option or key that led to them."""
        first, *others = self.problems
        return UserError(f"{place}: {first}", *others)


class PlannerError(UserError):
    """A planner raised, exited, or decided nonsense; says which one, what, when and where."""


class SensorError(UserError):
    """A sensor model raised, or told what cannot be a length; says which one."""


class MotionError(UserError):
    """A motion of an obstacle raised, or told what is no pose; says which one, what and when."""


class MachineError(UserError):
    """The machine failed, as with a full disk: nothing is wrong with what was asked.

    Nothing is concluded from it, so that the same can be done again when there is room.
    """


class Stopped(BaseException):
    """A signal asked the process to end: Ctrl-C, ``kill``, or its terminal went away.

    No ``KeyboardInterrupt``, of which libraries make what they like.

    Attributes:
        status: The exit code that shells use for it: 130 for Ctrl-C, 143 for SIGTERM.
    """

    def __init__(self, signum: int) -> None:
        super().__init__(signum)
        self.status = 128 + signum


def printable(text: str) -> str:
    """Return a text as one line that does nothing to a terminal.

    A file's name may hold anything, a line feed or a terminal's command among them.
    """
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
