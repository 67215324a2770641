"""What `tools/reproduce_paper.py` runs, compares and writes."""
