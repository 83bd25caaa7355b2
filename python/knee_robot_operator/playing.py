"""One exercise, repeated as often as asked for, as a course of requests to the robot."""
import asyncio
import contextlib
import time

from .answer import Answer

SLOWEST_PERCENT, FASTEST_PERCENT = 5.0, 100.0
MOST_REPETITIONS = 100
_LOOK_S = 0.1
_WIND_UP_S = 5.0
_SET_S = 1.5  # states on their way say the speed of before


class Playing:
    """What runs now, and how STOP ends it.

    Nothing is ever queued: a request that the robot cannot follow now is refused with the reason. Every STOP, and every stop that others ask
    the robot for, raises `stops`, and whatever was begun before looks at it after each wait: nothing moves by a Start that is older than the
    last of them."""

    def __init__(self, robot, journal, on_stop=lambda: None, on_pause=lambda: None):
        """`on_stop()`, `on_pause()`: called at every STOP, at every pause."""
        self._robot, self._journal, self._on_stop, self._on_pause = robot, journal, on_stop, on_pause
        self.stops = 0
        self.pause_asked = False
        self._task = None
        self.ending = True
        self.repetition = self.repetitions = 0
        self.message = ""
        self.succeeded = False
        self.recordings = []  # names, of the last start
        self.speed_percent = FASTEST_PERCENT
        self._speed_set = -_SET_S

    @property
    def active(self):
        return self._task is not None and not self._task.done()

    def as_dict(self):
        state = self._robot.state
        left = None
        if self.active and state and state["duration_s"] > 0:
            share = max(self.speed_percent, 1.0) / 100.0
            rest = max(0.0, state["duration_s"] - state["path_time_s"]) if state["playing"] else state["duration_s"]
            left = (rest + (self.repetitions - self.repetition) * state["duration_s"]) / share
        return {"active": self.active, "repetition": self.repetition, "repetitions": self.repetitions, "left_s": left,
                "message": self.message, "speed_percent": self.speed_percent}

    async def start(self, repetitions, record):
        """Begins at the first point of the loaded exercise. Answers when the first repetition has begun, or with why not."""
        stops = self.stops
        if not 1 <= repetitions <= MOST_REPETITIONS:
            return Answer(False, f"the exercise can be repeated 1 to {MOST_REPETITIONS} times")
        state = self._robot.state
        if state and state["state"] in ("stopping", "safe_stopping"):
            return Answer(False, "the robot is still slowing down; start again when it holds")
        if self.active and not self.ending:
            return Answer(False, "an exercise is being played already")
        if self.active:  # stopped, and its recording is being closed
            await asyncio.wait({self._task}, timeout=_WIND_UP_S)
            if self.active:
                return Answer(False, "what was stopped has not ended yet; start again in a moment")
        if stops != self.stops:
            return Answer(False, "stopped before it began")
        if not state or not state["reference_file"]:
            return Answer(False, "choose an exercise first")
        if state["state"] == "holding" and not state["at_start"]:
            return Answer(False, "the robot does not stand at the exercise's start; go to the start first")
        self.repetition, self.repetitions, self.message = 1, repetitions, ""
        self.succeeded, self.recordings, self.pause_asked = False, [], False
        begun = asyncio.get_running_loop().create_future()
        self.ending = False
        self._task = asyncio.create_task(self._run(stops, record, begun))
        return await begun

    def note_stop(self):
        """Somebody has stopped the robot, here or elsewhere: what was begun before begins no further motion."""
        self.stops += 1
        self._on_stop()

    async def stop(self):
        """To be called before the robot is asked to stop. Never waits."""
        self.note_stop()
        self.ending = True
        self._robot.cancel_play()

    async def ask_motion(self, service, stops):
        """A STOP that overtakes the order finds nothing to stop: the robot is stopped again when the order has been answered. `stops`: of
        when the order was given."""
        try:
            answer = await self._robot.ask(service)
        except asyncio.TimeoutError:
            # It may wait in the controller, and be obeyed when nobody expects it any more: a stop ends what waits.
            with contextlib.suppress(asyncio.TimeoutError):
                await self._robot.ask("stop")
            raise
        if answer.success and stops != self.stops:
            await self._robot.ask("stop")
            return Answer(False, f"stopped while the robot was being asked to {service}")
        return answer

    async def pause(self):
        """A pause that comes when a repetition is just ending, or between two, is none for the robot: then no further one begins."""
        self.note_pause()
        return await self._robot.ask("pause")

    def note_pause(self):
        """Somebody wants the robot to pause, here or elsewhere."""
        self.pause_asked = True
        self._on_pause()

    def note_resume(self):
        """Somebody wants it to go on: the pause has been taken back."""
        self.pause_asked = False

    def set_speed(self, percent):
        """The robot has been given this speed."""
        self.speed_percent, self._speed_set = percent, time.monotonic()

    def look(self, state):
        """At every state of the robot. Whoever else has slowed it down goes on being obeyed, and after a restart of this server, too."""
        if time.monotonic() - self._speed_set >= _SET_S:
            self.speed_percent = min(FASTEST_PERCENT, max(SLOWEST_PERCENT, state["speed_percent"]))
        if state["state"] == "paused":
            self.pause_asked = False  # the robot has it; who continues continues the repetition

    async def close(self):
        await self.stop()
        if self.active:
            await asyncio.wait({self._task}, timeout=_WIND_UP_S)

    async def _run(self, stops, record, begun):
        def on_begin():
            if not begun.done():
                begun.set_result(Answer(True, "the exercise has begun"))

        answer = Answer(False, "stopped before it began")
        try:
            exercise = self._robot.state["reference_file"]
            stem = exercise.rsplit("/", 1)[-1].rsplit(".", 1)[0]
            stamp = time.strftime("%Y-%m-%d_%H-%M-%S")
            for k in range(1, self.repetitions + 1):
                self.repetition = k
                if k > 1:
                    answer = await self._return_to_start(stops, exercise)
                    if not answer.success:
                        break
                if stops != self.stops:
                    break
                if k > 1 and self.pause_asked:
                    answer = Answer(False, f"paused after repetition {k - 1} of {self.repetitions}; Start begins anew")
                    break
                recording = f"{stem}_{stamp}_{k}.csv" if record else ""
                answer = await self._robot.play(self.speed_percent, recording, on_begin)
                if recording:
                    self.recordings.append(recording)
                if not answer.success or stops != self.stops:
                    break
            else:
                self.succeeded = True
        except Exception as error:  # the course ends, the server goes on
            answer = Answer(False, f"the exercise was given up: {error}")
            self._robot.cancel_play()
        finally:
            self.ending = True
            self.message = answer.message
            if not begun.done():
                begun.set_result(answer)
            self._journal.add("page", answer.message)

    async def _return_to_start(self, stops, exercise):
        """Where the exercise does not end where it begins: slowly and straight to its first point."""
        state = await self._robot.fresh_state()
        if state is None:
            return Answer(False, "the controller does not answer")
        if state["reference_file"] != exercise:
            return Answer(False, f"somebody else has loaded {state['reference_file']} in place of {exercise} meanwhile")
        if state["speed_percent"] < SLOWEST_PERCENT:
            return Answer(False, f"somebody has set the speed to {state['speed_percent']:g} %; Start begins anew")
        if state["at_start"]:
            return Answer(True, "")
        answer = await self.ask_motion("approach", stops)
        if not answer.success:
            return answer
        while stops == self.stops:
            state = await self._robot.fresh_state()
            if state is None:
                return Answer(False, "the controller does not answer")
            if state["state"] not in ("playing", "paused", "stopping"):
                break
            await asyncio.sleep(_LOOK_S)
        if stops != self.stops:
            return Answer(False, "stopped between two repetitions")
        if state["state"] != "holding":
            return Answer(False, state["cause"] or f"the robot is {state['state']}")
        return Answer(True, "")
