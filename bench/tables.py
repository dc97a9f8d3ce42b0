"""Small tables of pages, each by its name.

    .venv/bin/python bench/tables.py NAME [...]

base          time of runs on a base that gives over the rigid one (developer/decisions.md, 37)
elements      time of ordinates with vertical elements and two walls (theory/elements.md)
explorer      times until the pictures of the explorer are drawn, chromium (developer/bench.md)
fragility     share of 1,000 trials whose 95 % band holds the true value (developer/bench.md)
hosts         time of walls that step with a host in Python (howto/stepping-python.md)
pinned        share of periods at which a wall amplifies the frame's motion (reference/effects.md)
start_up      times of imports, a first run and a first spectrum (developer/bench.md)
tendons       effect of a tendon on a yielding frame, by the wall's size (reference/effects.md)
verification  README.md
"""

import csv
import math
import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np
import rwmf
from common import RECORD, ROOT, least, spent, table
from rwmf.studies import wall_effect

Rows = Iterator[Sequence[object]]
WALL = {"h": 2.0, "b": 0.5}
CABLE = {"eta_0": 1.0, "eta_alpha": 5.0}
COUPLED = {"rule": "coupled"}


def base() -> Rows:
    """Run El Centro with frame and straight tendon, in turn; fastest of 15 processor times."""
    groups = {
        "wall": WALL, "frame": {"T_s": 1.0, "gamma": 5.0, "xi_s": 0.05}, "motion": RECORD,
        "cable": CABLE | {"law": "truss"}, "model": {"formulation": "exact"},
    }  # fmt: skip
    bases = {"rigid": None, **{f"kappa = {k:.0e}": {"k_t_over_m_w": k} for k in (2e3, 2e4, 2e5)}}
    soft = {"k_t_over_m_w": 2e4}
    bases |= {"2e+04, slides": soft | {"mu": 0.2}, "2e+04, crushes": soft | {"d_y": 2e-3}}
    ways = {
        "run (ms)": ({}, rwmf.simulate, 1),
        "with outputs (ms)": ({"reactions": True, "energy": True}, rwmf.simulate, 1),
        "ordinate (ms)": ({}, partial(rwmf.spectrum, T_s=np.linspace(0.8, 1.2, 16), threads=1), 16),
    }
    yield "base", *(word for way in ways for word in (way, "over rigid run"))
    columns = []
    for output, ask, n in ways.values():
        calls = {}
        for name, keys in bases.items():
            given = groups if keys is None else groups | {"base": keys | {"xi": 0.2}}
            case = rwmf.Case(
                **given, solver={"rtol": 1e-8}, output=output | {"conditioning": False}
            )
            calls[name] = partial(spent, partial(ask, case))
        columns.append({name: time / n for name, time in least(calls, 15).items()})
    for name in bases:
        # outputs over the run with outputs, ordinates over the run without
        pairs = ((x[name], columns[i]["rigid"]) for x, i in zip(columns, (0, 1, 0), strict=True))
        yield name, *(cell for x, y in pairs for cell in (f"{1e3 * x:.1f}", f"{x / y:.2f}"))


