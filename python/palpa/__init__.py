"""palpa: feel a 3-D model in mid-air.

Scenes, touches, drives, sound fields and live sessions, computed by the engine of the `palpa` command. Lengths are in
metres, angles in radians, times in seconds, pressures in pascals (peak). Arrays are float64 or complex128, in C order,
with one row of three coordinates per point. Options have the names of the command line, with _ instead of -.

Warnings are Python's, of the category PalpaWarning.
"""
import pathlib as _pathlib

try:
    from . import _engine
except ImportError:
    import importlib.machinery as _machinery
    import platform as _platform
    _folder = _pathlib.Path(__file__).parent
    if any((_folder / f"_engine{_ending}").exists() for _ending in _machinery.EXTENSION_SUFFIXES):
        raise  # such as a library that it needs
    _others = ", ".join(sorted(_file.name for _file in _folder.glob("_engine.*")))
    raise ImportError(f"{_folder}: has no compiled part for this Python {_platform.python_version()}"
                      + (f", only {_others}: use the Python that palpa was built for" if _others else
                         ": ./dev build release palpa_python builds it")) from None
from ._engine import *  # noqa: F401,F403
from ._engine import __version__  # noqa: F401

__all__ = sorted([*(name for name in dir(_engine) if not name.startswith("_")), "gather", "sweep"])


def __getattr__(name):
    """The functions of sweeps, which few programs need."""
    if name not in ("gather", "sweep"):
        raise AttributeError(f"module 'palpa' has no attribute '{name}'")
    from . import sweeps
    return getattr(sweeps, name)


# palpa's own models and rigs: in the package, or where `cmake --install` puts them.
_folder = _pathlib.Path(__file__).parent
for _assets in (_folder / "assets", _folder / "../../../../share/palpa/assets"):
    if _assets.is_dir():
        _engine._use_assets(str(_assets))
        break
# The guard of boards: beside the module, or where `cmake --install` puts it.
_folder = _pathlib.Path(__file__).resolve().parent
_engine._use_guards([str(_folder / "palpa-guard"), str((_folder / "../../../../libexec/palpa/palpa-guard").resolve())])
del _assets, _folder
