"""The analysis of studies, for notebooks and scripts: `palpa.study.load(folder)` is the table of all trials, and
`analyse`, `compare` and `power` give what the commands of the same names write as JSON (docs/python/study.md).

It needs pandas, scipy and matplotlib, and nothing of palpa's engine.
"""
import importlib as _importlib

# What each file of the package has for others. A file is imported when something of it is needed: who reads a table does
# not wait for figures.
_FILES = {
    "analysis": ("analyse", "analyse_study", "compare", "compare_tables", "power"),
    "answers": ("answers_of", "choices", "questions_of", "scales", "text_answers", "yes_no"),
    "counts": ("read_counts",),
    "pages": ("Page", "analysis_page", "as_json", "comparison_page", "power_page"),
    "psychometric": ("fit", "right_at", "thresholds"),
    "reading": ("read_study",),
    "table": ("StudyWarning", "load"),
    "text": ("BadInput",),
}
_PLACES = {name: file for file, names in _FILES.items() for name in names}
__all__ = sorted(_PLACES)


def __getattr__(name):
    if name not in _PLACES:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    return getattr(_importlib.import_module(f".{_PLACES[name]}", __name__), name)


def __dir__():
    return __all__
