"""The native FMUs: the kernels as object code under a small C layer, so that the target needs no Python."""
