"""Makes the soak's study a command.

    fuzzyq bench soak --plugin tests/soak/plugin.py --episodes 100 --jobs 2

A plugin, because nobody but those who change the package needs it. A file of its own, because a
study stays registered for as long as the process lives, and tests import the study itself.
"""

from __future__ import annotations

from soak_study import Soak  # beside this file, whose folder --plugin makes importable

from fuzzyq_bullet.studies import register_study

register_study(Soak)
