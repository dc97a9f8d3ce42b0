"""Variables of a functional mock-up unit: inputs, outputs and parameters of a case."""

from __future__ import annotations

from dataclasses import dataclass

from rwmf import _library
from rwmf._simulation import start
from rwmf.case import Case
from rwmf.errors import InputError
from rwmf.quantities import find

__all__ = ["Variable", "variables_of"]

# numbers that an instance cannot change: of files, of sweeps, and those that decide on sizes
_NOT_PARAMETERS = {
    "motion.dt", "vertical.dt", "storeys.n", "solver.accuracy", "solver.verify", "solver.t_end",
}  # fmt: skip
_NO_PARAMETER_GROUPS = {"output", "spectrum", "sensitivity", "design"}
_TYPES = {"real": "f", "real list": "f", "integer": "i", "logical": "b", "int": "i"}
# variables that a step can change; the others are known before it, or tell of the computation
_FOUND = {"row", "peak", "time", "end", "count", "whether"}


@dataclass(frozen=True)
class Variable:
    """A variable; its value reference is its place in the list of all, from 1.

    Attributes
    ----------
    kind : str
        'p' number of the case, 's' other parameter, 'i' input, 'o' output of the table of
        quantities, 'r' other output: the letters of ``src/bindings/fmi/model.h``.
    type : str
        'f' real, 'i' integer, 'b' logical.
    key : str
        Its name; for a value of a list, that of the list.
    unit : str
        Unit, '' without one.
    meaning : str
        Description.
    start : float
        Start value of a parameter or an input.
    count : int
        Number of values of the list that it belongs to.
    place : int
        Number in this list from 1, 0 outside of a list.
    """

    kind: str
    type: str
    key: str
    unit: str
    meaning: str
    start: float = 0.0
    count: int = 1
    place: int = 0

    @property
    def name(self) -> str:
        """Name in the model description."""
        return f"{self.key}[{self.place}]" if self.place else self.key

    @property
    def is_output(self) -> bool:
        """True if the unit computes it."""
        return self.kind in "or"

    def line(self) -> str:
        """Return its line of ``variables.txt``."""
        return f"{self.kind} {self.type} {self.key} {self.count} {self.start!r}\n"


def variables_of(case: Case, link: bool) -> list[Variable]:
    """List the variables of a unit."""
    force = "N"
    if case.wall is None or case.wall.get("m_w") is None:
        force = "N/kg"
    fixed = _link_variables(force) if link else _ground_variables(case, force)
    return [*fixed, *([] if link else _outputs(case)), *_parameters(case)]


def _ground_variables(case: Case, force: str) -> list[Variable]:
    found = [
        Variable("i", "f", "ground_acceleration", "m/s2", "ground acceleration in the next step"),
        Variable(
            "i", "f", "ground_acceleration_end", "m/s2",
            "ground acceleration at the end of the next step, with ground_is_linear",
        ),
        Variable(
            "s", "b", "ground_is_linear", "",
            "a straight line to ground_acceleration_end; otherwise the acceleration is constant",
        ),
        Variable(
            "s", "f", "peak_ground_acceleration", "m/s2",
            "expected peak, for the absolute tolerance; 0: that of the case, or g/10",
        ),
        Variable("r", "f", "u_s_ddot_m_s2", "m/s2", "acceleration of the frame over the ground"),
        Variable("r", "f", "link_force", force, "force from the wall on the frame"),
        Variable("r", "f", "frame_shear", force, "force of the frame's spring and damper"),
        Variable("r", "f", "cable_tension", force, "tension of the cable"),
        Variable("r", "b", "at_rest", "", "the wall rests on both corners"),
    ]  # fmt: skip
    if case.motion is not None:
        meaning = "the ground follows the motion of the case, and the inputs have no effect"
        found.insert(2, Variable("s", "b", "own_motion", "", meaning, 1.0))
    return found


def _link_variables(force: str) -> list[Variable]:
    per = force.removeprefix("N")
    return [
        Variable("i", "f", "u", "m", "displacement of the link relative to the ground"),
        Variable("i", "f", "u_dot", "m/s", "velocity of the link"),
        Variable("i", "f", "u_ddot", "m/s2", "acceleration of the link"),
        Variable("i", "f", "ground_acceleration", "m/s2", "ground acceleration"),
        Variable("i", "f", "push", force, "force of the importer's frame on the resting wall"),
        Variable("s", "i", "start_side", "", "side of the wall at first: 1, -1, or 0: that of u"),
        Variable(
            "s", "f", "host_mass", "kg" + per,
            "mass of the importer's frame at the link, for the end of chatter",
        ),
        Variable("r", "f", "force", force, "resisting force of the wall on the link"),
        Variable("r", "f", "stiffness", "N/m" + per, "derivative of the force by u"),
        Variable("r", "f", "damping", "N s/m" + per, "derivative of the force by u_dot"),
        Variable("r", "f", "mass", "kg" + per, "derivative of the force by u_ddot"),
        Variable("r", "f", "theta", "rad", "rotation of the wall"),
        Variable("r", "f", "theta_dot", "rad/s", "angular velocity of the wall"),
        Variable("r", "f", "theta_ddot", "rad/s2", "angular acceleration of the wall"),
        Variable("r", "f", "cable_tension", force, "tension of the cable"),
        Variable("r", "f", "velocity_factor", "", "factor on the velocity at an impact"),
        Variable("r", "i", "side", "", "1 or -1 while the wall rocks, 0 at rest"),
        Variable("r", "i", "impacts", "", "number of impacts"),
        Variable("r", "i", "lift_offs", "", "number of uplifts"),
    ]  # fmt: skip


def _outputs(case: Case) -> list[Variable]:
    """List the columns and numbers of a run that a step can change, from a run of one row."""
    row = 1e-3
    short = case.replace(
        output={"dt": row, "reactions": True, "conditioning": False},
        solver={"t_end": row, "accuracy": None, "accuracy_of": None, "verify": None},
    )
    with start(short) as run:
        keys = [*run.history()[0], *run.summary()]
    found = []
    for key in dict.fromkeys(keys):
        quantity = find(key)
        if quantity.found in _FOUND and quantity.kind in _TYPES and key != "t_s":
            unit = "" if quantity.unit == "1" else quantity.unit
            found.append(Variable("o", _TYPES[quantity.kind], key, unit, quantity.meaning))
    return found


def _parameters(case: Case) -> list[Variable]:
    """List the numbers of the case, given or by default."""
    found = []
    rows = {(row.group, row.key): row for row in _library.schema()}
    for group, values in case.groups.items():
        if group in _NO_PARAMETER_GROUPS:
            continue
        given = values.as_given()
        for key, value in {**values, **given}.items():
            row = rows[group, key]
            name = f"{group}.{key}"
            if row.kind not in _TYPES or value is None or name in _NOT_PARAMETERS:
                continue
            if key in values.derived and key not in given:
                continue
            numbers = value if isinstance(value, tuple) else (value,)
            if any(isinstance(number, str) for number in numbers):
                raise InputError(f"{name} = {value}: must be a number")
            unit = "" if row.unit == "-" else row.unit
            for i, number in enumerate(numbers, 1):
                place = i if len(numbers) > 1 else 0
                variable = Variable(
                    "p",
                    _TYPES[row.kind],
                    name,
                    unit,
                    row.meaning,
                    float(number),
                    len(numbers),
                    place,
                )
                found.append(variable)
    return found
