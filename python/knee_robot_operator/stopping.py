"""STOP of the page: along the path first, by the safe stop if that is refused, unanswered or without effect."""
import asyncio
import time

from .answer import Answer

ANSWER_S = 1.0
TO_REST_S = 4.0
_AGAIN_S = (0.5, 6.0)  # a second press in this time, while the robot has not come to rest since, means: it does not stop as it should
_MOVING = ("enabling", "homing", "guiding", "playing", "paused", "stopping")
_UNKNOWN = None  # the controller's state is not heard (it is silent, or of another version than this page): it may move


class Stopping:
    """Never waits behind another request, never asks back, and repeats itself until the robot rests or nobody answers."""

    def __init__(self, robot, playing, journal, clock=time.monotonic):
        self._robot, self._playing, self._journal, self._clock = robot, playing, journal, clock
        self._pressed = None
        self._watch = None

    async def press(self):
        now, before = self._clock(), self._pressed
        self._pressed = now
        await self._playing.stop()
        state = (self._robot.state or {}).get("state")
        again = before is not None and _AGAIN_S[0] <= now - before <= _AGAIN_S[1] and state in (*_MOVING, _UNKNOWN)
        if again or state in ("enabling", "homing"):
            return await self._safe_stop("STOP was pressed again while the robot moved" if again else f"the robot is {state}")
        answer = await self._ask("stop")
        if answer is None:
            return await self._safe_stop("the controller did not answer to stop in time")
        if not answer.success and state in (*_MOVING, _UNKNOWN):
            return await self._safe_stop(answer.message)
        if self._watch is None or self._watch.done():
            self._watch = asyncio.create_task(self._see_it_rest())
        return answer

    async def _ask(self, service):
        try:
            return await asyncio.wait_for(self._robot.ask(service), ANSWER_S)
        except asyncio.TimeoutError:
            return None

    async def _safe_stop(self, why):
        self._journal.add("page", f"safe stop: {why}")
        answer = await self._ask("emergency_stop")
        if answer is None:
            return Answer(False, "the controller does not answer: use the hand switch or the emergency stop button")
        return answer

    async def _see_it_rest(self):
        """The robot slows down within a second or two; where it does not, the safe stop."""
        end = self._clock() + TO_REST_S
        while self._clock() < end:
            await asyncio.sleep(0.1)
            state = (self._robot.state or {}).get("state")
            has_started_anew = self._playing.active and not self._playing.ending
            if state not in ("playing", "stopping", "paused", _UNKNOWN) or has_started_anew:
                self._pressed = None  # that STOP has done its work: the next one is a first one
                return
        await self._safe_stop(f"the robot did not come to rest within {TO_REST_S:g} s of STOP")
