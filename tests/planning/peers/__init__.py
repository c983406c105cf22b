"""The planners of other papers: each behaves as its paper says in its paper's simplest case."""
