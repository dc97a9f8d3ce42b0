"""Files: nothing is lost and nothing half-written, whatever their names, whenever it ends."""

import errno
import fcntl
import os
import re
import resource
import shutil
import signal
import stat
import subprocess
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import h5netcdf
import pytest
import rwmf
from checkout import Runner, run_python
from rwmf import cli
from rwmf.errors import InputError, OutputError
from rwmf.kernel import files, results
from scenes import coupled
from writers import RWMF, WRITERS, Writer, prepare

EARLIER = b"an earlier result\n"
TEMPORARY = re.compile(r"\.rwmf-[0-9a-f]{16}\.tmp(\.\w+)?")
Run = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(params=WRITERS, ids=str)
def writer(request: pytest.FixtureRequest, tmp_path: Path) -> Writer:
    """Return each writer with its input files."""
    found = WRITERS[request.param]
    prepare(tmp_path)
    return found


@pytest.fixture
def start(batch_program: Path, tmp_path: Path) -> Run:
    """Run words in the test's folder."""

    def run(words: list[str], **how: object) -> subprocess.CompletedProcess[str]:
        words = [str(batch_program) if word == "rwmf-batch" else word for word in words]
        return subprocess.run(
            words, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False, **how
        )

    return run


def _leftovers(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir() if path.name.startswith(".")]


