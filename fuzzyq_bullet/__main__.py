"""``python -m fuzzyq_bullet``: the command line, for where its script is not on the path."""

from fuzzyq_bullet.cli import main

if __name__ == "__main__":
    main()
