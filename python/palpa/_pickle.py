"""What pickles of palpa's objects call. A function of the compiled part has no name that pickle could look up."""
from palpa import _engine  # type: ignore[attr-defined]  # it has no stub of its own


def restore(name, data, checksum, frame=None):
    """An object of this class; `checksum`: that of the data; `frame`: that of a Places."""
    return _engine._restore(name, data, checksum, frame)


def scene(given, options):
    """A scene, loaded again."""
    return _engine._restore_scene(given, options)


def recording(folder):
    """A recording, loaded again."""
    return _engine._restore_recording(folder)
