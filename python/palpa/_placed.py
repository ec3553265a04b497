"""Arrays that know where they belong: points their frame, drives their layout. palpa refuses them elsewhere."""
import numpy as _np


class Placed(_np.ndarray):
    """An array with `of`: "world" or a Layout, for points of its frame and drives of its transducers; None if it is not known.

    Views, copies and parts of it keep `of`. Results of calculations are plain arrays, because palpa cannot know where they
    belong. numpy.asarray(array) is a plain array, too.
    """

    def __array_finalize__(self, other):
        self.of = getattr(other, "of", None)

    def __array_ufunc__(self, ufunc, method, *inputs, **options):
        return getattr(ufunc, method)(*_plain(inputs), **_plain(options))

    def __array_function__(self, function, types, inputs, options):
        return function(*_plain(inputs), **_plain(options))

    def dot(self, *inputs, **options):
        """As ndarray.dot."""
        return _plain(self).dot(*_plain(inputs), **_plain(options))

    def __reduce__(self):
        return placed, (_np.array(self), self.of)


def _plain(value):
    if isinstance(value, Placed):
        return value.view(_np.ndarray)
    if type(value) in (list, tuple):
        return type(value)(_plain(part) for part in value)
    if type(value) is dict:
        return {name: _plain(part) for name, part in value.items()}
    return value


def placed(array, of):
    """The array as one that belongs there. It shows the same memory."""
    made = array.view(Placed)
    made.of = of
    return made
