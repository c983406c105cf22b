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