def elements() -> Rows:
    """Take 64 periods under El Centro, in turn; fastest of 9 processor times in one thread."""
    cable = CABLE | {"law": "truss"}
    fuse = {"eta_y": 0.3, "stroke_y": 0.005, "hardening": 0.02}
    yields = {"hardening": 0.02, "eta_y": 1.5}
    half = {"eta_0": 0.5, "eta_alpha": 2.5, "offset": [-0.2, 0.2]}
    four = {"fuse": fuse | {"offset": [-0.5, -0.2, 0.2, 0.5], "eta_y": 0.15}}
    pair = {"wall": WALL | {"walls": 2}, "coupling": fuse}
    scenes: dict[str, tuple[str, dict[str, Any]]] = {
        "one wall": ("one wall", {}),
        "two walls, UFPs between them": ("one wall", pair),
        "one wall, e by momentum": ("one wall, e by momentum", {"impact": COUPLED}),
        "two walls, UFPs, e by momentum": ("one wall, e by momentum", pair | {"impact": COUPLED}),
        "tendon, two fuses": ("tendon, two fuses", {"fuse": fuse}),
        "two tendons, four fuses": ("tendon, two fuses", {"cable": cable | half} | four),
        "tendon that yields, two fuses": (
            "tendon that yields, two fuses", {"cable": cable | yields, "fuse": fuse}
        ),
        "two that yield, four fuses": (
            "tendon that yields, two fuses",
            {"cable": cable | yields | half | {"eta_y": 0.75}} | four,
        ),
    }  # fmt: skip
    calls, impacts = {}, {}
    for name, (_, more) in scenes.items():
        groups = {
            "wall": WALL, "frame": {"gamma": 5.0, "xi_s": 0.05, "T_s": 1.0}, "motion": RECORD,
            "cable": cable, "model": {"formulation": "exact"}, "solver": {"rtol": 1e-7},
            "impact": {"e": 0.9},
        }  # fmt: skip
        ask = partial(rwmf.spectrum, rwmf.Case(**groups | more), np.linspace(0.1, 3.0, 64))
        calls[name] = partial(spent, partial(ask, quantities=["u_s_max_m"], threads=1))
        impacts[name] = float(ask(quantities=["impacts"]).impacts.mean())
    times = least(calls, 9)
    yield "scene", "an ordinate (us)", "impacts", "time over", "impacts over"
    for name, (base, _) in scenes.items():
        ratios = [f"{found[name] / found[base]:.2f}" for found in (times, impacts)]
        cells = (f"{ratios[0]} ({base})", ratios[1]) if name != base else ("", "")
        yield name, f"{1e6 * times[name] / 64:.0f}", f"{impacts[name]:.0f}", *cells


def fragility() -> Rows:
    """Draw capacities from a lognormal law (median 1, dispersion 0.4) and fit them."""
    trials, levels = 1000, (0.4, 0.6, 0.8, 1.0, 1.3, 1.7)
    chance = np.random.default_rng(1)
    yield "method", "records", "median", "dispersion"
    for method in ("counts", "capacities"):
        for n in (20, 44, 100):
            kept = np.zeros(2)
            for _ in range(trials):
                capacity = np.exp(0.4 * chance.standard_normal(n))
                # an incremental analysis brackets each capacity within 2 %
                steps = [levels if method == "counts" else (0.99 * c, 1.01 * c) for c in capacity]
                rows = [
                    (str(i), level, "collapsed" if level > c else "ok")
                    for i, c in enumerate(capacity)
                    for level in steps[i]
                ]
                names = ("record", "intensity", "status")
                stripes = dict(zip(names, map(list, zip(*rows, strict=True)), strict=True))
                found = rwmf.fragility(stripes, method=method, resamples=400)
                for i, (name, truth) in enumerate((("median", 1.0), ("dispersion", 0.4))):
                    low, high = found[f"{name}_band"].values
                    kept[i] += low <= truth <= high
            yield method, n, *(f"{100 * share:.1f} %" for share in kept / trials)


def hosts(walls: int = 10_000, steps: int = 100) -> Rows:
    """Advance walls under samples of 10 ms, one call for each interval unless stated."""
    text = (
        "&wall h = 2.0, b = 0.5, m_w = 2.0e4 / &frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"
        "&impact rule = 'coupled' / &solver t_end = 10.0 /"
    )
    case = rwmf.Case.from_text(text)
    t = np.arange(steps + 1) * 0.01
    a = 4.0 * np.sin(6.0 * t)

    def advance(wall: rwmf.Wall, whole: bool = False, query: bool = False) -> None:
        for part in [slice(None)] if whole else [slice(i, i + 2) for i in range(steps)]:
            if query:
                wall.save()
            wall.advance_samples(t[part], a[part])
            if query:
                _ = wall.state, wall.forces

    ways: list[tuple[str, int, Callable[[], Any], dict[str, bool]]] = [
        ("one wall, all steps in one call", 1, partial(rwmf.Wall, case), {"whole": True}),
        ("one wall, a call for each step", 1, partial(rwmf.Wall, case), {}),
        (
            "the same with `save`, `state` and `forces` in each step",
            1,
            partial(rwmf.Wall, case),
            {"query": True},
        ),
    ]
    for n, threads in ((100, 1), (walls, 1), (walls, 2)):
        words = f"{n:,} walls in {threads} {'thread' if threads == 1 else 'threads'}"
        ways.append((words, n, partial(rwmf.Walls, case, n, threads=threads), {}))
    yield "", "processor [us]", "elapsed [us]", "processor over that of one call"
    of_loop = None
    for words, n, make, how in ways:
        times = []
        for _ in range(3):
            with make() as wall:
                begin = time.perf_counter()
                processor = spent(lambda wall=wall, how=how: advance(wall, **how))
                times.append((processor, time.perf_counter() - begin))
        least_of = [1e6 * min(one) / steps / n for one in zip(*times, strict=True)]
        of_loop = of_loop or least_of[0]
        yield words, *(f"{x:.2f}" for x in least_of), f"{least_of[0] / of_loop:.1f}"


