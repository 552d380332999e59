"""`python -m hpm_mvs` is the program hpm_mvs."""
from ._program import main

main()
