"""One run of identify, trace or compare as a process that can be cancelled and leaves nothing half-written."""
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import threading

from .out_of_memory import yielding

_TO_END_S = 5.0


class Cancelled(Exception):
    """The run was cancelled; nothing of it stays."""


class Failed(Exception):
    """The program's own sentence."""


class Process:
    """`program(name)` gives the path of a program. `said(line)` is called with every line of its standard error."""

    def __init__(self, program, said):
        self._program, self._said = program, said
        self._lock = threading.Lock()
        self._child = None
        self._cancelled = False

    def cancel(self):
        with self._lock:
            self._cancelled = True
            if self._child is not None:
                _signal(self._child, signal.SIGINT)
                threading.Thread(target=_make_sure, args=(self._child,), daemon=True).start()

    def run(self, words):
        """Runs `words` to its end. Cancelled, or Failed with what it said."""
        with self._lock:
            if self._cancelled:
                raise Cancelled()
            # A session of its own: what the program starts is ended with it. Low priority: the controller shares the machine.
            self._child = subprocess.Popen([self._program(words[0]), *words[1:]], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                           stderr=subprocess.PIPE, text=True, errors="replace", start_new_session=True,
                                           preexec_fn=lambda: yielding(5))
        last = ""
        for line in self._child.stderr:
            line = line.strip()
            if line:
                last = line[:500]
                self._said(last)
        status = self._child.wait()
        with self._lock:
            self._child = None
            if self._cancelled:
                raise Cancelled()
        if status != 0:
            raise Failed(last or f"{words[0]} ended with status {status} and said nothing")

    def run_into(self, folder, make_words):
        """`make_words(output)` writes into a hidden folder beside `folder`, which gets its name when all of it is there."""
        folder = pathlib.Path(folder)
        folder.parent.mkdir(parents=True, exist_ok=True)
        beside = pathlib.Path(tempfile.mkdtemp(prefix=".unfinished_", dir=folder.parent))
        try:
            self.run(make_words(beside))
            os.chmod(beside, 0o755)
            if folder.exists():
                raise Failed(f"{folder} came into being meanwhile")
            os.rename(beside, folder)
        finally:
            shutil.rmtree(beside, ignore_errors=True)


def _signal(child, number):
    try:
        os.killpg(child.pid, number)
    except ProcessLookupError:
        pass


def _make_sure(child):
    try:
        child.wait(_TO_END_S)
    except subprocess.TimeoutExpired:
        _signal(child, signal.SIGKILL)
