"""Options as words of the program's command line."""

from __future__ import annotations

import os


def option_words(**given: object) -> list[str]:
    """The program's words for options: `seed=1` gives the word `--seed=1`.

    None and False give nothing; True gives the option alone; a list repeats the option. Floats keep all digits.
    """
    words = []
    for name, value in given.items():
        option = f"--{name.replace('_', '-')}"
        for each in value if isinstance(value, list) else [value]:
            if each is None or each is False:
                continue
            words.append(option if each is True else f"{option}={_word(each)}")
    return words


def _word(value: object) -> str:
    if isinstance(value, float):
        return repr(float(value))
    return os.fspath(value) if isinstance(value, os.PathLike) else str(value)
