"""What the tests of the page share: a robot that only remembers what it was asked, and the whole server on a port of its own."""
import asyncio
import contextlib
import json
import pathlib
import stat
import sys
import tempfile
import time
import unittest

import aiohttp

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))

from knee_robot_operator.answer import Answer  # noqa: E402
from knee_robot_operator.connections import serve  # noqa: E402
from knee_robot_operator.settings import Settings  # noqa: E402
from knee_robot_operator.web import Server  # noqa: E402

PAGE = ROOT / "operator"


class PageTest(unittest.IsolatedAsyncioTestCase):
    async def asyncSetUp(self):
        asyncio.get_running_loop().set_debug(False)  # a page beside other tests need not be told how slow the machine is


class ToyRobot:
    """States as the controller has them, advanced by the test or by what is asked. Slowing down takes `stop_s`, an exercise `play_s`."""

    def __init__(self, state="holding", stop_s=0.3, play_s=1.0):
        self.stop_s, self.play_s = stop_s, play_s
        self.asked = []            # (service, fields) in the order of arrival
        self.answers = {}          # service: Answer, or an exception, or seconds of silence
        self.goals, self.cancelled = 0, 0
        self.speeds = []           # of the goals
        self.here = True           # at the exercise's start
        self.arrived = False       # by an approach
        self._listeners, self._log_listeners, self._event_listeners = [], [], []
        self._told = (state, "")
        self._end = None
        self._goal_cancelled = None
        self._state = {"state": state, "fault": "", "cause": "", "reference_file": "lift.txt", "patient": "", "playing": "", "duration_s": play_s,
                       "path_time_s": 0.0, "progress": 0.0, "time_scale": 0.0, "speed_percent": 100.0, "recording": False, "homed": True,
                       "occupancy": "empty"}
        self.silent = False

    @property
    def state(self):
        return None if self.silent else dict(self._state, at_start=self.here)

    async def fresh_state(self):
        return self.state

    def live(self):
        return {"t": asyncio.get_running_loop().time(), "reference": [1] * 4, "position": [1] * 4, "force": [1] * 4, "residual": [0] * 4, "heat": 0}

    def listen(self, on_state, on_log, on_event):
        self._event_listeners.append(on_event)
        self._listeners.append(on_state)
        self._log_listeners.append(on_log)

    def say(self, sentence):
        for listener in self._log_listeners:
            listener(sentence)

    def tell(self, kind, what, answer="", who="", is_ours=False):
        """An entry of the controller's event log."""
        for listener in self._event_listeners:
            listener({"number": 1, "time": time.time(), "kind": kind, "who": who, "what": what, "answer": answer}, is_ours)

    def become(self, state, **more):
        self._state.update(state=state, **more)
        for listener in self._listeners:
            listener(dict(self._state))
        told, self._told = self._told, (state, self._state["fault"])
        if self._told[1] and self._told[1] != told[1]:
            self.tell("fault", self._state["fault"], self._state["cause"])
        if self._told[0] != told[0]:
            self.tell("state", state)

    async def ask(self, service, **fields):
        self.asked.append((service, fields))
        given = self.answers.get(service)
        if isinstance(given, float):
            await asyncio.sleep(given)
        if isinstance(given, Exception):
            raise given
        if isinstance(given, Answer):
            return given
        if service == "stop" and self._state["state"] in ("playing", "paused"):
            self.become("stopping")
            asyncio.get_running_loop().call_later(self.stop_s, self._rest)
        if service == "load_reference":
            self._state["reference_file"] = fields["file"]
        if service == "set_speed":
            self._state["speed_percent"] = fields["percent"]
        if service == "emergency_stop":
            self.become("safe_stopping")
        if service == "approach":
            self.become("playing", playing="approach")
            asyncio.get_running_loop().call_later(0.2, self._arrive)
        return Answer(True, f"the robot is {self._state['state']}")

    def _arrive(self):
        if self._state["state"] == "playing":
            self.here = self.arrived = True
            self.become("holding", playing="")

    def _rest(self):
        if self._state["state"] == "stopping":
            self.become("holding", playing="")

    async def play(self, speed_percent, recording, on_begin):
        self.goals += 1
        self.speeds.append(speed_percent)
        if self._state["state"] != "holding" or not self.here:
            return Answer(False, f"not possible while the robot is {self._state['state']}")
        self.become("playing", playing="lift.txt")
        self._goal_cancelled = asyncio.Event()
        on_begin()
        for _ in range(int(self.play_s / 0.02)):
            await asyncio.sleep(0.02)
            if self._state["state"] != "playing" or self._goal_cancelled.is_set():
                break
        else:
            self.become("holding", playing="")
            return Answer(True, "lift.txt was played to its end")
        self.here = False
        while self._state["state"] in ("stopping", "playing"):
            if self._state["state"] == "playing":
                await self.ask("stop")
            await asyncio.sleep(0.02)
        return Answer(False, "stopped")

    def cancel_play(self):
        self.cancelled += 1
        if self._goal_cancelled:
            self._goal_cancelled.set()


