"""Parser of the command line and completion of shells, both from the table of commands."""

from __future__ import annotations

import argparse
import sys
import textwrap
from collections.abc import Callable, Sequence
from typing import Any

from rwmf._renamed import renamed
from rwmf.cli.command_table import COMMANDS, GROUPS, Command
from rwmf.cli.words import Kept
from rwmf.kernel.names import shorten

_DESCRIPTION = "Dynamic response of post-tensioned rocking wall-moment frames."
_EXAMPLE = "example: rwmf spectrum inputs/fig12_one_cosine.nml --out cosine.png"
_FAMILIES = {
    "study": "A study from a case: overturning map, effect of the wall, equal response.",
    "records": "Ground motions: peaks and intensities, formats, suites, sequences.",
}
_SHELLS = ("bash", "zsh", "fish")


class _Parser(argparse.ArgumentParser):
    """A parser whose errors show its own usage and the nearest known word."""

    def parse_known_args(  # type: ignore[override]
        self,
        args: Sequence[str] | None = None,
        namespace: argparse.Namespace | None = None,
    ) -> tuple[argparse.Namespace, list[str]]:
        """Refuse unknown words here, not in the parser above."""
        found, further = super().parse_known_args(args, namespace)
        if further:
            self.error(f"unrecognized arguments: {' '.join(further)}{self._hint(further[0])}")
        return found, further

    def _hint(self, word: str) -> str:
        """Return the replacement of an old spelling, or the nearest word."""
        import difflib

        word = word.split("=")[0]
        spelled = " ".join([*self.prog.split()[1:], word])
        if new := renamed("words").get(word if word.startswith("-") else spelled):
            return f" (now: {new})"
        known = list(self._option_string_actions)
        for action in self._actions:
            known += action.choices if isinstance(action, argparse._SubParsersAction) else ()
        near = difflib.get_close_matches(word, known, 1)
        return f" (did you mean {near[0]}?)" if near else ""

    def _check_value(self, action: argparse.Action, value: str) -> None:
        if isinstance(action, argparse._SubParsersAction) and value not in action.choices:
            self.error(f"{shorten(value)}: is no command of {self.prog}{self._hint(value)}")
        super()._check_value(action, value)


def make_parser(arguments: Sequence[str] | None = None) -> argparse.ArgumentParser:
    """Build the parser; its result has the attribute ``run``, module and function.

    For given arguments only the commands that they name have words, which saves half of the time.
    """
    parser = _Parser(
        prog="rwmf",
        usage="rwmf [-h] [--version] [--completion SHELL] COMMAND ...",
        description=_DESCRIPTION,
        epilog=f"{_listed()}\n{_EXAMPLE}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--version",
        action=_Show,
        make=_version,
        nargs=0,
        help="show program's version number and exit",
    )
    parser.add_argument(
        "--completion",
        action=_Show,
        make=lambda shell: _fish() if shell == "fish" else _bash(is_zsh=shell == "zsh"),
        choices=_SHELLS,
        help='print the completion of a shell: eval "$(rwmf --completion bash)"',
    )
    top = parser.add_subparsers(
        metavar="COMMAND", prog="rwmf", required=True, help=argparse.SUPPRESS
    )
    families = {}
    for name, text in _FAMILIES.items():
        words = [word for word in COMMANDS if word.startswith(f"{name} ")]
        family = top.add_parser(
            name,
            description=text,
            epilog=f"example: rwmf {words[0]} {COMMANDS[words[0]].example}",
        )
        families[name] = family.add_subparsers(metavar="NAME", required=True)
    for name, command in COMMANDS.items():
        first, _, second = name.partition(" ")
        added = (families[first] if second else top).add_parser(
            second or first,
            help=command.text,
            description=command.text,
            epilog=f"example: rwmf {name} {command.example}",
        )
        added.set_defaults(run=command.run)
        is_named = arguments is None or (second or first) in arguments
        for word in command.words if is_named else ():
            action = added.add_argument(*word.names, **word.settings)
            added.set_defaults(**getattr(action, "further", {}))
    return parser


def _listed() -> str:
    """List the commands by groups, each with its first sentence."""
    lines = []
    for group, title in GROUPS.items():
        lines.append(f"{title}:")
        for name, command in COMMANDS.items():
            if command.group == group:
                text = textwrap.shorten(command.text, 74, placeholder=" ...")
                lines.append(f"  {name:21s} {text}")
        lines.append("")
    return "\n".join(lines)


class _Show(Kept):
    """Print the text that a function makes of the option's value, and end."""

    def __init__(self, make: Callable[[Any], str], **settings: Any) -> None:  # noqa: ANN401 (of argparse)
        super().__init__(default=argparse.SUPPRESS, **settings)
        self._make = make

    def keep(self, namespace: argparse.Namespace, values: Any) -> None:  # noqa: ANN401
        """Print."""
        print(self._make(values))
        sys.exit()


def _version(_: object) -> str:
    """Name version and instructions."""
    from rwmf.kernel.identity import identity

    return f"rwmf {identity()}"


def _options(command: Command) -> str:
    return " ".join(word.names[0] for word in command.words if word.names[0].startswith("-"))


def _bash(*, is_zsh: bool) -> str:
    first = " ".join(dict.fromkeys(name.split()[0] for name in COMMANDS))
    cases = [f'      "{name}"*) words="{_options(item)}" ;;' for name, item in COMMANDS.items()]
    for family in _FAMILIES:
        words = [name.split()[1] for name in COMMANDS if name.startswith(f"{family} ")]
        cases.append(f'      "{family}"*) words="{" ".join(words)}" ;;')
    return "\n".join(
        [
            *(["autoload -U +X bashcompinit && bashcompinit"] if is_zsh else []),
            "_rwmf() {",
            f'   local words="{first} --help --version --completion"',
            '   if [[ $COMP_CWORD -gt 1 ]]; then case "${COMP_WORDS[*]:1:COMP_CWORD-1}" in',
            *cases,
            "   esac; fi",
            '   COMPREPLY=($(compgen -W "$words" -- "${COMP_WORDS[COMP_CWORD]}"))',
            "}",
            "complete -o default -F _rwmf rwmf",
        ]
    )


def _fish() -> str:
    lines = []
    for name, command in COMMANDS.items():
        *above, last = name.split()
        seen = " ".join(f"; and __fish_seen_subcommand_from {word}" for word in above)
        lines.append(f"complete -c rwmf -n 'true{seen}' -a {last}")
        for option in _options(command).split():
            where = f"__fish_seen_subcommand_from {last}{seen}"
            lines.append(f"complete -c rwmf -n '{where}' -l {option.removeprefix('--')}")
    return "\n".join(lines)
