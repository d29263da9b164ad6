"""The exception of the package."""


class Error(Exception):
    """What is wrong, where, and how to correct it. `str(error)` is one line with all of it.

    kind    "input" (the input or a setting cannot be used) or "computation" (it failed although its input was well formed)
    what    what is wrong
    file    file of the user, or None
    line    line in it, from 1, or None
    column  column of a table, from 1, or None
    key     key of a setting, name of a column, an option or an argument, or None
    hint    how to correct it, or None
    """

    kind = "input"
    what = ""
    file = line = column = key = hint = None

    @classmethod
    def of(cls, what, key=None, hint=None):
        """An error of the package's own checks."""
        error = cls(f"{key}: {what}" * bool(key) + what * (not key) + (f"; {hint}" if hint else ""))
        error.what, error.key, error.hint = what, key, hint
        return error
