"""Is the bound on the error of the force a bound, for single asperities of all shapes up to their folds?"""