def pinned() -> Rows:
    """Compare a rocking and a pinned wall with the frame alone."""
    pulse = {"a_max_g": 0.4, "T_p": 1.0}
    motions = {
        "El Centro": RECORD,
        "one sine, 0.4 g, 1 s": pulse | {"kind": "one_sine"},
        "one cosine, 0.4 g, 1 s": pulse | {"kind": "one_cosine"},
    }
    walls: dict[str, dict[str, Any]] = {
        "rocking": {"wall": WALL, "impact": COUPLED},
        "rocking, cable": {"wall": WALL, "impact": COUPLED, "cable": CABLE},
        "pinned": {"wall": WALL | {"base": "pinned"}},
    }
    yield "motion", "gamma", *walls
    for name, motion in motions.items():
        for gamma in (5.0, 50.0):
            shares = []
            for groups in walls.values():
                case = rwmf.Case(
                    **groups,
                    frame={"T_s": 1.0, "gamma": gamma, "xi_s": 0.05},
                    motion=motion,
                    model={"formulation": "exact"},
                    solver={"method": "dop853", "t_end": 40.0},
                )
                ratio = wall_effect(case, {"T_s": np.linspace(0.1, 3.0, 59)})["ratio"].values
                shares.append(f"{100 * np.mean(ratio > 1):.0f} %")
            yield name, f"{gamma:g}", *shares


def start_up() -> Rows:
    """Start a new process for each."""
    case = str(ROOT / "inputs" / "fig12_one_cosine.nml")
    spectrum = f"rwmf.spectrum(rwmf.Case.from_namelist({case!r}), T_s=[0.5, 1.0])"
    commands = {
        "`python -c pass`": ["-c", "pass"],
        **{f"`import {name}`": ["-c", f"import {name}"] for name in ("numpy", "xarray", "rwmf")},
        "`rwmf --version`": ["-m", "rwmf", "--version"],
        "`rwmf check CASE`": ["-m", "rwmf", "check", case],
        "`rwmf run CASE`": ["-m", "rwmf", "run", case],
        "first `rwmf.simulate`": ["-c", f"import rwmf; rwmf.simulate({case!r})"],
        "first `rwmf.spectrum`": ["-c", f"import rwmf; {spectrum}"],
    }

    def start(words: list[str]) -> object:
        return subprocess.run([sys.executable, *words], check=True, capture_output=True, cwd=ROOT)

    calls = {
        name: partial(spent, partial(start, words), time.perf_counter)
        for name, words in commands.items()
    }
    seconds = least(calls)
    yield "start", "seconds", "over `import xarray`"
    for name, time_of in seconds.items():
        yield name, f"{time_of:.2f}", f"{time_of / seconds['`import xarray`']:.2f}"


