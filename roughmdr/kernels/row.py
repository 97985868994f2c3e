"""One curved asperity as a row of numbers: what ``prepare`` finds out once, and the kernels read.

In units of the shape's width and rise the contact is g(a) - tension sqrt(a) = indentation and ∫ x g' dx - tension a^(3/2)
= force over 2 E* width rise, with tension = dl(width)/rise. A branch is stable from its foot to its top.
"""

TENSION = 0
CONTROL = 1  # 0: fixed grips, 1: dead load
DEPTH = 2  # how far below first touch the lowest foot lies, in the controlled quantity; 1 without adhesion
FOLD = 3  # t of the lowest foot
COUNT = 4  # of stable branches; 0 where there are too many, or none that floats can hold
MOST = 8
FOOT, TOP = 5, 5 + MOST  # t
FOOT_X, TOP_X = 5 + 2 * MOST, 5 + 3 * MOST  # distance to the lowest foot, over DEPTH
OCTAVES = 24
NODE, SLOPE = 5 + 4 * MOST, 6 + 4 * MOST + OCTAVES  # t and its change over each octave of the start
FORM = SLOPE + OCTAVES + 1  # the numbers of the shape, to the end
