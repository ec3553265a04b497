"""Arrays that know where they belong: points their frame, drives their layout. palpa refuses them elsewhere."""
import numpy as _np


class Placed(_np.ndarray):
    """An array with `of`: "world" or a Layout, for points of its frame and drives of its transducers; None if it is not
    known.

    Views, copies and parts of it keep `of`. Results of calculations are plain arrays, because palpa cannot know where
    they belong. numpy.asarray(array) is a plain array, too. What is written into it from elsewhere changes `of`.
    """

    def __array_finalize__(self, other):
        self.of = getattr(other, "of", None)

    def __setitem__(self, key, value):
        super().__setitem__(key, value)
        if _np.ndim(_plain(value)) > 0:  # a number that is put in does not say where it belongs
            whole = isinstance(key, (slice, type(...))) and _plain(self)[key].size == self.size
            _written(self, _of(value), whole)

    def __array_ufunc__(self, ufunc, method, *inputs, **options):
        return _called(getattr(ufunc, method), inputs, options)

    def __array_function__(self, function, types, inputs, options):
        result = _called(function, inputs, options)
        if function in (_np.copyto, _np.place, _np.put, _np.putmask):
            _written(inputs[0] if inputs else options.get("dst"), None)
        return result

    def fill(self, value):
        """As ndarray.fill."""
        super().fill(value)
        _written(self, None)

    def put(self, *inputs, **options):
        """As ndarray.put."""
        super().put(*inputs, **options)
        _written(self, None)

    @property
    def flat(self):
        """As ndarray.flat, through which anything may be written."""
        if self.flags.writeable:
            _written(self, None)
        return _plain(self).flat

    @flat.setter
    def flat(self, values):
        _plain(self).flat = values
        _written(self, None)

    def dot(self, *inputs, **options):
        """As ndarray.dot."""
        return _called(_plain(self).dot, inputs, options)

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


def _called(function, inputs, options):
    result = function(*_plain(inputs), **_plain(options))
    out = options.get("out")
    for array in out if isinstance(out, tuple) else (out,):
        _written(array, None)
    return result


def _of(value):
    """Where an array, or the arrays in a list, belong: None if that is not known, or not one place."""
    if type(value) not in (list, tuple):
        return getattr(value, "of", None)
    places = [_of(part) for part in value]
    return places[0] if places and all(place == places[0] for place in places) else None


def _written(array, of, whole=False):
    """Values that belong to `of` were written into it: what it is a part of is no longer known to belong elsewhere."""
    if isinstance(array, Placed) and of != array.of:
        array.of = of if whole else None
        _written(array.base, of)


def placed(array, of):
    """The array as one that belongs there. It shows the same memory."""
    made = array.view(Placed)
    made.of = of
    return made
