"""Other cable codes on the same scenes, where they are installed (extra "peers"): how they are driven, and the comparison."""
