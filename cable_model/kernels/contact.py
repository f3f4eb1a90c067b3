"""Columns of the table that a seabed keeps of its contacts within a step, a row a node."""

FORCE = 0  # N, that the bottom pushes with
CHANGE = 1  # its Newton change at fixed velocities
HEIGHT, SPEED = 2, 3  # over the bottom and along its normal, at the old time; of a bottom that is a plane
BASE = 4  # of friction.py, three each: xi
BEFORE = 7  # P at the iteration before
NOW = 10  # P at this one, and then as the velocities' change takes it on
TURNS = 13  # how often it has turned round in the iterations of this step
WAIT = 14  # iterations for which it still takes the secant
PLACE, MOTION = 15, 18  # of a node at the old time, three each, over a bottom that is no plane
NORMAL = 21  # of the bottom there, three
BY_VELOCITY = 24  # derivative of N by the velocity of the node, three
COLUMNS = 27