class ToyJobs:
    def __init__(self):
        self.begun = []

    def as_dict(self):
        return {"active": False, "command": "", "stage": "", "share": 0.0, "message": "", "result": None}

    async def begin(self, _server, command, train, validate):
        self.begun.append((command, train, validate))
        return Answer(True, "begun")

    async def cancel(self):
        return Answer(False, "nothing is running")

    def use_model(self, path):
        return Answer(True, str(path))


async def until_closed(reader):
    """What comes until the other side closes. One that closes without having read everything sends a reset after its answer."""
    answer = b""
    with contextlib.suppress(ConnectionResetError):
        while block := await reader.read(65536):
            answer += block
    return answer


class Rig:
    """The server with its folders; `async with Rig() as rig`. `limits` are those of the gate."""

    def __init__(self, robot=None, limits=None, body_s=None, **settings):
        self.robot, self.jobs, self._limits, self._body_s = robot or ToyRobot(), ToyJobs(), limits or {}, body_s
        self._settings = settings

    async def __aenter__(self):
        self._stack = contextlib.AsyncExitStack()
        self.folder = pathlib.Path(self._stack.enter_context(tempfile.TemporaryDirectory(prefix="operator_test_")))
        for name in ("references", "patients", "recordings", "reports", "log"):
            (self.folder / name).mkdir()
        (self.folder / "secret.txt").write_text("secret")
        (self.folder / "references" / "lift.txt").write_text("0.6 0.6 0.6 0.6\n")
        checker = self.folder / "check_reference"
        checker.write_text('#!/bin/sh\necho \'{"points": 1, "duration_s": 1, "margins": [], "violation": null, "path": null}\'\n')
        checker.chmod(checker.stat().st_mode | stat.S_IXUSR)
        folders = {name: str(self.folder / name) for name in ("references", "patients", "recordings", "reports", "log")}
        settings = Settings(**folders, robot="robot.yaml", port=0, **self._settings)
        self.server = Server(settings, self.robot, self.jobs, PAGE, str(checker))
        app = self.server.application()
        if self._body_s:
            app["body_s"] = self._body_s
        listener, end = await serve(app, settings.address, 0, settings.tls_context(), **self._limits)
        self._stack.push_async_callback(end)
        self.port = listener.sockets[0].getsockname()[1]
        self.scheme = "https" if settings.tls else "http"
        self.url = f"{self.scheme}://127.0.0.1:{self.port}"
        return self

    async def __aexit__(self, *error):
        await self.server.playing.close()
        await self._stack.aclose()

    @contextlib.asynccontextmanager
    async def browser(self, user=None, password=None):
        jar = aiohttp.CookieJar(unsafe=True)
        async with aiohttp.ClientSession(cookie_jar=jar, connector=aiohttp.TCPConnector(ssl=False)) as session:
            browser = Browser(self, session)
            if user:
                status, _ = await browser.post("/api/login", {"user": user, "password": password})
                assert status == 200, status
            await browser.fetch_token()
            yield browser

    async def talk(self, data, seconds=30.0, local="127.0.0.1"):
        """Bytes as they are, from the address `local`; what comes back until the server closes."""
        reader, writer = await asyncio.open_connection("127.0.0.1", self.port, local_addr=(local, 0))
        try:
            writer.write(data)
            return await asyncio.wait_for(until_closed(reader), seconds)
        finally:
            writer.close()

    def audit(self):
        self.server.audit.settle()
        return [json.loads(line) for line in (self.folder / "log" / "audit.jsonl").read_text().splitlines()]


class Browser:
    def __init__(self, rig, session):
        self._rig, self.session, self.token = rig, session, ""

    async def fetch_token(self):
        _, content = await self.get("/api/session")
        self.token = content.get("csrf", "")

    async def get(self, path, **headers):
        async with self.session.get(self._rig.url + path, headers=headers) as answer:
            text = await answer.text()
            self.headers = answer.headers
            return answer.status, json.loads(text) if answer.content_type == "application/json" else text

    async def post(self, path, body=None, token=None, headers=None):
        headers = {"X-CSRF-Token": self.token if token is None else token, **(headers or {})}
        async with self.session.post(self._rig.url + path, json={} if body is None else body, headers=headers) as answer:
            return answer.status, await answer.json()
