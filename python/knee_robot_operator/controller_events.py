"""The controller's event log as it reaches the page: every entry once and in order, those from before the page's server was started too."""
import asyncio
import collections

_MOST_REMEMBERED = 1000  # more than the controller does


class ControllerEvents:
    """`fetch(after)`: a coroutine that answers the entries with larger numbers as dicts, or None when nobody answers. `tell(event, is_old)`: called
    for every entry; `is_old`: it is from before the first look. Everything on one loop."""

    def __init__(self, fetch, tell):
        self._fetch, self._tell = fetch, tell
        self._newest = None   # the newest entry that was told
        self._told = collections.OrderedDict()  # number: time
        self._heard = None    # the newest entry that came by itself
        self._looking = None

    def hear(self, event):
        """An entry that came by itself; numbers begin anew with the controller."""
        self._heard = event
        if self._newest and event["number"] == self._newest["number"] + 1 and self._looking is None:
            self._take(event, False)
        elif self._looking is None and not self._is_known(event):
            self._looking = asyncio.ensure_future(self._look())

    def _is_known(self, event):
        """By number and time: a controller that is started anew begins from one, and the clock may have been set back before."""
        return self._told.get(event["number"]) == event["time"]

    def _take(self, event, is_old):
        self._newest = event
        self._told.pop(event["number"], None)
        self._told[event["number"]] = event["time"]
        if len(self._told) > _MOST_REMEMBERED:
            self._told.popitem(last=False)
        self._tell(event, is_old)

    async def _look(self):
        """Catches up; again when something was heard meanwhile that was not among it."""
        try:
            while self._heard is not None and not self._is_known(self._heard):
                heard = self._heard
                began_anew = self._newest is not None and heard["number"] <= self._newest["number"]
                is_old = self._newest is None
                events = await self._fetch(0 if is_old or began_anew else self._newest["number"])
                for event in events or [heard]:
                    if not self._is_known(event):
                        self._take(event, is_old)
                if not self._is_known(heard):
                    self._take(heard, is_old)  # of a controller that has ended since
        finally:
            self._looking = None


def in_words(event):
    """(kind, text, more) for Journal.add."""
    kind, more = event["kind"], {"time": event["time"]}
    if kind == "fault":
        return kind, event["answer"], {**more, "name": event["what"]}
    if kind == "state":
        return kind, event["what"], more
    if kind in ("request", "refused", "ended"):
        return kind, event["what"].replace("_", " ", 1), {**more, "answer": event["answer"], "user": event["who"].lstrip("/")}
    return "controller", ": ".join(part for part in (event["what"], event["answer"]) if part), {**more, "warning": kind == "log"}
