"""Logs as files of one JSON object a line: the audit log (who asked what, and the answer) and the event log."""
import collections
import json
import logging
import logging.handlers
import pathlib
import threading
import time


class Journal:
    """Appends to a file that is replaced by a new one at `bytes_each`; `keep` old ones stay. Keeps the last entries in memory.

    JSON escapes line ends: nobody can write an entry of somebody else's by clever words. A disk that refuses is said once in the entry
    after it and does not stop anything."""

    def __init__(self, path, most=500, bytes_each=4_000_000, keep=10):
        self._lock = threading.Lock()
        self._entries = collections.deque(maxlen=most)
        self._count = 0
        self._listeners = []
        pathlib.Path(path).parent.mkdir(parents=True, exist_ok=True)
        self._handler = logging.handlers.RotatingFileHandler(path, maxBytes=bytes_each, backupCount=keep, encoding="utf-8")
        self._handler.handleError = self._refused
        self._lost = 0

    def _refused(self, _record):
        self._lost += 1

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
            self._handler.emit(logging.makeLogRecord({"msg": json.dumps(entry, ensure_ascii=True)}))
        for listener in self._listeners:
            listener(entry)
        return entry

    def entries(self, after=0):
        with self._lock:
            return [e for e in self._entries if e["number"] > after]

    def close(self):
        self._handler.close()
