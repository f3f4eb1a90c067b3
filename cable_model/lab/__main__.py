"""`python -m cable_model.lab`: the laboratory's command line."""

from cable_model.lab import docs

docs.cli.main()
