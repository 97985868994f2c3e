"""One curved asperity as a row of numbers: what ``prepare`` finds out once, and the kernels read.

In units of the shape's width and rise the contact is indentation = g(a) - tension sqrt(a) and, over 2 E* width rise,
force = ∫ x g' dx - tension a^(3/2), with tension = dl(width)/rise. A branch is stable from its foot to its top.
"""

MOST = 8
OCTAVES = 24

# Places from the end of a row: the numbers of the shape come first, so that its functions need not look for them.
TENSION = -1
CONTROL = -2  # 0: fixed grips, 1: dead load
DEPTH = -3  # how far below first touch the lowest foot lies, in the controlled quantity; 1 without adhesion
FOLD = -4  # t of the lowest foot
COUNT = -5  # of stable branches; 0 where there are too many, or none that floats can hold
LAST, LAST_X = -6, -7  # the foot of the last branch: its t, and its distance to the lowest foot over DEPTH
ONSET = -8  # the distance at which the contact, or attraction, begins
STRENGTH, RANGE = -9, -10  # 2 sigma0/E* width/rise and w/sigma0 over rise, where adhesion has a range (``dugdale``)
JUNCTION, UNIT = -11, -12  # the cohesive radius over width where contact begins, and what t - 1 is counted in
NEAR = -13  # times t: so near a foot the integral of the slope has more digits than the difference of the values
FOOT, TOP = NEAR - MOST, NEAR - 2 * MOST  # t of the first
FOOT_X, TOP_X = NEAR - 3 * MOST, NEAR - 4 * MOST  # the distances


def first_node(split: int) -> int:
    """The place of the nodes of the first guess, with octaves in 2^split parts: for each t and y dt/dy."""
    return TOP_X - 2 * ((OCTAVES << split) + 1)
