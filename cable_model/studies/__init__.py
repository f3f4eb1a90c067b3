"""Accuracy against cost: timed runs, converged references, work-precision studies, advice, and sweeps."""
