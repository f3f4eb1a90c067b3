"""`python -m cable_model`: the command line."""

from cable_model.cli import main

main()
