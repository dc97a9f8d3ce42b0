"""Earlier spellings of public names and of words of the command line, with the new ones."""

from collections.abc import Callable

_RECIPE = "a recipe of the page Studies"
_IN_HOSTS = ("ElementResponse", "WallEvent", "WallState")
# types without a public name, and what has them
_TYPES = {
    "ElementEvent": "the result of Element.next_event",
    "ElementSnapshot": "the result of Element.save",
    "WallEvents": "Walls.events",
    "WallForces": "Wall.forces",
    "WallMaxima": "Wall.maxima",
    "WallSnapshot": "the result of Wall.save",
    "records.Processed": "the result of rwmf.records.process",
    "records.RecordPair": "an item of rwmf.records.pairs",
    "records.Selection": "the result of rwmf.records.select",
    "sections.Footing": "the result of rwmf.sections.footing",
    "sections.Plate": "the result of rwmf.sections.ufp",
    "sections.Toe": "the result of rwmf.sections.toe",
    "Checks": "the result of rwmf.checks",
    "Cost": "the result of rwmf.cost",
    "Design": "the result of rwmf.design",
    "LimitCheck": "a row of rwmf.checks",
}
# names within rwmf
NAMES = {
    "RecordFile": "rwmf.records.RecordFile",
    "base_section": "rwmf.sections.base_section",
    "coupling": "rwmf.hosts",
    "find_records": "rwmf.records.find_records",
    "intensity": "rwmf.records.intensity",
    "loops": "rwmf.plot.loops, and rwmf.plot.find_loops",
    "merge": "rwmf sweep --merge PART ... --out FILE",
    "paper_coefficients": "Case.paper_coefficients",
    "plot.PANELS": "the default of rwmf.plot.history",
    "records.RECORDS": "the list of rwmf records export",
    "records.Record": "a line of rwmf records export",
    "records.find": "rwmf.records.export",
    "records.write_suite": "the method write of the result of rwmf.records.select",
    "records.list_records": "the list of rwmf records export",
    "ufp_force": "rwmf.sections.ufp",
    "ufp_stiffness": "rwmf.sections.ufp",
    "studies.annual_frequency": "a function of yours (page Gradients)",
    "studies.displacement_based_prestress": "a recipe of the page Design",
    "studies.fragility": "rwmf.fragility",
    "studies.fragility_median": "a function of yours (page Gradients)",
    "studies.incremental_dynamic_analysis": "rwmf.stripes or rwmf.ida",
    "studies.percentiles": "rwmf.quantile",
    "studies.without_wall": "Case.without_wall",
    "plot.draw_equal_response": "rwmf.plot.equal_response",
    "plot.draw_fragility": "rwmf.plot.fragility",
    "plot.draw_overturning": "rwmf.plot.overturning_map",
    "plot.draw_wall_effect": "rwmf.plot.wall_effect",
}
_RECIPES = "cumulative_distribution friction_spectra sensitivity_bands suite_spectra"
NAMES |= {f"studies.{name}": _RECIPE for name in _RECIPES.split()}
NAMES |= {f"plot.draw_{name}": _RECIPE for name in ("bands", "friction", "suite")}
NAMES |= {name: f"rwmf.hosts.{name}" for name in _IN_HOSTS}
NAMES |= {name: f"the type of {owner}" for name, owner in _TYPES.items()}
NAMES |= {
    f"hosts.{name}": f"the type of {owner}"
    for name, owner in _TYPES.items()
    if name.startswith(("Element", "Wall"))
}
# options, and words of commands
WORDS = {
    "merge": "rwmf sweep --merge PART ... --out FILE",
    "reproduce": "tools/run reproduce, in a checkout of the project",
    "records join": "rwmf.records.sequence (page Records)",
    "records list": "rwmf records export",
    "records process": "rwmf records convert",
    "study bands": _RECIPE,
    "study fragility": "rwmf stripes and rwmf fragility",
    "study friction": _RECIPE,
    "study spectra": _RECIPE,
    "--confidence": "--resamples N,SHARE",
    "--csv": "--out FILE.csv",
    "--damping": "--intensity KIND:PERIOD@DAMPING",
    "--dt": "--unit UNIT,S",
    "--file": "--out FILE",
    "--forces": "--pattern F1,F2",
    "--nrml": "--out FILE.xml",
    "--period": "--intensity KIND:PERIOD@DAMPING",
    "--periods": "--intensity KIND:PERIODS",
    "--plot": "--out FILE.png",
    "--quantity": "--quantities",
    "--report": "--out FILE.html",
    "--seed": "--resamples N,SHARE,SEED",
    "--workers": "--engine NAME:N",
}


def of_module(module: str) -> Callable[[str], object]:
    """Make the `__getattr__` of a public module: an error that names the new spelling."""

    def refuse(name: str) -> object:
        raise AttributeError(moved(f"{module}.{name}"))

    return refuse


def moved(name: str) -> str:
    """Return the message for a name that rwmf lacks."""
    module, _, last = f"rwmf.{name}".rpartition(".")
    new = f": it is now {NAMES[name]}" if name in NAMES else ""
    return f"module {module!r} has no attribute {last!r}{new}"
