"""Logs as files of one JSON object a line: the audit log (who asked what, and the answer) and the event log."""
import collections
import json
import logging
import logging.handlers
import pathlib
import queue
import threading
import time


class Journal:
    """Appends to a file that is replaced by a new one at `bytes_each`; `keep` old ones stay. Keeps the last entries in memory.

    JSON escapes line ends: nobody can write an entry of somebody else's by clever words. A disk that refuses is said once in the entry
    after it and does not stop anything; one that hangs keeps a thread of its own waiting, and nobody else."""

    def __init__(self, path, most=500, bytes_each=4_000_000, keep=10, most_waiting=5000):
        self._lock = threading.Lock()
        self._entries = collections.deque(maxlen=most)
        self._count = 0
        self._listeners = []
        pathlib.Path(path).parent.mkdir(parents=True, exist_ok=True)
        self._handler = logging.handlers.RotatingFileHandler(path, maxBytes=bytes_each, backupCount=keep, encoding="utf-8")
        self._handler.handleError = self._refused
        self._lost = 0
        self._waiting = queue.Queue(most_waiting)
        self._writer = threading.Thread(target=self._write, daemon=True)
        self._writer.start()

    def _refused(self, _record):
        with self._lock:
            self._lost += 1

    def _write(self):
        while (line := self._waiting.get()) is not None:
            self._handler.emit(logging.makeLogRecord({"msg": line}))
            self._waiting.task_done()
        self._handler.close()

    def listen(self, listener):
        """Calls `listener(entry)` on every entry, on the thread that adds it."""
        self._listeners.append(listener)

    def add(self, kind, text, **more):
        """`kind`: request, refused, state, fault, controller, page. Returns the entry with its number and time."""
        with self._lock:
            self._count += 1
            entry = {"number": self._count, "time": round(time.time(), 3), "kind": kind, "text": str(text)[:2000], **more}
            if self._lost:
                entry["lost_before"] = self._lost
                self._lost = 0
            self._entries.append(entry)
            try:
                self._waiting.put_nowait(json.dumps(entry, ensure_ascii=True))
            except queue.Full:
                self._lost += 1
        for listener in self._listeners:
            listener(entry)
        return entry

    def entries(self, after=0):
        with self._lock:
            return [e for e in self._entries if e["number"] > after]

    def settle(self):
        """Waits, without end where the disk hangs, until everything that was added is in the file."""
        self._waiting.join()

    def close(self, patience_s=2.0):
        """What was added is in the file afterwards, unless the disk takes longer than that."""
        try:
            self._waiting.put_nowait(None)
        except queue.Full:
            return
        self._writer.join(patience_s)
