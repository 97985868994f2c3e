"""The errors that roughmdr raises on purpose. Each message names the argument, its value and what is allowed."""


class RoughmdrError(ValueError):
    """Base of all errors that roughmdr raises on purpose."""


class SceneError(RoughmdrError):
    """What was asked for, in a scene or an ensemble, cannot be computed as it stands."""


class ShapeError(RoughmdrError):
    """A shape parameter, or the use of a shape, makes no sense."""


class OutOfRange(RoughmdrError):  # noqa: N818 - the name is part of the contract
    """A number lies outside the range in which there is a right answer."""


class StoreError(RoughmdrError):
    """A file cannot be read or written."""
