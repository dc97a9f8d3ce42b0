"""Typed, immutable cases, validated by the kernel on construction."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
import numpy.typing as npt

from rwmf.case.group import Group
from rwmf.case.groups import TYPES, Groups
from rwmf.case.motion import Motion
from rwmf.case.namelist import compose, numbers_of, read_text
from rwmf.errors import InputError, did_you_mean, no_line_numbers
from rwmf.kernel import files, kernel_case, tables
from rwmf.kernel.files import path_of
from rwmf.kernel.numbers import Array, show, to_array, to_items

_NAMELIST = "the path of a namelist"


def changes_without_wall(case: Case) -> dict[str, dict[str, object] | None]:
    """Return the changes that remove the wall."""
    found: dict[str, dict[str, object] | None] = {
        name: None for name in case.groups if name in groups_of_wall()
    }
    heights = _heights_of_wall(case, found)
    if "spectrum" in case.groups:
        found["spectrum"] = {"gamma": None, "b": None}
    if "output" in case.groups:
        found["output"] = {"friction_limit": None}
    return found | _free_floors(case) | heights | {"frame": {"gamma": None}}


def _free_floors(case: Case) -> dict[str, dict[str, object]]:
    """Choose the modes of storeys without a wall that every floor is linked to."""
    if case.storeys is not None and case.storeys.coupling == "springs":
        return {"storeys": {"coupling": "full", "k_link_over_m_w": None, "k_link": None}}
    if case.storeys is None or case.storeys.coupling != "every_floor":
        return {}
    one_by_one = case.yielding is not None and "storey_u_y" in case.yielding
    return {"storeys": {"coupling": "full" if one_by_one else "reduced"}}


def _heights_of_wall(case: Case, gone: Mapping[str, object]) -> dict[str, dict[str, object]]:
    """Return the keys that default to 2h; storeys have individual heights."""
    if case.wall is None or "storeys" in case.groups:
        return {}
    return {
        row.group: {row.key: 2 * case.wall.h}
        for row in tables.schema()
        if row.default == "2h" and row.group in case.groups and row.group not in gone
        if row.key not in case.groups[row.group].given
    }


def groups_of_wall() -> set[str]:
    """Return the wall and the groups that require it."""
    return {name for name, needs in tables.needs_of_groups().items() if {name, *needs} & {"wall"}}


class Case(Groups):
    """Scene, ground motion, solver and output of a namelist.

    A case never changes: `replace` and `without` return new ones. The kernel validates every case
    on construction. The groups are attributes (``case.frame.T_s``), None when absent.

    The kernel keeps the case with the samples of its records. Neither the case nor those derived by
    `replace` and `without` read these files again, even if the files change. Pickling stores the
    text, and the kernel reads it and the records when the case is loaded; the samples of a `Motion`
    are pickled.

    Parameters
    ----------
    **groups : mapping
        Keys and values of each namelist group, for example ``wall={"h": 2.0, "b": 0.5}``. A
        `Motion` replaces the group ``motion`` or ``vertical``, or the value of its ``file``.

    Raises
    ------
    InputError
        When the kernel does not accept the case.
    """

    __slots__ = ("_edited", "_folder", "_kept_groups", "_kernel", "_motions", "_source", "_text")

    _edited: bool
    _folder: Path
    _kept_groups: dict[str, Group] | None
    _kernel: kernel_case.KernelCase
    _motions: dict[str, Motion]
    _source: str | None
    _text: str | None

    def __init__(self, **groups: Mapping[str, object] | Motion) -> None:
        self._assemble_entries(_checked_entries(groups), None, None)

    def _assemble(
        self, text: str, source: str | None, origin: Case | None, motions: dict[str, Motion]
    ) -> None:
        """Have the kernel read the text; an edited case keeps folder and records of its origin."""
        folder = (Path(source).parent if source else Path()).absolute()
        if origin is not None and (source or origin._record_files()):
            folder = origin._folder
        edited = origin is not None
        self._put(source=source, folder=folder, edited=edited, text=text, motions=motions)
        known = None if origin is None else origin._kernel
        samples = {group: motion.samples for group, motion in motions.items()}
        self._put(kernel=kernel_case.read_case(text, self.kernel_source(), known, samples))

    def _assemble_entries(
        self, entries: Mapping[str, Mapping[str, object]], source: str | None, origin: Case | None
    ) -> None:
        """Have the kernel read composed text, without line numbers in messages."""
        with no_line_numbers():
            self._assemble(compose(entries), source, origin, _motions_of(entries))
        self._kernel.has_lines = False

    def _put(self, **fields: object) -> None:
        """Set fields; groups are made at first use."""
        for name, value in {"kept_groups": None, **fields}.items():
            super().__setattr__(f"_{name}", value)

    @classmethod
    def _make(
        cls,
        text: str,
        source: str | None,
        motions: dict[str, Motion] | None = None,
    ) -> Case:
        case = cls.__new__(cls)
        case._assemble(text, source, None, motions or {})
        return case

    def _changed(self, changes: kernel_case.Changes, numbers: np.ndarray[Any, Any]) -> Case | None:
        """Return the case with other numbers, without parsing text; None when text is needed."""
        try:
            found = self._kernel.find(changes)
        except InputError:
            # only the parser gives messages with line numbers, and only it adds a new group
            return None
        case = type(self).__new__(type(self))
        origin = {"source": self._source, "folder": self._folder, "motions": self._motions}
        case._put(edited=True, text=None, **origin)
        case._put(kernel=self._kernel.changed(found, numbers, case.label))
        return case

    @property
    def _groups(self) -> dict[str, Group]:
        if self._kept_groups is None:
            rows: dict[str, list[list[str]]] = {}
            for name, *row in self._kernel.describe():
                group, key = name.split(".", 1)
                rows.setdefault(group, []).append([key, *row])
            groups = {name: TYPES.get(name, Group)(name, entries) for name, entries in rows.items()}
            super().__setattr__("_kept_groups", groups)
            return groups
        return self._kept_groups

    @classmethod
    def from_namelist(cls, path: str | os.PathLike[str]) -> Case:
        """Read a namelist file.

        Parameters
        ----------
        path : str or path
            The file; the paths of records are relative to its folder.

        Returns
        -------
        Case
            The case.

        Raises
        ------
        InputError
            When the file cannot be read or the kernel does not accept the case.
        """
        source = path_of("path", path, _NAMELIST)
        return cls._make(read_text(source), source)

    @classmethod
    def from_text(cls, text: str, source: str | os.PathLike[str] | None = None) -> Case:
        """Make a case from namelist text.

        Parameters
        ----------
        text : str
            Namelist text.
        source : str or path, optional
            Path of the text's file: record paths are relative to its folder, otherwise to the
            current folder, and messages begin with its name.

        Returns
        -------
        Case
            The case.

        Raises
        ------
        InputError
            When the kernel does not accept the case.
        """
        if not isinstance(text, str):
            raise InputError(f"text = {show(text)}: must be the text of a namelist")
        return cls._make(text, None if source is None else path_of("source", source, _NAMELIST))

    @property
    def source(self) -> str | None:
        """Path of the case's namelist; None for a case made in memory."""
        return self._source

    @property
    def text(self) -> str:
        """Namelist text of the case, that of the file until the case is edited.

        A `Motion` appears by its name only.
        """
        if self._text is None:
            super().__setattr__("_text", compose(self._given_entries()))
        return str(self._text)

    @property
    def inputs(self) -> tuple[Path, ...]:
        """Files of the case: its namelist, if it has one, then its records."""
        own = [] if self._source is None else [self._folder / Path(self._source).name]
        return (*own, *(self._folder / name for name in self._record_files()))

    @property
    def motions(self) -> dict[str, Motion]:
        """Motions from arrays, by their groups."""
        return dict(self._motions)

    @property
    def groups(self) -> dict[str, Group]:
        """All groups of the case by name, in the kernel's order."""
        return dict(self._groups)

    if not TYPE_CHECKING:
        # type checkers use the declared groups

        def __getattr__(self, name: str) -> Group | None:
            """Return a group; None when the case does not have it."""
            if name.startswith("_"):
                raise AttributeError(name)
            if name.lower() in self._groups:
                return self._groups[name.lower()]
            if name.lower() in tables.keys_of_groups():
                return None
            raise AttributeError(f"there is no namelist group &{name}")

    def __dir__(self) -> list[str]:
        """List the attributes, with the groups that the case has."""
        return [*super().__dir__(), *self._groups]

    def __setattr__(self, name: str, value: object) -> NoReturn:
        """Refuse: a case never changes."""
        raise AttributeError("a case cannot be changed; case.replace(...) returns another one")

    def replace(self, **groups: Mapping[str, object] | Motion | None) -> Case:
        """Return a case with other values.

        New numbers in existing groups take microseconds, however long the records are.

        Parameters
        ----------
        **groups : mapping
            Keys and values to set in a group; a missing group is added. None for a key restores the
            kernel's default; None for a group removes the group and its effect. A `Motion` replaces
            the whole group ``motion`` or ``vertical``, or the file of a record when given as
            ``file``.

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
        numbers = numbers_of(groups)
        if numbers is not None:
            changed = self._changed(*numbers)
            if changed is not None:
                return changed
        _check_groups(groups, self._groups)
        entries = self._given_entries()
        for name, changes in groups.items():
            if changes is None or isinstance(changes, Motion):
                entries.pop(name.lower(), None)
            if changes is None:
                continue
            group = entries.setdefault(name.lower(), {})
            for key, value in _entries_of(name.lower(), changes).items():
                # a key matches in any capitalization
                same = next((k for k in group if k.lower() == key.lower()), key)
                group[same] = value
        case = type(self).__new__(type(self))
        case._assemble_entries(entries, self._source, self)
        return case

    def without(self, *groups: str) -> Case:
        """Return a case without some groups and their effects.

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
            When the case has no such group, or the kernel does not accept the other groups.
        """
        for name in groups:
            if not isinstance(name, str) or name.lower() not in self._groups:
                present = ", ".join(f"&{group}" for group in self._groups)
                shown = name.lower() if isinstance(name, str) else show(name)
                raise InputError(f"this case has no group &{shown}; it has {present}")
        return self.replace(**dict.fromkeys(groups))

    def without_wall(self) -> Case:
        """Return the case of the frame alone.

        Returns
        -------
        Case
            Case without wall, cable and impacts; heights derived from the wall are kept. Storeys
            that the wall kept on a straight line vibrate in their first mode, or in all modes where
            storeys yield individually.

        Raises
        ------
        InputError
            When the case has no frame.
        """
        if self.frame is None:
            raise InputError("the case has no &frame: nothing is left without the wall")
        return self.replace(**changes_without_wall(self))

    def paper_coefficients(self, theta: npt.ArrayLike) -> Array:
        """Compute the coefficients A_i and B_i of Eq. (15) of the paper.

        theta_ddot = A_1 theta_dot**2 + A_2 theta_dot + A_3 u_g_ddot + A_4 for theta < 0, and the
        same with B_i for theta > 0. Wall, frame, cable and g of the case count, and nothing else.

        Parameters
        ----------
        theta : float or sequence of float
            Rotations [rad]. At 0 the sign of the zero selects A_i (-0.0) or B_i.

        Returns
        -------
        numpy.ndarray, shape (4,) or (n, 4)
            The coefficients [-], [1/s], [1/m], [1/s2].

        Raises
        ------
        InputError
            When the case has no wall or no period, or theta is no array of numbers.

        Examples
        --------
        >>> block = rwmf.Case(wall={"h": 2.0, "b": 0.5}, solver={"t_end": 1.0})
        >>> block.paper_coefficients(0.0)[3] < 0 < block.paper_coefficients(-0.0)[3]
        True
        """
        found = self.kernel.paper_coefficients(to_array("theta", theta, least=1))
        return found[0] if to_items(theta) is None else found

    def to_namelist(self, path: str | os.PathLike[str] | None = None) -> str:
        """Return namelist text with the same results, and write it to a file if given.

        Parameters
        ----------
        path : str or path, optional
            File to write; record paths are then relative to its folder. Without a file they are
            absolute, so that the text works in any folder. The samples of a `Motion` go into a
            second file, ``quake.nml`` and ``quake_motion.txt`` (or ``quake_vertical.txt``), and the
            text names it.

        Returns
        -------
        str
            The given values, without comments.

        Raises
        ------
        InputError
            When the file is one of the case's records, or when a case with a `Motion` is not
            written to a file.
        OutputError
            When a file cannot be written.
        """
        path = None if path is None else path_of("path", path, _NAMELIST)
        if path is None and self._motions:
            raise InputError(
                f"{next(iter(self._motions.values()))!r} is in memory, which no text can name: "
                "to_namelist(path) writes it beside the namelist"
            )
        entries = self._given_entries()
        for group in ("motion", "vertical"):
            record = entries.get(group, {}).get("file")
            if record is None:
                continue
            if isinstance(record, Motion):
                beside = Path(f"{Path(str(path)).with_suffix('')}_{group}.txt")
                files.check_not_read(beside, self.inputs)
                record.write(beside)
                entries[group]["file"] = beside.name
                continue
            full = self._folder / str(record)
            if path is not None and not Path(str(record)).is_absolute():
                # Path.relative_to cannot ascend to a common folder before Python 3.12
                full = Path(os.path.relpath(full, Path(path).absolute().parent))
            entries[group]["file"] = str(full)
        text = compose(entries)
        if path is not None:
            # the namelist of the case may be overwritten; record paths must stay valid
            files.check_not_read(path, self.inputs[self._source is not None :])
            files.write_bytes(path, text.encode("utf-8", "surrogateescape"))
        return text

    @property
    def kernel(self) -> kernel_case.KernelCase:
        """The case in the kernel."""
        return self._kernel

    def kernel_source(self) -> str:
        """Return the path that the kernel resolves records against, valid in any folder.

        Returns
        -------
        str
            The path, marked as edited for an edited case.
        """
        label = self.label
        if Path(label).parent.absolute() == self._folder:
            return label
        return str(self._folder / (Path(label).name or "case.nml"))

    @property
    def label(self) -> str:
        """Beginning of messages: path of the file, marked when edited, or ''."""
        # the line numbers of an edited case are not those of the file
        return (self._source or "") + (" (edited)" if self._edited and self._source else "")

    def _record_files(self) -> list[str]:
        """Return the files of the records, without the names of motions from arrays."""
        return [
            str(group["file"])
            for name, group in self._groups.items()
            if group.get("file") and name not in self._motions
        ]

    def _given_entries(self) -> dict[str, dict[str, object]]:
        entries: dict[str, dict[str, object]] = {
            name: dict(group.as_given())
            for name, group in self._groups.items()
            # a hinged wall must not have it
            if name != "impact" or group.given
        }
        for name, motion in self._motions.items():
            entries[name]["file"] = motion
        return entries

    def _identity(self) -> tuple[object, ...]:
        """Return the input of the computation: text with full paths, and motions from arrays."""
        entries = self._given_entries()
        for name, group in entries.items():
            if "file" in group and name not in self._motions:
                group["file"] = str(self._folder / str(group["file"]))
        return (compose(entries), *self._motions.items())

    def __eq__(self, other: object) -> bool:
        """Compare the inputs of the computation."""
        if not isinstance(other, Case):
            return NotImplemented
        return self._identity() == other._identity()

    def __hash__(self) -> int:
        """Hash the inputs of the computation."""
        return hash(self._identity())

    def __reduce__(self) -> tuple[Callable[..., Case], tuple[object, ...]]:
        """Pickle text, folder and motions from arrays; the kernel reads the text again."""
        source = None if self._source is None else str(Path(self._folder, Path(self._source).name))
        text = self._identity()[0] if source is None else self.text
        return (type(self)._make, (text, source, self._motions))

    def __copy__(self) -> Case:
        """Return the case itself: it never changes."""
        return self

    def __deepcopy__(self, _: object) -> Case:
        """Return the case itself: it never changes."""
        return self

    def __repr__(self) -> str:
        """Show the groups, one per line."""
        lines = [f"Case({self.label or 'in memory'})"]
        lines += [f"  {name:8s} {group!r}" for name, group in self._groups.items()]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        """Show a table of the groups in a notebook; defaults are grey."""
        rows = "".join(group._html_rows() for group in self._groups.values())
        return f"<table><caption>Case({escape(self.label or 'in memory')})</caption>{rows}</table>"


def kernel_for_host(
    case: CaseLike | Mapping[str, Mapping[str, object]],
) -> tuple[kernel_case.KernelCase, str]:
    """Read a case for an element, whose file may lack keys that only a run needs."""
    if isinstance(case, Case):
        return case.kernel, case.kernel_source()
    if not isinstance(case, Mapping):
        source = path_of("case", case, _NAMELIST)
        return kernel_case.read_case(read_text(source), source, is_for_host=True), source
    with no_line_numbers():
        text = compose(_checked_entries(case))
        return kernel_case.read_case(text, "", is_for_host=True), ""


def _checked_entries(
    groups: Mapping[str, Mapping[str, object] | Motion],
) -> dict[str, dict[str, object]]:
    """Return groups with checked names."""
    for name in groups:
        if not isinstance(name, str):
            raise InputError(f"{show(name)}: the name of a group is a text")
    entries = {name: _entries_of(name.lower(), group) for name, group in groups.items()}
    _check_groups(entries, ())
    return entries


def _entries_of(name: str, group: Mapping[str, object] | Motion) -> dict[str, object]:
    """Return keys and values of a group, with those of a motion from arrays."""
    if isinstance(group, Motion):
        group = {"file": group}
    if not isinstance(group, Mapping):
        raise InputError(f"&{name} = {show(group)}: must be keys with values")
    entries = dict(group)
    motion = next((value for value in entries.values() if isinstance(value, Motion)), None)
    if motion is None:
        return entries
    if name not in ("motion", "vertical"):
        raise InputError(f"&{name}: {motion!r} belongs into motion or vertical")
    kind = {"kind": "record"} if name == "motion" else {}
    return kind | entries | motion.keys() | {"file": motion}


def _motions_of(entries: Mapping[str, Mapping[str, object]]) -> dict[str, Motion]:
    """Find the motions from arrays among the values of groups."""
    return {
        name.lower(): value
        for name, group in entries.items()
        for value in group.values()
        if isinstance(value, Motion)
    }


def _check_groups(
    groups: Mapping[str, Mapping[str, object] | Motion | None], present: Collection[str]
) -> None:
    """Check the names of groups and keys, and that each group is a mapping."""
    for name, values in groups.items():
        if name.lower() not in present:
            _check_group(name)
        if values is None or isinstance(values, Motion):
            continue
        if not isinstance(values, Mapping):
            raise InputError(f"&{name.lower()} = {show(values)}: must be keys with values, or None")
        known = tables.keys_of_groups()[name.lower()]
        for key in values:
            if not isinstance(key, str):
                raise InputError(f"&{name.lower()}: {show(key)}: the name of a key is a text")
            if key.lower() not in known:
                owners = [x for x, own in tables.keys_of_groups().items() if key.lower() in own]
                others = f", did you mean {key} of &{' or &'.join(owners)}?" if owners else ""
                hint = did_you_mean(key, known.values()) or others
                hint = f"{hint} Allowed" if hint else "; allowed"
                raise InputError(
                    f"&{name.lower()}: {show(key)[1:-1]}: unknown key{hint} are "
                    f"{', '.join(known.values())}"
                )


def _check_group(name: str) -> None:
    known = tables.keys_of_groups()
    if name.lower() in known:
        return
    owners = [
        f"{group}={{{keys[name.lower()]!r}: ...}}"
        for group, keys in known.items()
        if name.lower() in keys
    ]
    hint = f", did you mean {' or '.join(owners)}?" if owners else did_you_mean(name, known)
    hint = f"{hint} There" if hint else "; there"
    raise InputError(f"there is no group &{name}{hint} are {', '.join(known)}")


# type of the argument `case` of all functions
CaseLike = Case | str | os.PathLike[str]
