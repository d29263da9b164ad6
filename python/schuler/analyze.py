"""Theory and studies: the commands `schuler analyze ...` as functions."""
from ._commands import COMMANDS, function_of

__all__ = []
for _name in COMMANDS:
    if _name.startswith("analyze "):
        _word = _name.split(" ", 1)[1].replace("-", "_")
        globals()[_word] = function_of(_name, f"analyze.{_word}")
        __all__.append(_word)