def explorer() -> Rows:
    """Start the explorer, open its page and press a key on a slider of each example."""
    from browser import chromium
    from explorer_page import DESK, Opened

    yield "wait", "seconds"
    begin = time.perf_counter()
    words = [sys.executable, "-u", "-m", "rwmf", "explore", "--no-browser"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as program:
        (address,) = re.findall(r"http://\S+", program.stdout.readline())
        yield "`rwmf explore`, to its address", f"{time.perf_counter() - begin:.2f}"
        with chromium() as browser:
            context = browser.new_context(viewport=DESK, reduced_motion="reduce")
            begin = time.perf_counter()
            opened = Opened(context, address)
            yield "its page, to all pictures", f"{time.perf_counter() - begin:.2f}"
            slider = opened.slider("motion.a_max_g")

            def move() -> None:
                slider.press("ArrowRight")
                opened.settle()

            for name in ("block", "wall_and_frame", "six_storeys", "fig12_one_sine"):
                opened.page.select_option("#preset", name)
                opened.settle()
                (seconds,) = least({name: partial(spent, move, time.perf_counter)}).values()
                yield f"a slider of `{name}`, to all pictures", f"{seconds:.2f}"
        program.terminate()


def tendons() -> Rows:
    """Take medians over periods under El Centro; the strength is a tenth of the frame's weight."""
    yield "half height (m)", "change of u_s,max", "largest reaction without", "with the tendon"
    for h in (2.0, 6.0, 18.0):
        case = rwmf.Case(
            wall={"h": h, "b": h / 4},
            frame={"T_s": 1.0, "gamma": 10.0, "xi_s": 0.05},
            yielding={"f_y_over_m_s_g": 0.1, "hardening": 0.05},
            impact=COUPLED,
            motion=RECORD,
            model={"formulation": "exact"},
            solver={"method": "dop853"},
            output={"reactions": True, "dt": 0.005},
        )
        both = np.empty((30, 2, 2))
        for i, T_s in enumerate(np.linspace(0.5, 3.0, 30)):
            for j, cable in enumerate((None, CABLE)):
                run = rwmf.simulate(case.replace(frame={"T_s": float(T_s)}, cable=cable))
                both[i, j] = run["u_s_max"], run["pivot_normal_over_m_w_g"].max()
        change = np.median(np.abs(both[:, 1, 0] / both[:, 0, 0] - 1))
        yield f"{h:g}", f"{100 * change:.1f} %", *(f"{x:.2f}" for x in np.median(both[..., 1], 0))


def verification() -> Rows:
    """Compare with an independent program, literature and a closed form."""
    yield "case", "reference", "ours", "relative difference"
    with (ROOT / "tests" / "reference" / "peaks_taylor.csv").open(encoding="utf-8") as file:
        stored = list(csv.DictReader(line for line in file if not line.startswith("#")))
    pulse = {"a_max_g": 0.4, "omega_p": 6.283185307179586}
    for method in ("adams", "taylor", "dop853"):
        worst = 0.0
        for row in stored:
            is_record = row["motion"] == "elcentro"
            case = rwmf.Case(
                wall=WALL,
                frame={"T_s": float(row["T_s_s"]), "gamma": float(row["gamma"]), "xi_s": 0.05},
                cable=CABLE,
                impact={"e": 0.9},
                motion=RECORD if is_record else pulse | {"kind": row["motion"]},
                model={"formulation": row["formulation"]},
                solver={"method": method, "rtol": 1e-9, "t_end": None if is_record else 10.0},
            )
            peak = float(rwmf.simulate(case).u_s_max)
            worst = max(worst, abs(peak / float(row["u_s_max_m"]) - 1))
        words = f"{len(stored)} peaks, three formulations, `{method}`, rtol 1e-9"
        yield words, "independent Taylor-series program", "largest difference", f"{worst:.0e}"
    for T_s, xi_s, truth in ((0.5, 0.02, 0.068275), (1.0, 0.02, 0.151618), (2.0, 0.05, 0.136513)):
        frame = {"T_s": T_s, "xi_s": xi_s}
        found = float(
            rwmf.simulate(rwmf.Case(frame=frame, motion=RECORD, solver={"rtol": 1e-9})).u_s_max
        )
        words = f"bare frame, El Centro, T = {T_s} s, {100 * xi_s:.0f} %"
        shown = f"{truth} m (true peak between samples)"
        yield words, shown, f"{found:.6f} m", f"{abs(found / truth - 1):.0e}"
    alpha = math.atan(0.25)
    truth = 1 - 1.5 * math.sin(alpha) ** 2 / (1 + 15 * math.cos(alpha) ** 2)
    case = rwmf.Case(
        wall=WALL, frame={"T_s": 1.0, "gamma": 5.0, "xi_s": 0.05}, impact=COUPLED,
        solver={"t_end": 0.0},
    )  # fmt: skip
    found = float(rwmf.simulate(case).e)
    words = "restitution by momentum balance, gamma = 5"
    yield words, f"{truth:.6f}", f"{found:.6f}", f"{abs(found / truth - 1):.0e}"


TABLES = (
    base,
    elements,
    explorer,
    fragility,
    hosts,
    pinned,
    start_up,
    tendons,
    verification,
)

if __name__ == "__main__":
    for name in sys.argv[1:]:
        heads, *rows = {make.__name__: make for make in TABLES}[name]()
        print(table(heads, rows))
