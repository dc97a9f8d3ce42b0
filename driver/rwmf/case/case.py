"""One case: typed, immutable, validated by the kernel when it is made."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import Any, NoReturn

from rwmf import _library
from rwmf._files import files
from rwmf.case.group import Group
from rwmf.case.namelist import compose, read_text
from rwmf.errors import InputError, did_you_mean

__all__ = ["Case"]


class Case:
    """What a namelist describes: the scene, the motion, the solver and the output.

    A case never changes: `replace` and `without` return another one. Every case is validated by
    the kernel when it is made; its groups are attributes (``case.frame.T_s``), None when absent.

    A case is what was read: the kernel keeps it, the samples of its records included, so that
    neither it nor what `replace` and `without` return looks at those files again, whatever becomes
    of them. What is pickled is the text: the kernel reads it, and the records, where it is loaded.

    Parameters
    ----------
    **groups : mapping
        Keys and values of each namelist group, for example ``wall={"h": 2.0, "b": 0.5}``.

    Raises
    ------
    InputError
        When the kernel does not accept the case.
    """

    __slots__ = ("_edited", "_folder", "_groups", "_kernel", "_source", "_text")

    _edited: bool
    _folder: Path
    _groups: dict[str, Group]
    _kernel: _library.KernelCase
    _source: str | None
    _text: str

    def __init__(self, **groups: Mapping[str, object]) -> None:
        self._assemble(compose(groups), None, None)

    def _assemble(self, text: str, source: str | None, origin: Case | None) -> None:
        """Let the kernel read the text; an edited case keeps place and records of its origin."""
        put = super().__setattr__
        put("_text", text)
        put("_source", source)
        put("_edited", origin is not None)
        folder = (Path(source).parent if source else Path()).absolute()
        if origin is not None and (source or origin._names_records()):
            folder = origin._folder
        put("_folder", folder)
        known = None if origin is None else origin._kernel
        put("_kernel", _library.read_case(text, self.kernel_source(), known))
        rows: dict[str, list[list[str]]] = {}
        for name, *row in self._kernel.describe():
            group, key = name.split(".", 1)
            rows.setdefault(group, []).append([key, *row])
        put("_groups", {group: Group(group, entries) for group, entries in rows.items()})

    @classmethod
    def _make(cls, text: str, source: str | None, origin: Case | None = None) -> Case:
        case = cls.__new__(cls)
        case._assemble(text, source, origin)
        return case

    @classmethod
    def from_namelist(cls, path: str | os.PathLike[str]) -> Case:
        """Read a namelist file.

        Parameters
        ----------
        path : str or path
            The file; records are looked for relative to its folder.

        Returns
        -------
        Case
            The case.

        Raises
        ------
        InputError
            When the file cannot be read or the kernel does not accept the case.
        """
        source = os.fspath(path)
        return cls._make(read_text(source), source)

    @classmethod
    def from_text(cls, text: str, source: str | os.PathLike[str] | None = None) -> Case:
        """Make a case of namelist text.

        Parameters
        ----------
        text : str
            Namelist text.
        source : str or path, optional
            File that it stands for: records are looked for relative to its folder (otherwise
            relative to the current one), and messages begin with its name.

        Returns
        -------
        Case
            The case.

        Raises
        ------
        InputError
            When the kernel does not accept the case.
        """
        return cls._make(text, None if source is None else os.fspath(source))

    @property
    def source(self) -> str | None:
        """Path of the namelist that the case comes from; None when it was made in memory."""
        return self._source

    @property
    def text(self) -> str:
        """Namelist text that the kernel gets: the file's own until the case is edited."""
        return self._text

    @property
    def inputs(self) -> tuple[Path, ...]:
        """Files that the case was read from: its namelist, if it has one, then its records."""
        own = [] if self._source is None else [self._folder / Path(self._source).name]
        names = [group["file"] for group in self._groups.values() if "file" in group]
        return (*own, *(self._folder / str(name) for name in names if name))

    @property
    def groups(self) -> dict[str, Group]:
        """All groups of the case by name, in the kernel's order."""
        return dict(self._groups)

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 (a group that is there needs no check)
        """Return a group; None when the case has none of this name."""
        if name.startswith("_"):
            raise AttributeError(name)
        if name.lower() in self._groups:
            return self._groups[name.lower()]
        if name.lower() in {row[0] for row in _library.schema()}:
            return None
        raise AttributeError(f"there is no namelist group &{name}")

    def __setattr__(self, name: str, value: object) -> NoReturn:
        """Refuse: a case never changes."""
        raise AttributeError("a case cannot be changed; case.replace(...) returns another one")

    def replace(self, **groups: Mapping[str, object] | None) -> Case:
        """Return a case with other values.

        Parameters
        ----------
        **groups : mapping
            Keys and values to set in a group, which is added when the case has none. None for a
            key takes it out, so that the kernel's default holds; None for a group takes the
            group out: its effect is then not simulated.

        Returns
        -------
        Case
            The edited case.

        Raises
        ------
        InputError
            When the kernel does not accept the edited case.

        Examples
        --------
        >>> stiff = case.replace(frame={"T_s": 0.4})  # doctest: +SKIP
        """
        _check_groups(groups, self._groups)
        entries = self._given_entries()
        for name, changes in groups.items():
            if changes is None:
                entries.pop(name.lower(), None)
                continue
            group = entries.setdefault(name.lower(), {})
            for key, value in changes.items():
                # the same key in another spelling is the same key
                same = next((k for k in group if k.lower() == key.lower()), key)
                group[same] = value
        return self._make(compose(entries), self._source, self)

    def without(self, *groups: str) -> Case:
        """Return a case without some groups: effects that are then not simulated.

        Parameters
        ----------
        *groups : str
            Names of groups.

        Returns
        -------
        Case
            The edited case.

        Raises
        ------
        InputError
            When there is no such group in the case, or the kernel does not accept the rest.
        """
        for name in groups:
            if name.lower() not in self._groups:
                present = ", ".join(f"&{group}" for group in self._groups)
                raise InputError(f"this case has no group &{name.lower()}; it has {present}")
        return self.replace(**dict.fromkeys(groups))

    def to_namelist(self, path: str | os.PathLike[str] | None = None) -> str:
        """Return namelist text that gives the same results, and write it to a file if asked.

        Parameters
        ----------
        path : str or path, optional
            File to write. The path of a record is then relative to its folder; without a file
            it is absolute, so that the text means the same wherever it is read.

        Returns
        -------
        str
            The values that the case gives, without comments.

        Raises
        ------
        InputError
            When the file is one of the case's records.
        OutputError
            When the file cannot be written.
        """
        entries = self._given_entries()
        for group in ("motion", "vertical"):
            record = entries.get(group, {}).get("file")
            if record is None:
                continue
            full = self._folder / str(record)
            if path is not None and not Path(str(record)).is_absolute():
                # Path.relative_to cannot climb to a common folder before Python 3.12
                full = Path(os.path.relpath(full, Path(path).absolute().parent))
            entries[group]["file"] = str(full)
        text = compose(entries)
        if path is not None:
            # the case's own file may be written anew; the records stay what the text names
            files.check_not_read(path, self.inputs[self._source is not None :])
            files.write_bytes(path, text.encode("utf-8", "surrogateescape"))
        return text

    @property
    def kernel(self) -> _library.KernelCase:
        """The case as the kernel has read it."""
        return self._kernel

    def kernel_source(self) -> str:
        """Path that the kernel resolves records against; good from any current folder.

        Returns
        -------
        str
            The path; that of an edited case says so.
        """
        label = self._label()
        if Path(label).parent.absolute() == self._folder:
            return label
        return str(self._folder / (Path(label).name or "case.nml"))

    def _label(self) -> str:
        # the lines that a message counts are not those of the file once a case is edited
        return (self._source or "") + (" (edited)" if self._edited and self._source else "")

    def _names_records(self) -> bool:
        return any("file" in group for group in self._groups.values())

    def _given_entries(self) -> dict[str, dict[str, object]]:
        return {
            name: {key: group[key] for key in group if key in group.given}
            for name, group in self._groups.items()
        }

    def __eq__(self, other: object) -> bool:
        """Compare what the kernel would compute."""
        if not isinstance(other, Case):
            return NotImplemented
        return self.to_namelist() == other.to_namelist()

    def __hash__(self) -> int:
        """Hash what the kernel would compute."""
        return hash(self.to_namelist())

    def __reduce__(self) -> tuple[Callable[..., Case], tuple[str, str | None]]:
        """Pickle text and place; the kernel reads it again."""
        source = None if self._source is None else str(Path(self._folder, Path(self._source).name))
        return (_restore, (self.to_namelist() if source is None else self._text, source))

    def __copy__(self) -> Case:
        """Return the case itself: it never changes."""
        return self

    def __deepcopy__(self, _: object) -> Case:
        """Return the case itself: it never changes."""
        return self

    def __repr__(self) -> str:
        """Show the groups, one a line."""
        lines = [f"Case({self._label() or 'in memory'})"]
        lines += [f"  {name:8s} {group!r}" for name, group in self._groups.items()]
        return "\n".join(lines)


def _restore(text: str, source: str | None) -> Case:
    return Case.from_text(text, source)


def _check_groups(
    groups: Mapping[str, Mapping[str, object] | None], present: Collection[str]
) -> None:
    """Complain of what is no group, or of values without keys."""
    for name, values in groups.items():
        if name.lower() not in present:
            _check_group(name)
        if values is not None and not isinstance(values, Mapping):
            raise InputError(f"&{name.lower()} = {values!r}: must be keys with values, or None")


def _check_group(name: str) -> None:
    rows = [(group, key) for group, key, *_ in _library.schema()]
    known = dict.fromkeys(group for group, _ in rows)
    if name.lower() in known:
        return
    owners = [f"{group}={{{key!r}: ...}}" for group, key in rows if key.lower() == name.lower()]
    hint = f", did you mean {' or '.join(owners)}?" if owners else did_you_mean(name, known)
    hint = f"{hint} There" if hint else "; there"
    raise InputError(f"there is no group &{name}{hint} are {', '.join(known)}")
