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
FOOT, TOP = COUNT - MOST, COUNT - 2 * MOST  # t of the first
FOOT_X, TOP_X = COUNT - 3 * MOST, COUNT - 4 * MOST  # distance to the lowest foot, over DEPTH
NODE = TOP_X - OCTAVES - 1  # t at each octave of the first guess
SLOPE = NODE - OCTAVES - 1  # and its change over the octave
SIZE = -SLOPE
