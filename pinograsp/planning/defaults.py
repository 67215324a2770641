"""Defaults of a plan, apart from what needs a library to be loaded: the command line's help shows them."""

DEFAULT_STARTS = 1304
"""Number of starts: the paper's."""
PROPOSED = 24
"""Pairs of contacts that are proposed to starts where a task desires none."""
EXPLAINED, EXPLAIN_SECONDS = 64, 30.0
"""Starts of a plan that is explained, and time for remedies, s."""
