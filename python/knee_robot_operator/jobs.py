"""What takes minutes: comparing, identifying, tracing, and "record and check the model". One job at a time, and it can be cancelled."""
import asyncio
import os
import pathlib
import shutil
import signal
import time

from .answer import Answer
from .out_of_memory import yielding

_PLANNING_S = 15      # of each excitation
_EXCITATION_S = 20
_APPROACH_S = 180.0


class _Ended(Exception):
    """Why the job ends early: one sentence."""


class Jobs:
    """`identification`: what runs the action identify_recordings (RosIdentification, or a test's). `plan_excitation`: path of that program."""

    def __init__(self, settings, identification, plan_excitation):
        self._settings, self._identification, self._plan = settings, identification, plan_excitation
        self._task = None
        self._cancelled = False
        self._command = self._stage = self._message = ""
        self._share = 0.0
        self._result = None

    def as_dict(self):
        return {"active": self.active, "command": self._command, "stage": self._stage, "share": round(self._share, 3), "message": self._message,
                "result": self._result}

    @property
    def active(self):
        return self._task is not None and not self._task.done()

    async def begin(self, server, command, train, validate):
        if self.active:
            return Answer(False, "another job is running; wait for it or cancel it")
        self._cancelled = False
        self._command, self._stage, self._share, self._message, self._result = command, "starting", 0.0, "", None
        work = self._check_model(server) if command == "check_model" else self._identify(command, train, validate, "", 0.0, 1.0)
        self._task = asyncio.create_task(self._finish(server, work))
        return Answer(True, "begun")

    async def cancel(self):
        if not self.active:
            return Answer(False, "nothing is running")
        self._cancelled = True
        self._identification.cancel()
        return Answer(True, "cancelling")

    def use_model(self, path):
        """Copies a model to where the controller finds it at its next start (model_in_use); the one before stays beside it."""
        if not self._settings.model_in_use:
            return Answer(False, "no file for the model in use is set; start operator.launch with model_in_use:=FILE, and the controller with "
                                 "model:=FILE")
        place = pathlib.Path(self._settings.model_in_use)
        try:
            place.parent.mkdir(parents=True, exist_ok=True)
            if place.exists():
                shutil.copyfile(place, place.with_name(place.name + ".before"))
            beside = place.with_name(place.name + ".new")
            shutil.copyfile(path, beside)
            os.replace(beside, place)
        except OSError as error:
            return Answer(False, f"the model could not be written: {error.strerror}")
        return Answer(True, f"written to {place}: the controller uses it from its next start")

    async def close(self):
        if self.active:
            await self.cancel()
            await asyncio.wait({self._task}, timeout=10.0)

    async def _finish(self, server, work):
        try:
            self._message = await work
        except _Ended as error:
            self._message = str(error)
        except Exception as error:  # the job ends, the server goes on
            self._message = f"the job was given up: {error}"
        server.events.add("page", f"{self._command}: {self._message}")
        server.live.changed()

    def _at(self, stage, share):
        self._stage, self._share = stage, share

    async def _identify(self, command, train, validate, output, begin, end):
        def feed(stage, share):
            self._at(stage, begin + share * (end - begin))

        model = self._settings.model_in_use if os.path.isfile(self._settings.model_in_use or "") else ""
        answer, result = await self._identification.run(command, train, validate, output, model, feed)
        if not answer.success:
            raise _Ended(answer.message)
        self._result = result
        self._share = end
        return answer.message

    async def _check_model(self, server):
        """Two excitations are planned, played and recorded; a model is identified on the first and validated on the second, the residual is
        traced, and the model in use is set beside it."""
        state = server.robot.state
        if not state or state["state"] != "holding" or server.playing.active:
            raise _Ended("switch the robot on first; it must hold, with nothing being played")
        stops = server.playing.stops
        stamp = time.strftime("%Y-%m-%d_%H-%M-%S")
        recordings = []
        for k in (1, 2):
            name = f"excitation_{stamp}_{k}.txt"
            self._at(f"planning excitation {k}", 0.1 * (k - 1))
            await self._plan_excitation(server, k, name)
            self._at(f"playing excitation {k}", 0.25 * k)
            recordings.append(await self._play(server, name, stops))
        await self._identify("identify", recordings[:1], recordings[1:], f"identified_{stamp}", 0.6, 0.7)
        return await self._identify("trace", recordings[:1], recordings[1:], f"traced_{stamp}", 0.7, 1.0)

    async def _plan_excitation(self, server, seed, name):
        folder = pathlib.Path(self._settings.references)
        process = await asyncio.create_subprocess_exec(
            self._plan, "--robot", self._settings.robot, "--seed", str(seed), "--duration", str(_EXCITATION_S), "--seconds", str(_PLANNING_S),
            "-o", str(folder / name), stdin=asyncio.subprocess.DEVNULL, stdout=asyncio.subprocess.DEVNULL, stderr=asyncio.subprocess.PIPE,
            start_new_session=True, preexec_fn=yielding)
        talk = asyncio.create_task(process.communicate())
        while not talk.done():
            await asyncio.wait({talk}, timeout=0.2)
            if self._cancelled:
                os.killpg(process.pid, signal.SIGTERM)  # with whatever it has started
                await talk
                raise _Ended("cancelled; nothing of it was kept")
        if process.returncode != 0:
            raise _Ended(talk.result()[1].decode(errors="replace").strip().splitlines()[-1])

    async def _play(self, server, name, stops):
        """`stops`: of when the job began."""
        robot, playing = server.robot, server.playing
        playing.note_resume()  # what was paused before the job is no longer under way
        for service, fields in (("load_reference", {"file": name, "space": ""}), ("approach", {})):
            self._go_on(playing, stops)
            self._unless_paused(playing)
            answer = await (playing.ask_motion(service, stops) if service == "approach" else robot.ask(service, **fields))
            if not answer.success:
                raise _Ended(answer.message)
        end = time.monotonic() + _APPROACH_S
        while True:
            state = await robot.fresh_state()
            self._go_on(playing, stops)
            if state is None or time.monotonic() > end:
                raise _Ended("the robot did not reach the excitation's start")
            if state["state"] not in ("playing", "paused", "stopping"):
                break
            await asyncio.sleep(0.2)
        self._unless_paused(playing)
        answer = await playing.start(1, True)
        if not answer.success:
            raise _Ended(answer.message)
        while playing.active:
            await asyncio.sleep(0.2)
            if self._cancelled:
                await server.stopping.press()
        self._go_on(playing, stops)
        if not playing.succeeded:
            raise _Ended(playing.message)
        return playing.recordings[-1]

    def _unless_paused(self, playing):
        """A pause that the robot has not made: it was just arriving, or stood."""
        if playing.pause_asked:
            raise _Ended("paused before the excitation began; what was recorded so far is kept")

    def _go_on(self, playing, stops):
        if self._cancelled or playing.stops != stops:
            raise _Ended("stopped; what was recorded so far is kept")
