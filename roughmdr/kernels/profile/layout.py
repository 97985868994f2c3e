"""The row of numbers that describes one asperity: filled once by ``prepare``, read by the kernels.

In units of the shape's width and rise the contact is indentation = g(a) - tension sqrt(a) and, over 2 E* width rise,
force = ∫ x g' dx - tension a^(3/2), with tension = dl(width)/rise. A branch is stable from its foot to its top.
Under adhesion with a range the state is s (``dugdale.equilibrium``) in place of t in FOLD, LAST, FOOT and TOP.
"""

MAX_BRANCHES = 8
CANCELLED = 1e-4  # distance from a foot at t = 0, over the depth, within which four digits are lost

# Indices from the end of a row: the parameters of the shape stand at its beginning. All that a visit reads is on one or
# two cache lines.
TENSION = -1
DEPTH = -2  # distance of the lowest foot below first touch, in the controlled quantity; 1 without adhesion
COUNT = -3  # number of stable branches; 0 where they are too many, or not representable
LAST, LAST_X = -4, -5  # the foot of the last branch: its t and its x, the distance to the lowest foot over DEPTH
NEAR = -6  # distance from a foot, over t, within which the slope is integrated: a difference of values is less precise
NUMBER = -7  # shape parameter, e.g. the exponent n (a copy of params[0])
ROUNDINGS = -8  # number of roundings of g, from ``shapes.profile.Profile.roundings``
CONTROL = -9  # 0: fixed grips, 1: dead load
FOLD = -10  # t of the lowest foot
ONSET = -11  # the x at which contact, or attraction, begins when the surfaces approach
STRENGTH, RANGE = -12, -13  # 2 sigma0/E* width/rise and w/sigma0 over rise, where adhesion has a range
JUNCTION, UNIT = -14, -15  # the cohesive radius over width where contact begins, and t over s - 1 (s - 2 on a flat)
FUNCTIONS = -16  # the address of the functions of the shape, for kernels that are compiled for any; else 0
CORNER, FLAT, BRANCHED = -17, -18, -19  # 1 where the shape has a corner, a flat, or more than one branch with adhesion
FOOT, TOP, FOOT_X, TOP_X = (BRANCHED - rows * MAX_BRANCHES for rows in range(1, 5))  # t, and x, of the first


def first_node(octaves: int, split: int, numbers: int) -> int:
    """Return the index of the nodes of the initial guess, octaves in 2^split parts: as many numbers of each."""
    return TOP_X - numbers * ((octaves << split) + 1)
