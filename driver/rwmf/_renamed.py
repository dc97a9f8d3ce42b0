"""Messages for earlier spellings of public names and of words of the command line."""

from collections.abc import Callable
from functools import cache
from pathlib import Path


@cache
def renamed(kind: str) -> dict[str, str]:
    """Read the earlier names within rwmf ('names'), or words of commands ('words')."""
    # imported here: only the message of an error needs it
    import tomllib

    text = Path(__file__).with_name("renamed.toml").read_text(encoding="utf-8")
    found: dict[str, str] = tomllib.loads(text)[kind]
    return found


def of_module(module: str) -> Callable[[str], object]:
    """Make the `__getattr__` of a public module: an error that names the new spelling."""

    def refuse(name: str) -> object:
        raise AttributeError(moved(f"{module}.{name}"))

    return refuse


def moved(name: str) -> str:
    """Return the message for a name that rwmf lacks."""
    module, _, last = f"rwmf.{name}".rpartition(".")
    new = renamed("names").get(name)
    return f"module {module!r} has no attribute {last!r}" + (f": it is now {new}" if new else "")