@pytest.mark.slow
def test_where_files_go_and_what_goes(writer: Writer, start: Run, tmp_path: Path) -> None:
    """A link stays and its target is written; umask sets permissions; leftovers are removed."""
    place = tmp_path / "place"
    place.mkdir()
    for name in writer.targets:
        (tmp_path / name).symlink_to(f"place/{name}")
    named = "rwmf-batch" in writer.words or {"run", "--out"} <= {*writer.words}
    dead, others = _make_leftovers(tmp_path if named else place)
    alive = dead.with_name(".rwmf-fedcba9876543210.tmp")
    with alive.open("wb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        found = start(writer.words, umask=0o027)
    assert found.returncode == 0, found.stderr
    for name in writer.targets:
        assert (tmp_path / name).is_symlink()
        assert (place / name).stat().st_size > 0
        assert stat.S_IMODE((place / name).stat().st_mode) == 0o640
    assert not dead.exists()
    assert all(os.path.lexists(path) for path in others)
    assert alive.exists()
    left = {path.name for folder in (tmp_path, place) for path in folder.glob(".*")}
    assert left == {path.name for path in (alive, *others)}


@pytest.mark.slow
def test_a_pipe_gets_the_bytes(writer: Writer, start: Run, tmp_path: Path) -> None:
    """And stays a pipe; a sweep, which is read again, refuses it."""
    got: dict[str, bytes] = {}

    def read(path: Path) -> None:
        got[path.name] = path.read_bytes()

    readers = []
    for name in writer.targets:
        os.mkfifo(tmp_path / name)
        if writer.through:
            readers.append(threading.Thread(target=read, args=[tmp_path / name], daemon=True))
            readers[-1].start()
    found = start(writer.words)
    assert found.returncode == (0 if writer.through else 2), found.stderr
    for reader in readers:
        reader.join(10)
    for name in writer.targets:
        assert (tmp_path / name).is_fifo()
        assert (len(got.get(name, b"")) > 0) == writer.through
    assert writer.through or "regular file" in found.stderr


def test_the_standard_output_as_a_file(start: Run, tmp_path: Path) -> None:
    """Later printed text follows the output, in a pipe and in a file."""
    prepare(tmp_path)
    words = [*RWMF, "spectrum", "case.nml", "--out"]
    found = start([*words, "/dev/stdout"])
    assert found.returncode == 0, found.stderr
    assert found.stdout.startswith("# rwmf")
    assert found.stdout.endswith("written: /dev/stdout\n")
    text = " ".join([*words, "/dev/stdout"])
    assert start(["sh", "-c", f"echo first > log; {text} >> log"]).returncode == 0
    lines = (tmp_path / "log").read_text("utf-8").splitlines()
    assert (lines[0], lines[-1]) == ("first", "written: /dev/stdout")
    assert lines[1].startswith("# rwmf")


@pytest.mark.slow
def test_a_full_disk(writer: Writer, start: Run, tmp_path: Path) -> None:
    """A file-size limit simulates a full disk: one message, earlier files, no others."""
    for name in writer.targets:
        (tmp_path / name).write_bytes(EARLIER)
    if "sweep.nml" in writer.words:
        (tmp_path / "out.nc").unlink()
    before = {path.name for path in tmp_path.iterdir()}

    def limit() -> None:
        # a program started like in a shell, which does not ignore the signal as Python does
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
        resource.setrlimit(resource.RLIMIT_FSIZE, (50, resource.RLIM_INFINITY))

    found = start(writer.words, preexec_fn=limit, env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"})
    assert found.returncode == 2, found.stderr
    assert "cannot be written" in found.stderr or "cannot write" in found.stderr
    assert any(name in found.stderr for name in writer.targets)
    assert "Traceback" not in found.stderr
    after = {path.name for path in tmp_path.iterdir()}
    assert after - {"out.nc.journal"} == before
    assert all((tmp_path / name).read_bytes() == EARLIER for name in before & {*writer.targets})


def test_a_full_disk_and_netcdf(tmp_path: Path) -> None:
    """The process lives on, wherever in the file the disk is full; then there is room again."""
    code = """
import resource, signal, sys, rwmf
from scenes import coupled
case = coupled(solver={"t_end": 0.2, "rtol": 1e-4})
grid = {"e": [0.995, 1.0], "T_s": [0.3 + 0.0001 * i for i in range(3000)]}
rwmf.sweep(case, grid, file="whole.nc").close()
whole = open("whole.nc", "rb").read()
refused = 0
for size in [*range(0, len(whole), 30000), len(whole) - 1, len(whole)]:
    # the journal is not what is looked at
    from rwmf.sweeps import computation, netcdf, plan
    found = plan.make_plan(plan.Request(case, grid, quantities=("u_s_max",)))
    chunks = {c.number: c for c in computation._Work(found, 0, None, None, (1, 1)).run(set())}
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))
    try:
        netcdf.write(found.layout, chunks.__getitem__, computation.Path("out.nc"))
    except rwmf.OutputError as error:
        assert "File too large" in str(error), error
        refused += 1
    resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
assert open("out.nc", "rb").read() == whole
print(refused)
"""
    found = run_python(code, tmp_path)
    assert found.returncode == 0, found.stderr[-2000:]
    assert found.stderr == ""
    assert int(found.stdout) > 3
    assert not _leftovers(tmp_path)


@pytest.mark.slow
def test_the_order_of_a_power_cut(writer: Writer, start: Run, tmp_path: Path) -> None:
    """The order is data, name, name on the disk; the journal is removed last."""
    if shutil.which("strace") is None:
        pytest.skip("needs strace")
    log = tmp_path.with_name(f"{tmp_path.name}.strace")
    calls = "openat,open,creat,write,pwrite64,writev,fsync,fdatasync,rename,renameat,renameat2"
    trace = ["strace", "-f", "-y", "-s", "0", "-e", f"trace={calls},unlink,unlinkat", "-o", log]
    found = start([*map(str, trace), *writer.words])
    if "ptrace" in found.stderr.lower() and found.returncode != 0:
        pytest.skip("strace may not trace here")
    assert found.returncode == 0, found.stderr
    events = list(_events(log, tmp_path))
    for name in writer.targets:
        target = str(tmp_path / name)
        at, temporary = next(
            (i, event[1])
            for i, event in enumerate(events)
            if event[0] == "name" and event[2] == target
        )
        assert TEMPORARY.fullmatch(Path(temporary).name)
        own = [(i, event[0]) for i, event in enumerate(events) if event[1] == temporary]
        kinds = [kind for _, kind in own]
        # writers that go by the name open it again: the first time counts
        assert kinds[0] == "create"
        assert kinds[-2:] == ["sync", "name"], kinds
        assert "write" in kinds
        assert not any(event[:2] == ("write", target) for event in events)
        later = [i for i, event in enumerate(events) if event[:2] == ("sync", str(tmp_path))]
        synced = next(i for i in later if i > at)
        removed = [i for i, event in enumerate(events) if event[0] == "remove"]
        kept = [i for i in removed if events[i][1].endswith(".journal")]
        assert all(i > synced for i in kept)
        assert len(kept) == ("sweep.nml" in writer.words)


def _events(log: Path, folder: Path) -> Iterator[tuple[str, ...]]:
    """Yield the operations on files in the folder, in the order of completion."""
    begun: dict[str, str] = {}
    for line in log.read_text("utf-8", "replace").splitlines():
        process, text = line.split(None, 1)
        if text.endswith("<unfinished ...>"):
            begun[process] = text.removesuffix("<unfinished ...>")
            continue
        if match := re.match(r"<\.\.\. \w+ resumed>(.*)", text):
            text = begun.pop(process, "") + match[1]
        if re.search(r"\) += -1 ", text):
            continue
        call = text.split("(", 1)[0]
        names = [str(folder / name) for name in re.findall(r'"([^"]*)"', text)]
        opened = re.match(r"\w+\(\d+<([^>]*)>", text)
        if call in ("open", "openat") and "O_EXCL" in text and "O_NOFOLLOW" in text:
            yield "create", names[0]
        elif call in ("write", "pwrite64", "writev") and opened:
            yield "write", opened[1]
        elif call in ("fsync", "fdatasync") and opened:
            yield "sync", opened[1]
        elif call.startswith("rename"):
            yield "name", names[0], names[1]
        elif call.startswith("unlink"):
            yield "remove", names[0]


def _make_leftovers(folder: Path) -> tuple[Path, list[Path]]:
    """Make the file of a killed run, and others that have to stay."""
    dead = folder / ".rwmf-0123456789abcdef.tmp"
    others = [folder / ".rwmf-0123456789abcdef.tmp~", folder / ".rwmf-short.tmp", folder / ".x.tmp"]
    for path in (dead, *others):
        path.write_bytes(b"half")
    link = folder / ".rwmf-0123456789abcde0.tmp"
    link.symlink_to(others[0])
    return dead, [*others, link]


def _give_away(path: Path) -> None:
    """Make a file or link another user's, which only root can, or a user with sudo."""
    words = ["chown", "--no-dereference", "12345:12345", str(path)]
    if os.geteuid() != 0:
        if not shutil.which("sudo"):
            pytest.skip("only root can give files away, and there is no sudo")
        words = ["sudo", "--non-interactive", *words]
    if subprocess.run(words, check=False).returncode != 0:
        pytest.skip("only root can give files away, and sudo asks for a password")


def test_what_other_users_leave_stays(start: Run, tmp_path: Path) -> None:
    prepare(tmp_path)
    dead, _ = _make_leftovers(tmp_path)
    _give_away(dead)
    for name in ("spectrum --out", "rwmf-batch"):
        assert start(WRITERS[name].words).returncode == 0
        assert dead.exists()


def test_a_killed_run_leaves_a_file_that_the_next_one_removes(tmp_path: Path) -> None:
    code = """
import os, signal
from rwmf import cli
from rwmf.kernel import files, results
with files.replacing("x.txt") as stream:
    stream.write(b"half")
    stream.flush()
    os.kill(os.getpid(), signal.SIGKILL)
"""
    run_python(code, tmp_path)
    assert [bool(TEMPORARY.fullmatch(path.name)) for path in tmp_path.iterdir()] == [True]
    files.write_bytes(tmp_path / "y.txt", b"whole")
    assert [path.name for path in tmp_path.iterdir()] == ["y.txt"]


@pytest.mark.parametrize(
    "words",
    [
        ["run", "case.nml", "--out", "in.svg"],
        ["run", "case.nml", "--loops", "in.svg"],
        ["spectrum", "case.nml", "--out", "case.nml"],
        ["spectrum", "case.nml", "--out", "in.svg"],
        ["spectrum", "case.nml", "--out", "motion.txt"],
        ["spectrum", "case.nml", "--out", "other/../motion.txt"],
        ["spectrum", "case.nml", "--out", "hard.txt"],
        ["sweep", "sweep.nml", "--out", "case.nml"],
        ["sweep", "sweep.nml", "--out", "sweep.nml"],
        ["sweep", "sweep.nml", "--out", "motion.txt"],
        ["sweep", "sweep.nml", "--out", "sweep.nml", "--restart"],
        ["sweep", "--out", "part1.csv", "--merge", "part1.csv"],
        ["pushover", "case.nml", "--out", "case.nml"],
        ["pushover", "case.nml", "--out", "two.svg", "--checks", "two.svg"],
        ["study", "wall", "case.nml", "--out", "case.nml"],
        ["study", "wall", "case.nml", "--out", "in.svg"],
        ["study", "wall", "case.nml", "--records", "r.txt", "--unit", "g", "--out", "r.svg"],
        ["cost", "case.nml", "--out", "in.svg"],
        ["animate", "case.nml", "--out", "in.gif"],
        ["run", "case.nml", "--out", "linked"],
        ["rwmf-batch", "case.nml", "--out", "linked"],
        ["rwmf-batch", "case.nml", "case.summary.csv"],
        ["run", "case.nml", "--out", "twice.svg", "--loops", "twice.svg"],
        ["spectrum", "case.nml", "--out", "twice.svg", "--checks", "./twice.svg"],
    ],
    ids=" ".join,
)
def test_an_input_is_never_written(
    words: list[str],
    start: Run,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Under whatever name; nor are two outputs one file."""
    prepare(tmp_path)
    (tmp_path / "motion.txt").write_text("0 0\n0.5 1\n1 0\n", encoding="ascii")
    motion = {"kind": "record", "file": "motion.txt", "unit": "m/s2"}
    motion |= dict.fromkeys(("a_max_g", "omega_p"))
    case = rwmf.Case.from_namelist(tmp_path / "case.nml").replace(motion=motion)
    (tmp_path / "case.nml").unlink()
    case.to_namelist(tmp_path / "case.nml")
    shutil.copy(tmp_path / "case.nml", tmp_path / "case.summary.csv")
    os.link(tmp_path / "motion.txt", tmp_path / "hard.txt")
    (tmp_path / "in.svg").symlink_to("motion.txt")
    (tmp_path / "r.txt").write_text("0 0\n0.5 1\n1 0\n", encoding="ascii")
    (tmp_path / "r.svg").symlink_to("r.txt")
    (tmp_path / "in.gif").symlink_to("case.nml")
    for name in ("other", "linked"):
        (tmp_path / name).mkdir()
    (tmp_path / "linked" / "case.history.csv").symlink_to("../motion.txt")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    monkeypatch.chdir(tmp_path)
    if words[0] == "rwmf-batch":
        found = start(words)
        status, errors = found.returncode, found.stderr
    else:
        # refused before anything is computed
        for name in ("start_simulation", "start_spectrum"):
            monkeypatch.delattr(results, name)
        status, errors = cli.main(words), capsys.readouterr().err
    assert status == 2, errors
    assert re.search(r"is (read|written twice) by this run", errors), errors
    after = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    assert after == before


def test_a_case_does_not_replace_its_records(tmp_path: Path) -> None:
    (tmp_path / "motion.txt").write_text("0 0\n0.5 1\n1 0\n", encoding="ascii")
    motion = {"kind": "record", "file": str(tmp_path / "motion.txt"), "unit": "m/s2"}
    case = coupled(motion=motion | dict.fromkeys(("a_max_g", "omega_p")))
    with pytest.raises(InputError, match="is read by this run"):
        case.to_namelist(tmp_path / "motion.txt")
    path = tmp_path / "case.nml"
    case.to_namelist(path)
    edited = rwmf.Case.from_namelist(path).replace(frame={"T_s": 0.7})
    edited.to_namelist(path)
    assert rwmf.Case.from_namelist(path).frame.T_s == 0.7


def test_an_exported_record_does_not_replace_its_source(tmp_path: Path) -> None:
    from rwmf.motion import records

    _, source = records.find("elcentro")
    before = source.read_bytes()
    (tmp_path / "link.csv").symlink_to(source)
    with pytest.raises(InputError, match="is read by this run"):
        records.export("elcentro", tmp_path / "link.csv")
    assert source.read_bytes() == before


@pytest.mark.parametrize("name", ["thesis.txt", "foreign.nc", "out.nc.journal"])
def test_restart_discards_nothing_but_sweeps(command: Runner, tmp_path: Path, name: str) -> None:
    prepare(tmp_path)
    path = tmp_path / name
    path.write_text("three years of work\n", encoding="ascii")
    if name == "foreign.nc":
        path.unlink()
        with h5netcdf.File(path, "w") as file:
            file.attrs["sweep"] = "of another program"
    before = path.read_bytes()
    target = "out.nc" if name.endswith(".journal") else name
    found = command("sweep", "sweep.nml", "--out", target, "--restart")
    assert found.returncode == 2
    assert "Traceback" not in found.stderr
    assert path.read_bytes() == before
    known = {"case.nml", "sweep.nml", "part1.csv", name}
    assert {entry.name for entry in tmp_path.iterdir()} == known


def test_restart_leaves_a_running_sweep_alone(command: Runner, tmp_path: Path) -> None:
    prepare(tmp_path)
    assert command("sweep", "sweep.nml", "--out", "out.nc").returncode == 0
    result = (tmp_path / "out.nc").read_bytes()
    journal = tmp_path / "out.nc.journal"
    with journal.open("wb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        found = command("sweep", "sweep.nml", "--out", "out.nc", "--restart")
        assert found.returncode == 2
        assert "another process writes it" in found.stderr
        assert os.path.samestat(os.fstat(file.fileno()), journal.stat())
    assert (tmp_path / "out.nc").read_bytes() == result
    assert command("sweep", "sweep.nml", "--out", "out.nc", "--restart").returncode == 0
    assert (tmp_path / "out.nc").read_bytes() == result


def test_a_journal_beside_its_finished_file_goes(command: Runner, tmp_path: Path) -> None:
    """A run may be killed between the last two system calls."""
    prepare(tmp_path)
    words = ("sweep", "sweep.nml", "--out", "out.nc")
    journal = tmp_path / "out.nc.journal"
    assert command(*words, "--part", "1/2").returncode == 0
    shutil.copy(tmp_path / "out.nc.part-1-of-2.journal", journal)
    kept = journal.read_bytes()
    assert command(*words).returncode == 0
    assert not journal.exists()
    journal.write_bytes(kept)
    assert command(*words).returncode == 0
    assert not journal.exists()
    (tmp_path / "other.nml").write_text("&sweep case = 'case.nml' / &grid e = 0.7 /")
    assert command("sweep", "other.nml", "--part", "1/2").returncode == 0
    foreign = (tmp_path / "other.nc.part-1-of-2.journal").read_bytes()
    journal.write_bytes(foreign)
    assert command(*words).returncode == 0
    assert journal.read_bytes() == foreign


def test_a_planted_journal_is_not_followed(command: Runner, tmp_path: Path) -> None:
    prepare(tmp_path)
    (tmp_path / "precious").touch()
    (tmp_path / "out.nc.journal").symlink_to("precious")
    assert command("sweep", "sweep.nml", "--out", "out.nc").returncode == 2
    assert (tmp_path / "precious").stat().st_size == 0


@pytest.mark.slow
@pytest.mark.parametrize("redirection", [">/dev/full", ">&- 2>&-"])
@pytest.mark.parametrize("name", ["run --out", "rwmf-batch"])
def test_a_standard_output_that_takes_nothing(
    name: str, redirection: str, start: Run, tmp_path: Path
) -> None:
    """There is a message, a status, and the files are whole."""
    prepare(tmp_path)
    writer = WRITERS[name]
    assert start(writer.words).returncode == 0
    whole = [_lines(tmp_path / target) for target in writer.targets]
    for target in writer.targets:
        (tmp_path / target).unlink()
    found = start(["sh", "-c", f'exec "$@" {redirection}', "sh", *writer.words])
    assert found.returncode == 2
    assert ("standard output" in found.stderr) == ("2>&-" not in redirection)
    assert "Traceback" not in found.stderr
    assert [_lines(tmp_path / target) for target in writer.targets] == whole


def _lines(path: Path) -> list[bytes]:
    """Lines of a file without those that hold the computing time."""
    return [line for line in path.read_bytes().splitlines() if b",dop853," not in line]


def test_an_error_in_the_block_leaves_everything(tmp_path: Path) -> None:
    path = tmp_path / "x.txt"
    path.write_bytes(EARLIER)
    for error in (OSError(errno.ENOSPC, "full"), KeyboardInterrupt()):
        with pytest.raises((OutputError, KeyboardInterrupt)), files.replacing(path) as stream:
            stream.write(b"half")
            raise error
        assert path.read_bytes() == EARLIER
        assert list(tmp_path.iterdir()) == [path]
