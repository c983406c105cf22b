"""The command line ``fuzzyq``: a door; it holds no logic of its own."""

from typing import NoReturn


def main() -> NoReturn:
    """Run the command line and exit: 0 well, 1 bad verdict, 2 wrong input, 130 interrupted."""
    from fuzzyq_bullet.cli.process import guard

    def command() -> int:
        # Only now, when an interrupt is a plain message already: this takes a moment.
        from fuzzyq_bullet.cli.app import call

        return call()

    guard(command)


__all__ = ["main"]
