"""The server: pages and requests. What they mean is in the modules beside it."""
import asyncio
import collections
import json
import pathlib
import re

from aiohttp import web

from .access import LONGEST_PASSWORD, LoginLimit, Session, Sessions
from .connections import BODY_S, STOP, bounded_request
from .controller_events import in_words
from .answer import Answer, Refused
from .exercises import Exercises
from .folders import Folder, ReportFolders
from .freshness import Freshness
from .guard import COOKIE, LARGEST_BODY, fields, guarded, needs, session_of
from .journal import Journal
from .live import Live, LostPage
from .playing import FASTEST_PERCENT, SLOWEST_PERCENT, Playing
from .requests import Requests
from .stops import is_asked, is_stop
from .stopping import Stopping

_TYPES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".json": "application/json", ".svg": "image/svg+xml"}


_OTHERS_S = 1.0
_USERS_S = 1.0


def read_pages(folder):
    """Every file of the page's folder by its path; nothing else can be asked for, whatever a request's path says."""
    folder = pathlib.Path(folder)
    pages = {}
    for file in sorted(folder.rglob("*")):
        if file.suffix in _TYPES and file.is_file():
            pages["/" + file.relative_to(folder).as_posix()] = (file.read_bytes(), _TYPES[file.suffix])
    pages["/"] = pages["/index.html"]
    languages = [{"code": pathlib.Path(path).stem, "name": json.loads(content)["language"]}
                 for path, (content, _) in sorted(pages.items()) if path.startswith("/languages/")]
    pages["/languages/index.json"] = (json.dumps({"languages": languages}).encode(), _TYPES[".json"])
    return pages


