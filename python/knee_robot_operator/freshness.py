"""How old is what a page showed when somebody pressed its button? By this server's clock alone: it stamps every state, and the page sends the stamp
of the newest one back with each request."""
import time

SEEN = "X-Seen"
OLDEST_S = 3.0  # a state comes twice a second


class Freshness:
    """A phone that sleeps or has lost its network sends what was pressed when it wakes up; by then somebody else may have stopped the robot."""

    def __init__(self, clock=time.monotonic):
        self._clock, self._begin = clock, clock()
        self._stopped = self._calmed = self._changed = -1.0

    def now(self):
        """Seconds, the stamp of a state."""
        return round(self._clock() - self._begin, 3)

    def stop(self):
        self._stopped = self.now()

    def calm(self):
        """Somebody wants the robot to wait, or another speed: what was pressed before on another page, or was overtaken on its way, is older."""
        self._calmed = self.now()

    def change(self):
        """Another exercise or patient."""
        self._changed = self.now()

    def objection(self, request):
        """Why this request may move nothing and change nobody's limits any more; empty: it may. Programs that are no pages send no stamp."""
        if SEEN not in request.headers:
            return ""
        try:
            seen = float(request.headers[SEEN])
        except ValueError:
            seen = -1.0
        # Written so that what is not a number counts as old.
        if not 0.0 <= self.now() - seen <= OLDEST_S:
            return "this was asked for by a page that had not heard from the robot for a while; look at the robot, then ask again"
        if seen <= self._stopped:
            return "the robot was stopped since this was asked for; look at the robot, then ask again"
        if seen <= self._calmed:
            return "the robot was paused, or its speed changed, since this was asked for; look at the robot, then ask again"
        return "exercise or patient was changed since this was asked for; look at the page, then ask again" if seen <= self._changed else ""
