"""Programs as processes with limits, so that a crash, a hang and a hunger for memory are results like any other."""
from __future__ import annotations

import dataclasses
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import threading

ROOT = pathlib.Path(__file__).resolve().parent.parent
SENTENCE = 400  # characters kept of a program's complaint


def default_programs() -> pathlib.Path:
    """Where scripts/build leaves the programs."""
    return pathlib.Path(os.environ.get("KNEE_BUILD", ROOT / "build")) / "devel" / "lib" / "knee_robot"


@dataclasses.dataclass(frozen=True)
class Limits:
    """Of one run of one program."""

    seconds: float = 600.0
    memory_bytes: int = 4 * 1024**3  # address space


@dataclasses.dataclass(frozen=True)
class Outcome:
    """What one run of one program did. `status` is negative for a signal, None when the time limit ended it."""

    status: int | None
    sentence: str
    output: str
    processor_s: float
    peak_bytes: int

    @property
    def done(self) -> bool:
        return self.status == 0

    @property
    def final(self) -> bool:
        """Whether the input is to blame (bad input 2, refused 3): the same input would fail again."""
        return self.status in (2, 3)


def run(command: list[str | os.PathLike[str]], limits: Limits = Limits()) -> Outcome:
    """Runs a program to its end or to a limit. OSError when it cannot be started or its output not be kept."""
    arguments = [str(part) for part in command]
    if shutil.which(arguments[0]) is None:
        return Outcome(127, f"{arguments[0]}: no such program; run scripts/build", "", 0.0, 0)
    # The kernel ends the program with the worker that started it: a killed worker leaves nothing running.
    guarded = ["setpriv", "--pdeathsig", "KILL", "--", "prlimit", f"--as={limits.memory_bytes}", "--", *arguments]
    with tempfile.TemporaryFile() as out:
        with subprocess.Popen(guarded, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT, start_new_session=True) as process:
            late = threading.Event()
            timer = threading.Timer(limits.seconds, _end, (process.pid, late))
            timer.start()
            _, status, usage = os.wait4(process.pid, 0)
            timer.cancel()
            process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        text = out.read().decode(errors="replace")
    name, code = pathlib.Path(arguments[0]).name, process.returncode
    return Outcome(None if late.is_set() else code, _sentence(name, code, late.is_set(), limits, text), text,
                   usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)


def _end(group: int, late: threading.Event) -> None:
    late.set()
    try:
        os.killpg(group, signal.SIGKILL)
    except ProcessLookupError:
        late.clear()


def _sentence(name: str, code: int, late: bool, limits: Limits, text: str) -> str:
    """Why it ended, in one sentence; empty when all is well."""
    if late:
        return f"{name} was ended after its time limit of {limits.seconds:g} s"
    if code == 0:
        return ""
    if code < 0:
        return f"{name} was ended by {signal.Signals(-code).name}"
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return (f"{name}: {lines[-1]}" if lines else f"{name} ended with status {code}")[:SENTENCE]
