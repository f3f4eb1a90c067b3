"""A library before pythonfmu's: the same calls, in FMI's order of things where pythonfmu's own wrapper falls short of it."""
