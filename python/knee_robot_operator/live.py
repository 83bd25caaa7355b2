"""What is sent to the pages without being asked for: state, plots, events. A page that does not keep up loses messages, then its connection."""
import asyncio
import json
import time

from aiohttp import WSMsgType, web

from .access import may
from .guard import needs

LIVE_S = 0.1
STATE_S = 0.5
_SEND_S = 5.0
_MOST_WAITING = 30
MOST_PAGES = 24


class _Page:
    def __init__(self, session):
        self.session = session
        self.waiting = asyncio.Queue(_MOST_WAITING)

    def offer(self, text):
        """Drops the oldest when the page does not keep up."""
        if self.waiting.full():
            self.waiting.get_nowait()
        self.waiting.put_nowait(text)


class Live:
    """The open pages. `snapshot()`: what they are told every STATE_S and after changes; `curves()`: what they are told every LIVE_S."""

    def __init__(self, snapshot, curves, sessions):
        self._snapshot, self._curves, self._sessions = snapshot, curves, sessions
        self._pages = set()
        self._has_changed = False

    def operators(self):
        """Open pages that may operate."""
        return sum(may(page.session.role, "operate") for page in self._pages)

    def changed(self):
        self._has_changed = True

    def tell(self, kind, content):
        if self._pages:
            text = json.dumps({"type": kind, "content": content})
            for page in self._pages:
                page.offer(text)

    async def run(self):
        told, drawn, curve = 0.0, 0.0, None
        while True:
            await asyncio.sleep(LIVE_S / 2)
            now = time.monotonic()
            if self._has_changed or now - told >= STATE_S:
                self._has_changed = False
                told = now
                self.tell("state", self._snapshot())
            newest = self._curves() if self._pages and now - drawn >= LIVE_S else None
            if newest and newest != curve:
                curve, drawn = newest, now
                self.tell("live", curve)

    async def serve(self, request, session):
        """GET /api/live, a WebSocket; whatever the page says on it is ignored."""
        if len(self._pages) >= MOST_PAGES:
            return web.json_response({"success": False, "message": "too many pages are open"}, status=503)
        socket = web.WebSocketResponse(heartbeat=2.0, max_msg_size=1024, compress=False)
        await socket.prepare(request)
        page = _Page(session)
        page.offer(json.dumps({"type": "state", "content": self._snapshot()}))
        self._pages.add(page)
        sender = asyncio.create_task(self._send(socket, page))
        try:
            async for message in socket:
                if message.type is not WSMsgType.TEXT or sender.done():
                    break
        finally:
            self._pages.discard(page)
            sender.cancel()
        return socket

    async def _send(self, socket, page):
        try:
            while not socket.closed:
                text = await page.waiting.get()
                if page.session.token and self._sessions.find(page.session.token) is None:
                    break  # logged out, or the session has ended
                await asyncio.wait_for(socket.send_str(text), _SEND_S)
        except (asyncio.TimeoutError, ConnectionError):
            pass
        asyncio.create_task(socket.close())

    handler = property(lambda self: needs("look")(self.serve))


class LostPage:
    """Pauses what is played when no page that may operate has been open for `patience_s`; 0: never. Only where configured."""

    def __init__(self, robot, live, journal, patience_s, pause, clock=time.monotonic):
        """`pause()`: a coroutine that asks for it."""
        self._robot, self._live, self._journal, self._patience_s, self._pause, self._clock = robot, live, journal, patience_s, pause, clock

    async def run(self):
        if not self._patience_s > 0.0:
            return
        seen, paused = self._clock(), False
        while True:
            await asyncio.sleep(0.1)
            if self._live.operators():
                seen, paused = self._clock(), False
            state = (self._robot.state or {}).get("state")
            if state == "playing" and not paused and self._clock() - seen > self._patience_s:
                paused = True
                answer = await self._pause()
                self._journal.add("page", f"no page is open: pause: {answer.message}")