class Server:
    """Everything that the routes need. `robot`: RosRobot or what a test puts in its place; `jobs`: Jobs, likewise."""

    def __init__(self, settings, robot, jobs, page_folder, check_reference):
        self.settings, self.robot, self.jobs = settings, robot, jobs
        self.users = settings.load_users()
        self.sessions, self.login_limit = Sessions(), LoginLimit()
        self.audit = Journal(pathlib.Path(settings.log) / "audit.jsonl")
        self.events = Journal(pathlib.Path(settings.log) / "events.jsonl")
        self.freshness = Freshness()
        self.playing = Playing(robot, self.events, self.freshness.stop, self.freshness.calm)
        self.stopping = Stopping(robot, self.playing, self.events)
        self.references = Folder(settings.references, (".txt", ".ref", ".dat", ".csv"), any_name=True)
        self.patients = Folder(settings.patients, (".yaml", ".yml"), any_name=True)
        self.recordings = Folder(settings.recordings, (".csv",))
        self.reports = ReportFolders(settings.reports)
        self.exercises = Exercises(self.references, settings.robot, check_reference)
        self.live = Live(self.snapshot, robot.live, self.sessions)
        self.lost_page = LostPage(robot, self.live, self.events, settings.lost_page_pause_s, self.playing.pause)
        self.pages = read_pages(page_folder)
        self._told_answers = collections.deque(maxlen=50)
        robot.listen(self.on_state, self.on_log, self.on_event)
        self.events.listen(lambda entry: self.live.tell("event", entry))

    def snapshot(self):
        state = self.robot.state
        return {"seen": self.freshness.now(), "robot": state, "playing": self.playing.as_dict(),
                "job": self.jobs.as_dict()}

    def on_state(self, state):
        self.playing.look(state)
        self.live.changed()

    def on_event(self, event, is_ours):
        """An entry of the controller's log. Requests of this server's users are in the log by note()."""
        self._told_answers.append(event["answer"])
        if not is_ours:
            self._obey(event)
        if not is_ours:
            kind, words, more = in_words(event)
            self.events.add(kind, words, **more)

    def _obey(self, event):
        """What somebody else asks the robot for holds for what is planned here, too."""
        if is_stop(event):
            self.playing.note_stop()
        elif is_asked(event, "pause"):
            self.playing.note_pause()
        elif is_asked(event, "resume"):
            self.playing.note_resume()
        elif is_asked(event, "set_speed"):
            self.freshness.calm()

    def on_log(self, sentence):
        """A warning of the controller. A second later, when it is known which of them only repeat an answer."""
        def add():
            if not any(told and told in sentence for told in (*self._told_answers, self.playing.message)):
                self.events.add("controller", sentence, warning=True)

        asyncio.get_running_loop().call_later(_OTHERS_S, add)

    def note(self, request, session, what, answer):
        """One request and its answer, into both logs."""
        who = {"user": session.user if session else "", "role": session.role if session else "", "address": request.remote}
        self.audit.add("request" if answer.success else "refused", what, answer=answer.message, **who)
        self.events.add("request" if answer.success else "refused", what, answer=answer.message, user=who["user"])
        self._told_answers.append(answer.message)
        self.live.changed()
        return web.json_response(answer.as_dict())

    def application(self):
        app = web.Application(middlewares=[guarded, bounded_request], client_max_size=LARGEST_BODY)
        local = self.settings.is_local and self.users is None
        app["local_session"] = self.sessions.open("local", self.settings.local_role) if local else None
        if local:
            app["local_session"].ends = float("inf")
        app.update(settings=self.settings, sessions=self.sessions, audit=self.audit, body_s=BODY_S)
        add = app.router.add_route
        for path in self.pages:
            add("GET", path, self.page)
        add("GET", "/api/session", self.session)
        add("POST", "/api/login", self.login)
        add("POST", "/api/logout", needs("look")(self.logout))
        add("GET", "/api/live", self.live.handler)
        add("POST", STOP, self.stop)
        Requests(self).add_to(app)
        app.on_startup.append(self._begin)
        app.on_shutdown.append(self._end)
        return app

    async def _begin(self, _app):
        self._tasks = [asyncio.create_task(self.live.run()), asyncio.create_task(self.lost_page.run()),
                       asyncio.create_task(self._watch_users())]
        self.events.add("page", "the operator's page has started")

    async def _watch_users(self):
        """Whoever is removed from the users' file, or gets another role or password there, has to log in anew. No request waits for that disk."""
        while self.users is not None:
            await asyncio.sleep(_USERS_S)
            if await asyncio.to_thread(self.users.look):
                self.sessions.keep(self.users.mark)

    async def _end(self, _app):
        for task in self._tasks:
            task.cancel()
        self.audit.close()
        self.events.close()

    async def page(self, request):
        content, kind = self.pages[request.path]
        return web.Response(body=content, content_type=kind, charset="utf-8" if kind.startswith("text") else None,
                            headers={"Cache-Control": "no-cache"})

    async def session(self, request):
        try:
            session = session_of(request)
        except Refused:
            return web.json_response({"login": True})
        return web.json_response({"login": False, "user": session.user, "role": session.role, "csrf": session.csrf,
                                  "may_log_out": request.app["local_session"] is None,
                                  "slowest_percent": SLOWEST_PERCENT, "fastest_percent": FASTEST_PERCENT})

    async def login(self, request):
        asked = await fields(request, user=str, password=str)
        if self.users is None:
            raise Refused(404, "there are no users; nobody needs to log in")
        wait_s = self.login_limit.wait_s(request.remote)
        if wait_s > 0.0 or self._checking >= 2:
            raise Refused(429, f"too many attempts; try again in {max(1, round(wait_s))} s")
        name = asked["user"] if re.fullmatch(r"[\w.@-]{1,40}", asked["user"]) else ""
        password = asked["password"][:LONGEST_PASSWORD]
        mark = self.users.mark(name)
        self._checking += 1
        try:
            role = await asyncio.get_running_loop().run_in_executor(None, self.users.role, name, password)
        finally:
            self._checking -= 1
        if role is None or mark != self.users.mark(name):
            self.login_limit.failed(request.remote)
            self.audit.add("refused", "login", user=name, role="", address=request.remote, answer="wrong name or password")
            raise Refused(401, "wrong name or password")
        self.login_limit.succeeded(request.remote)
        session = self.sessions.open(name, role, mark)
        self.audit.add("request", "login", user=name, role=role, address=request.remote, answer="welcome")
        answer = web.json_response({"success": True, "message": ""})
        answer.set_cookie(COOKIE, session.token, httponly=True, samesite="Strict", secure=self.settings.tls, path="/")
        return answer

    _checking = 0

    async def logout(self, request, session):
        if request.app["local_session"] is None:
            self.sessions.close(session.token)
        answer = self.note(request, session, "logout", Answer(True, ""))
        answer.del_cookie(COOKIE, path="/")
        return answer

    async def stop(self, request):
        """For everyone: no login, no token, any body."""
        try:
            session = session_of(request)
        except Refused:
            session = Session("", "", "(not logged in)", "", 0.0)
        return self.note(request, session, "stop", await self.stopping.press())
