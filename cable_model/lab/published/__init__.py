"""The published figures and tables of both models' sources, computed anew; and where each of our own shortcuts holds."""
